// Queries on the device give the bits of queries on the CPU: all fields and states, also in
// batches.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>
#include <set>

#include "libvpm/cloud/normals.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/synthetic/render.h"
#include "tests/cuda/effort.h"
#include "tests/cuda/taken_memory.h"
#include "tests/query/expect_equal.h"
#include "tests/query/lattice_model.h"
#include "tests/query/replay.h"
#include "tests/query/ring_of_cameras.h"
#include "tests/refusal.h"
#include "tests/scene/scans.h"
#include "tests/test_name.h"

namespace vpm {
namespace {

using testing::expect_equal;

// Returns poses that never repeat, by the golden ratio and similar steps.
Pose pose_of(int k) {
  const auto fraction = [&](double step) { return k * step - std::floor(k * step); };
  const Vec3 axis =
      normalized_or_zero({fraction(0.618034) - 0.5, fraction(0.414214) - 0.5, fraction(0.732051)});
  const double half = fraction(0.236068);
  const double s = std::sin(half);
  return {rotation_from_quaternion({s * axis.x, s * axis.y, s * axis.z, std::cos(half)}),
          {0.3 * (fraction(0.324718) - 0.5), 0.3 * (fraction(0.754878) - 0.5),
           0.8 + 0.45 * fraction(0.569840)}};
}

std::vector<Pose> poses_of(int count) {
  std::vector<Pose> poses;
  for (int k = 0; k < count; ++k) poses.push_back(pose_of(k));
  return poses;
}

// Returns the sizes of the batches that are tried of so many poses, one after another: a pose of
// few has many of the device's blocks, one of many has one, and a launch must leave its memory
// clean.
std::vector<std::size_t> batch_sizes(std::size_t all) {
  std::vector<std::size_t> sizes{all};
  for (const std::size_t few : {2, 5, 300})
    if (few < all) sizes.push_back(few);
  return sizes;
}

// Compares batches with results that repeat for further poses.
void expect_same_batch(ToolQuery& query, const AnyBody& cloud, const std::vector<Pose>& poses,
                       const std::vector<Result>& expected) {
  const std::vector<Job> jobs = jobs_of(poses);
  for (const std::size_t size : batch_sizes(poses.size())) {
    SCOPED_TRACE(size);
    std::vector<Result> batch(size);
    query.run(cloud, std::span(jobs).first(size), batch);
    for (std::size_t k = 0; k < size; ++k) {
      SCOPED_TRACE(k);
      expect_equal(expected[k % expected.size()], batch[k]);
    }
  }
}

// Asks a tool on the CPU and on a device, pose by pose and then together, and expects the same
// bits. Returns the CPU's answers.
std::vector<Result> same_answers(const ToolModel& tool, const AnyBody& cloud,
                                 const std::vector<Pose>& poses) {
  ToolQuery on_cpu(tool, {}), on_device(tool, {.device = {Device::Kind::cuda, 0}});
  std::vector<Result> expected;
  for (const Pose& pose : poses) {
    expected.push_back(on_cpu.run(cloud, pose));
    SCOPED_TRACE(expected.size());
    expect_equal(expected.back(), on_device.run(cloud, pose));
  }
  expect_same_batch(on_device, cloud, poses, expected);
  return expected;
}

using SceneCase = std::tuple<const char*, bool>;  // scene, with camera

std::string name_of(const ::testing::TestParamInfo<SceneCase>& tested) {
  const auto& [scene, camera] = tested.param;
  return test::test_name(scene) + (camera ? "_camera" : "_points");
}

class SameQuery : public ::testing::TestWithParam<SceneCase> {
 protected:
  void SetUp() override {
    if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  }
};

TEST_P(SameQuery, OnCpuAndDevice) {
  const auto& [scene, camera] = GetParam();
  constexpr int kPoses = testing::effort(48);
  const Cloud seen = testing::see(synthetic::make_scene(scene));
  const AnyBody cloud(camera ? seen : without_camera(seen));
  std::uint32_t boundary = 0, inside = 0;
  for (const ToolModel& tool : {testing::lattice_cube(0.2, 9, 3), testing::lattice_cube(0.3, 4, 6),
                                testing::lattice_cube(0.25, 20, 1)}) {
    QueryOptions options;
    ToolQuery on_cpu(tool, options);
    options.device = {Device::Kind::cuda, 0};
    ToolQuery on_device(tool, options);
    std::vector<Pose> poses;
    std::vector<Result> expected;
    for (int k = 0; k < kPoses; ++k) {
      poses.push_back(pose_of(k));
      expected.push_back(on_cpu.run(cloud, poses.back()));
      boundary += expected.back().boundary;
      inside += expected.back().inside;
      SCOPED_TRACE(k);
      expect_equal(expected.back(), on_device.run(cloud, poses.back()));
      const auto states = on_cpu.states(), states_there = on_device.states();
      EXPECT_TRUE(std::equal(states.begin(), states.end(), states_there.begin()));
    }
    // Asks for more than a device takes at once, so that memory is used again.
    for (int k = kPoses; k < testing::effort(16 * 48); ++k) poses.push_back(poses[k % kPoses]);
    expect_same_batch(on_device, cloud, poses, expected);
  }
  EXPECT_GE(boundary, testing::expected_of(1000));
  EXPECT_GE(inside, testing::expected_of(1000));
}

TEST(SameQueryOfARig, OnCpuAndDevice) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  const auto scene = synthetic::make_union(
      {synthetic::make_block({0.24, 0.18, 0.2}, {testing::generic_rotation(), {}}),
       synthetic::make_block({0.004, 0.2, 0.2}, {{}, {0.25, 0.03, 0.02}}),
       synthetic::make_inverted_ball({}, 1.5)});
  std::vector<Camera> cameras = testing::ring_of_cameras(3);
  for (Camera& camera : cameras) {
    camera.intrinsics = {131, 131, 79.5, 59.5};
    camera.width = 160, camera.height = 120;
  }
  std::vector<DepthBody> images;
  for (const Camera& camera : cameras) {
    DepthImage image = synthetic::render(*scene, camera);
    for (std::uint32_t k = 0; k < image.depth.size(); ++k)  // one image has no holes
      if (!images.empty() && k % image.width % 16 < 6 && k / image.width % 16 < 6)
        image.depth[k] = 0;
    images.emplace_back(make_cloud(image, camera, {}));
  }
  EXPECT_GT(images.back().silhouettes().holes().fits().size(), 20U);
  std::vector<Pose> poses;
  for (int k = 0; k < testing::effort(48); ++k) {
    Pose pose = pose_of(k);
    pose.translation.z -= 1;
    poses.push_back(pose);
  }
  for (const bool have_all_holes : {false, true}) {
    if (have_all_holes) images.erase(images.begin());
    const ToolModel tool = testing::lattice_cube(0.12, 9, 3);
    const std::vector<Result> found = same_answers(tool, AnyBody(RigBody(images)), poses);
    const auto most = std::ranges::max_element(found, {}, &Result::volume_fraction);
    EXPECT_GT(most->volume_fraction, 0.3);
    ToolQuery on_device(tool, {.device = {Device::Kind::cuda, 0}});
    const Pose& pose = poses[static_cast<std::size_t>(most - found.begin())];
    std::vector<std::size_t> order(images.size());
    std::iota(order.begin(), order.end(), 0);
    while (std::ranges::next_permutation(order).found) {
      std::vector<DepthBody> ordered;
      for (const std::size_t k : order) ordered.push_back(images[k]);
      expect_equal(*most, on_device.run(AnyBody(RigBody(std::move(ordered))), pose));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, SameQuery,
                         ::testing::Combine(::testing::Values("wall", "groove", "block", "plate",
                                                              "inverted-ball", "step"),
                                            ::testing::Bool()),
                         name_of);

// Looks from 3 m, where single pixels show past a small cell that lies behind their mean plane.
TEST(NoisyImageOnDevice, GivesTheSame) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  synthetic::Scene scene = synthetic::make_scene("wall");
  scene.camera.to_world.translation.z = -2;
  const DepthImage depth = synthetic::render_with_kinect_noise(*scene.surface, scene.camera, 1);
  const AnyBody cloud(make_cloud(depth, scene.camera, NormalOptions{}));
  constexpr int kPoses = testing::effort(192);
  std::vector<Pose> poses = poses_of(kPoses);
  for (int k = 0; k < kPoses; ++k) poses[k].translation.z = 0.97 + 0.06 * k / kPoses;
  for (const ToolModel& tool :
       {testing::lattice_cube(0.02, 20, 1), testing::lattice_cube(0.03, 20, 1),
        testing::lattice_cube(0.05, 20, 2), testing::lattice_cube(0.03, 9, 1)})
    same_answers(tool, cloud, poses);
}

// Passes through the wall, its hole, the space that it hides, and out of the view.
TEST(UnseenOnDevice, IsTheSame) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  const AnyBody cloud(testing::wall_with_hole());
  constexpr int kPoses = testing::effort(96);
  std::vector<Pose> poses = poses_of(kPoses);
  for (int k = 0; k < kPoses; ++k)
    poses[k].translation = {2.0 * k / kPoses - 1, poses[k].translation.y, 0.1 + 0.4 * (k % 5)};
  double unseen = 0, out_of_view = 0;
  for (const ToolModel& tool : {testing::lattice_cube(0.2, 9, 3), testing::lattice_cube(0.3, 4, 6),
                                testing::lattice_cube(0.25, 21, 1)}) {
    for (const Result& result : same_answers(tool, cloud, poses)) {
      unseen += result.visibility->unseen;
      out_of_view += result.visibility->out_of_view;
    }
  }
  EXPECT_GT(unseen, testing::expected_of(20));
  EXPECT_GT(out_of_view, testing::expected_of(20));
}

// Alternates images and points: notes of one path through the kernels must not reach the other.
TEST(ImagesAndPoints, GiveTheSameByTurns) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  const Cloud seen = testing::see(synthetic::make_scene("block"));
  const AnyBody image(seen), points(without_camera(seen));
  for (const ToolModel& tool :
       {testing::lattice_cube(0.3, 6, 3), testing::lattice_cube(0.25, 20, 1)}) {
    QueryOptions options;
    ToolQuery on_cpu(tool, options);
    options.device = {Device::Kind::cuda, 0};
    ToolQuery on_device(tool, options);
    for (int k = 0; k < testing::effort(64); ++k) {
      SCOPED_TRACE(k);
      const AnyBody& cloud = k % 3 == 0 ? points : image;
      expect_equal(on_cpu.run(cloud, pose_of(k)), on_device.run(cloud, pose_of(k)));
    }
  }
}

// Expects the bytes of the CPU's replay.
TEST(ReplayOnDevice, GivesTheSameBytes) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  EXPECT_TRUE(testing::replay() == testing::replay({Device::Kind::cuda, 0}));
}

// The measure as printed is the CPU's.
TEST(PaperMeasure, IsRefusedOnADevice) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  const ToolModel tool = testing::lattice_cube(0.2, 3, 1);
  EXPECT_EQ(test::kind_of_fault([&] {
              ToolQuery(tool, {.measure = Measure::paper, .device = {Device::Kind::cuda, 0}});
            }),
            ErrorKind::invalid_argument);
}

// Gives up a query, its cloud and its tool right after each answer, while the kernel that sent it
// may still clear its memory.
TEST(SmallQueryOnDevice, MayBeGivenUpAtOnce) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  const Cloud seen = testing::see(synthetic::make_scene("wall"));
  for (int k = 0; k < 60; ++k) {
    const ToolModel tool = testing::lattice_cube(0.05, 2, 1);
    ToolQuery query(tool, {.device = {Device::Kind::cuda, 0}});
    const AnyBody cloud(seen);
    EXPECT_GE(query.run(cloud, pose_of(k)).volume, 0);
  }
}

// Takes every path through the kernels, small enough for compute-sanitizer: contact, occluded
// places, one pose and several.
TEST(SmallQueryOnDevice, GivesTheSame) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  const Cloud seen = testing::see(synthetic::make_scene("block"));
  const ToolModel tool = testing::lattice_cube(0.2, 4, 3);
  for (const bool camera : {true, false}) {
    const AnyBody cloud(camera ? seen : without_camera(seen));
    std::vector<Pose> poses;
    for (int k = 0; k < 4; ++k) poses.push_back(pose_of(7 * k + 5));
    same_answers(tool, cloud, poses);
  }
}

// Gives rotations in single precision, as many programs have them.
TEST(RoundedPosesOnDevice, GiveTheSame) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  const Cloud seen = testing::see(synthetic::make_scene("step"));
  const ToolModel tool = testing::lattice_cube(0.2, 12, 2);
  for (const bool camera : {true, false}) {
    const AnyBody cloud(camera ? seen : without_camera(seen));
    ToolQuery on_cpu(tool, {}), on_device(tool, {.device = {Device::Kind::cuda, 0}});
    std::vector<Pose> poses;
    std::vector<Result> expected;
    for (int k = 0; k < testing::effort(60); ++k) {
      SCOPED_TRACE(k);
      Pose pose = pose_of(k);
      for (Vec3* row : {&pose.rotation.row0, &pose.rotation.row1, &pose.rotation.row2})
        *row = widen(narrow(*row));
      poses.push_back(pose);
      expected.push_back(on_cpu.run(cloud, pose));
      expect_equal(expected.back(), on_device.run(cloud, pose));
    }
    expect_same_batch(on_device, cloud, poses, expected);
  }
}

TEST(SolidOccludedSpaceOnDevice, GiveTheSame) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  const AnyBody cloud(testing::see(synthetic::make_scene("block")));
  int hidden = 0;
  for (const ToolModel& tool : {testing::lattice_cube(0.2, 9, 3), testing::lattice_cube(0.1, 4, 6),
                                testing::lattice_cube(0.25, 20, 1)}) {
    QueryOptions options;
    ToolQuery near(tool, options);
    options.device = {Device::Kind::cuda, 0};
    ToolQuery near_on_device(tool, options);
    options.device = {};
    options.shadows = Shadows::solid;
    ToolQuery on_cpu(tool, options);
    options.device = {Device::Kind::cuda, 0};
    ToolQuery on_device(tool, options);
    std::vector<Pose> poses;
    std::vector<Result> expected;
    for (int k = 0; k < testing::effort(100); ++k) {
      SCOPED_TRACE(k);
      poses.push_back(pose_of(k));
      poses.back().translation.z += 0.003 * k;
      expected.push_back(on_cpu.run(cloud, poses.back()));
      expect_equal(expected.back(), on_device.run(cloud, poses.back()));
      const Result seen = near.run(cloud, poses.back());
      expect_equal(seen, near_on_device.run(cloud, poses.back()));  // planes support far pieces
      hidden += seen.volume < 0.5 * expected.back().volume;
    }
    expect_same_batch(on_device, cloud, poses, expected);
  }
  EXPECT_GE(hidden, static_cast<int>(testing::expected_of(31)));
}

// Tools wholly inside of what points enclose, further behind the surface than their radius or not,
// and such that the surface cuts.
TEST(EnclosedToolOnDevice, GivesTheSame) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  Cloud shell;
  add_box({0, 0, 1}, {0.5, 0.5, 0.5}, 1, 0.02, shell);
  add_box({0, 0, 1.3}, {0.1, 0.1, 0.1}, -1, 0.02, shell);
  const AnyBody cloud(shell);
  for (const ToolModel& tool : {testing::lattice_cube(0.3, 6, 3), testing::lattice_cube(0.1, 4, 6),
                                testing::lattice_cube(0.25, 20, 1)}) {
    std::vector<Pose> poses = poses_of(testing::effort(48));
    poses.push_back({{}, {0, 0, 1}});
    int whole = 0;
    for (const Result& result : same_answers(tool, cloud, poses))
      whole += result.boundary == 0 && result.volume > 0.99 * tool.volume;
    EXPECT_GE(whole, 1);
  }
}

// Passes below the upper half of a ball, a box without its lower face, and out of a room, where
// points do not tell whether the tool is inside.
TEST(UnknownOnDevice, IsTheSame) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  Cloud half, room, open;
  add_ball(
      0.3, 0.02, [](Vec3 n) { return n.z > 0; }, half);
  add_box({}, {0.4, 0.4, 0.4}, -1, 0.02, room);
  Cloud box;
  add_box({}, {0.3, 0.3, 0.3}, 1, 0.02, box);
  for (std::size_t k = 0; k < box.size(); ++k)
    if (box.normals[k].z >= 0)
      add_point(widen(box.positions[k]), widen(box.normals[k]), 0.02, open);
  constexpr int kPoses = testing::effort(160);
  double unknown = 0;
  for (const Cloud& scan : {half, room, open}) {
    const AnyBody cloud(scan);
    std::vector<Pose> poses = poses_of(kPoses);
    for (int k = 0; k < kPoses; ++k) poses[k].translation.z = 0.7 - 1.4 * k / (kPoses - 1);
    for (const double z : {-0.33, -0.45, 0.6}) poses.push_back({{}, {0.01, 0.02, z}});
    for (const ToolModel& tool :
         {testing::lattice_cube(0.2, 5, 3), testing::lattice_cube(0.25, 20, 1)})
      for (const Result& result : same_answers(tool, cloud, poses)) {
        ASSERT_TRUE(result.visibility);
        unknown += result.visibility->unseen;
      }
  }
  EXPECT_GT(unknown, 3);
}

// Alternates small and large tools, more than one launch takes, and one without a pose.
class ToolsTogether : public ::testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  }
};

TEST_P(ToolsTogether, GiveTheSameAsOneByOne) {
  const bool camera = GetParam();
  const Cloud seen = testing::see(synthetic::make_scene("step"));
  const AnyBody cloud(camera ? seen : without_camera(seen));
  constexpr std::uint32_t kTools = 19;
  std::deque<ToolModel> tools;
  std::deque<ToolQuery> on_cpu, on_device;
  std::vector<ToolQuery*> together;
  for (std::uint32_t t = 0; t < kTools; ++t) {
    const std::uint32_t side = 2 + 5 * t % 12;
    tools.push_back(testing::lattice_cube(0.15 + 0.01 * t, side, side < 6 ? 4 : 1));
    QueryOptions options;
    on_cpu.emplace_back(tools.back(), options);
    options.device = {Device::Kind::cuda, 0};
    on_device.emplace_back(tools.back(), options);
    together.push_back(&on_device.back());
  }
  std::vector<Job> poses;
  std::vector<Result> expected;
  std::set<std::uint32_t> touching;
  constexpr std::uint32_t kPoses = testing::effort(3000), kNever = 7;
  for (std::uint32_t k = 0; k < kPoses; ++k) {
    const std::uint32_t tool = k * k % kTools;
    if (tool == kNever) continue;
    poses.push_back({pose_of(static_cast<int>(k)), tool});
    expected.push_back(on_cpu[tool].run(cloud, poses.back().pose));
    if (expected.back().volume > 0) touching.insert(tool);
  }
  EXPECT_GT(touching.size(), 8U);
  std::vector<std::size_t> sizes = batch_sizes(poses.size());
  sizes.push_back(poses.size());  // again, in memory that the first launch used
  for (const std::size_t size : sizes) {
    SCOPED_TRACE(size);
    std::vector<Result> results(size);
    ToolQuery::run(together, cloud, std::span(poses).first(size), results);
    for (std::size_t k = 0; k < size; ++k) {
      SCOPED_TRACE(k);
      expect_equal(expected[k], results[k]);
    }
  }
  for (const std::uint32_t tool : {0U, 1U, 4U}) {
    std::vector<Pose> own;
    std::vector<Result> results;
    for (std::size_t k = 0; k < poses.size(); ++k) {
      if (poses[k].tool != tool) continue;
      own.push_back(poses[k].pose);
      results.push_back(expected[k]);
    }
    expect_same_batch(on_device[tool], cloud, own, results);
  }
}

INSTANTIATE_TEST_SUITE_P(Clouds, ToolsTogether, ::testing::Bool(), [](const auto& tested) {
  return std::string(tested.param ? "camera" : "points");
});

// Small enough for compute-sanitizer.
TEST(ToolsTogetherSmall, SmallQuery) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  const AnyBody cloud(testing::see(synthetic::make_scene("wall")));
  std::deque<ToolModel> tools;
  std::deque<ToolQuery> queries;
  std::vector<ToolQuery*> together;
  for (const std::uint32_t side : {2U, 4U, 3U}) {
    tools.push_back(testing::lattice_cube(0.2, side, 1));
    queries.emplace_back(tools.back(), QueryOptions{.device = {Device::Kind::cuda, 0}});
    together.push_back(&queries.back());
  }
  std::vector<Job> poses;
  for (std::uint32_t k = 0; k < 12; ++k) poses.push_back({pose_of(static_cast<int>(k)), k % 3});
  std::vector<Result> results(poses.size());
  ToolQuery::run(together, cloud, poses, results);
  for (std::size_t k = 0; k < poses.size(); ++k)
    expect_equal(queries[poses[k].tool].run(cloud, poses[k].pose), results[k]);
}

// Leaves little free memory, as other programs do: batches are cut, not refused.
TEST(TakenDevice, AnswersABatch) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  const AnyBody cloud(testing::see(synthetic::make_scene("wall")));
  const ToolModel tool = testing::lattice_cube(0.25, 20, 4);
  const std::vector<Pose> poses = poses_of(96);
  std::vector<Result> expected(poses.size());
  ToolQuery(tool, {}).run(cloud, jobs_of(poses), expected);
  ToolQuery on_device(tool, {.device = {Device::Kind::cuda, 0}});
  expect_equal(expected[0], on_device.run(cloud, poses[0]));
  const testing::TakenMemory others(std::size_t{256} << 20);
  expect_same_batch(on_device, cloud, poses, expected);
}

TEST(TakenDevice, HasRoomForFewerTeams) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  EXPECT_EQ(testing::teams_made(64, 0.1), 8U);
  EXPECT_EQ(testing::teams_made(3, 0.1), 3U);
  EXPECT_EQ(test::kind_of_fault([] { testing::teams_made(64, 1.1); }), ErrorKind::unavailable);
}

// Asks for more poses than one device takes at once.
TEST(QueryOnAllDevices, GivesTheSameInTheSameOrder) {
  if (cuda_device_count() < 2) GTEST_SKIP() << "fewer than two CUDA devices here";
  const AnyBody cloud(testing::see(synthetic::make_scene("wall")));
  const ToolModel tool = testing::lattice_cube(0.2, 9, 3);
  const std::vector<Pose> poses = poses_of(40000);
  QueryOptions options;
  std::vector<Result> of_one(poses.size()), of_all(poses.size());
  options.device = {Device::Kind::cuda, 0};
  ToolQuery(tool, options).run(cloud, jobs_of(poses), of_one);
  options.device.index = Device::kAll;
  ToolQuery on_all(tool, options);
  on_all.run(cloud, jobs_of(poses), of_all);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    SCOPED_TRACE(k);
    expect_equal(of_one[k], of_all[k]);
  }
  expect_equal(of_one[7], on_all.run(cloud, poses[7]));
}

// Of no points nobody knows anything.
TEST(SameQueryOnDevice, InAnEmptyCloud) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  const AnyBody cloud{Cloud{}};
  const ToolModel tool = testing::lattice_cube(0.2, 4, 2);
  Result expected;
  expected.visibility = Visibility{.seen_free = 0, .unseen = 1, .out_of_view = 0};
  QueryOptions options;
  expect_equal(expected, ToolQuery(tool, options).run(cloud, {}));
  options.device = {Device::Kind::cuda, 0};
  expect_equal(expected, ToolQuery(tool, options).run(cloud, {}));
}

}  // namespace
}  // namespace vpm
