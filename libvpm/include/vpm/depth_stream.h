// Depth images as a camera delivers them, made ready for queries; on a device without a way back
// over the host's memory.
//
//   vpm::DepthStream stream({intrinsics, 640, 480, 1000.0});
//   camera.read(stream.counts());                                 // 30 times a second
//   const vpm::Scene scene = stream.prepare(camera_to_world);     // returns at once on a device
//   const vpm::Result r = query.run(scene, pose);   // a thousand times a second; <vpm/query.h>
#pragma once

#include <vpm/camera.h>
#include <vpm/device.h>
#include <vpm/error.h>
#include <vpm/scene.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

namespace vpm {

struct DepthStreamOptions {
  Intrinsics intrinsics;
  std::uint32_t width = 0, height = 0;     // pixels
  std::optional<double> counts_per_metre;  // images are 16-bit counts; without, metres in float
  NormalOptions normals = {};
  Device device = {};  // that of the queries; queries on another copy what the CPU prepares
  Denoising points = Denoising::on;
};

// Belongs to one thread at a time; the bodies that it returns may be shared, held and outlive it.
// Memory of a body that nobody holds is used again, so a loop that holds two allocates nothing on a
// device.
class VPM_API DepthStream {
 public:
  // Throws Error(invalid_argument) for options out of range, Error(unavailable) without the device.
  explicit DepthStream(const DepthStreamOptions& options);
  ~DepthStream();
  DepthStream(DepthStream&&) noexcept;
  DepthStream& operator=(DepthStream&&) noexcept;

  // Returns where the next image belongs, width * height values row by row, in the unit of the
  // options; pinned memory with a device. To be written before prepare(), and not after it. Throws
  // Error(invalid_argument) if the options have the other unit.
  std::span<std::uint16_t> counts();
  std::span<float> metres();

  // Returns the body of that image seen from `camera_to_world`. A query gives the bits that it
  // gives on PointCloud::from_depth() of the same image, on every device. A device only begins
  // here, and queries wait for it. Throws Error(refused), here or in the first query, for a pose or
  // an image that PointCloud or Body refuse.
  Body prepare(const Pose& camera_to_world);

 private:
  struct Impl;
  Impl& impl() const;

  std::unique_ptr<Impl> impl_;  // null once moved from
};

}  // namespace vpm
