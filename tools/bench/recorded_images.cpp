#include "tools/bench/recorded_images.h"

#include <filesystem>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "libvpm/import/import_cloud.h"
#include "tools/bench/random_rotation.h"

namespace vpm::bench {
namespace {

constexpr std::uint64_t kPoseSeed = 1;

struct Frame {
  const char* file;
  Intrinsics intrinsics;
  double units_per_metre;
};
constexpr Frame kFrames[] = {
    {"redkitchen_seq/frame-000460.depth.png", {585, 585, 320, 240}, 1000},
    {"redkitchen_seq/frame-000467.depth.png", {585, 585, 320, 240}, 1000},
    {"redkitchen_seq/frame-000474.depth.png", {585, 585, 320, 240}, 1000},
    {"tum_desk_depth.png", {525, 525, 319.5, 239.5}, 5000},
    {"kinect_capture0001.pcd", {525, 525, 319.5, 239.5}, 1},
    {"d435_000000080-opaque-depth-img.exr", {921, 921, 642, 359}, 1},
};

std::string path_of(const Frame& frame, const std::string& folder) {
  return folder + "/depth/" + frame.file;
}

}  // namespace

void require_recorded_images(const std::string& folder) {
  for (const Frame& frame : kFrames) {
    if (std::filesystem::exists(path_of(frame, folder))) return;
  }
  throw Error(ErrorKind::invalid_argument,
              "--data " + folder + ": its folder depth/ holds none of the " +
                  "recorded images that are known by name, like " + kFrames[0].file +
                  "; leave --data away to do without");
}

std::vector<RecordedImage> recorded_images(const std::string& folder) {
  std::vector<RecordedImage> images;
  for (const Frame& frame : kFrames) {
    const std::string path = path_of(frame, folder);
    if (!std::filesystem::exists(path)) continue;
    ImportOptions options;
    options.intrinsics = frame.intrinsics;
    options.units_per_metre = frame.units_per_metre;
    try {
      images.push_back({frame.file, import_cloud(file::read_all(path), path, options).cloud});
    } catch (const Error& fault) {
      if (fault.kind() != ErrorKind::unavailable) throw;
    }
  }
  return images;
}

Pose random_pose_before(const Cloud& cloud, std::uint64_t k, double reach) {
  synthetic::NormalNumbers numbers(kPoseSeed, k);
  const Rotation rotation = random_rotation(numbers);
  constexpr std::uint64_t kStride = 7919;  // a prime: all over the image
  const std::size_t at = k * kStride % cloud.size();
  const double off = reach * (0.7 + 0.2 * numbers.next());
  return {rotation, cloud.origin + widen(cloud.positions[at]) + off * widen(cloud.normals[at])};
}

}  // namespace vpm::bench
