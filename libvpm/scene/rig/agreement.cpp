#include "libvpm/scene/rig/agreement.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libvpm/core/median.h"
#include "libvpm/core/parallel.h"
#include "libvpm/scene/rig/clear_pixel.h"

namespace vpm {
namespace {

constexpr int kStep = 10;                         // pixels between those that are compared
constexpr double kPerDeviation = 6;               // readings further apart are of two surfaces
constexpr double kMostPixels = kSilhouetteReach;  // bounds the agreement
constexpr double kWellBefore = 0.03;              // per depth
constexpr std::size_t kPixelsPerTask = 512;       // that another camera is asked about

// Holds a clear pixel's place and normal, the rig's frame, and its depth, m.
struct ClearPixel {
  Vec3 place, normal;
  double depth = 0;
};

std::vector<ClearPixel> clear_pixels(const RigCamera& camera, std::int32_t step) {
  std::vector<ClearPixel> pixels;
  const DepthSurface& image = camera.image;
  for_clear_pixels(image, step, [&](std::int32_t u, std::int32_t v, const Vec3& at) {
    const Vec3 normal = widen(image.normals[v * image.width + u]);
    if (-dot(normal, at) > kFrontal * norm(at))
      pixels.push_back({camera.to_rig * at, camera.to_rig.rotation * normal, at.z});
  });
  return pixels;
}

// Holds the depth of a pixel, m, and how far it is from what another camera sees there, per depth.
using Deviation = std::pair<double, double>;

void add_deviations(std::span<const ClearPixel> pixels, const RigCamera& other,
                    std::vector<Deviation>& deviations) {
  for (const ClearPixel& pixel : pixels) {
    const Vec3 at = other.from_rig * pixel.place;
    const SurfaceSample seen = other.image.sample(at);
    if (!seen.known || std::fabs(seen.distance) >= kSameSurface * pixel.depth ||
        dot(other.to_rig.rotation * seen.normal, pixel.normal) <= kAlikeNormals ||
        -dot(seen.normal, at) <= kFrontal * norm(at))
      continue;
    deviations.emplace_back(pixel.depth, std::fabs(seen.distance) / pixel.depth);
  }
}

// Returns the robust deviation, per depth, of the nearer half of them: tools touch what is near,
// and noise grows faster than depth.
double deviation_of(std::vector<Deviation>& deviations) {
  const auto middle = deviations.begin() + static_cast<std::ptrdiff_t>(deviations.size() / 2);
  std::nth_element(deviations.begin(), middle, deviations.end());
  std::vector<double> near;
  for (auto one = deviations.begin(); one != middle; ++one) near.push_back(one->second);
  return kDeviationOfMedian * median(near);
}

}  // namespace

std::int32_t step_of_comparison(const DepthSurface& image) {
  constexpr double kPixels = 6000;
  const double pixels = static_cast<double>(image.width) * image.height;
  return std::max(1, static_cast<std::int32_t>(std::sqrt(pixels / kPixels)));
}

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
    if (dot(normal(u, v), normal(x, y)) < kAlikeNormals ||
        !(std::fabs(image.inverse_depth(x, y) - own) <= DepthSampler::kJump * own))
      return false;
  }
  return true;
}

std::optional<double> deviation_between(const RigCamera& one, const RigCamera& other) {
  std::vector<Deviation> deviations;
  add_deviations(clear_pixels(one, step_of_comparison(one.image)), other, deviations);
  add_deviations(clear_pixels(other, step_of_comparison(other.image)), one, deviations);
  if (deviations.size() <= kFewReadings) return std::nullopt;
  return deviation_of(deviations);
}

RigAgreement agreement_of(std::span<const RigCamera> cameras) {
  constexpr double kUnknown = -1;
  const std::size_t count = cameras.size();
  const auto for_each = [](std::size_t all, const auto& body) {
    parallel_for(all, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) body(k);
    });
  };
  std::vector<std::vector<ClearPixel>> pixels(count);
  for_each(count, [&](std::size_t i) { pixels[i] = clear_pixels(cameras[i], kStep); });
  // Pixels of camera i that camera j is asked about.
  struct Part {
    std::size_t i, j;
    std::span<const ClearPixel> pixels;
    std::vector<Deviation> deviations = {};
  };
  std::vector<Part> parts;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < count; ++j)
      for (std::size_t k = 0; i != j && k < pixels[i].size(); k += kPixelsPerTask)
        parts.push_back({i, j,
                         std::span(pixels[i]).subspan(k).first(
                             std::min(kPixelsPerTask, pixels[i].size() - k))});
  for_each(parts.size(), [&](std::size_t k) {
    Part& part = parts[k];
    add_deviations(part.pixels, cameras[part.j], part.deviations);
  });
  RigAgreement agreement;
  agreement.of_pairs.assign(count * count, kUnknown);
  for_each(count * count, [&](std::size_t pair) {
    const std::size_t i = pair / count, j = pair % count;
    if (i >= j) return;
    std::vector<Deviation> deviations;
    for (const Part& part : parts)
      if (std::min(part.i, part.j) == i && std::max(part.i, part.j) == j)
        deviations.insert(deviations.end(), part.deviations.begin(), part.deviations.end());
    if (deviations.size() <= kFewReadings) return;
    agreement.of_pairs[pair] = agreement.of_pairs[j * count + i] = deviation_of(deviations);
  });
  const double largest = std::max(0.0, *std::ranges::max_element(agreement.of_pairs));
  const auto pixel = [&](std::size_t i) {
    return 1 / std::min(cameras[i].image.k.fx, cameras[i].image.k.fy);
  };
  for (std::size_t pair = 0; pair < count * count; ++pair) {
    const std::size_t i = pair / count, j = pair % count;
    const double width = std::max(pixel(i), pixel(j));
    double& one = agreement.of_pairs[pair];
    const double deviation = i == j ? 0 : one == kUnknown ? largest : one;
    one = std::clamp(kPerDeviation * deviation, width, kMostPixels * width);
    agreement.most = std::max(agreement.most, one);
  }
  agreement.well_before = kWellBefore + agreement.most;
  return agreement;
}

}  // namespace vpm
