#include "libvpm/graph/enclosing_sphere.h"

#include <algorithm>
#include <limits>

namespace vpm {
namespace {

constexpr int kSteps = 96;
// Steps are parts of the way to the farthest sphere's centre.
constexpr double kFirstStep = 0.25, kShrink = 0.95;
// Margin for the rounding of a distance and a sum.
constexpr double kRoundingMargin = 1 + 16 * std::numeric_limits<double>::epsilon();

struct Farthest {
  Vec3 center;
  double distance = 0;  // to the far side of the sphere
};

Farthest farthest(Vec3 from, std::span<const Sphere> spheres) {
  Farthest found{spheres.front().center, 0};
  for (const Sphere& s : spheres) {
    const double distance = norm(s.center - from) + s.radius;
    if (distance > found.distance) found = {s.center, distance};
  }
  return found;
}

Vec3 box_center(std::span<const Sphere> spheres) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3 low{kInfinity, kInfinity, kInfinity}, high = -low;
  for (const Sphere& s : spheres) {
    low = {std::min(low.x, s.center.x - s.radius), std::min(low.y, s.center.y - s.radius),
           std::min(low.z, s.center.z - s.radius)};
    high = {std::max(high.x, s.center.x + s.radius), std::max(high.y, s.center.y + s.radius),
            std::max(high.z, s.center.z + s.radius)};
  }
  return 0.5 * (low + high);
}

}  // namespace

double enclosing_radius(Vec3 center, std::span<const Sphere> spheres) {
  return farthest(center, spheres).distance * kRoundingMargin;
}

Sphere enclosing_sphere(std::span<const Sphere> spheres) {
  if (spheres.size() == 1) return {spheres[0].center, enclosing_radius(spheres[0].center, spheres)};
  Vec3 center = box_center(spheres);
  Sphere best{center, std::numeric_limits<double>::infinity()};
  double step = kFirstStep;
  for (int k = 0; k < kSteps; ++k, step *= kShrink) {
    const Farthest far = farthest(center, spheres);
    if (far.distance < best.radius) best = {center, far.distance};
    center += step * (far.center - center);
  }
  best.radius *= kRoundingMargin;
  return best;
}

}  // namespace vpm
