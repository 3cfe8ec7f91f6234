#include "libvpm/scene/rig/agreement.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libvpm/core/median.h"
#include "libvpm/scene/rig/clear_pixel.h"

namespace vpm {
namespace {

constexpr int kStep = 10;                        // pixels between those that are compared
constexpr double kPerDeviation = 4;              // readings further apart are of two surfaces
constexpr double kLeast = 0.002, kMost = 0.045;  // bounds of the agreement, per metre of depth
constexpr double kSame = 0.05;                   // per metre of depth: more is another surface
constexpr double kAlike = 0.9;                   // cosine of normals of one surface
constexpr double kFrontal = 0.3;                 // least cosine of incidence
constexpr double kWellBefore = 0.03;             // per metre of depth
constexpr std::size_t kFew = 30;                 // fewer readings tell nothing

// Holds a clear pixel's place and normal, the rig's frame, and its depth, m.
struct ClearPixel {
  Vec3 place, normal;
  double depth = 0;
};

std::vector<ClearPixel> clear_pixels(const RigCamera& camera) {
  std::vector<ClearPixel> pixels;
  const DepthSurface& image = camera.image;
  for_clear_pixels(image, kStep, [&](std::int32_t u, std::int32_t v, const Vec3& at) {
    const Vec3 normal = widen(image.normals[v * image.width + u]);
    if (-dot(normal, at) > kFrontal * norm(at))
      pixels.push_back({camera.to_rig * at, camera.to_rig.rotation * normal, at.z});
  });
  return pixels;
}

// Adds how far pixels of one camera are from the surface that another sees there.
void add_deviations(const std::vector<ClearPixel>& pixels, const RigCamera& other,
                    std::vector<double>& deviations) {
  for (const ClearPixel& pixel : pixels) {
    const Vec3 at = other.from_rig * pixel.place;
    const SurfaceSample seen = other.image.sample(at);
    if (!seen.known || std::fabs(seen.distance) >= kSame * pixel.depth ||
        dot(other.to_rig.rotation * seen.normal, pixel.normal) <= kAlike ||
        -dot(seen.normal, at) <= kFrontal * norm(at))
      continue;
    deviations.push_back(std::fabs(seen.distance));
  }
}

}  // namespace

bool is_clear_pixel(const DepthSurface& image, std::int32_t u, std::int32_t v) {
  constexpr std::int32_t kAcross = DepthSampler::kAcross;
  if (u < kAcross || v < kAcross || u >= image.width - kAcross || v >= image.height - kAcross)
    return false;
  const auto normal = [&](std::int32_t x, std::int32_t y) {
    return widen(image.normals[y * image.width + x]);
  };
  const double own = image.inverse_depth(u, v);
  if (!(own > 0)) return false;
  for (const auto& [x, y] :
       {std::pair{u - kAcross, v}, {u + kAcross, v}, {u, v - kAcross}, {u, v + kAcross}}) {
    if (dot(normal(u, v), normal(x, y)) < kAlike ||
        !(std::fabs(image.inverse_depth(x, y) - own) <= DepthSampler::kJump * own))
      return false;
  }
  return true;
}

RigAgreement agreement_of(std::span<const RigCamera> cameras) {
  constexpr double kUnknown = -1, kNormal = 1.48;  // median to standard deviation
  const std::size_t count = cameras.size();
  std::vector<std::vector<ClearPixel>> pixels;
  std::vector<double> depths;
  RigAgreement agreement;
  agreement.of_pairs.assign(count * count, kUnknown);
  for (const RigCamera& camera : cameras) {
    pixels.push_back(clear_pixels(camera));
    for (const ClearPixel& pixel : pixels.back()) depths.push_back(pixel.depth);
  }
  double largest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j) {
      std::vector<double> deviations;
      add_deviations(pixels[i], cameras[j], deviations);
      add_deviations(pixels[j], cameras[i], deviations);
      if (deviations.size() <= kFew) continue;
      const double deviation = kNormal * median(deviations);
      agreement.of_pairs[i * count + j] = agreement.of_pairs[j * count + i] = deviation;
      largest = std::max(largest, deviation);
    }
  }
  const double scale = depths.empty() ? 1 : median(depths);
  for (double& one : agreement.of_pairs) {
    one = std::clamp(kPerDeviation * (one == kUnknown ? largest : one), kLeast * scale,
                     kMost * scale);
    agreement.most = std::max(agreement.most, one);
  }
  agreement.well_before = kWellBefore * scale + agreement.most;
  return agreement;
}

}  // namespace vpm
