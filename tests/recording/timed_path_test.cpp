#include "libvpm/recording/timed_path.h"

#include <gtest/gtest.h>

#include <numbers>
#include <utility>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "tests/import/test_files.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace vpm {
namespace {

class ATimedPath : public test::InTemporaryFolder {
 protected:
  TimedPath path_of(const std::string& text) {
    file::write_all(path("path.txt"), text);
    PoseReader reader(path("path.txt"));
    return TimedPath(reader);
  }
};

TEST_F(ATimedPath, GoesStraightAndTurnsEvenlyBetweenPoses) {
  const double half = std::sqrt(0.5);  // a quarter turn about z
  const TimedPath quarter = path_of("10 1 0 0 0 0 0 1\n12 3 0 4 0 0 " + std::to_string(half) + " " +
                                    std::to_string(half) + "\n");
  for (const double part : {0.0, 0.25, 0.5, 0.9, 1.0}) {
    const Pose pose = quarter.at(10 + 2 * part);
    EXPECT_NEAR(pose.translation.x, 1 + 2 * part, 1e-12);
    EXPECT_NEAR(pose.translation.z, 4 * part, 1e-12);
    EXPECT_NEAR(pose.rotation.row0.x, std::cos(part * std::numbers::pi / 2), 1e-6);
  }
  EXPECT_EQ(quarter.at(0).translation, (Vec3{1, 0, 0}));
  EXPECT_EQ(quarter.at(99).translation, (Vec3{3, 0, 4}));
}

TEST_F(ATimedPath, TakesTimesFromJson) {
  for (const char* text : {"{\"time\": 5, \"name\": \"#1\", \"pose\": [0, 0, 0, 0, 0, 0, 1]}\n"
                           "{\"time\": 7, \"pose\": [4, 0, 0, 0, 0, 0, 1]}\n",
                           "[5, 0, 0, 0, 0, 0, 0, 1]\n[7, 4, 0, 0, 0, 0, 0, 1]\n"}) {
    const TimedPath path = path_of(text);
    EXPECT_TRUE(path.has_times());
    EXPECT_NEAR(path.at(6).translation.x, 2, 1e-12);
  }
}

TEST_F(ATimedPath, DropsALineThatGivesTheOneBeforeAgain) {
  const TimedPath path = path_of("1 1 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n");
  EXPECT_EQ(path.poses().size(), 2u);
  EXPECT_EQ(path.doubled(), 1u);
  const TimedPath untimed = path_of("1 0 0 0 0 0 1\n1 0 0 0 0 0 1\n");  // it stays
  EXPECT_EQ(untimed.poses().size(), 2u);
  EXPECT_EQ(untimed.doubled(), 0u);
}

TEST_F(ATimedPath, WhoseTimesDoNotAscendSaysWhereAndHowToMendIt) {
  const auto why = [&](const std::string& text) { return test::refusal([&] { path_of(text); }); };
  const std::string twice = why("1 1 0 0 0 0 0 1\n1 2 0 0 0 0 0 1\n");
  EXPECT_TRUE(says(twice, "line 2: times must ascend, but 1.000000 s has two poses"));
  EXPECT_TRUE(says(twice, "remove one of the two lines"));
  const std::string unsorted = why("1 1 0 0 0 0 0 1\n3 2 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n");
  EXPECT_TRUE(says(unsorted, "line 3: times must ascend, but 2.000000 s comes after 3.0"));
  EXPECT_TRUE(says(unsorted, "sort the lines by their times"));
}

// Only a camera may be lost for a time: a tool's path must say where it is.
TEST_F(ATimedPath, RefusesPosesThatAreUndefined) {
  for (const char* const lost :
       {"2 nan nan nan nan nan nan nan", "2 0 0 0 0 0 0 0", "inf 0 0 0 0 0 0 1"}) {
    const std::string text = "1 1 0 0 0 0 0 1\n" + std::string(lost) + "\n";
    EXPECT_TRUE(says(test::refusal([&] { path_of(text); }), "line 2")) << lost;
  }
}

TEST_F(ATimedPath, IsSampledFromTheFirstPoseToTheLast) {
  const SampledPath sampled(path_of("5 0 0 0 0 0 0 1\n5.5 1 0 0 0 0 0 1\n"), 1000);
  ASSERT_EQ(sampled.steps(), 501u);
  EXPECT_NEAR(sampled.pose(500).translation.x, 1, 1e-12);
  EXPECT_NEAR(sampled.pose(250).translation.x, 0.5, 1e-9);
  const SampledPath untimed(path_of("0 0 0 0 0 0 1\n1 0 0 0 0 0 1\n"), 1000);
  EXPECT_EQ(untimed.steps(), 2u);
  EXPECT_EQ(untimed.time(1), 0.001);
}

// Two poses, 2 s apart, in which the tool stays. The first of two solids moves by 4 m, the second
// stays.
constexpr const char* kWithSolids =
    "{\"time\": 1, \"tool\": [0, 0, 0, 0, 0, 0, 1],"
    " \"solids\": [[0, 0, 0, 0, 0, 0, 1], [7, 0, 0, 0, 0, 0, 1]]}\n"
    "{\"time\": 3, \"tool\": [0, 0, 0, 0, 0, 0, 1],"
    " \"solids\": [[4, 0, 0, 0, 0, 0, 1], [7, 0, 0, 0, 0, 0, 1]]}\n";

TEST_F(ATimedPath, MovesSolidsAsItMovesItself) {
  const TimedPath path = path_of(kWithSolids);
  EXPECT_EQ(path.solids(), 2u);
  for (const auto& [time, x] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.5, 1.0}, {3.0, 4.0}, {9, 4}}) {
    const std::vector<Pose> solids = path.solids_at(time);
    ASSERT_EQ(solids.size(), 2u);
    EXPECT_NEAR(solids[0].translation.x, x, 1e-12);
    EXPECT_NEAR(solids[1].translation.x, 7, 1e-12);
  }
  EXPECT_NEAR(SampledPath(path, 1000).solids(1000)[0].translation.x, 2, 1e-9);
  EXPECT_TRUE(path_of("1 1 0 0 0 0 0 1\n").solids_at(1).empty());
}

TEST_F(ATimedPath, MovesAsManySolidsWithEveryPose) {
  const std::string two = kWithSolids, none = "{\"time\": 5, \"tool\": [0, 0, 0, 0, 0, 0, 1]}\n";
  EXPECT_TRUE(says(test::refusal([&] { path_of(two + none); }), "line 3"));
  // The same time with other solids is another pose.
  std::string again = two.substr(two.find('\n') + 1);
  EXPECT_EQ(path_of(two + again).doubled(), 1u);
  again.replace(again.find("[4"), 2, "[5");
  EXPECT_THROW(path_of(two + again), Error);
}

TEST_F(ATimedPath, KnowsATimeWithoutPosesThatIsImprobable) {
  const auto path_at = [](const std::vector<double>& times) {
    return TimedPath(times, std::vector<Pose>(times.size()));
  };
  const auto gap = path_at({1, 1.1, 1.2, 3.5, 3.6, 3.7}).improbable_gap();
  ASSERT_TRUE(gap);
  EXPECT_EQ(gap->start, 1.2);
  EXPECT_EQ(gap->end, 3.5);
  for (const std::vector<double>& usual :
       {std::vector<double>{}, {1}, {1, 9}, {1, 2, 3, 12}, {0, 0.01, 0.02, 0.3, 0.31}, {1, 5, 9}})
    EXPECT_FALSE(path_at(usual).improbable_gap());
}

TEST_F(ATimedPath, RefusesTimesThatAreNone) {
  for (const char* text :
       {"", "1 0 0 0 0 0 0 1\n1 0 0 1 0 0 0 1\n", "2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n",
        "1 0 0 0 0 0 0 1\n0 0 0 0 0 0 1\n", "nan 0 0 0 0 0 0 1\n"})
    EXPECT_THROW(path_of(text), Error) << text;
  EXPECT_THROW(SampledPath(path_of("0 0 0 0 0 0 0 1\n1e9 0 0 0 0 0 0 1\n"), 1000), Error);
}

// A bar of half a metre that turns by a right angle in a second while it moves at 1 m/s.
TEST(TimedPath, TellsHowFastSolidsMove) {
  const Pose turned{rotation_from_vector({0, 0, 1.5707963267948966}), {1, 0, 0}};
  const TimedPath path({10, 11, 12}, std::vector<std::vector<Pose>>{{Pose{}}, {turned}, {turned}});
  EXPECT_NEAR(path.speed_of_solid(0, 10.5, 0.1, 0.5), 1 + 0.5 * 1.5707963267948966, 1e-12);
  EXPECT_NEAR(path.speed_of_solid(0, 10.5, 0.1, 0), 1, 1e-12);
  EXPECT_EQ(path.speed_of_solid(0, 11.5, 0.1, 0.5), 0);
  EXPECT_GT(path.speed_of_solid(0, 11.05, 0.1, 0.5), 1);  // it may have been before it stopped
  EXPECT_EQ(path.speed_of_solid(0, 20, 0.1, 0.5), 0);
}

}  // namespace
}  // namespace vpm
