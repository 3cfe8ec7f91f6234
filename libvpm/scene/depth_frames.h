// Prepares depth images for queries as they come from a camera; on a device without a way back over
// the host's memory.
//
//   DepthFrames frames({intrinsics, 640, 480, 1000.0, {}, device_from_text("auto")});
//   camera.read(frames.counts());                               // 30 times a second
//   const DepthBody frame = frames.prepare(camera_to_world);   // begins, and returns at once
//   const Result r = query.run(frame, pose);                    // a thousand times a second
//
// A query gives the bits that it gives on DepthBody(make_cloud(image, camera, normals),
// points), on any device.
//
// Frames are immutable and may be held, copied, and queried by several threads; the memory of one
// that nobody holds is used again, so the next image can be prepared while one is queried.
// DepthFrames belongs to one thread at a time, and frames may outlive it. On a device nothing is
// allocated once there is memory for the frames held at a time and one more; a CPU allocates while
// it prepares a frame.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "libvpm/cloud/normals.h"
#include "libvpm/device/device.h"
#include "libvpm/scene/depth/depth_body.h"

namespace vpm {

struct DepthFrameOptions {
  Intrinsics intrinsics;                   // pixels
  std::uint32_t width = 0, height = 0;     // pixels
  std::optional<double> counts_per_metre;  // images are 16-bit counts; otherwise metres in float
  NormalOptions normals;
  Device device;  // for queries on other devices the CPU prepares frames
  Denoising points = Denoising::on;
};

class DepthFrames {
 public:
  // Throws Error(invalid_argument) for intrinsics or normals out of range, an image without pixels
  // or counts per metre that are not positive; Error(unavailable) where the device is not there.
  explicit DepthFrames(const DepthFrameOptions& options);

  // Return the pixels of the next image, row by row, in pinned memory: counts() if the options give
  // counts per metre, else metres(). Write them before prepare(), and not after it.
  std::span<std::uint16_t> counts();
  std::span<float> metres();

  // Returns the body of that image. `camera_to_world` maps the camera's coordinates to the
  // world's. On a device this only begins the preparation, and queries wait for its end there. An
  // image or a pose that PreparedImage refuses is refused here or by the first query.
  DepthBody prepare(const Pose& camera_to_world);

 private:
  FrameSlot& next();

  DepthFrameOptions options_;
  std::vector<std::shared_ptr<FrameSlot>> slots_;
  std::shared_ptr<FrameSlot> next_;
};

}  // namespace vpm
