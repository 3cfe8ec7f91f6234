#include "libvpm/graph/hierarchy.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "libvpm/core/box.h"
#include "libvpm/core/parallel.h"
#include "libvpm/graph/enclosing_sphere.h"

namespace vpm {
namespace {

// Neighbourhood: a prototype of rank k learns with factor q^k. q starts at exp(-1/2) and is squared
// every second step, which halves the neighbourhood's range; the last steps are k-means.
constexpr double kFirstFactor = 0.60653065971263342;
constexpr int kSteps = 18;

// Starting places in the box, in units of half its extent. They differ along every axis, so that
// spheres in a row or in a plane separate too.
constexpr std::array<Vec3, kPrototypes> kPlaces{
    Vec3{-0.75, -0.25, 0.25}, {0.25, -0.75, -0.25}, {-0.25, 0.75, -0.75}, {0.75, 0.25, 0.75}};

using Prototypes = std::array<Vec3, kPrototypes>;
using Ranking = std::array<std::uint8_t, kPrototypes>;  // prototypes, nearest first

// Returns the weight of a sphere, r^4 as in the paper: large spheres attract prototypes.
double magnification(const Sphere& s) {
  const double squared = s.radius * s.radius;
  return squared * squared;
}

Ranking rank(Vec3 x, const Prototypes& prototypes) {
  std::array<double, kPrototypes> distance;
  Ranking ranking;
  for (std::uint8_t p = 0; p < kPrototypes; ++p) {
    const double d = squared_norm(x - prototypes[p]);
    std::uint8_t k = p;
    for (; k > 0 && distance[k - 1u] > d; --k) {
      distance[k] = distance[k - 1u];
      ranking[k] = ranking[k - 1u];
    }
    distance[k] = d;
    ranking[k] = p;
  }
  return ranking;
}

Prototypes first_prototypes(std::span<const Sphere> spheres) {
  Vec3 low = spheres.front().center, high = low;
  for (const Sphere& s : spheres) {
    low = {std::min(low.x, s.center.x), std::min(low.y, s.center.y), std::min(low.z, s.center.z)};
    high = {std::max(high.x, s.center.x), std::max(high.y, s.center.y),
            std::max(high.z, s.center.z)};
  }
  const Vec3 middle = 0.5 * (low + high), half = 0.5 * (high - low);
  Prototypes prototypes;
  for (std::size_t p = 0; p < kPrototypes; ++p) {
    prototypes[p] =
        middle + Vec3{kPlaces[p].x * half.x, kPlaces[p].y * half.y, kPlaces[p].z * half.z};
  }
  return prototypes;
}

void learn(std::span<const Sphere> spheres, double factor, Prototypes& prototypes) {
  std::array<Vec3, kPrototypes> moment{};
  std::array<double, kPrototypes> mass{};
  for (const Sphere& s : spheres) {
    double weight = magnification(s);
    for (const std::uint8_t p : rank(s.center, prototypes)) {
      moment[p] += weight * s.center;
      mass[p] += weight;
      weight *= factor;
    }
  }
  for (std::size_t p = 0; p < kPrototypes; ++p) {
    if (mass[p] > 0) prototypes[p] = moment[p] / mass[p];
  }
}

}  // namespace

std::vector<std::uint8_t> batch_neural_gas(std::span<const Sphere> spheres) {
  Prototypes prototypes = first_prototypes(spheres);
  double factor = kFirstFactor;
  for (int step = 0; step < kSteps; ++step) {
    learn(spheres, factor, prototypes);
    if (step % 2 == 1) factor *= factor;
  }
  std::vector<std::uint8_t> cluster;
  cluster.reserve(spheres.size());
  for (const Sphere& s : spheres) cluster.push_back(rank(s.center, prototypes)[0]);
  return cluster;
}

namespace {

using Members = std::vector<std::uint32_t>;  // sphere indices, ascending

// Largest part of the spheres that one cluster may get; more gains too little and makes deep trees.
constexpr double kLargestPart = 7.0 / 8;

std::vector<Sphere> gather(std::span<const Sphere> spheres, const Members& members) {
  std::vector<Sphere> gathered;
  gathered.reserve(members.size());
  for (const std::uint32_t i : members) gathered.push_back(spheres[i]);
  return gathered;
}

// Returns quarters along the longest axis of the centres.
std::vector<std::uint8_t> median_clusters(std::span<const Sphere> spheres) {
  Box box;
  for (const Sphere& s : spheres) box.add(s.center);
  const int axis = box.longest_axis();
  const auto key = [&](std::uint32_t i) { return coordinate(spheres[i].center, axis); };
  std::vector<std::uint32_t> order(spheres.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return key(a) != key(b) ? key(a) < key(b) : a < b;
  });
  std::vector<std::uint8_t> cluster(spheres.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    cluster[order[k]] = static_cast<std::uint8_t>(k * kPrototypes / order.size());
  }
  return cluster;
}

std::array<Members, kPrototypes> split(const Members& members,
                                       const std::vector<std::uint8_t>& cluster) {
  std::array<Members, kPrototypes> parts;
  for (std::size_t k = 0; k < members.size(); ++k) parts[cluster[k]].push_back(members[k]);
  return parts;
}

std::array<Members, kPrototypes> clusters(std::span<const Sphere> spheres, const Members& members) {
  const std::vector<Sphere> gathered = gather(spheres, members);
  std::array<Members, kPrototypes> parts = split(members, batch_neural_gas(gathered));
  const auto largest =
      std::max_element(parts.begin(), parts.end(),
                       [](const Members& a, const Members& b) { return a.size() < b.size(); });
  if (static_cast<double>(largest->size()) <= kLargestPart * static_cast<double>(members.size())) {
    return parts;
  }
  return split(members, median_clusters(gathered));
}

}  // namespace

Hierarchy build_hierarchy(std::span<const Sphere> spheres) {
  Hierarchy tree;
  std::vector<Members> row(1, Members(spheres.size()));  // nodes of one depth, not yet in the tree
  std::iota(row[0].begin(), row[0].end(), 0u);
  while (!row.empty()) {
    const std::size_t first = tree.nodes.size();
    tree.nodes.resize(first + row.size());
    std::vector<std::array<Members, kPrototypes>> parts(row.size());
    parallel_for(row.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        tree.nodes[first + n].bound = enclosing_sphere(gather(spheres, row[n]));
        if (row[n].size() > kPrototypes) parts[n] = clusters(spheres, row[n]);
      }
    });
    std::vector<Members> next;
    for (std::size_t n = 0; n < row.size(); ++n) {
      HierarchyNode& node = tree.nodes[first + n];
      if (row[n].size() <= kPrototypes) {
        node.children_are_leaves = 1;
        node.begin = static_cast<std::uint32_t>(tree.leaves.size());
        tree.leaves.insert(tree.leaves.end(), row[n].begin(), row[n].end());
        node.end = static_cast<std::uint32_t>(tree.leaves.size());
        continue;
      }
      node.begin = static_cast<std::uint32_t>(first + row.size() + next.size());
      for (Members& part : parts[n]) {
        if (!part.empty()) next.push_back(std::move(part));
      }
      node.end = static_cast<std::uint32_t>(first + row.size() + next.size());
    }
    row = std::move(next);
  }
  return tree;
}

std::uint32_t depth(const Hierarchy& hierarchy) {
  std::vector<std::uint32_t> level(hierarchy.nodes.size(), 1);
  for (std::size_t n = 0; n < level.size(); ++n) {
    const HierarchyNode& node = hierarchy.nodes[n];
    if (node.children_are_leaves != 0) continue;
    for (std::uint32_t child = node.begin; child < node.end; ++child) level[child] = level[n] + 1;
  }
  return *std::max_element(level.begin(), level.end());
}

}  // namespace vpm
