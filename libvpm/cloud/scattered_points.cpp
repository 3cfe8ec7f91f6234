#include "libvpm/cloud/scattered_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <tuple>

#include "libvpm/cloud/kd_tree.h"
#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"

namespace vpm {
namespace {

constexpr std::size_t kPointsPerTask = 4096;

// Returns the distinct positions in lexicographic order.
std::vector<Vec3f> distinct(std::vector<Vec3f> positions) {
  const auto key = [](const Vec3f& p) { return std::tuple(p.x, p.y, p.z); };
  std::sort(positions.begin(), positions.end(),
            [&](const Vec3f& a, const Vec3f& b) { return key(a) < key(b); });
  positions.erase(std::unique(positions.begin(), positions.end()), positions.end());
  return positions;
}

Vec3 middle_of_box(const std::vector<Vec3>& points) {
  Vec3 low = points.front(), high = low;
  for (const Vec3& p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return low + 0.5 * (high - low);
}

float median(std::vector<float> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Throws Error(refused) if float32 positions are too coarse for the points' spacing. The usual
// cause is one point far from all others, such as a marker for missing data.
void refuse_rounded_places(const Cloud& cloud, const std::string& name) {
  constexpr double kMaxRounding = 1.0 / 16;  // part of the sampling radius
  float farthest = 0;
  for (const Vec3f& p : cloud.positions)
    farthest = std::max({farthest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  const double rounding = 0.5 * std::numeric_limits<float>::epsilon() * farthest;
  if (rounding <= kMaxRounding * median(cloud.radii)) return;
  std::ostringstream metres;
  metres << rounding;
  refuse("its points are too far apart: float32 rounds their places by up to " + metres.str() +
             " m, too much for their spacing",
         name, "leave out those that are far from the others");
}

}  // namespace

std::vector<float> sampling_radii(const std::vector<Vec3f>& positions) {
  const std::vector<Vec3f> places = distinct(positions);
  const KdTree tree(places);
  const auto radius = [&](const Vec3f& p) {
    // The nearest point is the point itself, hence + 1.
    return static_cast<float>(kRadiusOfSpacing *
                              std::sqrt(tree.squared_distance(p, kSpacingNeighbour + 1)));
  };
  std::vector<float> of_place(places.size()), radii(positions.size());
  parallel_for(places.size(), kPointsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) of_place[i] = radius(places[i]);
  });
  // Takes the median over distinct positions, so that repeated points change nothing.
  const auto largest = static_cast<float>(kLargestRadius * median(of_place));
  parallel_for(positions.size(), kPointsPerTask, [&](std::size_t begin, std::size_t end) {
    const auto key = [](const Vec3f& p) { return std::tuple(p.x, p.y, p.z); };
    for (std::size_t i = begin; i < end; ++i) {
      const auto place =
          std::lower_bound(places.begin(), places.end(), positions[i],
                           [&](const Vec3f& a, const Vec3f& b) { return key(a) < key(b); });
      radii[i] = std::min(of_place[static_cast<std::size_t>(place - places.begin())], largest);
    }
  });
  return radii;
}

Cloud cloud_of_scattered_points(const std::vector<Vec3>& positions,
                                const std::vector<Vec3>& normals, const Pose& to_world,
                                const std::string& name) {
  std::vector<Vec3> kept;
  Cloud cloud;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3 normal = normalized_or_zero(normals[i]);
    if (!is_finite(positions[i]) || !is_finite(normals[i]) || normal == Vec3{}) continue;
    kept.push_back(to_world * positions[i]);
    cloud.normals.push_back(narrow(to_world.rotation * normal));
  }
  if (kept.empty()) refuse("no point with a finite position and normal", name);
  cloud.origin = middle_of_box(kept);
  cloud.positions.reserve(kept.size());
  for (const Vec3& p : kept) {
    cloud.positions.push_back(narrow(p - cloud.origin));
    if (!is_finite(cloud.positions.back()))
      refuse("its points are too far apart: float32 cannot hold their distances", name);
  }
  if (std::all_of(cloud.positions.begin(), cloud.positions.end(),
                  [&](const Vec3f& p) { return p == cloud.positions.front(); })) {
    refuse(
        "all points are at one place; their spacing, which tells the size of the surface that each "
        "stands for, is not known",
        name);
  }
  cloud.radii = sampling_radii(cloud.positions);
  refuse_rounded_places(cloud, name);
  return cloud;
}

}  // namespace vpm
