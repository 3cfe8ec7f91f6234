#include "libvpm/cloud/normals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>

#include "libvpm/cloud/window_span.h"
#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"
#include "libvpm/synthetic/render.h"
#include "tests/cloud/normal_scene.h"
#include "tests/refusal.h"
#include "tests/test_name.h"

namespace vpm {
namespace {

const Camera kSmallCamera{{525, 525, 15.5, 11.5}, 32, 24, {}};
const Camera kWideCamera{{40, 50, 15.5, 11.5}, 32, 24, {}};

bool same_bits(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3f)) == 0;
}

// Runs each test with both methods, which make the same promises.
class Normals : public testing::TestWithParam<NormalMethod> {
 protected:
  NormalOptions options(int window = 7, double gate = kEdgeGate) const {
    return {GetParam(), window, gate};
  }
  std::vector<Vec3f> normals(const DepthImage& depth, const Camera& camera) const {
    return estimate_normals(depth, camera.intrinsics, options());
  }
};

INSTANTIATE_TEST_SUITE_P(Methods, Normals,
                         testing::Values(NormalMethod::inverse_depth, NormalMethod::pca),
                         [](const auto& method) { return test::test_name(to_text(method.param)); });

TEST_P(Normals, PlanesAreExactAtEveryTiltAndDistanceAndWindow) {
  for (const double tilt : {0.0, 20.0, 45.0, 70.0}) {
    for (const double turn : {0.0, 50.0, 200.0}) {
      for (const double distance : {0.01, 1.0, 50.0}) {
        const double t = tilt * std::numbers::pi / 180, a = turn * std::numbers::pi / 180;
        const Vec3 normal{std::sin(t) * std::cos(a), std::sin(t) * std::sin(a), -std::cos(t)};
        const DepthImage image = plane_image(kSmallCamera, normal, distance);
        for (const int window : {5, 7, 11}) {
          const auto found = estimate_normals(image, kSmallCamera.intrinsics, options(window));
          for (std::size_t i = 0; i < found.size(); ++i) {
            ASSERT_LT(angle_between(found[i], normal), 1e-4)
                << "tilt " << tilt << " turn " << turn << " distance " << distance << " window "
                << window << " pixel " << i % image.width << " " << i / image.width;
          }
        }
      }
    }
  }
}

TEST_P(Normals, ObliqueRaysOfAWideCameraSeeThePlaneTheSame) {
  const Vec3 normal = Vec3{0.3, -0.2, -1} / norm({0.3, -0.2, -1});
  const auto found =
      estimate_normals(plane_image(kWideCamera, normal, 1), kWideCamera.intrinsics, options(5, 0));
  for (const Vec3f& n : found) ASSERT_LT(angle_between(n, normal), 1e-4);
}

TEST_P(Normals, AreUnitAndFaceTheSensor) {
  const NormalScene scene = see(room());
  const DepthImage noisy = synthetic::render_with_kinect_noise(*room(), scene.camera, 3);
  const auto found = normals(noisy, scene.camera);
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (!exists(found[i])) continue;
    const double u = static_cast<double>(i % noisy.width), v = static_cast<double>(i / noisy.width);
    ASSERT_NEAR(norm(widen(found[i])), 1, 1e-5);
    ASSERT_LT(dot(widen(found[i]), unproject(scene.camera.intrinsics, u, v, 1)), 0);
  }
}

TEST_P(Normals, AreAccurateOnCurvedScenesAndUnderNoise) {
  const NormalScene scene = see(room());
  const bool pca = GetParam() == NormalMethod::pca;
  const std::vector<bool> all(scene.truth.size(), true);
  const auto clean = normals(scene.depth, scene.camera);
  EXPECT_LT(mean_error(scene, clean, scene.inside), 0.1);
  EXPECT_LT(mean_error(scene, clean, all), 0.3);
  const DepthImage noisy = synthetic::render_with_kinect_noise(*room(), scene.camera, 1);
  const auto found = normals(noisy, scene.camera);
  // Noise along the ray nearly doubles the error of total least squares.
  EXPECT_LT(mean_error(scene, found, scene.inside), pca ? 10.5 : 5.6);
  EXPECT_LT(mean_error(scene, found, all), pca ? 10.5 : 5.9);
}

TEST_P(Normals, DoNotBleedAcrossAStep) {
  // The left half is at 1 m, the right half at 1.1 m, both facing the camera.
  DepthImage image = plane_image(kSmallCamera, {0, 0, -1}, 1);
  for (std::size_t i = 0; i < image.depth.size(); ++i) {
    if (i % image.width >= 16) image.depth[i] = 1.1F;
  }
  for (const Vec3f& n : normals(image, kSmallCamera)) ASSERT_LT(angle_between(n, {0, 0, -1}), 1e-4);
  // Without the gate, windows at the edge mix both sides.
  const auto ungated = estimate_normals(image, kSmallCamera.intrinsics, options(7, 0));
  EXPECT_GT(angle_between(ungated[image.index(15, 12)], {0, 0, -1}), 0.5);
}

TEST_P(Normals, AreLeftOutWhereTooLittleIsMeasured) {
  DepthImage image{kSmallCamera.width, kSmallCamera.height, {}};
  image.depth.assign(std::size_t{image.width} * image.height, 0.0F);
  const auto count = [&] {
    std::size_t n = 0;
    for (const Vec3f& normal : normals(image, kSmallCamera)) n += exists(normal);
    return n;
  };
  EXPECT_EQ(count(), 0U);
  image.depth[image.index(16, 12)] = 1;
  EXPECT_EQ(count(), 0U) << "a single pixel";
  for (std::uint32_t u = 0; u < image.width; ++u) image.depth[image.index(u, 12)] = 1;
  EXPECT_EQ(count(), 0U) << "pixels on a line";
  for (std::uint32_t u = 0; u < image.width; ++u) image.depth[image.index(u, 13)] = 1;
  EXPECT_EQ(count(), 2U * image.width) << "two rows";
}

TEST_P(Normals, TakeNoNumberForAMeasurementThatIsNone) {
  const Vec3 normal = Vec3{0.2, 0.1, -1} / norm({0.2, 0.1, -1});
  DepthImage image = plane_image(kSmallCamera, normal, 1);
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const float none[] = {0.0F,
                        -0.0F,
                        -1.0F,
                        kInfinity,
                        -kInfinity,
                        std::numeric_limits<float>::quiet_NaN(),
                        std::numeric_limits<float>::denorm_min(),
                        std::numeric_limits<float>::max()};
  for (std::size_t i = 0; i < 8; ++i)
    image.depth[image.index(8 + static_cast<std::uint32_t>(i), 10)] = none[i];
  const auto found = normals(image, kSmallCamera);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const bool measured = !(i / image.width == 10 && i % image.width >= 8 && i % image.width < 16);
    ASSERT_EQ(exists(found[i]), measured);
    if (!measured) continue;
    ASSERT_LT(angle_between(found[i], normal), 1e-4);
  }
}

TEST_P(Normals, ReachFromAMicrometreToTheEndOfSixteenBits) {
  for (const double distance : {1e-6, 65.535}) {
    for (const Vec3f& n : normals(plane_image(kSmallCamera, {0, 0, -1}, distance), kSmallCamera))
      ASSERT_LT(angle_between(n, {0, 0, -1}), 1e-4);
  }
  // Both planes are in one image, and neither disturbs the other.
  DepthImage image = plane_image(kSmallCamera, {0, 0, -1}, 65);
  for (std::size_t i = 0; i < image.depth.size() / 2; ++i) image.depth[i] = 1e-6F;
  for (const Vec3f& n : normals(image, kSmallCamera)) ASSERT_LT(angle_between(n, {0, 0, -1}), 1e-4);
}

TEST_P(Normals, DoNotChangeABitWithScaleOrThreads) {
  const NormalScene scene = see(room());
  DepthImage image = synthetic::render_with_kinect_noise(*room(), scene.camera, 2);
  set_thread_count(1);
  const auto expected = normals(image, scene.camera);
  for (const int threads : {2, 8}) {
    set_thread_count(threads);
    EXPECT_TRUE(same_bits(normals(image, scene.camera), expected)) << threads << " threads";
  }
  set_thread_count(0);
  for (const float scale : {0x1p-40F, 0x1p40F}) {
    DepthImage scaled = image;
    for (float& depth : scaled.depth) depth *= scale;
    EXPECT_TRUE(same_bits(normals(scaled, scene.camera), expected)) << scale;
  }
}

TEST_P(Normals, DependOnTheWindowAlone) {
  // Normals depend on the pixel's window alone, except that PCA's last bits depend on the parity of
  // its column.
  const NormalScene scene = see(room());
  const auto whole = normals(scene.depth, scene.camera);
  constexpr std::uint32_t kV = 151, kWidth = 60, kHeight = 50, kMargin = 3;
  for (const std::uint32_t first : {200U, 201U}) {
    DepthImage part{kWidth, kHeight, {}};
    for (std::uint32_t v = 0; v < kHeight; ++v) {
      for (std::uint32_t u = 0; u < kWidth; ++u)
        part.depth.push_back(scene.depth.depth[scene.depth.index(first + u, kV + v)]);
    }
    Intrinsics k = scene.camera.intrinsics;
    k.cx -= first;
    k.cy -= kV;
    const bool has_same_bits = GetParam() != NormalMethod::pca || first % 2 == 0;
    const auto found = estimate_normals(part, k, options());
    for (std::uint32_t v = kMargin; v < kHeight - kMargin; ++v) {
      for (std::uint32_t u = kMargin; u < kWidth - kMargin; ++u) {
        const Vec3f n = found[part.index(u, v)], m = whole[scene.depth.index(first + u, kV + v)];
        if (has_same_bits)
          ASSERT_EQ(n, m);
        else
          ASSERT_LT(angle_between(n, widen(m)), 1e-5);
      }
    }
  }
}

// Returns the plane of inverse depth nearest to a window's pixels, or the direction in which their
// points vary least, in double precision from the definitions.
Vec3 plane_by_definition(const std::vector<Vec3>& pixels, const Intrinsics& k) {
  Vec3 mean{};
  for (const Vec3& p : pixels)
    mean = mean + (1.0 / static_cast<double>(pixels.size())) * Vec3{p.x, p.y, 1 / p.z};
  double uu = 0, uv = 0, vv = 0, us = 0, vs = 0;
  for (const Vec3& p : pixels) {
    const Vec3 d = Vec3{p.x, p.y, 1 / p.z} - mean;
    uu += d.x * d.x, uv += d.x * d.y, vv += d.y * d.y, us += d.x * d.z, vs += d.y * d.z;
  }
  const double determinant = uu * vv - uv * uv;
  const double a = (us * vv - vs * uv) / determinant, b = (vs * uu - us * uv) / determinant;
  const Vec3 n{a * k.fx, b * k.fy, a * (k.cx - mean.x) + b * (k.cy - mean.y) + mean.z};
  return (-1 / norm(n)) * n;
}
Vec3 least_variance_by_definition(const std::vector<Vec3>& pixels, const Intrinsics& k) {
  std::vector<Vec3> points;
  Vec3 mean{};
  for (const Vec3& p : pixels) {
    points.push_back(unproject(k, p.x, p.y, p.z));
    mean = mean + (1.0 / static_cast<double>(pixels.size())) * points.back();
  }
  Vec3 x{}, y{}, z{};  // columns of the covariance
  for (const Vec3& point : points) {
    const Vec3 d = point - mean;
    x = x + d.x * d, y = y + d.y * d, z = z + d.z * d;
  }
  // Powers of the adjugate converge to the eigenvector of the least eigenvalue.
  Vec3 n{0, 0, -1};
  for (int i = 0; i < 100; ++i) {
    n = n.x * cross(y, z) + n.y * cross(z, x) + n.z * cross(x, y);
    n = (1 / norm(n)) * n;
  }
  return dot(n, mean) > 0 ? -1.0 * n : n;
}

TEST_P(Normals, AreThoseOfAWindowsPixelsWhereverTheBorderCutsIt) {
  DepthImage image = plane_image(kSmallCamera, Vec3{0.3, -0.4, -1} / norm({0.3, -0.4, -1}), 1);
  std::mt19937 random(11);
  for (float& depth : image.depth) depth *= 1 + 4e-6F * static_cast<float>(random() % 100);
  const Intrinsics& k = kSmallCamera.intrinsics;
  const auto definition =
      GetParam() == NormalMethod::pca ? least_variance_by_definition : plane_by_definition;
  const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
  for (const int window : {3, 5, 7, 15, 31}) {
    const auto found = estimate_normals(image, k, options(window));
    const int r = window / 2;
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) {
        std::vector<Vec3> pixels;
        for (int y = std::max(0, v - r); y <= std::min(height - 1, v + r); ++y) {
          for (int x = std::max(0, u - r); x <= std::min(width - 1, u + r); ++x) {
            const auto i = static_cast<std::size_t>(y * width + x);
            pixels.push_back({double(x), double(y), double{image.depth[i]}});
          }
        }
        const Vec3f n = found[static_cast<std::size_t>(v * width + u)];
        if (pixels.size() < kMinSupport) {
          ASSERT_FALSE(exists(n));
        } else {
          ASSERT_LT(angle_between(n, definition(pixels, k)), 2e-4)
              << "window " << window << " pixel " << u << " " << v;
        }
      }
    }
  }
}

TEST_P(Normals, WhereNothingIsAnEdgeTheGateChangesNothing) {
  // Noise stays below the gate, so all measured pixels belong to the surface.
  DepthImage image = plane_image(kSmallCamera, Vec3{0.2, -0.1, -1} / norm({0.2, -0.1, -1}), 1);
  std::mt19937 random(7);
  for (float& depth : image.depth)
    depth = random() % 5 == 0 ? 0 : depth * (1 + 0.007F * static_cast<float>(random() % 100) / 100);
  EXPECT_TRUE(same_bits(normals(image, kSmallCamera),
                        estimate_normals(image, kSmallCamera.intrinsics, options(7, 0))));
  // An edge gates only the windows that it crosses.
  image.depth[image.index(16, 12)] *= 2;
  const auto gated = normals(image, kSmallCamera),
             open = estimate_normals(image, kSmallCamera.intrinsics, options(7, 0));
  for (std::uint32_t v = 0; v < image.height; ++v) {
    for (std::uint32_t u = 0; u < image.width; ++u) {
      const bool crossed = u >= 13 && u <= 19 && v >= 9 && v <= 15;
      const std::size_t i = image.index(u, v);
      if (!exists(open[i])) continue;
      EXPECT_EQ(gated[i] != open[i], crossed) << u << " " << v;
    }
  }
}

TEST_P(Normals, ImagesSmallerThanTheWindowAreNoTrouble) {
  const Camera tiny{{525, 525, 1, 1}, 3, 2, {}};
  for (const Vec3f& n :
       estimate_normals(plane_image(tiny, {0, 0, -1}, 1), tiny.intrinsics, options(31)))
    EXPECT_LT(angle_between(n, {0, 0, -1}), 1e-4);
  EXPECT_TRUE(estimate_normals(DepthImage{}, tiny.intrinsics, options()).empty());
}

TEST(NormalOptions, OutOfRangeIsWrongUsage) {
  const DepthImage image = plane_image(kSmallCamera, {0, 0, -1}, 1);
  const Intrinsics k = kSmallCamera.intrinsics;
  const auto kind = [&](const Intrinsics& intrinsics, const NormalOptions& options) {
    return test::kind_of_fault([&] { estimate_normals(image, intrinsics, options); });
  };
  constexpr auto kMethod = NormalMethod::inverse_depth;
  for (const int window : {-1, 0, 1, 2, 8, 33})
    EXPECT_EQ(kind(k, {kMethod, window, kEdgeGate}), ErrorKind::invalid_argument) << window;
  for (const double gate : {-0.1, 1.0, std::nan("")})
    EXPECT_EQ(kind(k, {kMethod, 7, gate}), ErrorKind::invalid_argument) << gate;
  EXPECT_EQ(kind({0, 525, 0, 0}, {}), ErrorKind::invalid_argument);
  EXPECT_EQ(kind({525, std::nan(""), 0, 0}, {}), ErrorKind::invalid_argument);
  EXPECT_THROW(estimate_normals({4, 4, std::vector<float>(15)}, k, {}), Error);
  EXPECT_THROW(normal_method_from_text("svd"), Error);
  EXPECT_EQ(normal_method_from_text(to_text(NormalMethod::pca)), NormalMethod::pca);
}

}  // namespace
}  // namespace vpm
