#include "libvpm/scene/surface_noise.h"

#include <algorithm>
#include <cmath>

#include "libvpm/model/sphere.h"
#include "libvpm/scene/points/disk_windows.h"

namespace vpm {
namespace {

// Half the width of the window of pixels that tell the noise at a place.
constexpr std::int32_t kWindow = 3;
// Radius about a place, in sampling radii, of the disks that do so.
constexpr double kDisks = 4;
// Sum of the squared weights of a second difference.
constexpr double kSecondDifference = 6;

// Calls visit(difference) for second differences of inverse depth, 1/m, along rows and columns
// about a pixel, of pixels that show one surface.
template <class Visit>
void for_second_differences(const DepthSurface& image, std::int32_t u, std::int32_t v,
                            const Visit& visit) {
  const std::int32_t u0 = std::max(u - kWindow, 1), u1 = std::min(u + kWindow, image.width - 2);
  const std::int32_t v0 = std::max(v - kWindow, 1), v1 = std::min(v + kWindow, image.height - 2);
  const auto try_pixels = [&](double before, double middle, double after) {
    const double most = DepthSampler::kJump * middle;
    if (before > 0 && middle > 0 && after > 0 && std::fabs(before - middle) <= most &&
        std::fabs(after - middle) <= most)
      visit(before - 2 * middle + after);
  };
  for (std::int32_t y = v0; y <= v1; ++y)
    for (std::int32_t x = u0; x <= u1; ++x) {
      const double middle = image.measured_at(x, y);
      try_pixels(image.measured_at(x - 1, y), middle, image.measured_at(x + 1, y));
      try_pixels(image.measured_at(x, y - 1), middle, image.measured_at(x, y + 1));
    }
}

// Returns the height of a place's ray, 1 deep, along a normal there.
double along_ray(const SurfaceSample& at) {
  return std::fabs(dot(at.normal, at.foot)) / at.foot.z;
}

}  // namespace

double NoiseSum<DepthSurface>::per_area(const SurfaceSample& at) const {
  const auto [is_seen, u, v] = surface_.project(at.foot);
  if (!is_seen) return 0;
  double sum = 0, count = 0;
  for_second_differences(surface_, static_cast<std::int32_t>(u + 0.5),
                         static_cast<std::int32_t>(v + 0.5), [&](double difference) {
                           sum += difference * difference;
                           ++count;
                         });
  if (count == 0) return 0;
  const double squared = at.foot.z * at.foot.z;
  const double of_depth = squared * squared * (sum / (kSecondDifference * count));  // m^2
  return along_ray(at) * squared * of_depth / (surface_.k.fx * surface_.k.fy);
}

void NoiseSum<DiskSurface>::add(const SurfaceSample& at, double area) {
  const double reach = kDisks * surface_.radii.of_points[at.point];
  double sum = 0;
  std::uint32_t count = 0;
  // Adds the disks whose normals have this cosine with the surface's, or more.
  const auto add_disks = [&](double least) {
    surface_.feet.for_points_in_ball(at.foot, reach * reach, [&](std::uint32_t i) {
      const Vec3 normal = widen(surface_.normals[i]);
      if (dot(normal, at.normal) < least) return true;
      const double height =
          dot(normal, widen(surface_.measured[i]) - widen(surface_.feet.points[i]));
      sum += height * height;
      ++count;
      return true;
    });
  };
  add_disks(kAlike);  // not those beyond a crease, or a thin plate
  // On a crease, whose normal is a mean, no disk may be alike.
  if (count == 0) add_disks(0);
  if (count == 0) return;
  const double of_point = sum / count, per_point = kPi * reach * reach / count;  // m^2
  variance_ += area * of_point * per_point;
}

void NoiseSum<RigSurface>::add(const SurfaceSample& at, double area) {
  double weights = 0, weighted = 0, distances = 0, cameras = 0;
  std::array<double, RigSurface::kMostCameras> distance{}, weight{};
  for (std::int32_t i = 0; i < surface_.count; ++i) {
    const RigCamera& camera = surface_.cameras[i];
    const Vec3 x = camera.from_rig * at.foot, normal = camera.from_rig.rotation * at.normal;
    const SurfaceSample seen = camera.image.sample(x);
    if (!seen.known || dot(seen.normal, normal) < DepthSampler::kSmoothCosine) continue;
    distance[static_cast<std::size_t>(i)] = seen.distance;
    if (!(std::fabs(seen.distance) < surface_.most_agreement * x.z)) continue;
    const double facing = along_ray(seen) * seen.foot.z / norm(seen.foot);
    const double of_camera =
        facing * facing * camera.image.k.fx * camera.image.k.fy / (seen.foot.z * seen.foot.z);
    weight[static_cast<std::size_t>(i)] = of_camera;
    weights += of_camera;
    weighted += of_camera * of_camera * NoiseSum<DepthSurface>(camera.image).per_area(seen);
    distances += of_camera * seen.distance;
    ++cameras;
  }
  if (cameras == 0) return;
  of_pixels_ += area * weighted / (weights * weights);
  if (cameras == 1) return;
  const double mean = distances / weights, per_camera = 1 / std::sqrt(cameras * (cameras - 1));
  for (std::size_t i = 0; i < weight.size(); ++i)
    if (weight[i] > 0) disagreement_[i] += area * per_camera * (distance[i] - mean);
}

double NoiseSum<RigSurface>::variance() const {
  double sum = of_pixels_;
  for (const double volume : disagreement_) sum += volume * volume;
  return sum;
}

}  // namespace vpm
