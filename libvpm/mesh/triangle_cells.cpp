#include "libvpm/mesh/triangle_cells.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "libvpm/mesh/work_limit.h"

namespace vpm {
namespace {

// Tolerance for coordinates of magnitude 1: well above their rounding, well below what has a
// volume.
constexpr double kTolerance = 1e-12;

struct Line {
  Vec2 normal;  // unit length
  double offset = 0;
  double side(Vec2 p) const { return normal.x * p.x + normal.y * p.y - offset; }
};

Vec2 between(Vec2 a, Vec2 b, double t) {
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

std::optional<Line> line_through(const TriangleSegment& s) {
  const double dx = s.to.x - s.from.x, dy = s.to.y - s.from.y,
               length = std::sqrt(dx * dx + dy * dy);
  if (!(length > kTolerance)) return std::nullopt;
  const Vec2 normal{-dy / length, dx / length};
  return Line{normal, normal.x * s.from.x + normal.y * s.from.y};
}

// Clips the segment to `distance` >= 0. Returns false if the rest is too short to cut.
template <class Distance>
bool clip(TriangleSegment& s, Distance distance) {
  const double a = distance(s.from), b = distance(s.to);
  if (a < 0 && b < 0) return false;
  if (a < 0) s.from = between(s.from, s.to, a / (a - b));
  if (b < 0) s.to = between(s.to, s.from, b / (b - a));
  return line_through(s).has_value();
}

bool clip_to_triangle(TriangleSegment& s) {
  return clip(s, [](Vec2 p) { return p.x; }) && clip(s, [](Vec2 p) { return p.y; }) &&
         clip(s, [](Vec2 p) { return 1 - p.x - p.y; });
}

// Returns the part of a convex polygon where sign * side >= 0.
std::vector<Vec2> half_of(const std::vector<Vec2>& polygon, const Line& line, double sign) {
  std::vector<Vec2> half;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2 p = polygon[k], q = polygon[(k + 1) % polygon.size()];
    const double at_p = sign * line.side(p), at_q = sign * line.side(q);
    if (at_p >= 0) half.push_back(p);
    if ((at_p >= 0) != (at_q >= 0)) half.push_back(between(p, q, at_p / (at_p - at_q)));
  }
  return half;
}

class Partition {
 public:
  void insert(TriangleSegment segment) {
    const std::optional<Line> line = line_through(segment);
    if (!line || !clip_to_triangle(segment)) return;
    std::vector<std::pair<std::size_t, TriangleSegment>> rest{{0, segment}};
    while (!rest.empty()) {
      const auto [at, piece] = rest.back();
      rest.pop_back();
      work_ += kVisit;
      if (nodes_[at].front == 0) {
        split(at, *line);
      } else {
        descend(at, piece, rest);
      }
    }
  }

  std::uint64_t work() const { return work_; }

  std::vector<std::vector<Vec2>> cells() && {
    std::vector<std::vector<Vec2>> cells;
    for (Node& node : nodes_) {
      if (node.front == 0) cells.push_back(std::move(node.polygon));
    }
    return cells;
  }

 private:
  struct Node {
    std::vector<Vec2> polygon;  // set in leaves
    Line line;
    std::size_t front = 0, back = 0;  // 0 in leaves
  };

  void descend(std::size_t at, const TriangleSegment& piece,
               std::vector<std::pair<std::size_t, TriangleSegment>>& rest) const {
    const Node& node = nodes_[at];
    const double a = node.line.side(piece.from), b = node.line.side(piece.to);
    if (std::abs(a) <= kTolerance && std::abs(b) <= kTolerance) return;  // cut here already
    if (a >= -kTolerance && b >= -kTolerance) return rest.emplace_back(node.front, piece), void();
    if (a <= kTolerance && b <= kTolerance) return rest.emplace_back(node.back, piece), void();
    const Vec2 middle = between(piece.from, piece.to, a / (a - b));
    const TriangleSegment first{piece.from, middle}, second{middle, piece.to};
    rest.emplace_back(node.front, a > 0 ? first : second);
    rest.emplace_back(node.back, a > 0 ? second : first);
  }

  void split(std::size_t at, const Line& line) {
    const auto [least, most] =
        std::minmax_element(nodes_[at].polygon.begin(), nodes_[at].polygon.end(),
                            [&](Vec2 p, Vec2 q) { return line.side(p) < line.side(q); });
    if (line.side(*least) > -kTolerance || line.side(*most) < kTolerance) return;
    Node front, back;
    front.polygon = half_of(nodes_[at].polygon, line, 1);
    back.polygon = half_of(nodes_[at].polygon, line, -1);
    nodes_[at] = {{}, line, nodes_.size(), nodes_.size() + 1};
    nodes_.push_back(std::move(front));
    nodes_.push_back(std::move(back));
    work_ += work::kPiece;
  }

  // Cost of testing a segment against one line.
  static constexpr std::uint64_t kVisit = 2;

  std::uint64_t work_ = 0;
  std::vector<Node> nodes_{Node{{{0, 0}, {1, 0}, {0, 1}}, {}, 0, 0}};
};

}  // namespace

std::vector<std::vector<Vec2>> triangle_cells(const std::vector<TriangleSegment>& segments,
                                              std::uint64_t most_work, std::uint64_t& work) {
  Partition partition;
  for (const TriangleSegment& s : segments) {
    partition.insert(s);
    if (work + partition.work() > most_work) break;
  }
  work += partition.work();
  if (work > most_work) return {};
  return std::move(partition).cells();
}

}  // namespace vpm
