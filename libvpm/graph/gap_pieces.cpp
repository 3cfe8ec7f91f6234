#include <algorithm>
#include <cmath>

#include "libvpm/core/box.h"
#include "libvpm/graph/cells.h"

namespace vpm {
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

  // Halves the segments at their centroid along the axis of largest spread, until they fit.
  void cut(std::span<GapSegment> segments) {
    Vec3 spread;
    const CellPiece piece = measure(segments, spread);
    if (segments.size() == 1 || piece.moment_radius <= limit_) {
      pieces_.push_back(piece);
      return;
    }
    const int axis =
        spread.x >= spread.y && spread.x >= spread.z ? 0 : (spread.y >= spread.z ? 1 : 2);
    const double at = coordinate(piece.centroid + center_, axis);
    const auto middle =
        std::stable_partition(segments.begin(), segments.end(),
                              [&](const GapSegment& s) { return coordinate(s.center, axis) < at; });
    const std::size_t low = static_cast<std::size_t>(middle - segments.begin());
    if (low == 0 || low == segments.size()) {  // all centres coincide
      pieces_.push_back(piece);
      return;
    }
    cut(segments.first(low));
    cut(segments.subspan(low));
  }

 private:
  // Returns the piece that the segments form; `spread` receives the second moments of their centres
  // along the axes.
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
      piece.reach = std::max(piece.reach, norm(d) + norm(half));
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
};

}  // namespace

void cut_gap(const VoronoiCells& voronoi, std::size_t sphere, Vec3 center, double size,
             std::vector<CellPiece>& pieces) {
  const std::uint32_t begin = voronoi.gap_begin[sphere], end = voronoi.gap_begin[sphere + 1];
  if (begin == end || !(voronoi.gap_scale > 0)) return;
  std::vector<GapSegment> segments(voronoi.gap.segments.begin() + begin,
                                   voronoi.gap.segments.begin() + end);
  GapCutter(voronoi.gap, voronoi.gap_scale, center, size, pieces).cut(segments);
}

}  // namespace vpm
