#include "libvpm/graph/voronoi_cells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "libvpm/core/error.h"
#include "libvpm/graph/gap_segments.h"
#include "libvpm/mesh/outer_surface.h"
#include "libvpm/synthetic/shapes.h"
#include "tests/graph/test_packing.h"

namespace vpm {
namespace {

constexpr double kSpacing = 0.01;

VoronoiCells cells_of(const Solid& solid, const std::vector<Sphere>& spheres) {
  const SphereBvh bvh(spheres);
  return find_voronoi_cells(solid, mass_properties(solid), bvh, kSpacing);
}

Solid shifted(Solid solid, Vec3 by) {
  for (Vec3& v : solid.vertices) v += by;
  return solid;
}

// Returns the union of the triangles of several solids.
Solid joined(const Solid& a, const Solid& b) {
  Solid both = a;
  const std::uint32_t first = static_cast<std::uint32_t>(a.vertices.size());
  both.vertices.insert(both.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const Triangle& t : b.triangles)
    both.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return both;
}

Solid inside_out(Solid solid) {
  for (Triangle& t : solid.triangles) std::swap(t[0], t[1]);
  return solid;
}

TEST(VoronoiCells, OneSphereOwnsTheSolid) {
  const Solid cube = shifted(synthetic::make_cube(1), {0.25, 0, 0});
  const VoronoiCells cells = cells_of(cube, {{{0.25, 0, 0}, 0.5}});
  EXPECT_NEAR(cells.volume[0], 1, 1e-13);
  EXPECT_NEAR(norm(cells.centroid[0] - Vec3{0.25, 0, 0}), 0, 1e-13);
  EXPECT_NEAR(cells.radius[0], std::sqrt(0.75), 2 * kSpacing);
  EXPECT_LT(std::abs(cells.quality.volume_error), 1e-3);
}

TEST(VoronoiCells, SymmetricSpheresOwnEqualCells) {
  // Eight balls in the octants of a cube own an octant each, whose middle is the ball's.
  std::vector<Sphere> spheres;
  for (int k = 0; k < 8; ++k) {
    spheres.push_back({{k & 1 ? 0.25 : -0.25, k & 2 ? 0.25 : -0.25, k & 4 ? 0.25 : -0.25}, 0.25});
  }
  const VoronoiCells cells = cells_of(synthetic::make_cube(1), spheres);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_NEAR(cells.volume[i], 0.125, 2e-4);
    EXPECT_NEAR(norm(cells.centroid[i] - spheres[i].center), 0, 1e-3);
  }
}

TEST(VoronoiCells, BoundariesLieWhereSurfacesAreEquallyFar) {
  // Two balls lie in a long box. On the axis between them the boundary is in the middle of the gap;
  // far from it, it is a hyperboloid. The volumes are counted on a fine lattice of points.
  const Solid box = synthetic::make_box(2, 0.5, 0.5);
  const std::vector<Sphere> spheres{{{-0.5, 0, 0}, 0.25}, {{0.4, 0.1, 0}, 0.1}};
  const VoronoiCells cells = cells_of(box, spheres);
  double counted[2] = {0, 0};
  constexpr int kAcross = 50;
  for (int x = 0; x < 4 * kAcross; ++x) {
    for (int y = 0; y < kAcross; ++y) {
      for (int z = 0; z < kAcross; ++z) {
        const Vec3 p = 0.5 / kAcross * Vec3{x + 0.5, y + 0.5, z + 0.5} - Vec3{1, 0.25, 0.25};
        ++counted[surface_distance(p, spheres[1]) < surface_distance(p, spheres[0])];
      }
    }
  }
  EXPECT_NEAR(cells.volume[0], 0.5 * counted[0] / (counted[0] + counted[1]), 1e-3);
  EXPECT_NEAR(cells.volume[1], 0.5 * counted[1] / (counted[0] + counted[1]), 1e-3);
}

TEST(VoronoiCells, SumToTheSolidExactly) {
  for (const test::Shape& shape : {test::cube(), test::tetrahedron(), test::torus()}) {
    const Packing packing = test::greedy_packing(shape, 200, 30000);
    const MassProperties mass = mass_properties(packing.solid);
    const SphereBvh bvh(packing.spheres);
    const VoronoiCells cells =
        find_voronoi_cells(packing.solid, mass, bvh, 0.01 * std::cbrt(mass.volume));
    double sum = 0;
    Vec3 moment;
    for (std::size_t i = 0; i < packing.spheres.size(); ++i) {
      EXPECT_GE(cells.volume[i], volume(packing.spheres[i]));
      EXPECT_GE(cells.radius[i], packing.spheres[i].radius);
      sum += cells.volume[i];
      moment += cells.volume[i] * (cells.centroid[i] - mass.center_of_mass);
    }
    EXPECT_NEAR(sum / mass.volume, 1, 1e-12) << shape.name;
    EXPECT_LT(norm(moment) / mass.volume, 1e-12) << shape.name;
    EXPECT_LT(std::abs(cells.quality.volume_error), 1e-3) << shape.name;
    EXPECT_LT(cells.quality.centroid_error, 1e-3) << shape.name;
  }
}

TEST(VoronoiCells, CavitiesHoldNothing) {
  const Solid hollow = joined(synthetic::make_cube(1), inside_out(synthetic::make_cube(0.6)));
  const VoronoiCells cells = cells_of(hollow, {{{0.4, 0, 0}, 0.1}, {{-0.4, 0, 0}, 0.1}});
  EXPECT_LT(std::abs(cells.quality.volume_error), 2e-3);
  for (const GapSegment& s : cells.gap.segments) {
    EXPECT_GT(std::max({std::abs(s.center.x), std::abs(s.center.y), std::abs(s.center.z)}), 0.295);
  }
  EXPECT_NEAR(cells.volume[0], cells.volume[1], 1e-3);
}

TEST(VoronoiCells, OverlapsAreCountedOnce) {
  const Solid cross = joined(synthetic::make_box(1, 0.5, 0.5), synthetic::make_box(0.5, 1, 0.5));
  const std::vector<Sphere> spheres{{{0, 0, 0}, 0.25}};
  const SphereBvh bvh(spheres);
  const VoronoiCells cells = find_voronoi_cells(cross, enclosed_mass(cross), bvh, kSpacing);
  EXPECT_NEAR(cells.volume[0], 0.375, 1e-12);
  EXPECT_LT(std::abs(cells.quality.volume_error), 2e-3);
}

TEST(VoronoiCells, ThinSheetsAndNeedlesAreFound) {
  for (const Solid& thin : {synthetic::make_box(1, 1e-3, 1), synthetic::make_box(1e-3, 1e-3, 1),
                            synthetic::make_box(1e-3, 1, 1)}) {
    const VoronoiCells cells = cells_of(thin, {{{0, 0, 0}, 4e-4}});
    EXPECT_LT(std::abs(cells.quality.volume_error), 1e-3);
  }
}

// A vertex absurdly far away, as in a damaged file, must not fill all memory with lines.
TEST(LineLattice, IsNoLargerThanMemoryWhateverTheSolid) {
  constexpr std::uint32_t kMost = 4194304 + 1;
  for (const double far : {1e3, 1e9, 1e30}) {
    for (std::size_t k = 0; k < 8; ++k) {
      Solid solid = synthetic::make_cube(0.2);
      solid.vertices[k].x *= far;
      const LineLattice lattice = make_line_lattice(solid, 1e-3);
      EXPECT_LE(lattice.rows, kMost);
      EXPECT_LE(lattice.columns, kMost);
      EXPECT_GT(std::min(lattice.rows, lattice.columns), 0U);
    }
  }
}

TEST(VoronoiCells, RefusesSpheresOfAnotherSolid) {
  EXPECT_THROW(cells_of(synthetic::make_cube(1), {{{0, 0, 0}, 0.7}}), Error);
}

}  // namespace
}  // namespace vpm
