#include "tools/bench/sight.h"

#include <algorithm>
#include <array>

#include "libvpm/core/parallel.h"
#include "libvpm/mesh/triangle_bvh.h"
#include "libvpm/mesh/winding_number.h"

namespace vpm::bench {
namespace {

// Returns the fraction of 1 that the digits of k in a prime base spell backwards.
double radical_inverse(std::size_t k, std::size_t base) {
  double value = 0, digit = 1;
  for (; k > 0; k /= base) {
    digit /= static_cast<double>(base);
    value += digit * static_cast<double>(k % base);
  }
  return value;
}

// Relative difference of depth between neighbouring pixels above which they are a jump.
constexpr double kJump = 0.03;

}  // namespace

std::vector<Vec3> places_in(const Solid& solid, std::size_t count) {
  Vec3 low = solid.vertices.at(0), high = low;
  for (const Vec3& v : solid.vertices) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  const TriangleBvh bvh(solid.vertices, solid.triangles);
  const WindingNumber winding(bvh);
  std::vector<Vec3> places;
  for (std::size_t k = 1; places.size() < count; ++k) {
    const Vec3 x{low.x + radical_inverse(k, 2) * (high.x - low.x),
                 low.y + radical_inverse(k, 3) * (high.y - low.y),
                 low.z + radical_inverse(k, 5) * (high.z - low.z)};
    if (winding.inside(x)) places.push_back(x);
  }
  return places;
}

// Follows the ray from the camera to the place. Surfaces have one side: a camera inside an obstacle
// looks out through it.
Sight::Ray Sight::ray(Vec3 from_camera) const {
  const Vec3 origin = camera_.to_world.translation;
  const Vec3 direction = camera_.to_world.rotation * from_camera;
  thread_local std::vector<double> t;
  t.clear();
  surface_.crossings(origin, direction, t);
  std::erase_if(t, [](double at) { return !(at > 0 && at < 1); });
  std::sort(t.begin(), t.end());
  t.push_back(1);
  Ray ray;
  bool was_free = false, entered = false;
  double last = 0;
  for (const double at : t) {
    const bool is_free = surface_.distance(origin + (0.5 * (last + at)) * direction) > 0;
    if (was_free && !is_free && !entered) {
      entered = true;
      ray.inside = true;
      ray.entry = last * from_camera.z;
    } else if (is_free) {
      ray.inside = false;
    }
    was_free = is_free;
    last = at;
  }
  ray.sees = was_free && !entered;
  return ray;
}

// True if the place lies between the depths of its own pixel and a neighbouring one, or where
// nothing is measured.
bool Sight::is_ambiguous(Vec3 from_camera, double entry) const {
  const Intrinsics& k = camera_.intrinsics;
  const double u = k.fx * from_camera.x / from_camera.z + k.cx;
  const double v = k.fy * from_camera.y / from_camera.z + k.cy;
  if (!(u >= 0 && v >= 0 && u <= camera_.width - 1 && v <= camera_.height - 1)) return true;
  if (hole_ && (*hole_)[static_cast<std::size_t>(std::lround(v)) * camera_.width +
                        static_cast<std::size_t>(std::lround(u))])
    return true;
  synthetic::RayCaster rays(surface_, camera_);
  for (const auto& [du, dv] : {std::array{-1.0, 0.0}, {1.0, 0.0}, {0.0, -1.0}, {0.0, 1.0}}) {
    const double beside = rays.depth(u + du, v + dv).value_or(HUGE_VAL);
    const double near = std::min(beside, entry), far = std::max(beside, entry);
    if (far - near > kJump * far && from_camera.z > near && from_camera.z < far) return true;
  }
  return false;
}

Sight::Place Sight::at(Vec3 world) const {
  const Vec3 at = relative_to(camera_.to_world, {{}, world}).translation;
  if (!(at.z > 0)) return Place::unknown;
  constexpr double kFarther = 100;  // m, past every scene
  const Ray seen = ray(at);
  const double entry = seen.entry > 0 ? seen.entry : ray(kFarther * at).entry;
  if (entry > 0 && is_ambiguous(at, entry)) return Place::unknown;
  return seen.sees ? Place::free : (seen.inside ? Place::inside : Place::unknown);
}

bool Sight::sees_well(Vec3 on_surface, Vec3 normal) const {
  constexpr double kBefore = 1e-5;  // m, just off the surface
  const Vec3 at = relative_to(camera_.to_world, {{}, on_surface + kBefore * normal}).translation;
  if (!(at.z > 0)) return false;
  const Vec3 towards = camera_.to_world.translation - on_surface;
  return dot(towards, normal) > kGrazingCosine * norm(towards) && ray(at).sees;
}

Unseen unseen_parts(std::span<const Vec3> places, const Pose& pose,
                    const synthetic::Surface& surface, const std::vector<Sight>& cameras) {
  constexpr std::size_t kTogether = 256;
  std::vector<std::array<int, 3>> counts((places.size() + kTogether - 1) / kTogether);
  parallel_for(counts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t part = begin; part < end; ++part) {
      auto& [free, inside, foot] = counts[part];
      const std::size_t last = std::min(places.size(), (part + 1) * kTogether);
      for (std::size_t k = part * kTogether; k < last; ++k) {
        const Vec3 x = pose * places[k];
        const double distance = surface.distance(x);
        const auto known = [&](Sight::Place place) {
          return std::any_of(cameras.begin(), cameras.end(),
                             [&](const Sight& camera) { return camera.at(x) == place; });
        };
        if (distance >= 0) {
          free += !known(Sight::Place::free);
          continue;
        }
        inside += !known(Sight::Place::inside);
        const Vec3 normal = surface.gradient(x), nearest = x - distance * normal;
        foot += std::none_of(cameras.begin(), cameras.end(), [&](const Sight& camera) {
          return camera.sees_well(nearest, normal);
        });
      }
    }
  });
  Unseen unseen;
  for (const auto& [free, inside, foot] : counts) {
    unseen.free += free;
    unseen.inside += inside;
    unseen.foot += foot;
  }
  const double all = static_cast<double>(places.size());
  return {unseen.free / all, unseen.inside / all, unseen.foot / all};
}

ProjectiveCount count_behind(std::span<const Vec3> places, double reach, const Pose& pose,
                             const DepthImage& depth, const Camera& camera) {
  const Pose to_camera = relative_to(camera.to_world, pose);
  const Intrinsics& k = camera.intrinsics;
  std::size_t behind = 0, occluded = 0;
  for (const Vec3& place : places) {
    const Vec3 x = to_camera * place;
    if (!(x.z > 0)) continue;
    const double u = std::floor(k.fx * x.x / x.z + k.cx + 0.5),
                 v = std::floor(k.fy * x.y / x.z + k.cy + 0.5);
    if (!(u >= 0 && v >= 0 && u < depth.width && v < depth.height)) continue;
    const double seen =
        depth.depth[depth.index(static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v))];
    behind += seen > 0 && x.z > seen;
    occluded += seen > 0 && x.z > seen + reach;
  }
  const auto all = static_cast<double>(places.size());
  return {static_cast<double>(behind) / all, static_cast<double>(occluded) / all};
}

}  // namespace vpm::bench
