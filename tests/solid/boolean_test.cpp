// Volume of what two solids share, against the booleans of CGAL (exact signs, points in doubles)
// and against the reference by columns. Compiled without CGAL, the first is skipped.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "libvpm/synthetic/shapes.h"
#include "libvpm/synthetic/shared_volume.h"
#include "tests/solid/pair_cases.h"

#ifdef VPM_HAVE_CGAL
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Surface_mesh.h>
#endif

namespace vpm {
namespace {

using synthetic::make_torus;
using test::surface;

struct NamedPair {
  const char* name;
  Solid a, b;
};

// Concave pairs, which the tests of convex ones leave out; the third is thin.
std::vector<NamedPair> concave_pairs() {
  const Solid torus = make_torus(.3, .1, 40, 20);
  return {{"tori", torus, make_torus(.35, .08, 36, 16)},
          {"knot and torus", synthetic::make_torus_knot(2, 3, .25, .1, .05, 160, 8), torus},
          {"torus and plate", torus, synthetic::make_box(.6, .6, .006)},
          {"twisted torus and ball", synthetic::make_twisted_torus(.3, .15, 3, 48),
           synthetic::make_icosphere(.25, 3)}};
}

// Calls check(a, b, measured volume, volume of the smaller) with both placed, at poses that meet.
template <class Check>
void for_poses(const Check& check) {
  std::mt19937_64 random(8);
  for (const NamedPair& named : concave_pairs()) {
    SCOPED_TRACE(named.name);
    const auto a = surface(named.a), b = surface(named.b);
    SolidPair pair(a, b);
    int met = 0;
    for (int k = 0; k < 8; ++k) {
      const Pose pose_a = test::random_pose(random, .15), pose_b = test::random_pose(random, .15);
      const double volume = pair.measure(pose_a, pose_b, false).volume;
      met += volume > 0;
      check(test::moved(named.a, pose_a), test::moved(named.b, pose_b), volume,
            std::min(a->volume(), b->volume()));
    }
    EXPECT_GE(met, 4);
  }
}

TEST(SharedVolume, OfConcaveSolidsIsThatOfTheirColumns) {
  for_poses([](const Solid& a, const Solid& b, double volume, double smaller) {
    EXPECT_NEAR(volume, synthetic::shared_volume(a, b), 1e-9 * smaller);
  });
}

#ifdef VPM_HAVE_CGAL

using Mesh = CGAL::Surface_mesh<CGAL::Exact_predicates_inexact_constructions_kernel::Point_3>;

Mesh mesh_of(const Solid& solid) {
  Mesh mesh;
  for (const Vec3& v : solid.vertices) mesh.add_vertex({v.x, v.y, v.z});
  for (const auto& [i, j, k] : solid.triangles)
    mesh.add_face(Mesh::Vertex_index(i), Mesh::Vertex_index(j), Mesh::Vertex_index(k));
  return mesh;
}

TEST(SharedVolume, OfConcaveSolidsIsThatOfCgalsBooleans) {
  namespace processing = CGAL::Polygon_mesh_processing;
  for_poses([](const Solid& a, const Solid& b, double volume, double smaller) {
    Mesh first = mesh_of(a), second = mesh_of(b), both;
    ASSERT_TRUE(processing::corefine_and_compute_intersection(first, second, both));
    const double truth = both.is_empty() ? 0 : CGAL::to_double(processing::volume(both));
    EXPECT_NEAR(volume, truth, 1e-9 * smaller);
  });
}

#else

TEST(SharedVolume, OfConcaveSolidsIsThatOfCgalsBooleans) {
  GTEST_SKIP() << "needs CGAL (Debian: libcgal-dev)";
}

#endif

}  // namespace
}  // namespace vpm
