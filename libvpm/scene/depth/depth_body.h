// Defines the body that a camera's depth image is.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "libvpm/scene/depth/depth_surface.h"
#include "libvpm/scene/depth/prepared_image.h"

namespace vpm {

class FrameSlot;         // frame_slot.h
class ImageSilhouettes;  // rig/silhouettes.h
struct SharedSilhouettes;
namespace cuda {
class DeviceDepthBody;
}

// Handle of an immutable depth image that is ready for queries; copies share it. Thread-safe.
class DepthBody {
 public:
  using Surface = DepthSurface;
  using OnDevice = cuda::DeviceDepthBody;

  // Prepares a cloud that keeps its depth image. Throws what PreparedImage throws.
  explicit DepthBody(const Cloud& cloud, Denoising points = Denoising::on)
      : DepthBody(PreparedImage(cloud, points)) {}
  explicit DepthBody(PreparedImage image);
  // Takes a frame that is prepared, or being prepared, maybe on a device.
  explicit DepthBody(std::shared_ptr<const FrameSlot> slot);

  // Returns what maps the surface's frame, which is the camera's, to the world's.
  const Pose& to_world() const { return camera().to_world; }
  const Camera& camera() const;
  // Returns the number of pixels that have a normal. Waits for the preparation.
  std::size_t points() const;
  // Returns the image as the CPU prepares it: a device's frame on the first call. Throws what
  // PreparedImage throws.
  const PreparedImage& prepared() const;
  // Returns the surface in the host's memory. Of a device's frame the first call fetches it.
  DepthSurface surface() const;
  // Return the silhouettes of the prepared image, and these with what view() tells of them. The
  // first call finds them, for all copies.
  const ImageSilhouettes& silhouettes() const;
  const ImageSilhouettes& spread_silhouettes() const;
  std::uint64_t serial() const;

  // Returns the memory of a frame that DepthFrames has prepared, else null.
  const FrameSlot* slot() const { return slot_.get(); }

 private:
  std::shared_ptr<const PreparedImage> image_;  // one of these is null
  std::shared_ptr<const FrameSlot> slot_;
  std::shared_ptr<SharedSilhouettes> silhouettes_;
};

}  // namespace vpm
