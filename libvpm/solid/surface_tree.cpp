#include "libvpm/solid/surface_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "libvpm/core/box.h"

namespace vpm {
namespace {

// Padding of float bounds, relative to the reach: several float roundings of either solid.
constexpr double kPadding = 2e-6;
// Makes of a length a bound of it, as a float.
constexpr double kMore = 1.00001;
// Nodes of so many triangles or fewer keep no moments: these are most of all nodes.
constexpr std::uint32_t kSummedWhenAsked = 8;

}  // namespace

class SurfaceTree::Build {
 public:
  Build(SurfaceTree& tree, double reach) : tree_(tree), padding_(kPadding * reach) {
    const std::size_t n = tree.triangles_.size();
    order_.resize(n);
    std::iota(order_.begin(), order_.end(), 0u);
    for (std::uint32_t t = 0; t < n; ++t) {
      const auto [a, b, c] = tree.corners(t);
      middle_.push_back((a + b + c) / 3);
      Box& box = bounds_.emplace_back();
      for (const Vec3& corner : {a, b, c}) box.add(corner);
    }
  }

  void run(bool with_patches) {
    const Range all{0, static_cast<std::uint32_t>(order_.size())};
    add_node(0);
    ranges_.push_back(all);
    if (all.size() > 1) add_children(all, 0, 1);
    std::vector<Triangle> sorted;
    for (const std::uint32_t t : order_) sorted.push_back(tree_.triangles_[t]);
    tree_.triangles_ = std::move(sorted);
    tree_.parent_of_.assign(order_.size(), 0);
    for (std::uint32_t t = 0; t < order_.size(); ++t) {
      const auto [a, b, c] = tree_.corners(t);
      const double longest2 =
          std::max({squared_norm(b - a), squared_norm(c - b), squared_norm(a - c)});
      tree_.longest_edge_.push_back(static_cast<float>(kMore * std::sqrt(longest2)));
    }
    tree_.nodes_[0].child = {all.size() > 1 ? 1 : kLeaf, kNone, kNone, kNone};
    for (std::uint32_t k = 0; k < tree_.nodes_.size(); ++k) set_bounds(k);
    sum_up();
    find_connected();
    if (with_patches) make_patches();
  }

 private:
  struct Range {
    std::uint32_t begin, end;
    std::uint32_t size() const { return end - begin; }
  };

  std::uint32_t add_node(std::uint32_t parent) {
    Node node{};
    node.child.fill(kNone);
    tree_.nodes_.push_back(node);
    tree_.above_.push_back(parent);
    return static_cast<std::uint32_t>(tree_.nodes_.size() - 1);
  }

  // Where to split a range: along an axis, before a bin of the triangles' centres.
  struct Split {
    int axis = -1;  // none
    int bin = 0;
    double cost = HUGE_VAL;
  };
  static constexpr int kBins = 16;
  // Level from which on ranges are halved, so that 2^31 triangles take kMostLevels.
  static constexpr std::size_t kBalanced = kMostLevels - 17;

  static double half_area(const Box& box) {
    const Vec3 s = box.size();
    return s.x * s.y + s.y * s.z + s.z * s.x;
  }

  int bin_of(std::uint32_t triangle, const Box& centers, int axis) const {
    const double low = coordinate(centers.low, axis), high = coordinate(centers.high, axis);
    const double part = (coordinate(middle_[triangle], axis) - low) / (high - low);
    return std::min(static_cast<int>(kBins * part), kBins - 1);
  }

  // Returns the best split along an axis by the surface area heuristic (MacDonald and Booth 1990),
  // over bins of centres (Wald 2007).
  Split best_along(Range r, const Box& centers, int axis) const {
    if (!(coordinate(centers.size(), axis) > 0)) return {};
    std::array<Box, kBins> boxes;
    std::array<int, kBins> counts{};
    for (std::uint32_t i = r.begin; i < r.end; ++i) {
      const auto bin = static_cast<std::size_t>(bin_of(order_[i], centers, axis));
      boxes[bin].add_box(bounds_[order_[i]]);
      ++counts[bin];
    }
    std::array<double, kBins> above{};  // cost of the bins from here on
    Box box;
    int count = 0;
    for (std::size_t bin = kBins; bin-- > 1;) {
      box.add_box(boxes[bin]);
      count += counts[bin];
      above[bin] = count > 0 ? half_area(box) * count : HUGE_VAL;
    }
    Split best;
    box = {}, count = 0;
    for (std::size_t bin = 1; bin < kBins; ++bin) {
      box.add_box(boxes[bin - 1]);
      count += counts[bin - 1];
      if (count == 0) continue;
      const double cost = half_area(box) * count + above[bin];
      if (cost < best.cost) best = {axis, static_cast<int>(bin), cost};
    }
    return best;
  }

  std::pair<Range, Range> halves(Range r) {
    Box centers;
    for (std::uint32_t i = r.begin; i < r.end; ++i) centers.add(middle_[order_[i]]);
    Split best;
    for (int axis = 0; axis < 3; ++axis)
      if (const Split split = best_along(r, centers, axis); split.cost < best.cost) best = split;
    if (best.axis < 0) return halves_of_list(r);
    const auto middle = std::stable_partition(
        order_.begin() + r.begin, order_.begin() + r.end,
        [&](std::uint32_t t) { return bin_of(t, centers, best.axis) < best.bin; });
    const auto split = static_cast<std::uint32_t>(middle - order_.begin());
    return {{r.begin, split}, {split, r.end}};
  }

  // Splits triangles with one centre.
  static std::pair<Range, Range> halves_of_list(Range r) {
    const std::uint32_t split = r.begin + (r.size() + 1) / 2;
    return {{r.begin, split}, {split, r.end}};
  }

  // Adds the node of a range of at least two triangles and all below it.
  void add_children(Range range, std::uint32_t parent, std::size_t level) {
    const std::uint32_t node = add_node(parent);
    ranges_.push_back(range);
    std::vector<Range> parts;
    const auto split = [&](Range r) { return level < kBalanced ? halves(r) : halves_of_list(r); };
    const auto [left, right] = split(range);
    for (const Range half : {left, right}) {
      if (half.size() == 1) {
        parts.push_back(half);
        continue;
      }
      const auto [low, high] = split(half);
      parts.push_back(low);
      parts.push_back(high);
    }
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const bool is_leaf = parts[k].size() == 1;
      const auto next = static_cast<std::uint32_t>(tree_.nodes_.size());
      tree_.nodes_[node].child[k] = is_leaf ? kLeaf | parts[k].begin : next;
      if (!is_leaf) add_children(parts[k], node, level + 1);
    }
  }

  Range range_of(std::uint32_t child) const {
    const std::uint32_t t = child & ~kLeaf;
    return (child & kLeaf) != 0 ? Range{t, t + 1} : ranges_[child];
  }

  template <class Take>
  void for_vertices(Range range, const Take& take) const {
    for (std::uint32_t t = range.begin; t < range.end; ++t)
      for (const std::uint32_t v : tree_.triangles_[t]) take(tree_.vertices_[v]);
  }

  // Two parallel planes with triangles between them.
  struct Slab {
    Vec3 normal;  // in floats
    double low = HUGE_VAL, high = -HUGE_VAL;
    double middle() const { return 0.5 * (low + high); }
    double half_width() const { return 0.5 * (high - low); }
  };

  // Returns the slab of triangles across the direction of their area vector, or across any axis if
  // that is zero.
  Slab slab_of(Range range) const {
    Vec3 area;
    for (std::uint32_t t = range.begin; t < range.end; ++t) {
      const auto [a, b, c] = tree_.corners(t);
      area += cross(b - a, c - a);
    }
    const Vec3 unit = normalized_or_zero(area);
    Slab slab{widen(narrow(squared_norm(unit) > 0 ? unit : Vec3{1, 0, 0}))};
    for_vertices(range, [&](Vec3 v) {
      const double height = dot(slab.normal, v);
      slab.low = std::min(slab.low, height), slab.high = std::max(slab.high, height);
    });
    return slab;
  }

  void set_bounds(std::uint32_t k) {
    Node& node = tree_.nodes_[k];
    for (std::size_t l = 0; l < 4; ++l) {
      const std::uint32_t child = node.child[l];
      const int lane = static_cast<int>(l);
      if (child == kNone) {
        for (Float4& c : node.center) c[lane] = HUGE_VALF;  // meets nothing
        continue;
      }
      const Range range = range_of(child);
      if ((child & kLeaf) != 0) tree_.parent_of_[child & ~kLeaf] = k;
      Box box;
      for_vertices(range, [&](Vec3 v) { box.add(v); });
      const Slab slab = slab_of(range);
      float size = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        const int axis = static_cast<int>(i);
        const double from = coordinate(box.low, axis), to = coordinate(box.high, axis);
        node.center[i][lane] = static_cast<float>(0.5 * (from + to));
        node.half[i][lane] = static_cast<float>(0.5 * (to - from) + padding_);
        node.normal[i][lane] = static_cast<float>(coordinate(slab.normal, axis));
        size += node.half[i][lane];
      }
      node.offset[lane] = static_cast<float>(slab.middle());
      node.width[lane] = static_cast<float>(slab.half_width() + padding_);
      node.size[lane] = (child & kLeaf) != 0 ? 0 : size;
    }
  }

  // Sums the moments of nodes of many triangles, bottom-up: children have larger indices than their
  // parents.
  void sum_up() {
    for (const Range& range : ranges_) {
      const bool is_summed = range.size() > kSummedWhenAsked || tree_.summaries_.empty();
      const auto sums = is_summed ? static_cast<std::uint32_t>(tree_.sums_.size()) : kNone;
      tree_.summaries_.push_back({range.begin, range.end, sums, false});
      if (is_summed) tree_.sums_.emplace_back();
    }
    for (std::size_t k = tree_.nodes_.size(); k-- > 0;) {
      if (tree_.summaries_[k].sums == kNone) continue;
      ForceMoments& moments = tree_.sums_[tree_.summaries_[k].sums];
      for (const std::uint32_t child : tree_.nodes_[k].child) {
        if (child == kNone) continue;
        if (const ForceMoments* of_child =
                (child & kLeaf) != 0 ? nullptr : tree_.force_moments(child)) {
          moments.add(*of_child);
          continue;
        }
        const Range range = range_of(child);
        for (std::uint32_t t = range.begin; t < range.end; ++t) {
          const auto [a, b, c] = tree_.corners(t);
          moments.add(triangle_force_moments(a, b, c));
        }
      }
    }
  }

  // Counts, per node, the parts that its triangles form, by union-find over their vertices.
  void find_connected() {
    const std::size_t n = tree_.vertices_.size();
    std::vector<std::uint32_t> root(n), seen(n, kNone);
    const auto find = [&](std::uint32_t v) {
      while (root[v] != v) v = root[v] = root[root[v]];
      return v;
    };
    for (std::uint32_t k = 0; k < tree_.nodes_.size(); ++k) {
      std::size_t parts = 0;
      for (std::uint32_t t = ranges_[k].begin; t < ranges_[k].end; ++t) {
        const Triangle& corners = tree_.triangles_[t];
        for (const std::uint32_t v : corners)
          if (seen[v] != k) seen[v] = k, root[v] = v, ++parts;
        for (const std::uint32_t v : {corners[1], corners[2]}) {
          const std::uint32_t x = find(corners[0]), y = find(v);
          if (x != y) root[x] = y, --parts;
        }
      }
      tree_.summaries_[k].is_connected = parts == 1;
    }
  }

  void make_patches() {
    tree_.patches_.resize(tree_.nodes_.size());
    for (std::size_t k = tree_.nodes_.size(); k-- > 0;) {
      Patch& patch = tree_.patches_[k];
      double area = 0;
      Vec3 sum;
      for (std::uint32_t t = ranges_[k].begin; t < ranges_[k].end; ++t) {
        const auto [a, b, c] = tree_.corners(t);
        const double twice = norm(cross(b - a, c - a));
        area += twice, sum += twice / 3 * (a + b + c);
      }
      patch.area = static_cast<float>(0.5 * area);
      patch.middle = narrow(area > 0 ? sum / area : tree_.corners(ranges_[k].begin)[0]);
      const Vec3 middle = widen(patch.middle);
      double radius2 = 0;
      for_vertices(ranges_[k],
                   [&](Vec3 v) { radius2 = std::max(radius2, squared_norm(v - middle)); });
      patch.radius = static_cast<float>(kMore * std::sqrt(radius2));
      patch.thickness = static_cast<float>(slab_of(ranges_[k]).half_width());
    }
  }

  SurfaceTree& tree_;
  double padding_;
  std::vector<std::uint32_t> order_;
  std::vector<Vec3> middle_;
  std::vector<Box> bounds_;
  std::vector<Range> ranges_;  // of the nodes
};

SurfaceTree::SurfaceTree(std::vector<Vec3> vertices, std::vector<Triangle> triangles, double reach,
                         bool with_patches)
    : vertices_(std::move(vertices)), triangles_(std::move(triangles)) {
  Build(*this, reach).run(with_patches);
}

SurfaceMoments SurfaceTree::moments(std::uint32_t node) const {
  const Summary& below = summaries_[node];
  if (below.sums != kNone) return sums_[below.sums].surface;
  SurfaceMoments moments;
  for (std::uint32_t t = below.first; t < below.end; ++t) {
    const auto [a, b, c] = corners(t);
    moments.add(triangle_moments(a, b, c));
  }
  return moments;
}

SurfaceBounds SurfaceTree::bounds(std::uint32_t node, std::uint32_t child) const {
  const Node& n = nodes_[node];
  const int l = static_cast<int>(child);
  return {{n.center[0][l], n.center[1][l], n.center[2][l]},
          {n.half[0][l], n.half[1][l], n.half[2][l]},
          {n.normal[0][l], n.normal[1][l], n.normal[2][l]},
          n.offset[l],
          n.width[l],
          n.size[l]};
}

std::size_t SurfaceTree::bytes() const {
  const auto held = [](const auto& list) { return list.size() * sizeof(list[0]); };
  return held(vertices_) + held(triangles_) + held(parent_of_) + held(longest_edge_) +
         held(nodes_) + held(above_) + held(summaries_) + held(sums_) + held(patches_);
}

}  // namespace vpm
