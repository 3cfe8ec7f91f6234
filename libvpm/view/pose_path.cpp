#include "libvpm/view/pose_path.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace vpm::view {
namespace {

double length_of_way(std::span<const Vec3> places) {
  double length = 0;
  for (std::size_t k = 1; k < places.size(); ++k) length += norm(places[k] - places[k - 1]);
  return length;
}

// Returns the length of the shortest tree that joins the places. Adds the place that is nearest to
// the tree, time and again (Prim).
double length_of_tree(std::span<const Vec3> places) {
  if (places.empty()) return 0;
  std::vector<double> distance(places.size(), std::numeric_limits<double>::infinity());
  std::vector<bool> is_joined(places.size(), false);
  double length = 0;
  std::size_t last = 0;
  for (std::size_t joined = 1; joined < places.size(); ++joined) {
    is_joined[last] = true;
    std::size_t nearest = last;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (is_joined[k]) continue;
      distance[k] = std::min(distance[k], norm(places[k] - places[last]));
      if (distance[k] < least) {
        least = distance[k];
        nearest = k;
      }
    }
    length += least;
    last = nearest;
  }
  return length;
}

}  // namespace

bool is_path(std::span<const Vec3> places) {
  constexpr double kMost = 1.5, kRounding = 1e-9;
  return length_of_way(places) <= (kMost + kRounding) * length_of_tree(places);
}

}  // namespace vpm::view
