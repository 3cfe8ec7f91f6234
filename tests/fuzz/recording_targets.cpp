#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "libvpm/import/import_cloud.h"
#include "libvpm/import/intrinsics_file.h"
#include "libvpm/recording/pose_reader.h"
#include "libvpm/recording/recording.h"
#include "libvpm/recording/timed_path.h"
#include "tests/fuzz/targets.h"

namespace vpm::fuzz {

void run_poses(Bytes input) {
  expect_error_at_most([&] {
    constexpr double kRate = 100;
    constexpr std::size_t kSteps = 20;
    PoseReader reader(path_of(input));
    if (Choice(input).one_of(2) == 0) {
      while (const std::optional<Pose> pose = reader.next()) expect_finite(*pose);
      return;
    }
    TimedPath timed(reader);
    if (timed.has_times())
      for (const double part : {0.0, 0.3, 1.0})
        expect_finite(timed.at(timed.start() + part * (timed.end() - timed.start())));
    const SampledPath sampled(std::move(timed), kRate);
    for (std::size_t k = 0; k < std::min(sampled.steps(), kSteps); ++k)
      expect_finite(sampled.pose(k));
    if (sampled.steps() > 0) expect_finite(sampled.pose(sampled.steps() - 1));
  });
}

void run_camera_pose(Bytes input) {
  const std::string& path = path_of(input);
  expect_error_at_most([&] { expect_finite(read_camera_pose(path)); });
}

void run_intrinsics(Bytes input) {
  expect_error_at_most([&] {
    const Intrinsics found = parse_intrinsics(input, "x.yaml").intrinsics;
    for (const double number : {found.fx, found.fy, found.cx, found.cy})
      if (!std::isfinite(number)) fail("intrinsics are not finite");
  });
}

namespace {

namespace fs = std::filesystem;

// Folder of two frames in memory, where there is a file system of it, which the end removes.
class Folder {
 public:
  Folder() {
    const fs::path base = fs::is_directory("/dev/shm") ? "/dev/shm" : fs::temp_directory_path();
    std::string pattern = (base / "vpm-fuzz-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) fail("no folder");
    path_ = pattern;
    std::ofstream(path_ / "1.png");
    std::ofstream(path_ / "2.png");
  }
  ~Folder() {
    std::error_code fault;
    fs::remove_all(path_, fault);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

void expect_finite(const Recording& recording) {
  for (const RecordedFrame& frame : recording.frames) {
    if (!std::isfinite(frame.time)) fail("a time is not finite");
    if (frame.camera) fuzz::expect_finite(*frame.camera);
  }
}

}  // namespace

void run_recording(Bytes input) {
  static const Folder folder;
  constexpr std::string_view kBetween = "\n--\n";
  const std::string text = text_of(input);
  std::size_t at = 0;
  for (const char* name : {"depth.txt", "groundtruth.txt", "camera-intrinsics.txt", "1.pose.txt"}) {
    const fs::path path = folder.path() / name;
    fs::remove(path);
    if (at >= text.size()) continue;
    const std::size_t end = std::min(text.find(kBetween, at), text.size());
    std::ofstream(path, std::ios::binary) << text.substr(at, end - at);
    at = end + kBetween.size();
  }
  expect_error_at_most([&] {
    const Recording recording = read_recording(folder.path().string(), {});
    expect_finite(recording);
  });
}

void run_mcap(Bytes input) {
  const std::string& path = path_of(input);
  expect_error_at_most([&] {
    const Recording recording = read_recording(path, {});
    expect_finite(recording);
    for (const RecordedFrame& frame : recording.frames)
      expect_error_at_most([&] { const auto scan = import_scan(bytes_of(frame), frame.path, {}); });
  });
  for (const char* const poses : {"", ":tool0", ":base:camera"})
    expect_error_at_most([&] {
      PoseReader reader(path + poses);
      while (const std::optional<Pose> pose = reader.next()) expect_finite(*pose);
    });
}

}  // namespace vpm::fuzz
