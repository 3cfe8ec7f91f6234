#include "libvpm/graph/cell_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "libvpm/core/box.h"
#include "libvpm/core/lanes.h"
#include "libvpm/core/parallel.h"
#include "libvpm/core/pose.h"
#include "libvpm/core/vec3x4.h"
#include "libvpm/graph/enclosing_sphere.h"

namespace vpm {
namespace {

// Number of points per size and axis that measure a piece's moments.
constexpr double kPointsPerSize = 4;
// Least distance of sites from the ball's surface, in sizes; nearer ones would have slivers as
// cells.
constexpr double kSiteInset = 0.4;
// Edge of the cubic cell of a body-centred lattice with two sites per cell: cbrt(2).
constexpr double kCubicEdge = 1.2599210498948732;
// Rotation of the lattice; any without symmetry will do.
const Rotation kTurn = rotation_from_quaternion(
    {0.18257418583505536, 0.36514837167011072, 0.54772255750516607, 0.73029674334022143});

// Returns the largest whole numbers that are not above x, whose lanes lie within those of Int4.
[[gnu::always_inline]] inline Double4 floor_of(const Double4& x) {
  const Double4 whole = widen(truncated(x));
  return whole > x ? whole - 1.0 : whole;
}

// Sites of a body-centred cubic lattice about the origin, in units of its edge.
class BodyCenteredSites {
 public:
  explicit BodyCenteredSites(double limit)
      : limit_(limit), half_(static_cast<int>(std::ceil(limit)) + 1), side_(2 * half_ + 1) {
    const std::size_t cells = static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_) *
                              static_cast<std::size_t>(side_);
    index_.assign(2 * cells, -1);
  }

  // Returns the indices of the sites nearest to four places; where such a site lies beyond the
  // limit, that of the one nearest to a point further in.
  [[gnu::always_inline]] std::array<int, kFour> nearest(Vec3x4 q) {
    constexpr double kStepInwards = 0.25;
    for (;;) {
      const Sites corners = sites(q, 0), middles = sites(q, 0.5);
      const Mask4 is_corner =
          squared_norm(q - corners.position) <= squared_norm(q - middles.position);
      const Vec3x4 position = choose(is_corner, corners.position, middles.position);
      const Mask4 is_beyond = square_root(squared_norm(position)) > limit_;
      if (!any(is_beyond))
        return indices_of(choose(is_corner, corners.cell, middles.cell), is_corner);
      const Double4 kept = 1 - kStepInwards / square_root(squared_norm(q)), none{};
      q = choose(is_beyond, (none < kept ? kept : none) * q, q);
    }
  }
  int count() const { return count_; }

 private:
  // The nearest sites of one of the two cubic lattices, and the low corners of their cells.
  struct Sites {
    Vec3x4 position, cell;
  };

  [[gnu::always_inline]] static Sites sites(const Vec3x4& q, double offset) {
    const Vec3x4 cell{floor_of(q.x - offset + 0.5), floor_of(q.y - offset + 0.5),
                      floor_of(q.z - offset + 0.5)};
    return {{cell.x + offset, cell.y + offset, cell.z + offset}, cell};
  }
  [[gnu::always_inline]] std::array<int, kFour> indices_of(const Vec3x4& cell,
                                                           const Mask4& is_corner) {
    const auto slot = [&](double k) {
      return static_cast<std::size_t>(std::clamp(static_cast<int>(k) + half_, 0, side_ - 1));
    };
    const std::size_t side = static_cast<std::size_t>(side_);
    std::array<int, kFour> indices{};
    for (int k = 0; k < kFour; ++k) {
      int& index =
          index_[((slot(cell.z[k]) * side + slot(cell.y[k])) * side + slot(cell.x[k])) * 2 +
                 (is_corner[k] != 0 ? 0 : 1)];
      if (index < 0) index = count_++;
      indices[static_cast<std::size_t>(k)] = index;
    }
    return indices;
  }

  double limit_;
  int half_, side_, count_ = 0;
  std::vector<int> index_;
};

struct Point {
  Vec3 position;
  double weight = 0;
  int piece = 0;
};

// Returns a cubic lattice of points in the ball about the origin, symmetric to it. A point at the
// surface weighs as much as the ball covers of its cube, and is moved to the middle of that.
VPM_VECTOR_CLONES
std::vector<Point> points_in_ball(double radius, double spacing) {
  std::vector<Point> points;
  const int half = static_cast<int>(std::ceil(radius / spacing + 0.5));
  const Double4 zero{}, one = zero + 1.0;
  for (int z = -half; z < half; ++z) {
    for (int y = -half; y < half; ++y) {
      for (int x = -half; x < half; x += kFour) {
        const Vec3x4 p{spacing * (widen(Int4{x, x + 1, x + 2, x + 3}) + 0.5),
                       zero + spacing * (y + 0.5), zero + spacing * (z + 0.5)};
        const Double4 distance = square_root(squared_norm(p));
        const Double4 part = (radius - distance) / spacing + 0.5;
        if (!any(part > zero)) continue;
        const Double4 covered = part < one ? part : one;
        const Vec3x4 moved = (1.0 - 0.5 * (1.0 - covered) * spacing / distance) * p;
        for (int k = 0; k < kFour; ++k)
          if (covered[k] > 0) points.push_back({moved.of(k), covered[k], 0});
      }
    }
  }
  return points;
}

// Gives each point the piece of the site nearest to it, of a turned lattice of this edge.
VPM_VECTOR_CLONES
void find_pieces(double edge, BodyCenteredSites& sites, std::span<Point> points) {
  const Double4 edges = Double4{} + edge;
  for (std::size_t first = 0; first < points.size(); first += kFour) {
    const auto [a, b, c, d] = four_of(std::span<const Point>(points), first);
    const Vec3x4 p{a.position, b.position, c.position, d.position};
    const Vec3x4 q{p.x / edges, p.y / edges, p.z / edges};
    const std::array<int, kFour> pieces =
        sites.nearest({dot(kTurn.row0, q), dot(kTurn.row1, q), dot(kTurn.row2, q)});
    for (std::size_t k = 0; k < kFour && first + k < points.size(); ++k)
      points[first + k].piece = pieces[k];
  }
}

// Measures pieces in two passes: volumes and centroids, then moments and radii about the centroids.
void measure(const std::vector<Point>& points, double spacing, double radius,
             std::span<CellPiece> pieces) {
  for (const Point& p : points) {
    CellPiece& piece = pieces[static_cast<std::size_t>(p.piece)];
    piece.volume += p.weight;
    piece.centroid += p.weight * p.position;
  }
  double total = 0;
  Vec3 moment;
  for (CellPiece& piece : pieces) {
    total += piece.volume;
    moment += piece.centroid;
    piece.centroid = piece.centroid / piece.volume;
  }
  for (CellPiece& piece : pieces) piece.centroid -= moment / total;
  const double half_diagonal = 0.5 * std::sqrt(3.0) * spacing;
  for (const Point& p : points) {
    CellPiece& piece = pieces[static_cast<std::size_t>(p.piece)];
    const Vec3 d = p.position - piece.centroid;
    const double squared = squared_norm(d);
    piece.moment_radius += p.weight * (squared + spacing * spacing / 4);
    piece.bounding_radius = std::max(piece.bounding_radius, squared);
    piece.moment.add(p.weight, d, spacing / 2 * Vec3{1, 1, 1});
  }
  const double scale = volume({{}, radius}) / total;
  for (CellPiece& piece : pieces) {
    piece.moment_radius = std::sqrt(5.0 / 3 * piece.moment_radius / piece.volume);
    piece.bounding_radius = std::sqrt(piece.bounding_radius) + half_diagonal;
    piece.moment.scale(1 / piece.volume);
    piece.volume *= scale;
  }
}

}  // namespace

void cut_ball(double radius, double size, std::vector<CellPiece>& pieces) {
  const double edge = kCubicEdge * size;
  const double limit = radius / edge - kSiteInset / kCubicEdge;  // in units of the lattice
  if (limit < std::sqrt(0.75)) {  // the sites nearest to the first lie at sqrt(3/4)
    pieces.push_back({{}, volume({{}, radius}), radius, radius, Moment::of_ball(radius)});
    return;
  }
  BodyCenteredSites sites(limit);
  const double spacing = size / kPointsPerSize;
  std::vector<Point> points = points_in_ball(radius, spacing);
  find_pieces(edge, sites, points);
  const std::size_t first = pieces.size();
  pieces.resize(first + static_cast<std::size_t>(sites.count()));
  measure(points, spacing, radius, std::span(pieces).subspan(first));
}

namespace {

// Largest moment radius of a piece, in sizes. A compact piece of volume size^3 has 0.63. Pieces of
// the gap are smaller, since they line the solid's surface, where errors of neighbours add up
// instead of cancelling.
constexpr double kMomentRadius = 0.5;

class GapCutter {
 public:
  GapCutter(const GapSegments& gap, double scale, Vec3 center, double size,
            std::vector<CellPiece>& pieces)
      : gap_(gap), scale_(scale), center_(center), limit_(kMomentRadius * size), pieces_(pieces) {}

  // Halves the segments at their centroid along the axis of largest spread, until they fit; sorts
  // them by piece.
  void cut(std::span<GapSegment> segments) {
    Vec3 spread;
    const CellPiece piece = measure(segments, spread);
    if (segments.size() == 1 || piece.moment_radius <= limit_) return keep(piece, segments);
    const int axis =
        spread.x >= spread.y && spread.x >= spread.z ? 0 : (spread.y >= spread.z ? 1 : 2);
    const double at = coordinate(piece.centroid + center_, axis);
    const std::size_t low = part(segments, axis, at);
    if (low == 0 || low == segments.size()) return keep(piece, segments);  // all centres coincide
    cut(segments.first(low));
    cut(segments.subspan(low));
  }

 private:
  // Moves the segments below `at` before the others, each in their order; returns their number.
  // std::stable_partition takes memory anew each time, which takes as long as the rest.
  std::size_t part(std::span<GapSegment> segments, int axis, double at) {
    others_.clear();
    std::size_t low = 0;
    for (const GapSegment& s : segments) {
      if (coordinate(s.center, axis) < at) {
        segments[low++] = s;
      } else {
        others_.push_back(s);
      }
    }
    std::copy(others_.begin(), others_.end(), segments.begin() + static_cast<std::ptrdiff_t>(low));
    return low;
  }

  // Keeps a piece that is cut no further, with its bounding radius and its second moment.
  void keep(CellPiece piece, std::span<const GapSegment> segments) {
    for (const GapSegment& s : segments) {
      const Vec3 d = s.center - center_ - piece.centroid, half_extent = gap_.half_extent(s);
      piece.bounding_radius = std::max(piece.bounding_radius, norm(d) + norm(half_extent));
      piece.moment.add(scale_ * gap_.volume(s), d, half_extent);
    }
    piece.moment.scale(1 / piece.volume);
    pieces_.push_back(piece);
  }

  // Returns the piece that the segments form, without its bounding radius and second moment;
  // `spread` receives the second moments of their centres along the axes.
  CellPiece measure(std::span<const GapSegment> segments, Vec3& spread) const {
    CellPiece piece;
    for (const GapSegment& s : segments) {
      const double v = scale_ * gap_.volume(s);
      piece.volume += v;
      piece.centroid += v * (s.center - center_);
    }
    piece.centroid = piece.centroid / piece.volume;
    double own = 0;  // second moment of the prisms about their own centres
    for (const GapSegment& s : segments) {
      const double v = scale_ * gap_.volume(s);
      const Vec3 d = s.center - center_ - piece.centroid, half = gap_.half_extent(s);
      spread += v * Vec3{d.x * d.x, d.y * d.y, d.z * d.z};
      own += v * squared_norm(half) / 3;
    }
    piece.moment_radius =
        std::sqrt(5.0 / 3 * (spread.x + spread.y + spread.z + own) / piece.volume);
    return piece;
  }

  const GapSegments& gap_;
  const double scale_;
  const Vec3 center_;
  const double limit_;
  std::vector<CellPiece>& pieces_;
  std::vector<GapSegment> others_;
};

}  // namespace

void cut_gap(VoronoiCells& cells, std::size_t sphere, Vec3 center, double size,
             std::vector<CellPiece>& pieces) {
  const std::uint32_t begin = cells.gap.begin[sphere], end = cells.gap.begin[sphere + 1];
  if (begin == end || !(cells.gap_scale > 0)) return;
  GapCutter(cells.gap, cells.gap_scale, center, size, pieces)
      .cut(std::span(cells.gap.segments).subspan(begin, end - begin));
}

namespace {

constexpr std::size_t kBlockSamples = 64;

// Sorts pieces into runs of `size` that are compact in space, and appends the ends of the runs. All
// runs but one of a split are full.
void group(std::span<CellPiece> pieces, std::size_t size, std::size_t offset,
           std::vector<std::size_t>& ends) {
  if (pieces.size() <= size) {
    ends.push_back(offset + pieces.size());
    return;
  }
  Box box;
  for (const CellPiece& p : pieces) box.add(p.centroid);
  const int axis = box.longest_axis();
  std::stable_sort(pieces.begin(), pieces.end(), [&](const CellPiece& a, const CellPiece& b) {
    return coordinate(a.centroid, axis) < coordinate(b.centroid, axis);
  });
  const std::size_t runs = (pieces.size() + size - 1) / size;
  const std::size_t middle = runs / 2 * size;
  group(pieces.first(middle), size, offset, ends);
  group(pieces.subspan(middle), size, offset + middle, ends);
}

float round_up(double value) {
  const float rounded = static_cast<float>(value);
  return double{rounded} < value ? std::nextafter(rounded, std::numeric_limits<float>::infinity())
                                 : rounded;
}

// Maps pieces about a sphere's centre to stored coordinates.
struct Placement {
  Vec3 origin;  // of what is stored
  Vec3 center;  // sphere's centre relative to it
  double unit = 1, volume = 1;

  Vec3f place(Vec3 p) const { return narrow(unit * (center + p)); }
  CellSample sample(const CellPiece& piece) const {
    return {place(piece.centroid), static_cast<float>(unit * piece.moment_radius),
            piece.volume / volume};
  }
  // Finds the face beside a piece whose centroid is where it is stored, that is rounded to float.
  // Moves the centroid back into the solid where it is not.
  void find_face(const SolidFaces& faces, CellPiece& piece) const {
    const Vec3 stored = widen(place(piece.centroid)) / unit + origin;
    Vec3 inside = stored;
    piece.face = faces.beside(inside, piece.moment_radius, piece.moment);
    piece.centroid += inside - stored;
    piece.bounding_radius += norm(inside - stored);
  }
  SampleFace face(SampleFace face, std::size_t sample) const {
    face.sample = static_cast<std::uint32_t>(sample);
    for (float* const extent : {&face.toward, &face.away, &face.along, &face.across})
      *extent *= static_cast<float>(unit);  // a power of two
    return face;
  }
  CellBlock block(std::span<const CellPiece> pieces) const {
    std::vector<Sphere> balls;
    for (const CellPiece& p : pieces) balls.push_back({p.centroid, p.bounding_radius});
    const Vec3f stored = place(enclosing_sphere(balls).center);
    const Vec3 at = widen(stored) / unit - center;
    return {stored, round_up(unit * enclosing_radius(at, balls)), 0, 0};
  }
};

struct CutCell {
  std::vector<CellBlock> blocks;
  std::vector<CellSample> samples;
  std::vector<SampleFace> faces;
};

// Orders the pieces of a block: those beside faces come last, and each run of four lies side by
// side. The run that has both kinds takes the faces nearest to its balls.
void order_block(std::span<CellPiece> pieces) {
  std::vector<std::size_t> runs;
  const auto beside_faces = std::stable_partition(
      pieces.begin(), pieces.end(), [](const CellPiece& piece) { return !piece.face; });
  const auto balls = static_cast<std::size_t>(beside_faces - pieces.begin());
  group(pieces.first(balls), kNeighborSamples, 0, runs);
  const std::size_t mixed = std::min(
      (kNeighborSamples - balls % kNeighborSamples) % kNeighborSamples, pieces.size() - balls);
  if (mixed > 0) {
    const Vec3 last = pieces[balls - 1].centroid;
    std::stable_sort(beside_faces, pieces.end(), [&](const CellPiece& a, const CellPiece& b) {
      return squared_norm(a.centroid - last) < squared_norm(b.centroid - last);
    });
  }
  group(pieces.subspan(balls + mixed), kNeighborSamples, 0, runs);
}

CutCell cut_cell(std::vector<CellPiece> pieces, const SolidFaces& faces,
                 const Placement& placement) {
  std::vector<std::size_t> ends;
  for (CellPiece& piece : pieces) placement.find_face(faces, piece);
  group(pieces, kBlockSamples, 0, ends);
  CutCell cell;
  std::size_t begin = 0;
  for (const std::size_t end : ends) {
    const std::span<CellPiece> of_block = std::span(pieces).subspan(begin, end - begin);
    order_block(of_block);
    CellBlock block = placement.block(of_block);
    block.begin = static_cast<std::uint32_t>(begin);
    block.end = static_cast<std::uint32_t>(end);
    cell.blocks.push_back(block);
    begin = end;
  }
  for (const CellPiece& piece : pieces) {
    if (piece.face) cell.faces.push_back(placement.face(*piece.face, cell.samples.size()));
    cell.samples.push_back(placement.sample(piece));
  }
  return cell;
}

}  // namespace

CutCells cut_cells(std::span<const Sphere> spheres, VoronoiCells& cells, const SolidFaces& faces,
                   double size, Vec3 origin, double unit, double volume) {
  std::vector<CutCell> of_sphere(spheres.size());
  parallel_for(spheres.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::vector<CellPiece> pieces;
      cut_ball(spheres[i].radius, size, pieces);
      cut_gap(cells, i, spheres[i].center, size, pieces);
      of_sphere[i] =
          cut_cell(std::move(pieces), faces, {origin, spheres[i].center - origin, unit, volume});
    }
  });
  CutCells all;
  for (const CutCell& cell : of_sphere) {
    const std::uint32_t first = static_cast<std::uint32_t>(all.samples.size());
    all.block_begin.push_back(static_cast<std::uint32_t>(all.blocks.size()));
    for (CellBlock block : cell.blocks) {
      block.begin += first;
      block.end += first;
      all.blocks.push_back(block);
    }
    all.samples.insert(all.samples.end(), cell.samples.begin(), cell.samples.end());
    for (SampleFace face : cell.faces) {
      face.sample += first;
      all.faces.push_back(face);
    }
  }
  all.block_begin.push_back(static_cast<std::uint32_t>(all.blocks.size()));
  return all;
}

}  // namespace vpm
