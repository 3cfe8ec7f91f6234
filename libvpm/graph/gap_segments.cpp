#include "libvpm/graph/gap_segments.h"

#include <algorithm>
#include <cmath>

#include "libvpm/core/parallel.h"
#include "libvpm/graph/line_lattice.h"

namespace vpm {
namespace {

// Length, in spacings, below which a gap is rounding where a sphere touches another or the mesh.
constexpr double kNegligible = 1e-6;

// Cuts the lines of one row, from left to right.
class RowCutter {
 public:
  RowCutter(const LineLattice& lattice, const SphereBvh& bvh, double spacing, std::uint32_t row)
      : lattice_(lattice), bvh_(bvh), spacing_(spacing), row_(row) {}

  std::vector<GapSegment> cut(const LatticeRows& rows) {
    const std::vector<MeshCrossing> crossings = rows.crossings(row_);
    const std::vector<BallChord> chords = rows.chords(row_);
    auto chord = chords.begin();
    for (auto first = crossings.begin(); first != crossings.end();) {
      auto last = first;
      int winding = 0;
      for (; last != crossings.end() && last->column == first->column; ++last)
        winding += last->winding;
      while (chord != chords.end() && chord->column < first->column) ++chord;
      auto chords_end = chord;
      while (chords_end != chords.end() && chords_end->column == first->column) ++chords_end;
      // Skips lines that slip through a vertex by rounding and do not close; the other lines make
      // up for them.
      if (winding == 0) cut_line({first, last}, {chord, chords_end});
      first = last;
    }
    return std::move(segments_);
  }

 private:
  void cut_line(std::span<const MeshCrossing> crossings, std::span<const BallChord> chords) {
    int winding = 0;
    double enter = 0;
    std::size_t next = 0;
    for (const MeshCrossing& crossing : crossings) {
      const bool was_inside = winding > 0;
      winding += crossing.winding;
      if (!was_inside && winding > 0) enter = crossing.w;
      if (was_inside && winding <= 0)
        cut_interval(crossing.column, enter, crossing.w, chords, next);
    }
  }

  // Adds what the chords leave of [low, high]; `next` is the first chord that may end beyond low.
  void cut_interval(std::uint32_t column, double low, double high,
                    std::span<const BallChord> chords, std::size_t& next) {
    while (next < chords.size() && chords[next].high <= low) ++next;
    for (; next < chords.size() && chords[next].low < high; ++next) {
      owner_ = chords[next].sphere;
      add(column, low, std::min(chords[next].low, high));
      low = std::max(low, chords[next].high);
      if (low >= high) return;
    }
    add(column, low, high);
  }

  void add(std::uint32_t column, double low, double high) {
    const double length = high - low;
    if (!(length > kNegligible * spacing_)) return;
    const int pieces = static_cast<int>(std::ceil(length / spacing_));
    const double half = 0.5 * length / pieces;
    double begin = low, middle = low + half;
    owner_ = bvh_.nearest_surface(point(column, middle), owner_);
    for (int k = 1; k < pieces; ++k) {
      const std::uint32_t owner = owner_;
      const double next = low + length * ((k + 0.5) / pieces);
      owner_ = bvh_.nearest_surface(point(column, next), owner);
      const double end =
          owner == owner_ ? 0.5 * (middle + next) : boundary(column, middle, owner, next, owner_);
      add_piece(column, begin, end, owner);
      begin = end;
      middle = next;
    }
    add_piece(column, begin, high, owner_);
  }

  // Returns where the cells of two spheres meet, between a point of one and a point of the other.
  double boundary(std::uint32_t column, double w0, std::uint32_t sphere0, double w1,
                  std::uint32_t sphere1) const {
    const auto nearer_to_1 = [&](double w) {
      const Vec3 p = point(column, w);
      return surface_distance(p, bvh_.spheres()[sphere0]) -
             surface_distance(p, bvh_.spheres()[sphere1]);
    };
    const double from = nearer_to_1(w0), to = nearer_to_1(w1);
    const double along = to > from ? std::clamp(-from / (to - from), 0.0, 1.0) : 0.5;
    return w0 + along * (w1 - w0);
  }

  void add_piece(std::uint32_t column, double begin, double end, std::uint32_t sphere) {
    const float length = static_cast<float>(end - begin);
    if (length > 0) segments_.push_back({point(column, 0.5 * (begin + end)), length, sphere});
  }

  Vec3 point(std::uint32_t column, double w) const {
    return lattice_.to_xyz({lattice_.u_of(row_, column), lattice_.v_of(row_), w});
  }

  const LineLattice& lattice_;
  const SphereBvh& bvh_;
  const double spacing_;
  const std::uint32_t row_;
  std::uint32_t owner_ = 0;  // sphere at which the next search starts
  std::vector<GapSegment> segments_;
};

}  // namespace

Vec3 GapSegments::half_extent(const GapSegment& segment) const {
  LineLattice lattice;
  lattice.axis = axis;
  return lattice.to_xyz(0.5 * Vec3{column, row, double{segment.length}});
}

GapSegments find_gap_segments(const Solid& solid, const SphereBvh& bvh, double spacing) {
  const LineLattice lattice = make_line_lattice(solid, spacing);
  const LatticeRows rows(lattice, solid, bvh.spheres());
  // Lengthens segments with the lines' spacing, where that was increased to limit their number.
  const double length = std::max({spacing, lattice.du, lattice.dv});
  std::vector<std::vector<GapSegment>> of_row(lattice.rows);
  parallel_for(lattice.rows, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      of_row[row] = RowCutter(lattice, bvh, length, static_cast<std::uint32_t>(row)).cut(rows);
    }
  });
  GapSegments gap{lattice.axis, lattice.dv, lattice.du, {}};
  for (std::vector<GapSegment>& segments : of_row) {
    gap.segments.insert(gap.segments.end(), segments.begin(), segments.end());
    segments = {};
  }
  return gap;
}

}  // namespace vpm
