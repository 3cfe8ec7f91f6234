#include "libvpm/cloud/kd_tree.h"

#include <algorithm>
#include <tuple>

namespace vpm {
namespace {

// Ranges of so few points are searched one by one.
constexpr std::size_t kLeaf = 12;

float coordinate(Vec3f p, int axis) {
  return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

int longest_axis(const Vec3f* begin, const Vec3f* end) {
  Vec3f low = *begin, high = *begin;
  for (const Vec3f* p = begin; p != end; ++p) {
    low = {std::min(low.x, p->x), std::min(low.y, p->y), std::min(low.z, p->z)};
    high = {std::max(high.x, p->x), std::max(high.y, p->y), std::max(high.z, p->z)};
  }
  const Vec3 size = widen(high) - widen(low);
  if (size.x >= size.y && size.x >= size.z) return 0;
  return size.y >= size.z ? 1 : 2;
}

}  // namespace

// The n smallest squared distances met so far, ascending.
struct KdTree::Nearest {
  std::vector<double> squares;
  std::size_t wanted;

  double limit() const { return squares.size() < wanted ? HUGE_VAL : squares.back(); }
  void offer(double square) {
    if (!(square < limit())) return;
    if (squares.size() == wanted) squares.pop_back();
    squares.insert(std::upper_bound(squares.begin(), squares.end(), square), square);
  }
};

KdTree::KdTree(std::vector<Vec3f> points) : points_(std::move(points)), axis_(points_.size()) {
  build(0, points_.size());
}

void KdTree::build(std::size_t begin, std::size_t end) {
  if (end - begin <= kLeaf) return;
  const std::size_t middle = begin + (end - begin) / 2;
  const int axis = longest_axis(points_.data() + begin, points_.data() + end);
  const auto at = [this](std::size_t i) {
    return points_.begin() + static_cast<std::ptrdiff_t>(i);
  };
  std::nth_element(at(begin), at(middle), at(end), [axis](Vec3f a, Vec3f b) {
    return std::tuple(coordinate(a, axis), a.x, a.y, a.z) <
           std::tuple(coordinate(b, axis), b.x, b.y, b.z);
  });
  axis_[middle] = static_cast<std::uint8_t>(axis);
  build(begin, middle);
  build(middle + 1, end);
}

double KdTree::squared_distance(Vec3f from, int n) const {
  Nearest nearest{{}, static_cast<std::size_t>(n)};
  nearest.squares.reserve(nearest.wanted + 1);
  search(0, points_.size(), widen(from), nearest);
  return nearest.squares.back();
}

void KdTree::search(std::size_t begin, std::size_t end, Vec3 from, Nearest& nearest) const {
  if (end - begin <= kLeaf) {
    for (std::size_t i = begin; i < end; ++i) nearest.offer(squared_norm(widen(points_[i]) - from));
    return;
  }
  const std::size_t middle = begin + (end - begin) / 2;
  const int axis = axis_[middle];
  const double offset = (axis == 0   ? from.x
                         : axis == 1 ? from.y
                                     : from.z) -
                        static_cast<double>(coordinate(points_[middle], axis));
  nearest.offer(squared_norm(widen(points_[middle]) - from));
  if (offset < 0) {
    search(begin, middle, from, nearest);
    if (offset * offset < nearest.limit()) search(middle + 1, end, from, nearest);
  } else {
    search(middle + 1, end, from, nearest);
    if (offset * offset < nearest.limit()) search(begin, middle, from, nearest);
  }
}

}  // namespace vpm
