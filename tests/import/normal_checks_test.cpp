#include "libvpm/import/normal_checks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include "libvpm/cloud/scattered_points.h"
#include "libvpm/core/error.h"
#include "tests/import/test_files.h"

namespace vpm {
namespace {

// Returns a wall before the origin, 1 m away, whose points are 10 mm apart.
PointSet wall() {
  PointSet points;
  constexpr int kHalf = 20;
  for (int i = -kHalf; i <= kHalf; ++i) {
    for (int k = -kHalf; k <= kHalf; ++k) {
      points.positions.push_back({0.01 * i, 0.01 * k, 1});
      points.normals.push_back({0, 0, -1});
    }
  }
  return points;
}

// Returns the surface of a box, whose points are `spacing` apart.
PointSet box(Vec3 low, Vec3 high, double spacing) {
  PointSet points;
  const auto add = [&](Vec3 corner, Vec3 u, Vec3 v, Vec3 normal) {
    const int across = static_cast<int>(norm(u) / spacing),
              down = static_cast<int>(norm(v) / spacing);
    for (int i = 0; i <= across; ++i) {
      for (int k = 0; k <= down; ++k) {
        points.positions.push_back(corner + i * 1.0 / across * u + k * 1.0 / down * v);
        points.normals.push_back(normal);
      }
    }
  };
  const Vec3 size = high - low, x{size.x, 0, 0}, y{0, size.y, 0}, z{0, 0, size.z};
  add(low, y, z, {-1, 0, 0}), add(low + x, y, z, {1, 0, 0});
  add(low, x, z, {0, -1, 0}), add(low + y, x, z, {0, 1, 0});
  add(low, x, y, {0, 0, -1}), add(low + z, x, y, {0, 0, 1});
  return points;
}

// Returns what is said of points, or why they are refused.
std::string said(const PointSet& points) {
  const Cloud cloud = cloud_of_scattered_points(points.positions, points.normals, Pose{}, "points");
  std::string text;
  try {
    for (const Remark& remark : improbable_normals(cloud, "points")) text += remark.text + "\n";
  } catch (const Error& error) {
    text = error.what();
  }
  return text;
}

// Turns the normals of the points that `is_turned` names.
PointSet turned(PointSet points, const std::function<bool(std::size_t, const Vec3&)>& is_turned) {
  for (std::size_t k = 0; k < points.normals.size(); ++k)
    if (is_turned(k, points.positions[k])) points.normals[k] = -points.normals[k];
  return points;
}

TEST(NormalChecks, AFewTurnedNormalsAreSaid) {
  std::mt19937 random(1);
  for (const double share : {0.02, 0.05, 0.3, 0.5}) {
    std::bernoulli_distribution is_turned(share);
    EXPECT_TRUE(says(said(turned(wall(), [&](auto, auto) { return is_turned(random); })),
                     "face opposite ways"))
        << share;
  }
  const PointSet half = turned(wall(), [](auto, const Vec3& p) { return p.x < 0.003; });
  const PointSet corner = turned(wall(), [](auto, const Vec3& p) { return p.x + p.y < -0.2; });
  EXPECT_TRUE(says(said(half), "face opposite ways"));
  EXPECT_TRUE(says(said(corner), "face opposite ways"));
}

// Of more, volumes would be wrong by far more than noise makes them.
TEST(NormalChecks, ManyTurnedNormalsAreRefused) {
  const auto check = [](double share) {
    std::mt19937 random(1);
    std::bernoulli_distribution is_turned(share);
    const PointSet points = turned(wall(), [&](auto, auto) { return is_turned(random); });
    return improbable_normals(
        cloud_of_scattered_points(points.positions, points.normals, Pose{}, "points"), "points");
  };
  EXPECT_EQ(check(0.01).size(), 1U);
  EXPECT_THROW(check(0.05), Error);
  EXPECT_THROW(check(0.5), Error);
}

TEST(NormalChecks, NormalsOfOtherSurfacesAreSaid) {
  const auto with = [](const std::function<Vec3(const Vec3&)>& change) {
    PointSet points = wall();
    for (Vec3& n : points.normals) n = change(n);
    return said(points);
  };
  EXPECT_TRUE(says(with([](const Vec3&) { return Vec3{1, 0, 0}; }), "lie 90 degrees off"));
  EXPECT_TRUE(says(with([](const Vec3&) { return Vec3{1, 0, -1}; }), "lie 45 degrees off"));
  EXPECT_TRUE(says(with([](const Vec3& n) { return 0.5 * (n + Vec3{1, 1, 1}); }), "coded"));
  EXPECT_TRUE(says(with([](const Vec3& n) { return 127.5 * (n + Vec3{1, 1, 1}); }), "coded"));
  EXPECT_EQ(with([](const Vec3& n) { return 7 * n; }), "");
  EXPECT_EQ(with([](const Vec3& n) { return n + Vec3{0.3, 0, 0}; }), "");
}

// Returns what a camera at the origin sees of a room with a floor and three walls, in depths of
// `step` metres (0: as they are), with the room's true normals.
PointSet room(double step) {
  constexpr int kWidth = 160, kHeight = 120;
  constexpr double kFocal = 130;
  struct Wall {
    Vec3 normal;
    double distance;
  };
  const Wall walls[] = {{{0, -1, 0}, 1.2}, {{-0.8, 0, -0.6}, 2}, {{0.6, 0, -0.8}, 2.2}};
  PointSet points;
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const Vec3 ray{(u - 0.5 * kWidth) / kFocal, (v - 0.5 * kHeight) / kFocal, 1};
      double depth = 1e9;
      Vec3 normal;
      for (const Wall& wall : walls) {
        const double found = -wall.distance / dot(wall.normal, ray);
        if (found > 0 && found < depth) depth = found, normal = wall.normal;
      }
      if (step > 0) depth = step * std::round(depth / step);
      points.positions.push_back(depth * ray);
      points.normals.push_back(normal);
    }
  }
  return points;
}

TEST(NormalChecks, QuantisedDepthsAreNoSurfacesOfTheirOwn) {
  const auto with = [](PointSet points, const std::function<Vec3(const Vec3&)>& change) {
    for (Vec3& n : points.normals) n = change(n);
    return said(points);
  };
  const auto about_y = [](double degrees) {
    return [turn = degrees * std::numbers::pi / 180](const Vec3& n) {
      return Vec3{std::cos(turn) * n.x + std::sin(turn) * n.z, n.y,
                  std::cos(turn) * n.z - std::sin(turn) * n.x};
    };
  };
  for (const double step : {0.0, 0.001, 0.01, 0.03, 0.06}) {
    EXPECT_EQ(said(room(step)), "") << step;
    // The floor's normals stay right. Turned by 45 degrees, a wall's face the camera, as the flat
    // parts of wide steps do.
    for (const double degrees : {step > 0.01 ? 90.0 : 45.0, 90.0, 150.0})
      EXPECT_TRUE(says(with(room(step), about_y(degrees)), "degrees off")) << step << degrees;
    EXPECT_TRUE(says(with(room(step),
                          [](const Vec3& n) {
                            return 0.5 * (n + Vec3{1, 1, 1});
                          }),
                     "degrees off"))
        << step;
    std::mt19937 random(1);
    std::normal_distribution<double> any;
    const auto of_chance = [&](const Vec3&) { return Vec3{any(random), any(random), any(random)}; };
    EXPECT_TRUE(says(with(room(step), of_chance), "degrees off")) << step;
  }
}

TEST(NormalChecks, SoundPointsAreNotSuspected) {
  EXPECT_EQ(said(wall()), "");
  EXPECT_EQ(said(box({-0.3, -0.3, -0.3}, {0.3, 0.3, 0.3}, 0.02)), "");
  // The sides of sheets, of which the thinnest is thinner than its points' spacing.
  for (const double thickness : {0.005, 0.01, 0.02, 0.05})
    EXPECT_EQ(said(box({-0.2, -0.2, 1}, {0.2, 0.2, 1 + thickness}, 0.01)), "") << thickness;
  std::mt19937 random(1);
  for (const double noise : {0.002, 0.01}) {  // m, beside a spacing of 0.01
    std::normal_distribution<double> deviation(0, noise);
    PointSet points = wall();
    for (Vec3& p : points.positions) p.z += deviation(random);
    EXPECT_EQ(said(points), "") << noise;
  }
  for (const int count : {100, 3000}) {  // on a ball
    PointSet ball;
    for (int k = 0; k < count; ++k) {
      const double z = 1 - (2 * k + 1.0) / count, turn = 2.399963 * k, r = std::sqrt(1 - z * z);
      ball.normals.push_back({r * std::cos(turn), r * std::sin(turn), z});
      ball.positions.push_back(0.1 * ball.normals.back());
    }
    EXPECT_EQ(said(ball), "") << count;
  }
}

TEST(NormalChecks, OnlyPointsThatAreSeenMustFaceTheSensor) {
  // A post along the axis: nearly all of its normals face away from the origin or along it.
  const PointSet post = box({-0.05, -0.05, 0.9}, {0.05, 0.05, 1.3}, 0.005);
  EXPECT_TRUE(facing_away(post, false).empty());
  const auto inward = [](auto, auto) { return true; };
  for (const PointSet& points : {turned(post, inward), turned(wall(), inward)}) {
    ASSERT_EQ(facing_away(points, false).size(), 1U);
    EXPECT_TRUE(says(facing_away(points, false)[0].text, "give `flip` to turn them"));
  }
  EXPECT_TRUE(facing_away(wall(), false).empty());
}

}  // namespace
}  // namespace vpm
