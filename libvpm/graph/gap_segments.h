// Gap of a packing: the part of the solid in none of its spheres, as short segments of lines.
//
// A lattice of parallel lines crosses the solid along the axis of its largest projection. On each
// line the solid and the spheres are exact intervals; what spheres leave of the solid is cut into
// segments about as long as the lattice's spacing. The only error is that a sum over lines replaces
// an integral. Rows are shifted by the golden ratio, so that faces along the axes do not bias it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/graph/sphere_bvh.h"
#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm {

// Returns the vector whose part along `axis` is w, and whose u and v follow cyclically.
inline Vec3 from_uvw(int axis, Vec3 q) {
  if (axis == 0) return {q.z, q.x, q.y};
  return axis == 1 ? Vec3{q.y, q.z, q.x} : q;
}

// Lattice of parallel lines: w along them, u from column to column, v from row to row.
struct LineLattice {
  int axis = 2;  // axis of w; u and v follow cyclically
  double u0 = 0, v0 = 0, du = 0, dv = 0;
  std::uint32_t columns = 0, rows = 0;

  Vec3 to_uvw(Vec3 p) const;
  Vec3 to_xyz(Vec3 uvw) const { return from_uvw(axis, uvw); }
  double v_of(std::uint32_t row) const { return v0 + (row + 0.5) * dv; }
  double u_of(std::uint32_t row, std::uint32_t column) const;
  // Stores the half-open range of columns whose lines may lie in [low, high]; never too short.
  void columns_between(std::uint32_t row, double low, double high, std::uint32_t& begin,
                       std::uint32_t& end) const;
  void rows_between(double low, double high, std::uint32_t& begin, std::uint32_t& end) const;
};

// Returns lines at most `spacing` apart over the solid's bounding box, along the axis of its
// largest projection.
LineLattice make_line_lattice(const Solid& solid, double spacing);

struct MeshCrossing {
  std::uint32_t column = 0;
  double w = 0;
  int winding = 0;  // +1 into the solid, -1 out of it
};

struct BallChord {
  std::uint32_t column = 0;
  double low = 0, high = 0;
  std::uint32_t sphere = 0;
};

// Intersects a row of lines with the solid and the spheres. Buckets them by rows. Thread-safe once
// made; keeps a reference to the solid's triangles.
class LatticeRows {
 public:
  LatticeRows(const LineLattice& lattice, const Solid& solid, std::span<const Sphere> spheres);

  // Returns intersections by column, then by w. For a closed solid they sum to zero on each line: a
  // line through an edge meets exactly one of its two triangles.
  std::vector<MeshCrossing> crossings(std::uint32_t row) const;
  std::vector<BallChord> chords(std::uint32_t row) const;

 private:
  void cross_triangle(std::uint32_t row, const Triangle& triangle,
                      std::vector<MeshCrossing>& found) const;

  LineLattice lattice_;
  std::vector<Vec3> vertices_;  // as (u, v, w)
  std::span<const Triangle> triangles_;
  std::vector<Sphere> spheres_;
  std::vector<std::vector<std::uint32_t>> triangles_of_row_, spheres_of_row_;
};

struct GapSegment {
  Vec3 center;  // midpoint
  float length = 0;
  std::uint32_t sphere = 0;  // the sphere whose surface is nearest
};

struct GapSegments {
  int axis = 2;                      // direction of the lines
  double row = 0, column = 0;        // spacing of the lines along axis + 2 and axis + 1 (modulo 3)
  std::vector<GapSegment> segments;  // by sphere, then by row of lines
  std::vector<std::uint32_t> begin;  // where each sphere's segments begin; spheres + 1 entries

  // Returns the segments of a sphere.
  std::span<const GapSegment> of(std::size_t sphere) const {
    return std::span(segments).subspan(begin[sphere], begin[sphere + 1] - begin[sphere]);
  }

  // Returns half the edge lengths of the prism that a segment stands for.
  Vec3 half_extent(const GapSegment& segment) const {
    return from_uvw(axis, 0.5 * Vec3{column, row, double{segment.length}});
  }
  double volume(const GapSegment& segment) const { return row * column * double{segment.length}; }
};

// Returns the gap's segments. Inside is where the winding number is positive, so that
// self-intersecting and nested shells count once. `spacing` is the largest distance of lines and
// length of segments. Coordinates must be of magnitude 1.
GapSegments find_gap_segments(const Solid& solid, const SphereBvh& bvh, double spacing);

}  // namespace vpm
