// Inputs at the edge of what is possible are answered right or refused with a message, never by a
// result that is not finite.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libvpm/cloud/normals.h"
#include "libvpm/query/tool_query.h"
#include "tests/query/lattice_model.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

using test::refusal;
using testing::lattice_cube;
using testing::see;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Returns disks larger than the tool, which are planes to it.
Cloud points(std::vector<Vec3f> positions, std::vector<Vec3f> normals, float radius = 3) {
  Cloud cloud;
  cloud.positions = std::move(positions);
  cloud.normals = std::move(normals);
  cloud.radii.assign(cloud.positions.size(), radius);
  return cloud;
}

Result ask(const ToolModel& tool, const Cloud& cloud, Measure measure, const Pose& pose = {}) {
  QueryOptions options;
  options.measure = measure;
  return ToolQuery(tool, options).run(AnyBody(cloud), pose);
}

void expect_sound(const Result& r) {
  EXPECT_TRUE(r.volume >= 0 && std::isfinite(r.volume));
  EXPECT_TRUE(r.volume_fraction >= 0 && r.volume_fraction <= 1 + 1e-6);
  EXPECT_TRUE(is_finite(r.wrench.force) && is_finite(r.wrench.torque));
}

TEST(ExtremePoints, NoneTouchesNothing) {
  const ToolModel tool = lattice_cube(2, 4, 2);
  for (const Measure measure : {Measure::refined, Measure::paper}) {
    const Result r = ask(tool, points({}, {}), measure);
    EXPECT_EQ(r.volume, 0);
    EXPECT_EQ(r.boundary + r.inside + r.points.value_or(0), 0u);
  }
}

TEST(ExtremePoints, OneTwoOrAThousandAtOnePlaceAreOnePlane) {
  const ToolModel tool = lattice_cube(2, 4, 2);
  for (const std::size_t count : {1, 2, 1000}) {
    const Cloud cloud =
        points(std::vector<Vec3f>(count, Vec3f{}), std::vector<Vec3f>(count, Vec3f{0, 0, 1}));
    const Result r = ask(tool, cloud, Measure::refined);
    EXPECT_NEAR(r.volume_fraction, 0.5, 1e-9) << count;
    EXPECT_NEAR(r.wrench.force.z, r.volume, 1e-9) << count;
  }
}

TEST(ExtremePoints, OnTheCentreASphereIsHalfInside) {
  const ToolModel ball = lattice_cube(2, 1, 4);
  const Cloud cloud = points({{0, 0, 0}}, {{0, 0, 1}});
  EXPECT_NEAR(ask(ball, cloud, Measure::paper).volume, volume(Sphere{{}, 1}) / 2, 1e-9);
  EXPECT_NEAR(ask(ball, cloud, Measure::refined).volume_fraction, 0.5, 1e-9);
}

TEST(ExtremePoints, OnTheSurfaceASphereIsNotTouched) {
  const ToolModel ball = lattice_cube(2, 1, 4);
  const Cloud tangent =
      points({{0, 0, -1}, {0.5f, 0, -1}, {0, -0.75f, -1}}, std::vector<Vec3f>(3, Vec3f{0, 0, 1}));
  const Result r = ask(ball, tangent, Measure::paper);
  EXPECT_EQ(r.volume, 0);
  EXPECT_EQ(r.boundary, 0u);
}

TEST(ExtremePoints, OppositeNormalsCancelTheForceNotTheVolume) {
  const ToolModel ball = lattice_cube(2, 1, 4);
  const Cloud cloud = points({{0, 0, 0}, {0, 0, 0}}, {{0, 0, 1}, {0, 0, -1}});
  const Result r = ask(ball, cloud, Measure::paper);
  EXPECT_NEAR(r.volume, volume(Sphere{{}, 1}) / 2, 1e-9);
  EXPECT_EQ(norm(r.wrench.force), 0);
  expect_sound(ask(ball, cloud, Measure::refined));
}

TEST(ExtremePoints, NormalsThatAreNoneAreRefused) {
  const auto with_normal = [](Vec3f n) {
    return refusal([&] { AnyBody{points({{0, 0, 0}}, {n})}; });
  };
  const float nan = static_cast<float>(kNan);
  for (const Vec3f n : {Vec3f{0, 0, 0}, Vec3f{0, 0, 2}, Vec3f{nan, 0, 1}, Vec3f{0, 0, 1e-30f}})
    EXPECT_NE(with_normal(n).find("point 0 has a normal"), std::string::npos);
  EXPECT_EQ(with_normal({0, 0, -1}), "");
}

TEST(ExtremePoints, MoreThanCanBeCountedAreRefused) {
  Cloud cloud;
  cloud.positions.resize(kMaxPoints + 1);
  EXPECT_NE(refusal([&] { AnyBody{cloud}; }).find("at most 16777216"), std::string::npos);
}

TEST(ExtremePoints, AFarOriginIsRefused) {
  Cloud cloud = points({{0, 0, 0}}, {{0, 0, 1}});
  cloud.origin = {0, 1e31, 0};
  EXPECT_NE(refusal([&] { AnyBody{cloud}; }).find("2^100 m"), std::string::npos);
}

TEST(ExtremePoses, FarAwayNothingIsTouched) {
  const ToolModel tool = lattice_cube(0.2, 4, 2);
  const Cloud seen = see(synthetic::make_scene("wall"));
  for (const Cloud& cloud : {seen, without_camera(seen)}) {
    const AnyBody wall(cloud);
    for (const Measure measure : {Measure::refined, Measure::paper}) {
      for (const double far : {1e6, -1e6, 1e15, -1e30, 1e30}) {
        for (const Vec3 at : {Vec3{far, 0, 1}, Vec3{0, -far, 1}, Vec3{far, far, far}})
          EXPECT_EQ(ToolQuery(tool, {.measure = measure}).run(wall, {{}, at}).volume, 0) << far;
      }
    }
  }
}

TEST(ExtremePoses, WhatIsNoRigidMotionIsRefused) {
  const ToolModel tool = lattice_cube(0.2, 2, 1);
  const AnyBody cloud(points({{0, 0, 0}}, {{0, 0, 1}}));
  const Rotation mirror{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, zero{{}, {}, {}};
  const Rotation stretched{{1.1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const Rotation not_finite{{kNan, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  ToolQuery query(tool, {});
  for (const Rotation& r : {mirror, zero, stretched, not_finite})
    EXPECT_NE(refusal([&] { query.run(cloud, {r, {}}); }).find("rotation"), std::string::npos);
  for (const double t : {kNan, kInfinity, -kInfinity, 1e31})
    EXPECT_NE(refusal([&] {
                query.run(cloud, {{}, {0, 0, t}});
              }).find("translation"),
              std::string::npos);
  EXPECT_EQ(refusal([&] { query.run(cloud, {}); }), "");
}

TEST(ExtremeOptions, AStiffnessThatOverflowsIsRefused) {
  const ToolModel tool = lattice_cube(2e3, 2, 1);
  for (const double stiffness : {0.0, -1.0, kNan, kInfinity, 1e305}) {
    QueryOptions options;
    options.stiffness = stiffness;
    EXPECT_NE(refusal([&] { ToolQuery(tool, options); }).find("stiffness"), std::string::npos);
  }
}

// An image has one measured pixel, or depths that no inverse holds.
TEST(ExtremeImages, WhatIsNotMeasuredCountsForNothing) {
  const ToolModel tool = lattice_cube(0.2, 4, 4);
  const Camera camera = synthetic::default_camera();
  DepthImage image{camera.width, camera.height, {}};
  for (const float depth : {0.0f, 1e-40f, 1e38f, std::numeric_limits<float>::infinity()}) {
    image.depth.assign(std::size_t{camera.width} * camera.height, depth);
    const Cloud cloud = make_cloud(image, camera, {});
    EXPECT_EQ(cloud.size(), 0u) << depth;
    for (const Measure measure : {Measure::refined, Measure::paper})
      EXPECT_EQ(ask(tool, cloud, measure, {{}, {0, 0, 1}}).volume, 0) << depth;
  }
  image.depth.assign(image.depth.size(), 0.0f);
  image.depth[image.index(320, 240)] = 1;
  const Result r = ask(tool, make_cloud(image, camera, {}), Measure::refined, {{}, {0, 0, 1}});
  expect_sound(r);
  const double pixel = 1.1 / 525;  // side at the tool's far face
  EXPECT_LE(r.volume, 0.11 * pixel * pixel + 1e-4 * tool.volume);
}

TEST(ExtremeImages, OfOnePixelAreFine) {
  const ToolModel tool = lattice_cube(0.2, 2, 2);
  for (const std::uint32_t width : {1u, 300u}) {
    Camera camera = synthetic::default_camera();
    camera.width = width;
    camera.height = 1;
    const Cloud cloud = make_cloud({width, 1, std::vector<float>(width, 1.0f)}, camera, {});
    expect_sound(ask(tool, cloud, Measure::refined, {{}, {-0.6, -0.45, 1}}));
  }
}

// Fixed-point sums have limits, and a model beyond them is refused.
TEST(ExtremeTools, SumsBeyondTheirLimitAreRefused) {
  const ToolModel good = lattice_cube(2, 2, 2);
  ASSERT_EQ(refusal([&] { validate(good, "tool"); }), "");
  const auto spoiled = [&](auto spoil) {
    ToolModel tool = good;
    spoil(tool, tool.levels[0]);
    return refusal([&] { validate(tool, "tool"); });
  };
  const auto expect_refused = [](const std::string& said, const char* word) {
    EXPECT_NE(said.find(word), std::string::npos) << "said '" << said << "'";
  };
  expect_refused(spoiled([](ToolModel& t, Level&) { t.volume /= 16; }), "overlap");
  expect_refused(spoiled([](ToolModel&, Level& l) { l.samples[3].weight *= 2; }), "weights");
  expect_refused(spoiled([](ToolModel&, Level& l) { l.cell_volume[1] *= 1.1; }), "cells sum");
  expect_refused(spoiled([](ToolModel&, Level& l) { l.samples[5].center.x = 10; }), "sample 5");
  expect_refused(spoiled([](ToolModel&, Level& l) { l.samples[5].radius = 10; }), "sample 5");
  const auto with_a_face_first = [](ToolModel&, Level& l) {
    const float r = l.samples[0].radius;
    l.faces = {{0, {1, 0, 0}, r, r, r, r}};
  };
  expect_refused(spoiled(with_a_face_first), "sample 0 is at a face, and a later one");
  expect_refused(spoiled([](ToolModel&, Level& l) { l.blocks[2].center.y = -9; }), "block 2");
  expect_refused(spoiled([](ToolModel&, Level& l) { l.cell_radius[7] = 0; }), "no radius");
  expect_refused(spoiled([](ToolModel& t, Level&) { t.radius = 0; }), "2^-100 m");
  expect_refused(spoiled([](ToolModel& t, Level&) { t.radius = 1e-3; }), "beyond the tool radius");
  expect_refused(spoiled([](ToolModel& t, Level&) { t.radius = 1e31; }), "2^100 m");
  expect_refused(spoiled([](ToolModel& t, Level&) { t.volume = 1e-310; }), "volume");
}

TEST(ExtremeTools, MoreSamplesThanACellCanCountAreRefused) {
  ToolModel tool = lattice_cube(2, 2, 1);
  Level& level = tool.levels[0];
  constexpr std::uint32_t kMore = 1u << 20;
  level.samples.insert(level.samples.begin(), kMore, CellSample{{}, 0.1f, 0});
  for (CellBlock& block : level.blocks) block.begin += kMore, block.end += kMore;
  level.blocks[0].begin = 0;
  EXPECT_NE(refusal([&] { validate(tool, "tool"); }).find("2^20"), std::string::npos);
}

TEST(ExtremeTools, AHierarchyThatIsAChainIsRefused) {
  ToolModel tool = lattice_cube(2, 1, 1);
  std::vector<HierarchyNode>& nodes = tool.levels[0].hierarchy.nodes;
  constexpr std::uint32_t kLength = 100000;
  nodes.clear();
  for (std::uint32_t k = 0; k < kLength; ++k) nodes.push_back({{{}, 2}, k + 1, k + 2, 0, 0});
  nodes.push_back({{{}, 2}, 0, 1, 1, 0});
  EXPECT_NE(refusal([&] { validate(tool, "tool"); }).find("deeper than 1000"), std::string::npos);
}

TEST(ExtremeTools, AMillionSpheresCountAsTheWholeDoes) {
  const ToolModel tool = lattice_cube(2, 100, 1);
  std::vector<Vec3f> floor;  // gives every cell that it cuts points nearby
  for (int x = -75; x < 75; ++x) {
    for (int y = -75; y < 75; ++y)
      floor.push_back({0.02f * (float(x) + 0.5f), 0.02f * (float(y) + 0.5f), 0});
  }
  const Cloud cloud = points(floor, std::vector<Vec3f>(floor.size(), Vec3f{0, 0, 1}), 0.02f);
  const Result r = ask(tool, cloud, Measure::refined);
  EXPECT_NEAR(r.volume_fraction, 0.5, 1e-9);
  EXPECT_NEAR(r.wrench.force.z, r.volume, 1e-9);
}

}  // namespace
}  // namespace vpm
