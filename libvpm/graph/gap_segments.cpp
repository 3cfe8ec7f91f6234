#include "libvpm/graph/gap_segments.h"

#include <algorithm>
#include <cmath>
#include <compare>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "libvpm/core/parallel.h"
#include "libvpm/graph/four_spheres.h"

namespace vpm {
namespace {

constexpr double kGoldenRatio = 0.61803398874989485;
// Most lines of a lattice over its projection, and most of its rows and of its columns, so that its
// memory is bounded whatever its shape.
constexpr double kMaxLines = 4194304;

// Returns the area of the solid's projections along x, y and z, counting hidden layers.
Vec3 projected_areas(const Solid& solid) {
  Vec3 area;
  for (const Triangle& t : solid.triangles) {
    const Vec3 a = solid.vertices[t[0]];
    const Vec3 n = cross(solid.vertices[t[1]] - a, solid.vertices[t[2]] - a);
    area += 0.25 * Vec3{std::abs(n.x), std::abs(n.y), std::abs(n.z)};
  }
  return area;
}

std::uint32_t clamp_index(double value, std::uint32_t count) {
  return static_cast<std::uint32_t>(std::clamp(value, 0.0, static_cast<double>(count)));
}

// Side of the edge a-b on which a point lies. Both triangles of an edge get the same answer, since
// the edge is always taken from its lower index to its higher.
struct EdgeSide {
  double twice_area = 0;
  bool left = false;
};
EdgeSide side_of_edge(const std::vector<Vec3>& vertices, std::uint32_t from, std::uint32_t to,
                      double u, double v) {
  const bool swapped = from > to;
  const Vec3 a = vertices[swapped ? to : from], b = vertices[swapped ? from : to];
  const double area = (b.x - a.x) * (v - a.y) - (b.y - a.y) * (u - a.x);
  return {swapped ? -area : area, (area >= 0) != swapped};
}

}  // namespace

Vec3 LineLattice::to_uvw(Vec3 p) const {
  if (axis == 0) return {p.y, p.z, p.x};
  return axis == 1 ? Vec3{p.z, p.x, p.y} : p;
}

double LineLattice::u_of(std::uint32_t row, std::uint32_t column) const {
  const double turns = (row + 1) * kGoldenRatio;
  return u0 + (column + (turns - std::floor(turns)) - 0.5) * du;
}

void LineLattice::columns_between(std::uint32_t row, double low, double high, std::uint32_t& begin,
                                  std::uint32_t& end) const {
  const double first = u_of(row, 0);
  begin = clamp_index(std::floor((low - first) / du), columns);
  end = clamp_index(std::floor((high - first) / du) + 2, columns);
}

void LineLattice::rows_between(double low, double high, std::uint32_t& begin,
                               std::uint32_t& end) const {
  begin = clamp_index(std::floor((low - v0) / dv - 0.5), rows);
  end = clamp_index(std::floor((high - v0) / dv - 0.5) + 2, rows);
}

LineLattice make_line_lattice(const Solid& solid, double spacing) {
  const Vec3 areas = projected_areas(solid);
  LineLattice lattice;
  lattice.axis = areas.z >= areas.x && areas.z >= areas.y ? 2 : (areas.y >= areas.x ? 1 : 0);
  const double area = lattice.to_uvw(areas).z;
  spacing = std::max(spacing, std::sqrt(area / kMaxLines));

  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3 low{kInfinity, kInfinity, kInfinity}, high = -low;
  for (const Vec3& vertex : solid.vertices) {
    const Vec3 q = lattice.to_uvw(vertex);
    low = {std::min(low.x, q.x), std::min(low.y, q.y), std::min(low.z, q.z)};
    high = {std::max(high.x, q.x), std::max(high.y, q.y), std::max(high.z, q.z)};
  }
  const auto cells = [&](double extent) {
    return static_cast<std::uint32_t>(std::ceil(std::clamp(extent / spacing, 1.0, kMaxLines)));
  };
  const std::uint32_t across = cells(high.x - low.x);
  // The shift of rows moves half a column out at either end.
  lattice.columns = across + 1;
  lattice.rows = cells(high.y - low.y);
  lattice.u0 = low.x;
  lattice.v0 = low.y;
  lattice.du = (high.x - low.x) / across;
  lattice.dv = (high.y - low.y) / lattice.rows;
  return lattice;
}

LatticeRows::LatticeRows(const LineLattice& lattice, const Solid& solid,
                         std::span<const Sphere> spheres)
    : lattice_(lattice),
      triangles_(solid.triangles),
      triangles_of_row_(lattice.rows),
      spheres_of_row_(lattice.rows) {
  for (const Vec3& vertex : solid.vertices) vertices_.push_back(lattice.to_uvw(vertex));
  for (const Sphere& s : spheres) spheres_.push_back({lattice.to_uvw(s.center), s.radius});
  std::uint32_t begin = 0, end = 0;
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    const auto [low, high] =
        std::minmax({vertices_[triangles_[t][0]].y, vertices_[triangles_[t][1]].y,
                     vertices_[triangles_[t][2]].y});
    lattice.rows_between(low, high, begin, end);
    for (std::uint32_t row = begin; row < end; ++row) triangles_of_row_[row].push_back(t);
  }
  for (std::uint32_t i = 0; i < spheres_.size(); ++i) {
    lattice.rows_between(spheres_[i].center.y - spheres_[i].radius,
                         spheres_[i].center.y + spheres_[i].radius, begin, end);
    for (std::uint32_t row = begin; row < end; ++row) spheres_of_row_[row].push_back(i);
  }
}

void LatticeRows::cross_triangle(std::uint32_t row, const Triangle& t,
                                 std::vector<MeshCrossing>& found) const {
  const double v = lattice_.v_of(row);
  // Restricts the search to the columns that the triangle covers on this row.
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (int k = 0; k < 3; ++k) {
    const Vec3 a = vertices_[t[static_cast<std::size_t>(k)]],
               b = vertices_[t[static_cast<std::size_t>((k + 1) % 3)]];
    if (std::min(a.y, b.y) > v || std::max(a.y, b.y) < v) continue;
    const double along = a.y == b.y ? 0 : (v - a.y) / (b.y - a.y);
    const double u = a.x + along * (b.x - a.x), other = a.y == b.y ? b.x : u;
    low = std::min({low, u, other});
    high = std::max({high, u, other});
  }
  if (!(low <= high)) return;
  std::uint32_t begin = 0, end = 0;
  lattice_.columns_between(row, low - 0.5 * lattice_.du, high + 0.5 * lattice_.du, begin, end);
  const double a = vertices_[t[0]].z, b = vertices_[t[1]].z, c = vertices_[t[2]].z;
  for (std::uint32_t column = begin; column < end; ++column) {
    const double u = lattice_.u_of(row, column);
    const EdgeSide ab = side_of_edge(vertices_, t[0], t[1], u, v);
    const EdgeSide bc = side_of_edge(vertices_, t[1], t[2], u, v);
    const EdgeSide ca = side_of_edge(vertices_, t[2], t[0], u, v);
    if (ab.left != bc.left || bc.left != ca.left) continue;
    const double area = ab.twice_area + bc.twice_area + ca.twice_area;
    // A triangle seen edge-on has no area; any of its points will do.
    const double w =
        area != 0 ? (bc.twice_area * a + ca.twice_area * b + ab.twice_area * c) / area : a;
    found.push_back(
        {column, std::clamp(w, std::min({a, b, c}), std::max({a, b, c})), ab.left ? -1 : 1});
  }
}

std::vector<MeshCrossing> LatticeRows::crossings(std::uint32_t row) const {
  std::vector<MeshCrossing> found;
  for (const std::uint32_t t : triangles_of_row_[row]) cross_triangle(row, triangles_[t], found);
  std::sort(found.begin(), found.end(), [](const MeshCrossing& a, const MeshCrossing& b) {
    return std::tie(a.column, a.w, b.winding) < std::tie(b.column, b.w, a.winding);
  });
  return found;
}

std::vector<BallChord> LatticeRows::chords(std::uint32_t row) const {
  std::vector<BallChord> found;
  const double v = lattice_.v_of(row);
  std::uint32_t begin = 0, end = 0;
  for (const std::uint32_t i : spheres_of_row_[row]) {
    const Sphere& s = spheres_[i];
    const double across = s.radius * s.radius - (v - s.center.y) * (v - s.center.y);
    if (!(across > 0)) continue;
    const double half_width = std::sqrt(across);
    lattice_.columns_between(row, s.center.x - half_width, s.center.x + half_width, begin, end);
    for (std::uint32_t column = begin; column < end; ++column) {
      const double u = lattice_.u_of(row, column) - s.center.x;
      if (!(across - u * u > 0)) continue;
      const double half = std::sqrt(across - u * u);
      found.push_back({column, s.center.z - half, s.center.z + half, i});
    }
  }
  std::sort(found.begin(), found.end(), [](const BallChord& a, const BallChord& b) {
    return std::tie(a.column, a.low, a.sphere) < std::tie(b.column, b.low, b.sphere);
  });
  return found;
}

namespace {

// Length, in spacings, below which a gap is rounding where a sphere touches another or the mesh.
constexpr double kNegligible = 1e-6;

// Rows of lines that a thread cuts one after the other, and places of each line, that share a list
// of near spheres.
constexpr std::uint32_t kTogether = 4;

// Finds the spheres nearest to places of a few rows of lines. Places in one cell of the lattice, of
// kTogether rows, columns and spacings, share a list of the spheres that can be nearest to any of
// them, which one search of the tree finds. Belongs to one thread.
class NearestSpheres {
 public:
  NearestSpheres(const LineLattice& lattice, const SphereBvh& bvh, double spacing)
      : lattice_(lattice), bvh_(bvh), depth_(kTogether * spacing) {}

  // Returns the sphere with the surface nearest to the place x, which lies at w on a line, the
  // lowest of equal ones. `start` is a guess.
  std::uint32_t nearest(std::uint32_t row, std::uint32_t column, double w, Vec3 x,
                        std::uint32_t start) {
    const Cell cell{row / kTogether, column / kTogether,
                    static_cast<std::int64_t>(std::floor(w / depth_))};
    if (last_ == nullptr || cell != last_cell_) {
      const auto [place, is_new] = lists_.try_emplace(cell);
      last_ = &place->second;
      last_cell_ = cell;
      if (is_new) fill(cell, start);
    }
    return last_->numbers.empty() ? bvh_.nearest_surface(x, start) : nearest_of(*last_, x);
  }

 private:
  // Most spheres in a list, with which it is no slower than the tree.
  static constexpr std::size_t kMost = 96;

  struct Cell {
    std::uint32_t row, column;  // in kTogether
    std::int64_t depth;         // along the lines
    friend auto operator<=>(const Cell&, const Cell&) = default;
  };
  struct List {
    std::vector<std::uint32_t> numbers;
    std::vector<FourSpheres> spheres;
  };

  // Fills the list of a cell with the spheres not farther from the middle of its places than the
  // nearest is, by the way to its corner and back. Leaves the list empty if they are too many.
  void fill(const Cell& cell, std::uint32_t start) {
    constexpr double kHalf = 0.5 * kTogether;
    const double u = lattice_.u0 + (kTogether * cell.column + kHalf - 0.5) * lattice_.du,
                 v = lattice_.v0 + (kTogether * cell.row + kHalf) * lattice_.dv,
                 w = (static_cast<double>(cell.depth) + 0.5) * depth_;
    const Vec3 middle = lattice_.to_xyz({u, v, w});
    const double reach = norm({kHalf * lattice_.du, kHalf * lattice_.dv, 0.5 * depth_});
    const std::uint32_t nearest = bvh_.nearest_surface(middle, start);
    const double farthest =
        surface_distance(middle, bvh_.spheres()[nearest]) + 2 * reach + kBvhSlack;
    std::vector<std::uint32_t> near;
    bvh_.walk(
        middle,
        [&](std::uint32_t, double bound) { return bound <= farthest && near.size() <= kMost; },
        [&](std::uint32_t i) {
          if (surface_distance(middle, bvh_.spheres()[i]) <= farthest) near.push_back(i);
        });
    if (near.size() > kMost) return;
    std::sort(near.begin(), near.end());
    std::vector<Sphere> spheres;
    for (const std::uint32_t i : near) spheres.push_back(bvh_.spheres()[i]);
    *last_ = {std::move(near), in_fours(spheres)};
  }

  VPM_VECTOR_CLONES
  static std::uint32_t nearest_of(const List& list, Vec3 x) {
    const Vec3x4 place{x, x, x, x};
    LeastOfFours nearest;
    for (const FourSpheres& four : list.spheres)
      nearest.add(square_root(squared_norm(place - four.centers())) - four.radii());
    return list.numbers[nearest.first()];
  }

  const LineLattice& lattice_;
  const SphereBvh& bvh_;
  const double depth_;  // of a cell along the lines
  std::map<Cell, List> lists_;
  Cell last_cell_{};
  List* last_ = nullptr;
};

// Cuts the lines of one row, from left to right.
class RowCutter {
 public:
  RowCutter(const LineLattice& lattice, const SphereBvh& bvh, NearestSpheres& nearest,
            double spacing, std::uint32_t row)
      : lattice_(lattice), bvh_(bvh), nearest_(nearest), spacing_(spacing), row_(row) {}

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
    owner_ = nearest_to(column, middle);
    for (int k = 1; k < pieces; ++k) {
      const std::uint32_t owner = owner_;
      const double next = low + length * ((k + 0.5) / pieces);
      owner_ = nearest_to(column, next);
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

  std::uint32_t nearest_to(std::uint32_t column, double w) {
    return nearest_.nearest(row_, column, w, point(column, w), owner_);
  }
  Vec3 point(std::uint32_t column, double w) const {
    return lattice_.to_xyz({lattice_.u_of(row_, column), lattice_.v_of(row_), w});
  }

  const LineLattice& lattice_;
  const SphereBvh& bvh_;
  NearestSpheres& nearest_;
  const double spacing_;
  const std::uint32_t row_;
  std::uint32_t owner_ = 0;  // sphere at which the next search starts
  std::vector<GapSegment> segments_;
};

}  // namespace

GapSegments find_gap_segments(const Solid& solid, const SphereBvh& bvh, double spacing) {
  const LineLattice lattice = make_line_lattice(solid, spacing);
  const LatticeRows rows(lattice, solid, bvh.spheres());
  // Lengthens segments with the lines' spacing, where that was increased to limit their number.
  const double length = std::max({spacing, lattice.du, lattice.dv});
  std::vector<std::vector<GapSegment>> of_row(lattice.rows);
  parallel_for(lattice.rows, kTogether, [&](std::size_t begin, std::size_t end) {
    NearestSpheres nearest(lattice, bvh, length);
    for (std::size_t row = begin; row < end; ++row) {
      of_row[row] =
          RowCutter(lattice, bvh, nearest, length, static_cast<std::uint32_t>(row)).cut(rows);
    }
  });
  GapSegments gap{lattice.axis, lattice.dv, lattice.du, {}, {}};
  gap.begin.assign(bvh.spheres().size() + 1, 0);
  for (const std::vector<GapSegment>& segments : of_row)
    for (const GapSegment& s : segments) ++gap.begin[s.sphere + 1];
  std::partial_sum(gap.begin.begin(), gap.begin.end(), gap.begin.begin());
  std::vector<std::uint32_t> next(gap.begin.begin(), gap.begin.end() - 1);
  gap.segments.resize(gap.begin.back());
  for (std::vector<GapSegment>& segments : of_row) {
    for (const GapSegment& s : segments) gap.segments[next[s.sphere]++] = s;
    segments = {};
  }
  return gap;
}

}  // namespace vpm
