#include "libvpm/recording/recording.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "tests/import/test_files.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace vpm {
namespace {

using test::refusal;

class ARecording : public test::InTemporaryFolder {
 protected:
  void write(const std::string& name, const std::string& text = "x") {
    std::filesystem::create_directories(std::filesystem::path(path(name)).parent_path());
    file::write_all(path(name), text);
  }
  Recording read(const RecordingOptions& options = {}) {
    return read_recording(path("."), options);
  }
  std::vector<double> times() {
    std::vector<double> times;
    for (const RecordedFrame& frame : read().frames) times.push_back(frame.time);
    return times;
  }
};

TEST_F(ARecording, OfAnotherFormatIsNamed) {
  write("a.mkv", "\x1a\x45\xdf\xa3....");
  write("a.bag", "#ROSBAG V2.0\n");
  write("a.png", "\x89PNG\r\n");
  const auto fault = [&](const char* name) {
    return refusal([&] { read_recording(path(name), {}); });
  };
  EXPECT_TRUE(says(fault("a.mkv"),
                   "this is a Matroska recording (.mkv), such as an Azure Kinect's; "
                   "extract its depth images as 16-bit PNG"));
  EXPECT_TRUE(says(fault("a.bag"), "this is a ROS bag; convert it to MCAP: rosbags-convert"));
  EXPECT_TRUE(says(fault("a.png"), "this is a PNG picture; give the folder of the frames"));
}

TEST_F(ARecording, MayBeListedInUtf16) {
  write("a.png");
  std::string wide = "\xFF\xFE";
  for (const char letter : std::string("# time file\r\n1.5 a.png\r\n")) wide += {letter, '\0'};
  write("list.txt", wide);
  const Recording recording = read_recording(path("list.txt"), {});
  ASSERT_EQ(recording.frames.size(), 1U);
  EXPECT_EQ(recording.frames[0].time, 1.5);
}

constexpr const char* kIdentity = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";

TEST_F(ARecording, OfNumberedFramesHasNumbersForTimes) {
  for (const char* name : {"frame-000009", "frame-000010", "frame-000012"}) {
    write(std::string(name) + ".depth.png");
    write(std::string(name) + ".color.png");
    write(std::string(name) + ".pose.txt", kIdentity);
  }
  const Recording r = read({10, "", {}});
  ASSERT_EQ(r.frames.size(), 3u);
  EXPECT_FALSE(r.has_clock);
  EXPECT_EQ(r.missing, 1u);
  EXPECT_DOUBLE_EQ(r.frames[1].time, 0.1);
  EXPECT_DOUBLE_EQ(r.frames[2].time, 0.3);
  for (const RecordedFrame& frame : r.frames) {
    EXPECT_TRUE(frame.camera);
    EXPECT_NE(frame.path.find("depth"), std::string::npos);
  }
}

TEST_F(ARecording, StampsInNamesAreTimes) {
  for (const char* const name :
       {"Depth_1567167300033.123.png", "Depth_1567167300066.5.png", "Depth_1567167300100.9.png"})
    write(name);
  EXPECT_TRUE(read().has_clock);
  EXPECT_NEAR(times()[1] - times()[0], 0.033, 1e-6);
  EXPECT_NEAR(times()[0], 1567167300.033, 1e-6);
}

TEST_F(ARecording, EndingsMayBeInCapitals) {
  write("DEPTH_000.PNG");
  write("DEPTH_001.Png");
  EXPECT_EQ(read().frames.size(), 2u);
}

TEST_F(ARecording, ListsMayHaveCommas) {
  write("a.png");
  write("b.png");
  write("depth.txt",
        "#timestamp [ns],filename\n1403636579763555584,a.png\n1403636579813555584,b.png\n");
  ASSERT_EQ(times().size(), 2u);
  EXPECT_NEAR(times()[1] - times()[0], 0.05, 1e-6);
  for (const char* const line : {",", "1,", ",a.png", "1,a.png,b.png"}) {
    write("depth.txt", line);
    EXPECT_NE(refusal([&] { read(); }).find("depth.txt"), std::string::npos) << line;
  }
}

TEST_F(ARecording, OfWhichNoPoseCanBeReadSaysWhy) {
  for (const char* const name : {"frame-1", "frame-2"}) {
    write(std::string(name) + ".png");
    write(std::string(name) + ".pose.txt", "2 0 0 0\n0 2 0 0\n0 0 2 0\n0 0 0 1\n");
  }
  const std::string why = refusal([&] { read(); });
  EXPECT_NE(why.find("frame-1.pose.txt"), std::string::npos) << why;
  write("frame-2.pose.txt", kIdentity);
  EXPECT_FALSE(read().frames[1].is_lost);
}

TEST_F(ARecording, ThatCannotBeReadIsSaid) {
  std::filesystem::create_symlink("loop", path("loop"));
  EXPECT_NE(refusal([&] { read_recording(path("loop"), {}); }).find("loop"), std::string::npos);
  write("3.png");
  std::filesystem::create_symlink("depth.txt", path("depth.txt"));
  EXPECT_NE(refusal([&] { read(); }).find("depth.txt"), std::string::npos);
}

// A single pose given for all frames wins over poses beside the frames.
TEST_F(ARecording, TakesThePoseThatIsGivenForTheCamera) {
  write("3.png");
  write("3.pose.txt", kIdentity);
  const Recording r = read({30, "", Pose{{}, {1, 2, 3}}});
  EXPECT_EQ(r.frames.at(0).camera->translation, (Vec3{1, 2, 3}));
}

TEST_F(ARecording, OfEveryThirdFrameMissesNone) {
  for (const char* name : {"3.png", "6.png", "9.png"}) write(name);
  EXPECT_EQ(read().missing, 0u);
}

TEST_F(ARecording, KnowsTimesInNamesAndInLists) {
  write("12.500000.png");
  write("7.25.png");
  EXPECT_EQ(times(), (std::vector<double>{7.25, 12.5}));
  write("depth.txt", "# comment\n8 7.25.png\n9.5 12.500000.png\n10 gone.png\n");
  EXPECT_EQ(times(), (std::vector<double>{8, 9.5}));
  EXPECT_EQ(read().missing, 1u);
  std::filesystem::remove(path("depth.txt"));
  write("depth/a.png");
  write("associations.txt", "1 rgb/a.png 1.5 depth/a.png\n");
  EXPECT_EQ(times(), (std::vector<double>{1.5}));
  write("other.txt", "2.5 depth/a.png 2 rgb/a.png\r\n");
  EXPECT_EQ(read_recording(path("other.txt"), {}).frames.front().time, 2.5);
}

TEST_F(ARecording, LosesOnlyFramesWithoutAPoseOfTheirCamera) {
  for (int k = 0; k < 4; ++k) write(std::to_string(k) + ".png");
  write("0.pose.txt", kIdentity);
  write("1.pose.txt", "nan nan nan nan\nnan nan nan nan\nnan nan nan nan\nnan nan nan nan\n");
  write("3.pose.txt", "1 0 0 5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  const Recording r = read();
  const bool lost[] = {false, true, true, false};
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(r.frames[k].is_lost, lost[k]) << k;
  EXPECT_EQ(r.frames[3].camera->translation, (Vec3{5, 0, 0}));
}

TEST_F(ARecording, OfTimesInNamesHasAPoseForEach) {
  const std::pair<const char*, const char*> frames[] = {
      {"12.100", "1 0 0 5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"},
      {"12.600", "1 0 0 6\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"},
      {"13.100", "1 0 0 7\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"}};
  for (const auto& [name, pose] : frames) {
    write(std::string(name) + ".png");
    write(std::string(name) + ".pose.txt", pose);
  }
  write("12.pose.txt", kIdentity);  // belongs to another frame
  Recording r = read();
  for (std::size_t k = 0; k < 3; ++k) {
    ASSERT_TRUE(r.frames[k].camera) << k;
    EXPECT_EQ(r.frames[k].camera->translation.x, 5.0 + static_cast<double>(k));
  }
  std::filesystem::remove(path("12.600.pose.txt"));
  EXPECT_TRUE(read().frames[1].is_lost);
}

TEST_F(ARecording, TakesTheCamerasPathAtTheFramesTimes) {
  write("depth.txt", "1 a.png\n1.5 a.png\n2.01 a.png\n3 a.png\n");
  write("a.png");
  write("groundtruth.txt", "1 0 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n");
  const Recording r = read();
  EXPECT_EQ(r.frames[1].camera->translation, (Vec3{1, 0, 0}));
  EXPECT_EQ(r.frames[2].camera->translation, (Vec3{2, 0, 0}));  // near enough to the last
  EXPECT_TRUE(r.frames[3].is_lost);
  write("mine.txt", "7 0 0 0 0 0 1\n8 0 0 0 0 0 1\n");
  EXPECT_THROW(read({30, path("mine.txt"), {}}), Error);  // two poses for four frames
  write("mine.txt", "7 0 0 0 0 0 1\n");  // one is that of a camera that does not move
  for (const RecordedFrame& frame : read({30, path("mine.txt"), {}}).frames)
    EXPECT_EQ(frame.camera->translation, (Vec3{7, 0, 0}));
  write("mine.txt", "7 0 0 0 0 0 1\n7 0 0 0 0 0 1\n8 0 0 0 0 0 1\n9 0 0 0 0 0 1\n");
  EXPECT_EQ(read({30, path("mine.txt"), {}}).frames[2].camera->translation, (Vec3{8, 0, 0}));
}

TEST_F(ARecording, WhoseCameraHasNoPoseInItsTimeSaysBothTimes) {
  write("depth.txt", "1000 a.png\n1001.5 a.png\n");
  write("a.png");
  for (const char* const path : {"1 0 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n", "3000 0 0 0 0 0 0 1\n"}) {
    write("groundtruth.txt", path);
    const std::string why = refusal([&] { read(); });
    EXPECT_TRUE(says(why, "groundtruth.txt: no frame (1000.000 to 1001.500 s)")) << why;
    EXPECT_TRUE(says(why, std::string(path).starts_with('1') ? "(1.000 to 2.000 s)"
                                                             : "(3000.000 to 3000.000 s)"))
        << why;
  }
  write("groundtruth.txt", "1001 0 0 0 0 0 0 1\n3000 2 0 0 0 0 0 1\n");
  EXPECT_TRUE(read().frames[0].is_lost);
  EXPECT_FALSE(read().frames[1].is_lost);
}

TEST_F(ARecording, SkipsLinesOfTheCamerasPathWithoutAPose) {
  write("depth.txt", "1 a.png\n2 a.png\n3 a.png\n");
  write("a.png");
  for (const char* const lost :
       {"2 nan nan nan nan nan nan nan", "2 9 9 9 nan nan nan nan", "2 inf 9 9 0 0 0 1",
        "nan 9 9 9 0 0 0 1", "2 0 0 0 0 0 0 0", "2 9 9 9 0 0 0 -inf"}) {
    write("groundtruth.txt",
          "1 1 0 0 0 0 0 1\n" + std::string(lost) + "\n3 3 0 0 0 0 0 1\n3 3 0 0 0 0 0 1\n");
    const Recording r = read();
    EXPECT_EQ(r.camera_undefined, 1u) << lost;
    EXPECT_EQ(r.camera_doubled, 1u);
    EXPECT_EQ(r.frames[1].camera->translation, (Vec3{2, 0, 0})) << lost;
  }
  write("groundtruth.txt", "1 1 0 0 0 0 0 1\n2 9 9 9 2 0 0 0\n");  // a mistake, not a loss
  EXPECT_TRUE(says(refusal([&] { read(); }), "line 2"));
  write("groundtruth.txt", "1 nan nan nan nan nan nan nan\n");
  EXPECT_TRUE(says(refusal([&] { read(); }), "none of its 1 poses has finite numbers"));
}

TEST_F(ARecording, LosesTheFrameOfAPoseWithoutTimeThatIsUndefined) {
  for (const char* const name : {"1.png", "2.png", "3.png"}) write(name);
  write("mine.txt", "1 0 0 0 0 0 1\nnan nan nan nan nan nan nan\n3 0 0 0 0 0 1\n");
  const Recording r = read({30, path("mine.txt"), {}});
  EXPECT_EQ(r.frames[0].camera->translation, (Vec3{1, 0, 0}));
  EXPECT_TRUE(r.frames[1].is_lost);
  EXPECT_EQ(r.frames[2].camera->translation, (Vec3{3, 0, 0}));
  write("mine.txt", "0 0 0 0 0 0 0\n0 0 0 0 0 0 0\n0 0 0 0 0 0 0\n");
  EXPECT_TRUE(says(refusal([&] { read({30, path("mine.txt"), {}}); }), "none of its 3 poses"));
}

TEST_F(ARecording, WithFramesInAFolderOfItNamesThat) {
  write("depth/0.png");
  write("depth/1.png");
  write("color/0.png");
  const std::string why = refusal([&] { read(); });
  EXPECT_TRUE(says(why, "2 in its folder depth; give `frames`")) << why;
  EXPECT_TRUE(says(why, "/depth")) << why;
}

TEST_F(ARecording, TakesPosesFromTheFolderBesideItsOwn) {
  for (const char* const folder : {"pose", "poses"}) {
    const std::string scene(std::string(folder) + "_scene/");
    for (const char* const name : {"0", "1", "2"}) write(scene + "depth/" + name + ".png");
    write(scene + folder + "/0.txt", "1 0 0 5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
    write(scene + folder + "/1.txt",
          "-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n");
    const Recording r = read_recording(path(scene + "depth"), {});
    ASSERT_EQ(r.frames.size(), 3u);
    EXPECT_EQ(r.frames[0].camera->translation, (Vec3{5, 0, 0})) << folder;
    EXPECT_TRUE(r.frames[1].is_lost);
    EXPECT_TRUE(r.frames[2].is_lost);
    write(scene + "depth/0.pose.txt", kIdentity);  // nearer, so it wins
    EXPECT_EQ(read_recording(path(scene + "depth"), {}).frames[0].camera->translation, Vec3{});
  }
}

TEST_F(ARecording, KnowsItsCamera) {
  write("1.png");
  EXPECT_FALSE(read().intrinsics);
  write("camera-intrinsics.txt", "585.0 0 320\n0 584 240\n0 0 1\n");
  const Recording r = read();
  EXPECT_EQ(r.intrinsics->intrinsics.fx, 585);
  EXPECT_EQ(r.intrinsics->intrinsics.fy, 584);
  EXPECT_EQ(r.intrinsics->intrinsics.cx, 320);
  EXPECT_EQ(r.intrinsics->intrinsics.cy, 240);
  write("camera-intrinsics.txt", "585 0 320");
  EXPECT_THROW(read(), Error);
}

TEST_F(ARecording, IsRefusedWithTheReason) {
  const auto says_why = [&](const std::string& why) { return says(refusal([&] { read(); }), why); };
  EXPECT_TRUE(says_why("no frames in it"));
  for (const std::string bag : {"a.bag", "a_0.db3"}) {
    write(bag);
    EXPECT_TRUE(says_why("no frames in it, but a recording of ROS, " + bag));
    std::filesystem::remove(path(bag));
  }
  write("one.png");
  EXPECT_TRUE(says_why("neither a time"));
  std::filesystem::remove(path("one.png"));
  write("a1.png");
  write("b1.png");
  EXPECT_TRUE(says_why("has the number of a1.png"));
  write("depth.txt", "1 a1.png\nx b1.png\n");
  EXPECT_TRUE(says_why("line 2: not a time and a file"));
  write("depth.txt", "1 gone.png\n");
  EXPECT_TRUE(says_why("none of the 1 files"));
  EXPECT_TRUE(says(refusal([&] { read_recording(path("gone"), {}); }), "No such file"));
}

TEST(SharedRecording, OfTheRedKitchenIsWhole) {
  const std::string folder = VPM_SOURCE_DIR "/../shared/data/depth/redkitchen_seq";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared data here";
  const Recording r = read_recording(folder, {});
  ASSERT_EQ(r.frames.size(), 15u);
  EXPECT_EQ(r.missing, 0u);
  EXPECT_EQ(r.intrinsics->intrinsics.fx, 585);
  EXPECT_NEAR(norm(r.frames.back().camera->translation - r.frames.front().camera->translation), 0.2,
              0.01);
  EXPECT_LT(r.largest_deviation, 4e-4);
}

}  // namespace
}  // namespace vpm
