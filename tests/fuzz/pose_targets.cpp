#include <algorithm>
#include <cmath>

#include "libvpm/import/intrinsics_file.h"
#include "libvpm/recording/pose_reader.h"
#include "libvpm/recording/timed_path.h"
#include "tests/fuzz/targets.h"

namespace vpm::fuzz {

void run_poses(Bytes input) {
  const std::string& path = path_of(input);
  expect_error_at_most([&] {
    PoseReader reader(path);
    while (const std::optional<Pose> pose = reader.next()) expect_finite(*pose);
  });
  expect_error_at_most([&] {
    constexpr double kRate = 100;
    constexpr std::size_t kSteps = 20;
    PoseReader reader(path);
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

}  // namespace vpm::fuzz
