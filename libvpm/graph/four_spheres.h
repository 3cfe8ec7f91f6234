// Spheres in fours, as vectors load them. Pass vectors between inlined functions only.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "libvpm/core/lanes.h"
#include "libvpm/core/vec3x4.h"
#include "libvpm/model/sphere.h"

namespace vpm {

struct FourSpheres {
  double x[kFour], y[kFour], z[kFour], radius[kFour];

  [[gnu::always_inline]] Vec3x4 centers() const {
    return {load<Double4>(x), load<Double4>(y), load<Double4>(z)};
  }
  [[gnu::always_inline]] Double4 radii() const { return load<Double4>(radius); }
};

// Returns the spheres in fours, of which the last is filled up with the last sphere.
inline std::vector<FourSpheres> in_fours(std::span<const Sphere> spheres) {
  std::vector<FourSpheres> fours((spheres.size() + kFour - 1) / kFour);
  for (std::size_t k = 0; k < kFour * fours.size(); ++k) {
    const auto& [center, radius] = spheres[std::min(k, spheres.size() - 1)];
    FourSpheres& four = fours[k / kFour];
    const std::size_t lane = k % kFour;
    four.x[lane] = center.x, four.y[lane] = center.y, four.z[lane] = center.z;
    four.radius[lane] = radius;
  }
  return fours;
}

// Finds the least of numbers that come in fours, the first of equal ones.
struct LeastOfFours {
  Double4 least = Double4{} + HUGE_VAL, place{}, next{0, 1, 2, 3};

  [[gnu::always_inline]] void add(const Double4& numbers) {
    const Mask4 is_less = numbers < least;
    least = is_less ? numbers : least;
    place = is_less ? next : place;
    next += 4.0;
  }
  // Returns how many numbers came before the least one.
  [[gnu::always_inline]] std::size_t first() const {
    int best = 0;
    for (int k = 1; k < kFour; ++k)
      if (least[k] < least[best] || (least[k] == least[best] && place[k] < place[best])) best = k;
    return static_cast<std::size_t>(place[best]);
  }
};

}  // namespace vpm
