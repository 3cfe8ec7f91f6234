// Queries that a device stands by for give the bits of queries on the CPU, whatever comes between
// them.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <deque>
#include <optional>
#include <thread>

#include "libvpm/query/tool_query.h"
#include "tests/cuda/effort.h"
#include "tests/query/expect_equal.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

using testing::expect_equal;

const Device kDevice{Device::Kind::cuda, 0};
constexpr std::uint32_t kStandbyMicroseconds = 5000;
constexpr auto kLonger = std::chrono::milliseconds(20);

QueryOptions standing_by(std::uint32_t microseconds = kStandbyMicroseconds) {
  return {.device = kDevice, .counts_points = false, .standby_us = microseconds};
}

// Into the middle of the scene and out again, turning.
Pose pose_of(int k) {
  const double turn = 0.05 * k;
  return {rotation_from_quaternion({0, std::sin(turn), 0.1, std::cos(turn)}),
          {0.002 * (k % 23), -0.001 * (k % 17), 0.8 + 0.02 * (k % 29)}};
}

class Standby : public ::testing::Test {
 protected:
  void SetUp() override {
    if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  }

  const Cloud seen_ = testing::see(synthetic::make_scene("block"));
  const PreparedCloud cloud_{seen_};
  const ToolModel tool_ = testing::lattice_cube(0.2, 9, 3);
  ToolQuery on_cpu_{tool_, {.counts_points = false}};
};

TEST_F(Standby, GivesTheSameWithStates) {
  ToolQuery query(tool_, standing_by());
  std::uint32_t touched = 0;
  for (int k = 0; k < testing::effort(300); ++k) {
    SCOPED_TRACE(k);
    const Result expected = on_cpu_.run(cloud_, pose_of(k));
    expect_equal(expected, query.run(cloud_, pose_of(k)));
    if (k % 7 != 0) continue;
    const auto states = on_cpu_.states(), states_there = query.states();
    EXPECT_TRUE(std::equal(states.begin(), states.end(), states_there.begin()));
    touched += expected.boundary + expected.inside;
  }
  EXPECT_GE(touched, testing::expected_of(1000));
}

TEST_F(Standby, TakesToolsAndCloudsByTurns) {
  const ToolModel large = testing::lattice_cube(0.25, 20, 1);
  ToolQuery small_query(tool_, standing_by()), large_query(large, standing_by()),
      large_on_cpu(large, {.counts_points = false});
  std::vector<PreparedCloud> clouds;
  for (const char* scene : {"wall", "groove", "block", "plate", "step", "ball"})
    clouds.emplace_back(testing::see(synthetic::make_scene(scene)));
  // They hold the clouds on the device, so that nothing is copied between the poses.
  std::deque<ToolQuery> holders;
  for (const PreparedCloud& cloud : clouds)
    holders.emplace_back(tool_, standing_by()).run(cloud, pose_of(0));
  for (int k = 0; k < testing::effort(120); ++k) {
    SCOPED_TRACE(k);
    const PreparedCloud& cloud = clouds[k * k % clouds.size()];
    expect_equal(on_cpu_.run(cloud, pose_of(k)), small_query.run(cloud, pose_of(k)));
    if (k % 3 == 0)
      expect_equal(large_on_cpu.run(cloud, pose_of(k)), large_query.run(cloud, pose_of(k)));
  }
}

TEST_F(Standby, LeavesWhenNoPoseComesAndIsBackForTheNext) {
  ToolQuery query(tool_, standing_by());
  for (int k = 0; k < testing::effort(12); ++k) {
    SCOPED_TRACE(k);
    if (k % 4 == 3) std::this_thread::sleep_for(kLonger);
    expect_equal(on_cpu_.run(cloud_, pose_of(k)), query.run(cloud_, pose_of(k)));
  }
}

// It waits for as long as the next pose takes, and so leaves just when that comes.
TEST_F(Standby, LosesNoPoseThatComesAsItLeaves) {
  using std::chrono::nanoseconds, std::chrono::steady_clock;
  constexpr int kPoses = testing::effort(40);
  std::vector<Result> expected(kPoses);
  for (int k = 0; k < kPoses; ++k) expected[k] = on_cpu_.run(cloud_, pose_of(k));
  ToolQuery query(tool_, standing_by(30));
  for (int k = 0; k < testing::effort(6000); ++k) {
    SCOPED_TRACE(k);
    const Result result = query.run(cloud_, pose_of(k % kPoses));
    const auto next = steady_clock::now() + nanoseconds(20000 + 7 * (k % 3000));
    expect_equal(expected[k % kPoses], result);
    while (steady_clock::now() < next) {
    }
  }
}

TEST_F(Standby, MakesWayForWhatIsLaunched) {
  ToolQuery query(tool_, standing_by());
  QueryOptions counting_options = standing_by(), paper_options = standing_by();
  counting_options.counts_points = true;
  paper_options.measure = Measure::paper;
  ToolQuery counting(tool_, counting_options), paper(tool_, paper_options),
      counting_on_cpu(tool_, {.counts_points = true}),
      paper_on_cpu(tool_, {.measure = Measure::paper, .counts_points = false});
  const PreparedCloud points(without_camera(seen_));
  std::vector<Pose> poses(200);
  for (std::size_t k = 0; k < poses.size(); ++k) poses[k] = pose_of(static_cast<int>(k));
  std::vector<Result> batch(poses.size());
  for (int k = 0; k < testing::effort(40); ++k) {
    SCOPED_TRACE(k);
    const Pose pose = pose_of(k);
    expect_equal(on_cpu_.run(cloud_, pose), query.run(cloud_, pose));
    if (k % 5 == 0) expect_equal(counting_on_cpu.run(cloud_, pose), counting.run(cloud_, pose));
    if (k % 5 == 1) expect_equal(paper_on_cpu.run(cloud_, pose), paper.run(cloud_, pose));
    if (k % 5 == 2) expect_equal(on_cpu_.run(points, pose), query.run(points, pose));
    if (k % 10 == 3) {
      query.run(cloud_, jobs_of(poses), batch);
      expect_equal(on_cpu_.run(cloud_, poses[k]), batch[k]);
    }
    if (k % 10 == 8) ToolQuery(tool_, standing_by()).run(cloud_, pose);  // comes and goes
  }
}

TEST_F(Standby, MakesWayForNewFrames) {
  const Camera& camera = seen_.sensor->camera;
  DepthFrames frames({camera.intrinsics, camera.width, camera.height, {}, {}, kDevice});
  ToolQuery query(tool_, standing_by());
  std::optional<DepthFrame> last;
  for (int f = 0; f < 12; ++f) {
    std::vector<float> depth = seen_.sensor->depth.depth;
    for (float& z : depth) z *= 1 + 0.01F * static_cast<float>(f % 5);
    std::copy(depth.begin(), depth.end(), frames.metres().begin());
    const DepthFrame frame = frames.prepare(camera.to_world);
    if (last)  // while the new one is prepared
      expect_equal(on_cpu_.run(last->cloud(), pose_of(f)), query.run(*last, pose_of(f)));
    for (int k = 0; k < testing::effort(10); ++k) {
      SCOPED_TRACE(10 * f + k);
      expect_equal(on_cpu_.run(frame.cloud(), pose_of(k)), query.run(frame, pose_of(k)));
      if (last && k % 2 == 0)  // as of two cameras
        expect_equal(on_cpu_.run(last->cloud(), pose_of(k)), query.run(*last, pose_of(k)));
    }
    last = frame;
  }
}

TEST_F(Standby, HindersNobodyElse) {
  std::atomic<bool> ends = false;
  std::thread loop([&] {
    ToolQuery query(tool_, standing_by(QueryOptions::kLongestStandby));
    while (!ends) query.run(cloud_, pose_of(3));
  });
  // Would wait for as long as the loop goes on.
  const Result expected = ToolQuery(tool_, {.counts_points = true}).run(cloud_, pose_of(5));
  for (int k = 0; k < testing::effort(20); ++k) {
    ToolQuery counting(tool_, {.device = kDevice, .counts_points = true});
    expect_equal(expected, counting.run(cloud_, pose_of(5)));
    const PreparedCloud another(seen_);
    expect_equal(expected, counting.run(another, pose_of(5)));
  }
  ends = true;
  loop.join();
}

TEST_F(Standby, ServesSeveralThreads) {
  constexpr int kPoses = testing::effort(60);
  std::vector<Result> expected(kPoses);
  for (int k = 0; k < kPoses; ++k) expected[k] = on_cpu_.run(cloud_, pose_of(k));
  std::vector<std::thread> threads;
  threads.reserve(3);
  for (int t = 0; t < 3; ++t) {
    threads.emplace_back([&, t] {
      ToolQuery query(tool_, standing_by(t == 2 ? 0 : kStandbyMicroseconds));
      for (int k = 0; k < 5 * kPoses; ++k)
        expect_equal(expected[k % kPoses], query.run(cloud_, pose_of(k % kPoses)));
    });
  }
  for (std::thread& thread : threads) thread.join();
}

// For compute-sanitizer.
TEST_F(Standby, SmallQuery) {
  const ToolModel tool = testing::lattice_cube(0.2, 4, 3);
  ToolQuery query(tool, standing_by()), on_cpu(tool, {.counts_points = false});
  for (int k = 0; k < testing::effort(6); ++k)
    expect_equal(on_cpu.run(cloud_, pose_of(4 * k)), query.run(cloud_, pose_of(4 * k)));
}

}  // namespace
}  // namespace vpm
