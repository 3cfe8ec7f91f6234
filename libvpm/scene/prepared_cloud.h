// A cloud made ready for queries: everything that depends on the frame alone is done once, here.
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
#include "libvpm/scene/depth/depth_surface.h"
#include "libvpm/scene/pixel_rectangle.h"
#include "libvpm/scene/points/denoised_disks.h"
#include "libvpm/scene/points/disk_surface.h"

namespace vpm {

class PreparedCloud {
 public:
  // The most points a cloud may have: what the fixed-point sums of a sphere can count (see
  // measure_paper.h).
  static constexpr std::size_t kMaxPoints = std::size_t{1} << 24;

  // Throws Error(refused): more than kMaxPoints, an image of more than 2^31 - 1 pixels or 65536 a
  // side, an origin, a camera or a point beyond kLargestLength, or what validate(cloud)
  // refuses. Depths outside of [kMinDepth, kMaxDepth] (normal_limits.h) count as not measured. From
  // a depth image, FramePreparation (frame_preparation.h) is quicker. To settle 300 000 points
  // takes one core a millisecond where a camera saw them, otherwise a second or two (README.md).
  explicit PreparedCloud(const Cloud& cloud, Denoising points = Denoising::on);

  // The same for copies, different for any two clouds of a process: what is known of a cloud
  // elsewhere (on a device) can be told by it.
  std::uint64_t serial() const { return serial_; }

  Vec3 origin() const { return origin_; }
  const std::vector<Vec3f>& positions() const {
    return positions_;
  }  // about origin(), canonical order
  const std::vector<Vec3f>& normals() const { return normals_; }

  // The camera's surface, where there is one; in the frame of camera_to_world().
  bool is_organised() const { return camera_.has_value(); }
  const Pose& camera_to_world() const { return camera_->to_world; }
  DepthSurface depth_surface() const { return image_.surface(camera_->intrinsics); }
  // Of organised clouds: the first point at or after each pixel; pixels + 1.
  const std::vector<std::uint32_t>& pixel_begin() const { return pixel_begin_; }
  PointTree point_tree() const;                          // of the positions; and
  DiskSurface disk_surface() const;                      // of clouds that are not organised
  const DenoisedDisks& disks() const { return disks_; }  // the same; in the order of positions()

  // Calls visit(begin, end) for ranges of points that hold all that lie in the ball (about
  // origin()), and others.
  template <class Visit>
  void for_ranges_in_ball(Vec3 center, double radius, const Visit& visit) const;
  // Of organised clouds: for the points of these pixels.
  template <class Visit>
  void for_ranges_in_pixels(const PixelRectangle& pixels, const Visit& visit) const;
  // Bound of their number.
  std::size_t most_ranges() const {
    return is_organised() ? camera_->height : leaves_for(positions_.size());
  }

 private:
  friend class FramePreparation;

  void take_image(const Cloud& cloud, Denoising points);
  // Notes the pixels' normals in `seen`, which has the image's size.
  void order_by_pixel(const Cloud& cloud, SeenImage& seen);
  std::vector<float> order_in_space(const Cloud& cloud);  // returns the sampling radii
  void take_in_order(const Cloud& cloud, const std::vector<std::uint32_t>& order);

  PixelRectangle pixels_of_ball(Vec3 center, double radius) const;

  static std::uint64_t next_serial();

  std::uint64_t serial_;
  Vec3 origin_;
  std::vector<Vec3f> positions_, normals_;

  std::optional<Camera> camera_;
  std::vector<std::uint32_t> pixel_begin_;
  DenoisedImage image_;

  std::vector<BoxQuad> boxes_;        // of the positions
  std::vector<float> largest_radii_;  // of the disks in each node of their tree
  std::vector<BoxQuad> foot_boxes_;   // of the disks' feet; none where those are the positions
  DenoisedDisks disks_;
  std::vector<ConeQuad> cones_;  // of the disks
};

// True if no point of this camera can be refused for where it lies: float positions of usable
// depths are finite and lie on the rays of their pixels, their disks are finite, and they are no
// more than a PreparedCloud takes. With rays `longest` times as long as deep, a position errs by
// less than 2^-22 of its length. Cameras beyond that are not used.
bool is_usual(const Camera& camera);

template <class Visit>
void PreparedCloud::for_ranges_in_pixels(const PixelRectangle& r, const Visit& visit) const {
  for (std::int32_t v = r.v0; v <= r.v1 && r.u0 <= r.u1; ++v) {
    const std::size_t row = std::size_t{camera_->width} * static_cast<std::size_t>(v);
    const std::uint32_t begin = pixel_begin_[row + static_cast<std::size_t>(r.u0)];
    const std::uint32_t end = pixel_begin_[row + static_cast<std::size_t>(r.u1) + 1];
    if (begin < end) visit(begin, end);
  }
}

template <class Visit>
void PreparedCloud::for_ranges_in_ball(Vec3 center, double radius, const Visit& visit) const {
  if (is_organised()) {
    for_ranges_in_pixels(pixels_of_ball(center, radius), visit);
    return;
  }
  point_tree().for_leaves_in_ball(center, radius * radius,
                                  [&](std::uint32_t begin, std::uint32_t end) {
                                    visit(begin, end);
                                    return true;
                                  });
}

}  // namespace vpm
