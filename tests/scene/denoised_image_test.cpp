#include "libvpm/scene/depth/denoised_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <random>

#include "libvpm/cloud/normals.h"
#include "libvpm/cloud/row_bands.h"
#include "libvpm/core/parallel.h"
#include "libvpm/scene/depth/depth_body.h"
#include "libvpm/synthetic/render.h"
#include "libvpm/synthetic/scenes.h"
#include "tests/test_name.h"

namespace vpm {
namespace {

struct Denoised {
  DenoisedImage image;
  DepthSurface surface;

  explicit Denoised(const SeenImage& seen) {
    const int height = seen.inverse.height;
    image.resize(static_cast<std::uint32_t>(seen.inverse.width),
                 static_cast<std::uint32_t>(height));
    for_bands(height,
              [&](int begin, int end) { image.read_rows(seen, Denoising::on, begin, end); });
    image.unite();
    surface = image.surface({});
  }
  float inverse(int u, int v) const { return surface.tiles[0][v * surface.width + u].high; }
  Vec3f normal(int u, int v) const { return surface.normals[v * surface.width + u]; }
};

SeenImage seen(const DepthImage& depth, const Intrinsics& k) {
  SeenImage result;
  result.resize(depth.width, depth.height);
  take_inverse_depth(depth, 0, result.inverse.height, result.inverse);
  const std::vector<Vec3f> normals = estimate_normals(depth, k, {});
  for (std::size_t i = 0; i < normals.size(); ++i)
    result.set_normal(static_cast<int>(i % depth.width), static_cast<int>(i / depth.width),
                      normals[i]);
  for_bands(result.inverse.height, [&](int begin, int end) { result.mark_rows(begin, end); });
  return result;
}

double angle(Vec3f a, Vec3 b) {
  return std::atan2(norm(cross(widen(a), b)), dot(widen(a), b));
}

// Errors of depths, m, and normals where a smooth surface faces the camera.
struct Errors {
  double depth = 0, normal = 0;  // root mean squares
};
class Scene {
 public:
  explicit Scene(const std::string& name)
      : scene_(synthetic::make_scene(name)),
        true_depth_(synthetic::render(*scene_.surface, scene_.camera)),
        true_(seen(true_depth_, intrinsics())) {}

  const Intrinsics& intrinsics() const { return scene_.camera.intrinsics; }
  const DepthImage& true_depth() const { return true_depth_; }
  DepthImage noisy_depth() const {
    return synthetic::render_with_kinect_noise(*scene_.surface, scene_.camera, 3);
  }

  Errors errors(const std::function<float(int, int)>& inverse,
                const std::function<Vec3f(int, int)>& normal) const {
    Errors sums;
    double count = 0;
    const int width = static_cast<int>(true_depth_.width),
              height = static_cast<int>(true_depth_.height);
    for (int v = kAround; v < height - kAround; ++v) {
      for (int u = kAround; u < width - kAround; ++u) {
        if (!is_smooth(u, v)) continue;
        const double off = 1 / double{inverse(u, v)} -
                           true_depth_.depth[true_depth_.index(static_cast<std::uint32_t>(u),
                                                               static_cast<std::uint32_t>(v))];
        const double turned = angle(normal(u, v), true_normal(u, v));
        sums.depth += off * off, sums.normal += turned * turned, ++count;
      }
    }
    return {std::sqrt(sums.depth / count), std::sqrt(sums.normal / count)};
  }
  Errors errors(const SeenImage& s) const {
    return errors([&](int u, int v) { return *s.inverse.at(u, v); },
                  [&](int u, int v) {
                    return Vec3f{*s.x.at(u, v), *s.y.at(u, v), *s.z.at(u, v)};
                  });
  }
  Errors errors(const Denoised& s) const {
    return errors([&](int u, int v) { return s.inverse(u, v); },
                  [&](int u, int v) { return s.normal(u, v); });
  }

 private:
  static constexpr int kAround = 12;  // pixels

  bool is_smooth(int u, int v) const {
    const Vec3 n = true_normal(u, v);
    for (const int du : {-kAround, 0, kAround}) {
      for (const int dv : {-kAround, 0, kAround})
        if (!(dot(n, true_normal(u + du, v + dv)) > 0.95)) return false;
    }
    return n.z < -0.8;
  }
  Vec3 true_normal(int u, int v) const {
    return {*true_.x.at(u, v), *true_.y.at(u, v), *true_.z.at(u, v)};
  }

  synthetic::Scene scene_;
  DepthImage true_depth_;
  SeenImage true_;
};

TEST(DenoisedImage, NoiseFallsToWhatAWindowLeaves) {
  for (const char* name : {"tilted-wall", "ball", "inverted-ball"}) {
    SCOPED_TRACE(name);
    const Scene scene(name);
    const SeenImage noisy = seen(scene.noisy_depth(), scene.intrinsics());
    const Errors before = scene.errors(noisy), after = scene.errors(Denoised(noisy));
    // A paraboloid over 7 by 7 pixels keeps sqrt(11 / 147) of independent noise; the noise of
    // neighbouring windows of normals is nearly independent.
    EXPECT_LT(after.depth, 0.35 * before.depth);
    EXPECT_LT(after.normal, 0.55 * before.normal);
  }
}

TEST(DenoisedImage, WhatHasNoNoiseStaysWhereItIs) {
  for (const char* name : {"tilted-wall", "ball", "inverted-ball"}) {
    SCOPED_TRACE(name);
    const Scene scene(name);
    const Errors after = scene.errors(Denoised(seen(scene.true_depth(), scene.intrinsics())));
    EXPECT_LT(after.depth, 1e-6);   // m, at 1 m
    EXPECT_LT(after.normal, 2e-3);  // mean of normals 8 pixels aside, on a radius of .3 m
  }
}

// Two planes meet in the column kCrease at right angles; right of the column kStep the second one
// lies `step` m behind.
constexpr int kCrease = 60, kStep = 90;
DepthImage creased(double step) {
  DepthImage depth{120, 40, {}};
  for (int v = 0; v < 40; ++v) {
    for (int u = 0; u < 120; ++u) {
      // Solves z = 1 + |x| with x = (u - kCrease) / 525 z.
      const double slope = std::abs(u - kCrease) / 525.0;
      depth.depth.push_back(static_cast<float>(1 / (1 - slope) + (u >= kStep ? step : 0)));
    }
  }
  return depth;
}

TEST(DenoisedImage, CreasesAndStepsAreNotRoundedOff) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 5e-4);
  DepthImage depth = creased(0.2);
  for (float& z : depth.depth) z += static_cast<float>(noise(random));
  const SeenImage image = seen(depth, {525, 525, kCrease, 20});
  const Denoised after(image);
  const auto stays = [&](int u, int v) { return after.inverse(u, v) == *image.inverse.at(u, v); };
  for (int v = 8; v < 32; ++v) {
    for (const int middle : {kCrease, kStep}) {
      for (int u = middle - kDenoisedRadius; u <= middle + kDenoisedRadius - 1; ++u)
        EXPECT_TRUE(stays(u, v)) << u << ", " << v;
    }
    for (const int u : {30, 45, 75, 105}) EXPECT_FALSE(stays(u, v)) << u << ", " << v;
  }
}

// Windows of normals hold both sides of a crease up to three pixels beside it.
TEST(DenoisedImage, NormalsBesideACreaseLeanToNoSide) {
  const SeenImage image = seen(creased(0), {525, 525, kCrease, 20});
  const Denoised after(image);
  const Vec3 right = normalized_or_zero(Vec3{1, 0, -1});
  for (int v = 12; v < 28; ++v) {
    for (int u = kCrease + 2; u < 110; ++u)
      EXPECT_LT(angle(after.normal(u, v), right), 2e-4) << u << ", " << v;
  }
}

// Depths stay between those around, so a place that they show as free is not classified as behind.
TEST(DenoisedImage, DepthsStayAmongThoseOfTheNinePixelsAround) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(0, 1);
  DepthImage depth = creased(0);
  for (float& z : depth.depth)
    z += static_cast<float>(number(random) < 0.3 ? 0.02 * number(random) : 0);
  const SeenImage image = seen(depth, {525, 525, kCrease, 20});
  const Denoised after(image);
  int on_rim = 0;
  for (int v = 1; v < 39; ++v) {
    for (int u = 1; u < 119; ++u) {
      float low = 1e9F, high = 0;
      for (int dv = -1; dv <= 1; ++dv) {
        for (int du = -1; du <= 1; ++du) {
          low = std::min(low, *image.inverse.at(u + du, v + dv));
          high = std::max(high, *image.inverse.at(u + du, v + dv));
        }
      }
      const float value = after.inverse(u, v);
      EXPECT_TRUE(low <= value && value <= high) << u << ", " << v;
      on_rim += (value == low || value == high) && value != *image.inverse.at(u, v);
    }
  }
  EXPECT_GT(on_rim, 0);
}

TEST(DenoisedImage, NothingComesOfNothing) {
  DepthImage depth = creased(0);
  for (std::size_t i = 0; i < depth.depth.size(); i += 3) depth.depth[i] = 0;
  const SeenImage image = seen(depth, {525, 525, kCrease, 20});
  const Denoised after(image);
  for (int v = 0; v < 40; ++v) {
    for (int u = 0; u < 120; ++u) {
      if (*image.inverse.at(u, v) > 0) continue;
      EXPECT_EQ(after.inverse(u, v), 0);
      EXPECT_EQ(widen(after.normal(u, v)), Vec3());
    }
  }
}

// Repeats the arithmetic pixel by pixel in loops of its own.
class OneByOne {
 public:
  explicit OneByOne(const SeenImage& seen) : seen_(seen) {}

  bool is_clear(int u, int v) const {
    bool clear = true;
    for (const int d : {-kDenoisedRadius, kDenoisedRadius})
      clear &= is_alike(at(u, v), at(u + d, v)) && is_alike(at(u, v), at(u, v + d));
    return clear;
  }
  float inverse(int u, int v) const {
    const WindowOfDepths<float> w = window(u, v);
    return is_clear(u, v) && w.is_one_surface() ? w.paraboloid() : at(u, v).inverse;
  }
  Vec3f normal(int u, int v) const {
    Sum of_clear, of_all;
    add(u, v, 0, 0, of_clear, of_all);
    for (int across = kDenoisedAcross; across <= kDenoisedReach; across += kDenoisedAcross) {
      for (int dv = -across; dv <= across; dv += across) {
        for (int du = -across; du <= across; du += across)
          if (du != 0 || dv != 0) add(u, v, du, dv, of_clear, of_all);
      }
    }
    const Sum& sum = of_clear.count > 0 ? of_clear : of_all;
    const float scale = per_length(sum.x, sum.y, sum.z);
    return {sum.x * scale, sum.y * scale, sum.z * scale};
  }

 private:
  struct Sum {
    float x = 0, y = 0, z = 0;
    int count = 0;

    void add(const SeenPixel<float>& pixel) {
      x += pixel.x, y += pixel.y, z += pixel.z;
      ++count;
    }
  };
  void add(int u, int v, int du, int dv, Sum& of_clear, Sum& of_all) const {
    if (u + du < 0 || v + dv < 0 || u + du >= seen_.inverse.width ||
        v + dv >= seen_.inverse.height || !is_alike(at(u, v), at(u + du, v + dv)))
      return;
    of_all.add(at(u + du, v + dv));
    if (is_clear(u + du, v + dv)) of_clear.add(at(u + du, v + dv));
  }
  SeenPixel<float> at(int u, int v) const {
    return {*seen_.inverse.at(u, v), *seen_.x.at(u, v), *seen_.y.at(u, v), *seen_.z.at(u, v)};
  }
  WindowOfDepths<float> column(int u, int v) const {
    WindowOfDepths<float> sums(*seen_.inverse.at(u, v));
    for (int d = 1; d <= kDenoisedRadius; ++d)
      sums.add_rows(*seen_.inverse.at(u, v + d), *seen_.inverse.at(u, v - d), d);
    return sums;
  }
  WindowOfDepths<float> window(int u, int v) const {
    WindowOfDepths<float> sums = column(u, v);
    for (int d = 1; d <= kDenoisedRadius; ++d)
      sums.add_columns(column(u + d, v), column(u - d, v), d);
    return sums;
  }

  const SeenImage& seen_;
};

template <class T>
bool same_bytes(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

TEST(DenoisedImage, HasTheBitsOfItsPixelsAtAnySize) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> number(0, 1);
  for (const auto& [width, height] :
       {std::pair(1, 1), std::pair(2, 9), std::pair(63, 5), std::pair(65, 11), std::pair(200, 31),
        std::pair(577, 5), std::pair(70, 97)}) {
    DepthImage depth{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
    for (int i = 0; i < width * height; ++i) {
      const double z = i % width < width / 2 ? 1 : 1.5;
      depth.depth.push_back(number(random) < 0.01 ? 0.0F
                                                  : static_cast<float>(z + 2e-3 * number(random)));
    }
    const SeenImage image = seen(depth, {525, 525, width / 2.0, height / 2.0});
    const OneByOne expected(image);
    for (const int threads : {1, 3}) {
      set_thread_count(threads);
      const Denoised found(image);
      int differ = 0;
      for (int v = 0; v < height; ++v) {
        for (int u = 0; u < width; ++u)
          differ += !same_bytes(found.inverse(u, v), expected.inverse(u, v)) ||
                    !same_bytes(found.normal(u, v), expected.normal(u, v));
      }
      EXPECT_EQ(differ, 0) << width << " x " << height << ", " << threads << " threads";
    }
    set_thread_count(0);
  }
}

TEST(DenoisedImage, IsReadAsMeasuredWhereThatIsAsked) {
  const Scene scene("tilted-wall");
  const DepthImage depth = scene.noisy_depth();
  const Camera camera{scene.intrinsics(), depth.width, depth.height, {}};
  const Cloud cloud = make_cloud(depth, camera, {});
  const DepthBody measured(cloud, Denoising::off), denoised(cloud);
  const std::vector<Vec3f> normals = estimate_normals(depth, camera.intrinsics, {});
  std::size_t differ = 0;
  for (std::size_t i = 0; i < depth.depth.size(); ++i) {
    if (!(depth.depth[i] > 0)) continue;
    ASSERT_EQ(measured.surface().tiles[0][i].high, 1 / depth.depth[i]);
    ASSERT_LT(norm(widen(measured.surface().normals[i]) - widen(normals[i])), 1e-6);
    differ += measured.surface().tiles[0][i].high != denoised.surface().tiles[0][i].high;
  }
  EXPECT_GT(differ, depth.depth.size() / 2);
}

}  // namespace
}  // namespace vpm
