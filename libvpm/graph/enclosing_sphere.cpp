#include "libvpm/graph/enclosing_sphere.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "libvpm/graph/four_spheres.h"

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

// Finds the sphere that reaches farthest from a place, the first of equal ones.
VPM_VECTOR_CLONES
Farthest farthest(Vec3 from, std::span<const Sphere> spheres,
                  const std::vector<FourSpheres>& fours) {
  const Vec3x4 x{from, from, from, from};
  LeastOfFours least;
  for (const FourSpheres& four : fours)
    least.add(-(square_root(squared_norm(four.centers() - x)) + four.radii()));
  const Sphere& found = spheres[least.first()];
  return {found.center, norm(found.center - from) + found.radius};
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
  double most = 0;
  for (const Sphere& s : spheres) most = std::max(most, norm(s.center - center) + s.radius);
  return most * kRoundingMargin;
}

Sphere enclosing_sphere(std::span<const Sphere> spheres) {
  if (spheres.size() == 1) return {spheres[0].center, enclosing_radius(spheres[0].center, spheres)};
  const std::vector<FourSpheres> fours = in_fours(spheres);
  Vec3 center = box_center(spheres);
  Sphere best{center, std::numeric_limits<double>::infinity()};
  double step = kFirstStep;
  for (int k = 0; k < kSteps; ++k, step *= kShrink) {
    const Farthest far = farthest(center, spheres, fours);
    if (far.distance < best.radius) best = {center, far.distance};
    center += step * (far.center - center);
  }
  best.radius *= kRoundingMargin;
  return best;
}

}  // namespace vpm
