// What two solids share, as programs ask it.

#include <gtest/gtest.h>
#include <vpm/solid.h>

#include <array>
#include <cmath>
#include <limits>
#include <thread>
#include <vector>

#include "tests/api/boxes.h"

namespace {

using vpm::test::kind_of;

// Returns a closed box with its low corner at the origin.
vpm::SolidMesh box(double x, double y, double z) {
  return vpm::test::box({}, {x, y, z});
}

TEST(Overlap, IsToldInCubicMetresInTheWorldsFrame) {
  const vpm::SolidBody a(box(.1, .1, .1)), b(box(.1, .2, .3));
  EXPECT_NEAR(a.volume(), 1e-3, 1e-12);
  EXPECT_NEAR(b.center_of_mass().z, .15, 1e-9);
  EXPECT_NEAR(a.radius(), .05 * std::sqrt(3), 1e-9);
  EXPECT_EQ(a.triangles(), 12U);
  const vpm::Overlap o = vpm::overlap(a, {{}, {1, 2, 3}}, b, {{}, {1.08, 2.05, 3 - .15}});
  EXPECT_NEAR(o.volume, .02 * .05 * .1, 1e-12);
  EXPECT_NEAR(o.centroid.x, 1.09, 1e-9);
  EXPECT_NEAR(o.centroid.y, 2.075, 1e-9);
  EXPECT_NEAR(o.centroid.z, 3.05, 1e-9);
  EXPECT_NEAR(o.area.x, .05 * .1, 1e-9);
  EXPECT_LT(o.wrench.force.x, 0);  // a is pushed back, out of b
  EXPECT_LE(o.closure, 1e-8);
}

TEST(Overlap, OfSolidsThatTouchIsNothing) {
  const vpm::SolidBody a(box(.1, .1, .1));
  EXPECT_NEAR(vpm::overlap(a, {}, a, {{}, {.1, 0, 0}}).volume, 0, 1e-12);
  EXPECT_EQ(vpm::overlap(a, {}, a, {{}, {.3, 0, 0}}), vpm::Overlap{});
}

TEST(Overlap, OfSwappedSolidsHasTheOppositeWrenchInTheSameBits) {
  const vpm::SolidBody a(box(.1, .1, .1)), b(box(.1, .2, .3));
  const vpm::Rotation turn = vpm::rotation_from_quaternion({.1, .2, .3, std::sqrt(1 - .14)});
  const vpm::Pose pose{turn, {.03, .02, .04}};
  const vpm::Overlap there = vpm::overlap(a, pose, b, {}), back = vpm::overlap(b, {}, a, pose);
  ASSERT_GT(there.volume, 0);
  EXPECT_EQ(there.volume, back.volume);
  EXPECT_EQ(there.centroid, back.centroid);
  EXPECT_EQ(there.wrench.force.x, -back.wrench.force.x);
  EXPECT_EQ(there.wrench.force.y, -back.wrench.force.y);
  EXPECT_EQ(there.wrench.torque.z, -back.wrench.torque.z);
}

// Poses of a batch have the answers of one by one, with forces and contacts as well.
TEST(Overlap, OfManyPosesIsThatOfEach) {
  const vpm::SolidBody a(box(.1, .1, .1)), b(box(.1, .2, .3));
  vpm::OverlapQuery query(a, b, {.stiffness = 100, .contacts = 2});
  std::vector<vpm::Pose> of_a, of_b;
  for (int k = 0; k < 70; ++k) {
    of_a.push_back({{}, {.001 * k, 0, 0}});
    of_b.push_back({{}, {.05, .02, -.003 * k}});
  }
  std::vector<vpm::Overlap> answers(of_a.size());
  query.run(of_a, of_b, answers);
  for (std::size_t k = 0; k < answers.size(); ++k)
    EXPECT_EQ(answers[k], query.run(of_a[k], of_b[k])) << k;
  EXPECT_GT(answers.back().volume, 0);
  answers.pop_back();
  EXPECT_EQ(kind_of([&] { query.run(of_a, of_b, answers); }), vpm::ErrorKind::invalid_argument);
}

// Bodies without forces are enough for a device; where it is not there, that is told at once.
TEST(Overlap, OnADeviceHasTheSameBits) {
  const vpm::SolidBody a(box(.1, .1, .1), false);
  const vpm::OverlapOptions on_device{.with_force = false, .device = {vpm::Device::Kind::cuda}};
  if (vpm::cuda_device_count() == 0) {
    EXPECT_EQ(kind_of([&] { vpm::OverlapQuery(a, a, on_device); }), vpm::ErrorKind::unavailable);
    GTEST_SKIP() << "no CUDA device here";
  }
  const std::vector<vpm::Part> parts{{a, {}}, {a, {{}, {.05, .02, .01}}}, {a, {{}, {.1, 0, 0}}}};
  const auto here = vpm::overlapping_pairs(parts, {.with_force = false}),
             there = vpm::overlapping_pairs(parts, on_device);
  ASSERT_EQ(here.size(), there.size());
  for (std::size_t k = 0; k < here.size(); ++k) EXPECT_EQ(here[k].overlap, there[k].overlap);
  EXPECT_EQ(vpm::overlap(a, {}, a, parts[1].to_world, on_device), here.front().overlap);
}

TEST(Overlap, StiffnessMakesNewtons) {
  const vpm::SolidBody a(box(.1, .1, .1)), b(box(2, 2, 2));
  const vpm::Pose pose{{}, {1, 1, 1.95}};
  const vpm::Overlap o = vpm::overlap(a, pose, b, {}, {.stiffness = 0x1p20});
  EXPECT_EQ(o.wrench.force.z, 0x1p20 * vpm::overlap(a, pose, b, {}).wrench.force.z);
  EXPECT_NEAR(o.wrench.force.z, 0x1p20 * o.volume, 1e-4 * 0x1p20 * o.volume);
}

TEST(Overlap, RefusesWhatMeansNothing) {
  const vpm::SolidBody a(box(.1, .1, .1)), bare(box(.1, .1, .1), false);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  using enum vpm::ErrorKind;
  for (const double stiffness : {0.0, -1.0, kNan, HUGE_VAL})
    EXPECT_EQ(kind_of([&] { vpm::overlap(a, {}, a, {}, {.stiffness = stiffness}); }),
              invalid_argument);
  EXPECT_EQ(kind_of([&] { vpm::overlap(a, {}, bare, {}); }), invalid_argument);
  EXPECT_NEAR(vpm::overlap(a, {}, bare, {}, {.with_force = false}).volume, 1e-3, 1e-12);
  EXPECT_EQ(kind_of([&] { vpm::overlap(a, {{}, {kNan, 0, 0}}, a, {}); }), refused);
  EXPECT_EQ(kind_of([&] { vpm::overlap(a, {}, a, {{}, {1e300, 0, 0}}); }), refused);
  const vpm::Rotation mirror{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  EXPECT_EQ(kind_of([&] { vpm::overlap(a, {mirror, {}}, a, {}); }), refused);
}

// Bodies are shared between threads, each with its own query.
TEST(Overlap, OfSharedBodiesIsTheSameOnEachThread) {
  const vpm::SolidBody a(box(.1, .1, .1)), b(box(.1, .2, .3));
  const auto path = [&] {
    vpm::OverlapQuery query(a, b);
    std::vector<vpm::Overlap> found;
    for (int k = 0; k < 20; ++k) found.push_back(query.run({{}, {.005 * k, .01, .02}}, {}));
    return found;
  };
  const std::vector<vpm::Overlap> expected = path();
  std::vector<std::vector<vpm::Overlap>> found(3);
  std::vector<std::thread> threads;
  for (auto& list : found) threads.emplace_back([&] { list = path(); });
  for (std::thread& thread : threads) thread.join();
  for (const auto& list : found) EXPECT_EQ(list, expected);
}

}  // namespace
