#include "libvpm/synthetic/render.h"

#include <algorithm>
#include <cmath>

#include "libvpm/core/parallel.h"
#include "libvpm/model/sphere.h"

namespace vpm::synthetic {

Camera default_camera() {
  Camera camera;
  camera.intrinsics = {525, 525, 319.5, 239.5};
  camera.width = 640;
  camera.height = 480;
  return camera;
}

Vec3 RayCaster::point(double u, double v, double depth) const {
  return camera_.to_world * unproject(camera_.intrinsics, u, v, depth);
}

std::optional<double> RayCaster::depth(double u, double v) {
  const Vec3 origin = camera_.to_world.translation;
  const Vec3 direction = camera_.to_world.rotation * unproject(camera_.intrinsics, u, v, 1);
  crossings_.clear();
  surface_.crossings(origin, direction, crossings_);
  crossings_.push_back(0);
  std::sort(crossings_.begin(), crossings_.end());
  for (std::size_t k = 0; k < crossings_.size(); ++k) {
    const double t = crossings_[k];
    if (t <= 0) continue;
    // Tests the middle of the stretch before the crossing for free space.
    const Vec3 before = origin + (0.5 * (crossings_[k - 1] + t)) * direction;
    if (surface_.distance(before) > 0) return t;
  }
  return std::nullopt;
}

namespace {

// Makes an image of depth_of(rays, u, v), m; 0 is unset. Rows are made in parallel.
template <class DepthOf>
DepthImage render_pixels(const Surface& surface, const Camera& camera, const DepthOf& depth_of) {
  DepthImage image{camera.width, camera.height, {}};
  image.depth.resize(std::size_t{camera.width} * camera.height);
  parallel_for(camera.height, 8, [&](std::size_t begin, std::size_t end) {
    RayCaster rays(surface, camera);
    for (std::size_t v = begin; v < end; ++v)
      for (std::size_t u = 0; u < camera.width; ++u)
        image.depth[v * camera.width + u] = depth_of(rays, u, v);
  });
  return image;
}

// SplitMix64 (Steele, Lea, Flood 2014): a bijection with uniform outputs for consecutive inputs.
std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}
constexpr std::uint64_t kGoldenStep = 0x9e3779b97f4a7c15u;

double angle_to_axis(const Surface& surface, const Camera& camera, Vec3 point) {
  const Vec3 axis = camera.to_world.rotation * Vec3{0, 0, 1};
  return std::acos(std::clamp(-dot(surface.gradient(point), axis), 0.0, 1.0));
}

float noisy_depth(RayCaster& rays, const Surface& surface, const Camera& camera, double u, double v,
                  NormalNumbers numbers) {
  const double du = numbers.next(), dv = numbers.next(), dz = numbers.next();
  const std::optional<double> seen = rays.depth(u, v);
  if (!seen) return 0;
  const double lateral = lateral_sigma(angle_to_axis(surface, camera, rays.point(u, v, *seen)));
  const double u2 = u + lateral * du, v2 = v + lateral * dv;
  const std::optional<double> beside = rays.depth(u2, v2);
  if (!beside) return 0;
  const double angle = angle_to_axis(surface, camera, rays.point(u2, v2, *beside));
  return static_cast<float>(std::max(*beside + axial_sigma(*beside, angle) * dz, 0.0));
}

}  // namespace

double axial_sigma(double z, double angle) {
  const double frontal = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
  if (angle < kPi / 3) return frontal;
  const double a = std::min(angle, kLargestAngle), ratio = a / (kPi / 2 - a);
  return frontal + 0.0001 / std::sqrt(z) * ratio * ratio;
}

double lateral_sigma(double angle) {
  const double a = std::min(angle, kLargestAngle);
  return 0.8 + 0.035 * a / (kPi / 2 - a);
}

NormalNumbers::NormalNumbers(std::uint64_t seed, std::uint64_t counter)
    : state_(mix(mix(seed + kGoldenStep) ^ (counter * kGoldenStep))) {}

double NormalNumbers::uniform() {
  state_ += kGoldenStep;
  return static_cast<double>(mix(state_) >> 11) * 0x1p-53;
}

// Von Neumann 1951: the length of the first descending run decides if its head is accepted.
double NormalNumbers::exponential() {
  for (double whole = 0;; whole += 1) {
    const double head = uniform();
    double last = head;
    bool odd = true;
    for (double u = uniform(); u < last; u = uniform()) {
      last = u;
      odd = !odd;
    }
    if (odd) return whole + head;
  }
}

// Kahn 1954: accepts an exponential number x with probability exp(-(x - 1)^2 / 2).
double NormalNumbers::next() {
  for (;;) {
    const double x = exponential();
    if (exponential() >= 0.5 * (x - 1) * (x - 1)) return uniform() < 0.5 ? -x : x;
  }
}

Pose looking_at(Vec3 eye, Vec3 target, Vec3 up) {
  const Vec3 z = normalized_or_zero(target - eye), x = normalized_or_zero(cross(z, up));
  return {transpose(Rotation{x, cross(z, x), z}), eye};
}

DepthImage render(const Surface& surface, const Camera& camera) {
  return render_pixels(surface, camera, [](RayCaster& rays, std::size_t u, std::size_t v) {
    return static_cast<float>(
        rays.depth(static_cast<double>(u), static_cast<double>(v)).value_or(0));
  });
}

DepthImage render_with_kinect_noise(const Surface& surface, const Camera& camera,
                                    std::uint64_t seed) {
  return render_pixels(surface, camera, [&](RayCaster& rays, std::size_t u, std::size_t v) {
    return noisy_depth(rays, surface, camera, static_cast<double>(u), static_cast<double>(v),
                       NormalNumbers(seed, v * camera.width + u));
  });
}

}  // namespace vpm::synthetic
