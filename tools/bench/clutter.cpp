#include "tools/bench/clutter.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "libvpm/cloud/normals.h"
#include "libvpm/synthetic/render.h"
#include "tools/bench/random_draws.h"

namespace vpm::bench {
namespace {

constexpr std::uint64_t kThingSeed = 12, kClutterHoleSeed = 13;

// Unsets the pixels to the right of nearer ones, as far as the shadow of what is nearer falls.
void unset_shadows(DepthImage& image, double shift) {
  const std::vector<float> seen = image.depth;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (!(seen[i] > 0)) continue;
    const std::size_t u = i % image.width;
    for (std::size_t left = 1; left <= std::min<std::size_t>(u, 24); ++left) {
      const double nearer = seen[i - left];
      if (nearer > 0 && shift * (1 / nearer - 1 / double{seen[i]}) > static_cast<double>(left))
        image.depth[i] = 0;
    }
  }
}

// Unsets round holes.
void unset_holes(DepthImage& image) {
  constexpr int kHoles = 60;
  constexpr double kRadius = 9;  // pixels, of an average one
  for (std::uint64_t k = 0; k < kHoles; ++k) {
    synthetic::NormalNumbers numbers(kClutterHoleSeed, k);
    const double u0 = image.width * (0.5 + 0.22 * within_two(numbers)),
                 v0 = image.height * (0.5 + 0.22 * within_two(numbers)),
                 radius = kRadius * (1 + 0.4 * within_two(numbers));
    for (std::size_t i = 0; i < image.depth.size(); ++i) {
      const double u = static_cast<double>(i % image.width) - u0,
                   v = static_cast<double>(i / image.width) - v0;
      if (u * u + v * v < radius * radius) image.depth[i] = 0;
    }
  }
}

}  // namespace

// A table, tilted toward the camera, with things in rows and columns above it that do not touch
// each other.
synthetic::SurfacePtr clutter_surface() {
  constexpr int kColumns = 6, kRows = 4;
  constexpr double kApart = 0.14, kSmallest = 0.025, kSpread = 0.006;  // m
  const Vec3 up = normalized_or_zero({0, -0.5, -1}), middle{0, 0, 0.85};
  const Vec3 across{1, 0, 0}, along = cross(up, across);
  std::vector<synthetic::SurfacePtr> parts{synthetic::make_wall(middle, up)};
  for (int k = 0; k < kColumns * kRows; ++k) {
    synthetic::NormalNumbers numbers(kThingSeed, static_cast<std::uint64_t>(k));
    const double size = kSmallest + kSpread * (2 + within_two(numbers));
    const double x = kApart * (k % kColumns - 0.5 * (kColumns - 1)),
                 y = kApart * (k / kColumns - 0.5 * (kRows - 1));
    const Vec3 at = middle + x * across + y * along + 1.8 * size * up;
    if (k % 3 == 0)
      parts.push_back(synthetic::make_ball(at, size));
    else
      parts.push_back(
          synthetic::make_block({size, 2 * size, 1.5 * size}, {random_rotation(numbers), at}));
  }
  return synthetic::make_union(std::move(parts));
}

Cloud make_clutter(std::uint64_t noise_seed) {
  constexpr double kBaseline = 0.075;  // m, between camera and projector
  const Camera camera = synthetic::default_camera();
  DepthImage image = synthetic::render_with_kinect_noise(*clutter_surface(), camera, noise_seed);
  unset_shadows(image, camera.intrinsics.fx * kBaseline);
  unset_holes(image);
  return assemble_cloud(image, camera, estimate_normals(image, camera.intrinsics, {}));
}

}  // namespace vpm::bench
