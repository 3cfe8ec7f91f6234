#include <algorithm>
#include <array>
#include <cmath>

#include "libvpm/core/pose.h"
#include "libvpm/graph/cells.h"

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

// Sites of a body-centred cubic lattice about the origin, in units of its edge.
class BodyCenteredSites {
 public:
  explicit BodyCenteredSites(double limit)
      : limit_(limit), half_(static_cast<int>(std::ceil(limit)) + 1), side_(2 * half_ + 1) {
    const std::size_t cells = static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_) *
                              static_cast<std::size_t>(side_);
    index_.assign(2 * cells, -1);
  }

  // Returns the index of the site nearest to q; where that lies beyond the limit, the one nearest
  // to a point further in.
  int nearest(Vec3 q) {
    constexpr double kStepInwards = 0.25;
    for (;;) {
      const Site site = nearest_of_lattice(q);
      if (norm(site.position) <= limit_ || site.position == Vec3{}) return index_of(site);
      q = std::max(0.0, 1 - kStepInwards / norm(q)) * q;
    }
  }
  int count() const { return count_; }

 private:
  struct Site {
    Vec3 position;
    std::size_t slot = 0;
  };

  Site site(Vec3 q, double offset, std::size_t sublattice) const {
    const Vec3 cell{std::floor(q.x - offset + 0.5), std::floor(q.y - offset + 0.5),
                    std::floor(q.z - offset + 0.5)};
    const auto slot = [&](double k) {
      return static_cast<std::size_t>(std::clamp(static_cast<int>(k) + half_, 0, side_ - 1));
    };
    const std::size_t side = static_cast<std::size_t>(side_);
    return {cell + Vec3{offset, offset, offset},
            ((slot(cell.z) * side + slot(cell.y)) * side + slot(cell.x)) * 2 + sublattice};
  }
  Site nearest_of_lattice(Vec3 q) const {
    const Site corner = site(q, 0, 0), middle = site(q, 0.5, 1);
    return squared_norm(q - corner.position) <= squared_norm(q - middle.position) ? corner : middle;
  }
  int index_of(const Site& site) {
    if (index_[site.slot] < 0) index_[site.slot] = count_++;
    return index_[site.slot];
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
std::vector<Point> points_in_ball(double radius, double spacing) {
  std::vector<Point> points;
  const int half = static_cast<int>(std::ceil(radius / spacing + 0.5));
  for (int z = -half; z < half; ++z) {
    for (int y = -half; y < half; ++y) {
      for (int x = -half; x < half; ++x) {
        const Vec3 p = spacing * Vec3{x + 0.5, y + 0.5, z + 0.5};
        const double distance = norm(p);
        const double covered = std::min(1.0, (radius - distance) / spacing + 0.5);
        if (!(covered > 0)) continue;
        points.push_back({(1 - 0.5 * (1 - covered) * spacing / distance) * p, covered, 0});
      }
    }
  }
  return points;
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
    const double squared = squared_norm(p.position - piece.centroid);
    piece.moment_radius += p.weight * (squared + spacing * spacing / 4);
    piece.reach = std::max(piece.reach, std::sqrt(squared) + half_diagonal);
  }
  const double scale = volume({{}, radius}) / total;
  for (CellPiece& piece : pieces) {
    piece.moment_radius = std::sqrt(5.0 / 3 * piece.moment_radius / piece.volume);
    piece.volume *= scale;
  }
}

}  // namespace

void cut_ball(double radius, double size, std::vector<CellPiece>& pieces) {
  const double edge = kCubicEdge * size;
  const double limit = radius / edge - kSiteInset / kCubicEdge;  // in units of the lattice
  if (limit < std::sqrt(0.75)) {  // the sites nearest to the first lie at sqrt(3/4)
    pieces.push_back({{}, volume({{}, radius}), radius, radius});
    return;
  }
  BodyCenteredSites sites(limit);
  const double spacing = size / kPointsPerSize;
  std::vector<Point> points = points_in_ball(radius, spacing);
  for (Point& p : points) p.piece = sites.nearest(kTurn * (p.position / edge));
  const std::size_t first = pieces.size();
  pieces.resize(first + static_cast<std::size_t>(sites.count()));
  measure(points, spacing, radius, std::span(pieces).subspan(first));
}

}  // namespace vpm
