// Prepares a depth image for queries: all that depends on the frame alone is computed once, here.
// Immutable; safe to share between threads.
#pragma once

#include <vpm/camera.h>

#include <vector>

#include "libvpm/core/pose.h"
#include "libvpm/scene/cloud_order.h"
#include "libvpm/scene/depth/denoised_image.h"
#include "libvpm/scene/depth/depth_sampler.h"
#include "libvpm/scene/depth/depth_surface.h"

namespace vpm {

class PreparedImage {
 public:
  // Makes an image without pixels.
  PreparedImage() = default;
  // Takes a cloud that keeps its depth image. Throws what check_for_queries() throws, and
  // Error(refused) for two points at one pixel or a point that is not on its pixel's ray. Depths
  // outside of [kMinDepth, kMaxDepth] (depth_image.h) count as not measured. FramePreparation is
  // faster. Denoising 300 000 points takes a core a millisecond.
  explicit PreparedImage(const Cloud& cloud, Denoising points = Denoising::on);

  // Returns a number shared by copies of the image only.
  std::uint64_t serial() const { return serial_; }
  const Camera& camera() const { return camera_; }
  // Returns the camera's surface, in the frame of camera().to_world.
  DepthSurface surface() const { return image_.surface(camera_.intrinsics); }

  // Return the pixels' points about origin(), row by row, and their normals, world axes.
  Vec3 origin() const { return points_.origin; }
  const std::vector<Vec3f>& positions() const { return points_.positions; }
  const std::vector<Vec3f>& normals() const { return points_.normals; }
  // Returns the first point at or after each pixel, pixels + 1 entries.
  const std::vector<std::uint32_t>& pixel_begin() const { return pixel_begin_; }

  // Calls visit(begin, end) for ranges that hold all points in the ball about origin(), and others.
  template <class Visit>
  void for_ranges_in_ball(Vec3 center, double radius, const Visit& visit) const {
    const Vec3 at = relative_to(camera_.to_world, {{}, origin()}) * center;
    const PixelRectangle r =
        rectangle_of_ball(camera_.intrinsics, static_cast<std::int32_t>(camera_.width),
                          static_cast<std::int32_t>(camera_.height), at, radius);
    for (std::int32_t v = r.v0; v <= r.v1 && r.u0 <= r.u1; ++v) {
      const std::size_t row = std::size_t{camera_.width} * static_cast<std::size_t>(v);
      const std::uint32_t begin = pixel_begin_[row + static_cast<std::size_t>(r.u0)];
      const std::uint32_t end = pixel_begin_[row + static_cast<std::size_t>(r.u1) + 1];
      if (begin < end) visit(begin, end);
    }
  }
  // Returns a bound of the number of ranges in a ball.
  std::size_t most_ranges() const { return camera_.height; }

 private:
  friend class FramePreparation;

  // Writes the pixels' normals to `seen`, which has the image's size.
  void order_by_pixel(const Cloud& cloud, SeenImage& seen);

  std::uint64_t serial_ = next_serial();
  Camera camera_;
  OrderedPoints points_;
  std::vector<std::uint32_t> pixel_begin_;
  DenoisedImage image_;
};

// True if no point of this camera can be refused for where it lies: float positions of usable
// depths are finite and lie on the rays of their pixels, their disks are finite, and they are no
// more than kMaxPoints. With rays `longest` times as long as deep, a position errs by less than
// 2^-22 of its length. Cameras beyond that are not used.
bool is_usual(const Camera& camera);

}  // namespace vpm
