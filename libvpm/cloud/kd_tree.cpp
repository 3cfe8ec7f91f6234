#include "libvpm/cloud/kd_tree.h"

#include <algorithm>
#include <tuple>

#include "libvpm/core/box.h"

namespace vpm {
namespace {

// Size of ranges that are searched linearly.
constexpr std::size_t kLeaf = 12;

}  // namespace

// The n smallest squared distances found so far, ascending.
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
  Box box;
  for (std::size_t i = begin; i < end; ++i) box.add(widen(points_[i]));
  const int axis = box.longest_axis();
  const auto at = [this](std::size_t i) {
    return points_.begin() + static_cast<std::ptrdiff_t>(i);
  };
  std::nth_element(at(begin), at(middle), at(end), [axis](Vec3f a, Vec3f b) {
    return std::tuple(coordinate(widen(a), axis), a.x, a.y, a.z) <
           std::tuple(coordinate(widen(b), axis), b.x, b.y, b.z);
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
  const double offset = coordinate(from, axis) - coordinate(widen(points_[middle]), axis);
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
