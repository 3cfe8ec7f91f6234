#include "libvpm/cloud/kd_tree.h"

#include <algorithm>
#include <tuple>

#include "libvpm/core/box.h"

namespace vpm {
namespace {

// Size of ranges that are searched linearly.
constexpr std::size_t kLeaf = 12;

}  // namespace

// The n nearest points found so far, ascending by their squared distances.
struct KdTree::Nearest {
  std::vector<double> squares;
  std::vector<std::uint32_t>* indices;  // of the same points; null if nobody asks
  std::size_t wanted;

  double limit() const { return squares.size() < wanted ? HUGE_VAL : squares.back(); }
  void offer(double square, std::uint32_t index) {
    if (!(square < limit())) return;
    const bool is_full = squares.size() == wanted;
    if (is_full) squares.pop_back();
    const auto at =
        squares.insert(std::upper_bound(squares.begin(), squares.end(), square), square);
    if (indices == nullptr) return;
    if (is_full) indices->pop_back();
    indices->insert(indices->begin() + (at - squares.begin()), index);
  }
};

KdTree::KdTree(std::span<const Vec3f> points) : axis_(points.size()) {
  points_.reserve(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) points_.push_back({points[i], i});
  build(0, points_.size());
}

void KdTree::build(std::size_t begin, std::size_t end) {
  if (end - begin <= kLeaf) return;
  const std::size_t middle = begin + (end - begin) / 2;
  Box box;
  for (std::size_t i = begin; i < end; ++i) box.add(widen(points_[i].at));
  const int axis = box.longest_axis();
  const auto at = [this](std::size_t i) {
    return points_.begin() + static_cast<std::ptrdiff_t>(i);
  };
  std::nth_element(at(begin), at(middle), at(end), [axis](const Point& one, const Point& other) {
    const Vec3f &a = one.at, &b = other.at;
    return std::tuple(coordinate(widen(a), axis), a.x, a.y, a.z) <
           std::tuple(coordinate(widen(b), axis), b.x, b.y, b.z);
  });
  axis_[middle] = static_cast<std::uint8_t>(axis);
  build(begin, middle);
  build(middle + 1, end);
}

double KdTree::squared_distance(Vec3f from, int n) const {
  Nearest nearest{{}, nullptr, static_cast<std::size_t>(n)};
  nearest.squares.reserve(nearest.wanted + 1);
  search(0, points_.size(), widen(from), nearest);
  return nearest.squares.back();
}

void KdTree::nearest(Vec3f from, int n, std::vector<std::uint32_t>& found) const {
  found.clear();
  Nearest nearest{{}, &found, static_cast<std::size_t>(n)};
  nearest.squares.reserve(nearest.wanted + 1);
  search(0, points_.size(), widen(from), nearest);
}

void KdTree::search(std::size_t begin, std::size_t end, Vec3 from, Nearest& nearest) const {
  if (end - begin <= kLeaf) {
    for (std::size_t i = begin; i < end; ++i)
      nearest.offer(squared_norm(widen(points_[i].at) - from), points_[i].index);
    return;
  }
  const std::size_t middle = begin + (end - begin) / 2;
  const int axis = axis_[middle];
  const double offset = coordinate(from, axis) - coordinate(widen(points_[middle].at), axis);
  nearest.offer(squared_norm(widen(points_[middle].at) - from), points_[middle].index);
  if (offset < 0) {
    search(begin, middle, from, nearest);
    if (offset * offset < nearest.limit()) search(middle + 1, end, from, nearest);
  } else {
    search(middle + 1, end, from, nearest);
    if (offset * offset < nearest.limit()) search(begin, middle, from, nearest);
  }
}

}  // namespace vpm
