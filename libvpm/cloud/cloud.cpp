#include "libvpm/cloud/cloud.h"

#include <cmath>
#include <limits>

#include "libvpm/core/error.h"

namespace vpm {
namespace {

// Tolerance for normals stored as floats; those further from unit length were not normalised.
constexpr double kNormalTolerance = 1e-3;

}  // namespace

Cloud without_camera(Cloud cloud) {
  cloud.sensor.reset();
  cloud.pixels.clear();
  return cloud;
}

void validate(const Camera& camera, const std::string& name) {
  const Intrinsics& k = camera.intrinsics;
  if (!are_sound(k))
    refuse(
        "the camera's intrinsics are not finite or beyond 2^40 pixels, or a focal length is not "
        "positive",
        name);
  const std::uint64_t pixels = std::uint64_t{camera.width} * camera.height;
  if (pixels == 0 || pixels > std::numeric_limits<std::uint32_t>::max())
    refuse("the camera's image is empty or has more than 2^32 - 1 pixels", name);
  if (!is_rotation(camera.to_world.rotation, kRotationExact) ||
      !is_finite(camera.to_world.translation))
    refuse("the camera's pose is not finite, or not a rotation and a translation", name,
           "make its rotation with rotation_from_matrix or rotation_from_quaternion");
}

void validate(const Cloud& cloud, const std::string& name) {
  const std::size_t n = cloud.size();
  if (n > std::numeric_limits<std::uint32_t>::max()) refuse("more than 2^32 - 1 points", name);
  if (cloud.normals.size() != n || cloud.radii.size() != n ||
      (cloud.sensor ? cloud.pixels.size() != n : !cloud.pixels.empty()))
    refuse("positions, normals, radii and pixels differ in number", name);
  if (!is_finite(cloud.origin)) refuse("the cloud's origin is not finite", name);
  if (cloud.sensor) {
    const auto& [camera, depth] = *cloud.sensor;
    validate(camera, name);
    if (depth.width != camera.width || depth.height != camera.height ||
        depth.depth.size() != std::size_t{camera.width} * camera.height)
      refuse("the depth image is not as large as the camera's", name);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const auto refuse_point = [&](const char* defect) {
      refuse("point " + std::to_string(i) + " " + defect, name);
    };
    if (!is_finite(cloud.positions[i])) refuse_point("is not finite");
    if (!(cloud.radii[i] >= 0) || !std::isfinite(cloud.radii[i]))
      refuse_point("has a sampling radius that is negative or not finite");
    if (!(std::abs(norm(widen(cloud.normals[i])) - 1) <= kNormalTolerance))
      refuse_point("has a normal that is not of unit length");
    if (cloud.sensor && cloud.pixels[i] >= cloud.sensor->depth.depth.size())
      refuse_point("lies outside of the camera's image");
  }
}

}  // namespace vpm
