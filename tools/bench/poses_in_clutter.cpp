#include "tools/bench/poses_in_clutter.h"

#include <cmath>
#include <cstdint>

#include "tools/bench/random_draws.h"

namespace vpm::bench {

std::vector<Pose> poses_in_clutter(const Cloud& cloud, std::size_t count) {
  constexpr std::uint64_t kSeed = 14;
  constexpr double kOffSurface = 0.025;  // m
  std::vector<Pose> poses;
  for (std::uint64_t k = 0; poses.size() < count; ++k) {
    synthetic::NormalNumbers numbers(kSeed, k);
    const double fraction = std::fabs(within_two(numbers)) / 2;
    const auto point =
        static_cast<std::size_t>(fraction * static_cast<double>(cloud.positions.size() - 1));
    const Vec3 aside{within_two(numbers), within_two(numbers), within_two(numbers)};
    const Vec3 at = cloud.origin + widen(cloud.positions[point]) + kOffSurface * aside;
    poses.push_back({random_rotation(numbers), at});
  }
  return poses;
}

}  // namespace vpm::bench
