// What two solids share has the same bits on CPU and device.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "libvpm/device/device.h"
#include "libvpm/solid/device_solids.h"
#include "libvpm/synthetic/shapes.h"
#include "tests/cuda/effort.h"
#include "tests/solid/pair_cases.h"

namespace vpm {
namespace {

using synthetic::make_box;
using synthetic::make_icosphere;
using synthetic::make_torus;
using Surface = std::shared_ptr<const SolidSurface>;
using Poses = std::pair<Pose, Pose>;

constexpr Device kDevice{Device::Kind::cuda, 0};

Surface surface_of(const Solid& solid) {
  return std::make_shared<const SolidSurface>(solid, false);
}

// Returns random poses at which solids of half a metre often meet.
std::vector<Poses> random_poses(int count) {
  std::mt19937_64 random(7);
  std::vector<Poses> poses;
  for (int k = 0; k < count; ++k)
    poses.push_back({test::random_pose(random, .2), test::random_pose(random, .2)});
  return poses;
}

void expect_equal(const SharedSolid& a, const SharedSolid& b) {
  EXPECT_EQ(a.volume, b.volume);
  EXPECT_EQ(a.centroid, b.centroid);
  EXPECT_EQ(a.area, b.area);
  EXPECT_EQ(a.turn, b.turn);
  EXPECT_EQ(a.closure, b.closure);
  EXPECT_EQ(a.attempts, b.attempts);
}

// Returns the volume up to which the host tells if the solids of a job only touch, m^3.
double little_of(const Surface& a, const Surface& b, const SolidJob& job) {
  const OrderedPair pair(a, b);
  return pair.volume_of_touch(std::max(a->area(), b->area()), pair.place(job.pose_a, job.pose_b));
}

// How many answers of how many poses are not 0, and how many of more than little are left to the
// host.
struct Told {
  std::size_t met = 0, left = 0;
};

// Asks for the poses together and one by one.
Told expect_same(const Surface& a, const Surface& b, const std::vector<Poses>& poses) {
  DeviceSolids device(kDevice, {a, b});
  SolidPair pair(a, b);
  std::vector<SolidJob> jobs;
  for (const auto& [of_a, of_b] : poses) jobs.push_back({0, 1, of_a, of_b});
  const auto together = device.run(jobs);
  Told told;
  for (std::size_t k = 0; k < jobs.size(); ++k) {
    SCOPED_TRACE(k);
    const SharedSolid expected = pair.measure(jobs[k].pose_a, jobs[k].pose_b, false);
    const auto alone = device.run({&jobs[k], 1}).front();
    for (const auto& answer : {together[k], alone}) {
      if (answer) expect_equal(expected, *answer);
      told.left += !answer && expected.volume > little_of(a, b, jobs[k]);
    }
    told.met += expected.volume > 0;
  }
  return told;
}

class SameOverlap : public ::testing::Test {
 protected:
  void SetUp() override {
    if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  }
};

TEST_F(SameOverlap, AtRandomPoses) {
  const std::vector<Surface> solids{
      surface_of(make_box(.5, .4, .3)), surface_of(make_torus(.3, .1, 14, 7)),
      surface_of(make_icosphere(.4, 1)), surface_of(make_box(.6, .6, .006)),
      surface_of(synthetic::make_torus_knot(2, 3, .25, .1, .05, 40, 5))};
  const std::vector<Poses> poses = random_poses(testing::effort(80));
  std::size_t met = 0;
  for (std::size_t i = 0; i < solids.size(); ++i)
    for (std::size_t j = i; j < solids.size(); ++j) {
      const Told told = expect_same(solids[i], solids[j], poses);
      EXPECT_EQ(told.left, 0U) << i << ' ' << j;
      met += told.met;
    }
  EXPECT_GE(met, 8 * poses.size());
}

// On a floor, whose triangles are far larger than the other solid, on fine ground, and around it.
TEST_F(SameOverlap, OfASmallSolidOnALargeOne) {
  const Surface small = surface_of(make_box(.1, .08, .06));
  const double edge = 800;
  for (const Solid& solid : {make_box(edge, edge, .1 * edge), make_torus(3, 1, 120, 60)}) {
    const Surface large = surface_of(solid);
    std::vector<Poses> poses;
    for (const auto& [stands, beside] : random_poses(testing::effort(30))) {
      const Vec3 on = solid.vertices.size() == 8 ? Vec3{.31 * edge, -.2 * edge, .05 * edge}
                                                 : solid.vertices[poses.size()];
      const Pose from{beside.rotation, .3 * beside.translation + on};
      poses.push_back({stands * from, stands});
    }
    const Told told = expect_same(small, large, poses);
    EXPECT_EQ(told.left, 0U);
    EXPECT_GE(told.met, poses.size() / 2);
  }
}

TEST_F(SameOverlap, OfEnclosedFlushAndCoincidentSolids) {
  const Surface box = surface_of(make_box(.5, .4, .3)), ball = surface_of(make_icosphere(.05, 1)),
                torus = surface_of(make_torus(.3, .1, 20, 10));
  std::vector<Poses> same, flush, enclosed;
  for (const auto& [at, other] : random_poses(testing::effort(40))) {
    same.push_back({at, at});
    flush.push_back({at, {at.rotation, at * Vec3{.5, 0, 0}}});
    flush.push_back({at, {at.rotation, at * Vec3{.2, .1, 0}}});
    enclosed.push_back({at, {other.rotation, at.translation}});
  }
  const Told of_boxes = expect_same(box, box, same), of_flush = expect_same(box, box, flush),
             of_enclosed = expect_same(box, ball, enclosed);
  EXPECT_EQ(of_boxes.met, same.size());
  EXPECT_GE(of_flush.met, same.size());
  EXPECT_EQ(of_enclosed.met, enclosed.size());
  EXPECT_EQ(of_boxes.left + of_flush.left + of_enclosed.left, 0U);
  EXPECT_EQ(expect_same(torus, torus, same).met, same.size());  // the host may have to help
}

// Scaling by powers of two changes exponents only.
TEST_F(SameOverlap, OfScaledSolids) {
  const auto scaled = [](Solid solid, double by) {
    for (Vec3& v : solid.vertices) v = by * v;
    return surface_of(solid);
  };
  for (const double by : {0x1p-20, 0x1p13}) {
    const Solid box = make_box(.5, .4, .3), torus = make_torus(.3, .1, 20, 10);
    DeviceSolids as_made(kDevice, {surface_of(box), surface_of(torus)}),
        as_scaled(kDevice, {scaled(box, by), scaled(torus, by)});
    for (const auto& [a, b] : random_poses(testing::effort(40))) {
      const SolidJob job{0, 1, a, b};
      const SolidJob large{
          0, 1, {a.rotation, by * a.translation}, {b.rotation, by * b.translation}};
      const auto made = as_made.run({&job, 1}).front(), other = as_scaled.run({&large, 1}).front();
      ASSERT_TRUE(made && other);
      EXPECT_EQ(by * by * by * made->volume, other->volume);
      EXPECT_EQ(by * by * made->area, other->area);
      EXPECT_EQ(by * made->centroid, other->centroid);
    }
  }
}

// Many different pairs in one batch.
TEST_F(SameOverlap, OfManyPairsTogether) {
  std::vector<Surface> solids;
  for (const double size : {.2, .3, .4, .5}) {
    solids.push_back(surface_of(make_box(size, .4, .3)));
    solids.push_back(surface_of(make_torus(size, .1, 20, 10)));
  }
  std::vector<SolidJob> jobs;
  const std::vector<Poses> poses = random_poses(28);
  for (std::uint32_t i = 0; i < solids.size(); ++i)
    for (std::uint32_t j = 0; j < i; ++j)
      jobs.push_back({i, j, poses[jobs.size()].first, poses[jobs.size()].second});
  DeviceSolids device(kDevice, solids);
  const auto answers = device.run(jobs);
  for (std::size_t k = 0; k < jobs.size(); ++k) {
    SCOPED_TRACE(k);
    ASSERT_TRUE(answers[k]);
    SolidPair pair(solids[jobs[k].a], solids[jobs[k].b]);
    expect_equal(pair.measure(jobs[k].pose_a, jobs[k].pose_b, false), *answers[k]);
  }
}

}  // namespace
}  // namespace vpm
