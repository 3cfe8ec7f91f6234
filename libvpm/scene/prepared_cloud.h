// Prepares a cloud for queries: all that depends on the frame alone is computed once, here.
//
// Points are put into a canonical order and equal points are merged, so that the order of the
// points, or giving each twice, changes no result. Immutable; safe to share between threads.
#pragma once

#include <optional>
#include <vector>

#include "libvpm/cloud/cloud.h"
#include "libvpm/core/pose.h"
#include "libvpm/include/vpm/camera.h"
#include "libvpm/scene/depth/denoised_image.h"
#include "libvpm/scene/depth/depth_sampler.h"
#include "libvpm/scene/depth/depth_surface.h"
#include "libvpm/scene/points/disk_surface.h"

namespace vpm {

class PreparedCloud {
 public:
  // Limits the number of points that the fixed-point sums of a sphere can count (paper_contact.h).
  static constexpr std::size_t kMaxPoints = std::size_t{1} << 24;

  // Throws Error(refused) for more than kMaxPoints, an image of more than 2^31 - 1 pixels or 65536
  // a side, an origin, a camera or a point beyond kLargestLength, or what validate(cloud) refuses.
  // Depths outside of [kMinDepth, kMaxDepth] (depth_image.h) count as not measured.
  // FramePreparation is faster for depth images. Denoising 300 000 points takes a core a
  // millisecond for an image, otherwise a second or two.
  explicit PreparedCloud(const Cloud& cloud, Denoising points = Denoising::on);

  // Returns a number shared by copies of a cloud only, to recognise copies on a device.
  std::uint64_t serial() const { return serial_; }

  Vec3 origin() const { return origin_; }
  const std::vector<Vec3f>& positions() const {
    return positions_;
  }  // about origin(), canonical order
  const std::vector<Vec3f>& normals() const { return normals_; }

  // Returns the camera's surface, in the frame of camera_to_world(). Requires is_organised().
  bool is_organised() const { return camera_.has_value(); }
  const Pose& camera_to_world() const { return camera_->to_world; }
  DepthSurface depth_surface() const { return image_.surface(camera_->intrinsics); }
  // Returns the first point at or after each pixel, pixels + 1 entries. Requires is_organised().
  const std::vector<std::uint32_t>& pixel_begin() const { return pixel_begin_; }
  PointTree point_tree() const;                          // tree of the positions
  DiskSurface disk_surface() const;                      // requires !is_organised()
  const DenoisedDisks& disks() const { return disks_; }  // in the order of positions()

  // Calls visit(begin, end) for ranges that hold all points in the ball, and others.
  template <class Visit>
  void for_ranges_in_ball(Vec3 center, double radius, const Visit& visit) const {
    if (is_organised()) {
      const Vec3 at = relative_to(camera_->to_world, {{}, origin_}) * center;
      for_ranges_in_pixels(
          rectangle_of_ball(camera_->intrinsics, static_cast<std::int32_t>(camera_->width),
                            static_cast<std::int32_t>(camera_->height), at, radius),
          visit);
      return;
    }
    point_tree().for_leaves_in_ball(center, radius * radius,
                                    [&](std::uint32_t begin, std::uint32_t end) {
                                      visit(begin, end);
                                      return true;
                                    });
  }
  // Calls visit(begin, end) for the points of these pixels. Requires is_organised().
  template <class Visit>
  void for_ranges_in_pixels(const PixelRectangle& r, const Visit& visit) const {
    for (std::int32_t v = r.v0; v <= r.v1 && r.u0 <= r.u1; ++v) {
      const std::size_t row = std::size_t{camera_->width} * static_cast<std::size_t>(v);
      const std::uint32_t begin = pixel_begin_[row + static_cast<std::size_t>(r.u0)];
      const std::uint32_t end = pixel_begin_[row + static_cast<std::size_t>(r.u1) + 1];
      if (begin < end) visit(begin, end);
    }
  }
  // Returns a bound of the number of ranges in a ball.
  std::size_t most_ranges() const {
    return is_organised() ? camera_->height : leaves_for(positions_.size());
  }

 private:
  friend class FramePreparation;

  void take_image(const Cloud& cloud, Denoising points);
  // Writes the pixels' normals to `seen`, which has the image's size.
  void order_by_pixel(const Cloud& cloud, SeenImage& seen);
  std::vector<float> order_in_space(const Cloud& cloud);  // returns the sampling radii
  void take_in_order(const Cloud& cloud, const std::vector<std::uint32_t>& order);

  static std::uint64_t next_serial();

  std::uint64_t serial_;
  Vec3 origin_;
  std::vector<Vec3f> positions_, normals_;

  std::optional<Camera> camera_;
  std::vector<std::uint32_t> pixel_begin_;
  DenoisedImage image_;

  std::vector<BoxQuad> boxes_;        // bounds of the positions
  std::vector<float> largest_radii_;  // largest radius of a disk in each tree node
  std::vector<BoxQuad> foot_boxes_;   // bounds of the disks' feet, unless those are positions_
  DenoisedDisks disks_;
  std::vector<ConeQuad> cones_;  // cones of the disks' normals
};

// True if no point of this camera can be refused for where it lies: float positions of usable
// depths are finite and lie on the rays of their pixels, their disks are finite, and they are no
// more than a PreparedCloud takes. With rays `longest` times as long as deep, a position errs by
// less than 2^-22 of its length. Cameras beyond that are not used.
bool is_usual(const Camera& camera);

}  // namespace vpm
