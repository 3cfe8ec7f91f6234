#include "tools/bench/projective_count.h"

#include <cmath>

namespace vpm::bench {

ProjectiveCount count_behind(std::span<const Vec3> places, double reach, const Pose& pose,
                             const DepthImage& depth, const Camera& camera) {
  const Pose to_camera = relative_to(camera.to_world, pose);
  const Intrinsics& k = camera.intrinsics;
  std::size_t behind = 0, shadow = 0;
  for (const Vec3& place : places) {
    const Vec3 x = to_camera * place;
    if (!(x.z > 0)) continue;
    const double u = std::floor(k.fx * x.x / x.z + k.cx + 0.5),
                 v = std::floor(k.fy * x.y / x.z + k.cy + 0.5);
    if (!(u >= 0 && v >= 0 && u < depth.width && v < depth.height)) continue;
    const double seen =
        depth.depth[depth.index(static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v))];
    behind += seen > 0 && x.z > seen;
    shadow += seen > 0 && x.z > seen + reach;
  }
  const auto all = static_cast<double>(places.size());
  return {static_cast<double>(behind) / all, static_cast<double>(shadow) / all};
}

}  // namespace vpm::bench
