// Prepares several cameras' images as one body, once per frame: orders them, finds their
// silhouettes, and what the images themselves disagree by. Immutable; safe to share between
// threads.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "libvpm/scene/depth/depth_body.h"
#include "libvpm/scene/rig/agreement.h"
#include "libvpm/scene/rig/rig_surface.h"
#include "libvpm/scene/rig/silhouettes.h"

namespace vpm {

// Returns images in an order that depends on them alone, each once.
std::vector<DepthBody> different_images(std::vector<DepthBody> images);

class PreparedRig {
 public:
  // Takes images in any order; one that is given twice counts once. Takes a core 30 ms for four
  // images of 300 000 pixels, of which those that were part of another rig take little. Throws what
  // PreparedImage throws, and Error(invalid_argument) for none or more than
  // RigSurface::kMostCameras.
  explicit PreparedRig(std::vector<DepthBody> images);

  // Returns a number shared by copies of the rig only.
  std::uint64_t serial() const { return serial_; }
  // Returns the images in the order in which the rig names them.
  const std::vector<DepthBody>& images() const { return images_; }
  const RigAgreement& agreement() const { return agreement_; }

  // Maps the rig's frame, which is that of the first camera, to the world's.
  const Pose& to_world() const { return images_.front().to_world(); }
  // Returns the surface on the host. The first call spreads the silhouettes, which devices do
  // themselves.
  RigSurface surface() const {
    return surface_of(spread_cameras().data(), agreement_.of_pairs.data());
  }
  // Returns the surface of cameras and of their agreement, where these lie.
  RigSurface surface_of(const RigCamera* cameras, const double* of_pairs) const {
    return {cameras, of_pairs, static_cast<std::int32_t>(cameras_.size()), agreement_.most,
            agreement_.well_before};
  }
  // Returns the cameras, images in the host's memory, without silhouettes.
  const std::vector<RigCamera>& cameras() const { return cameras_; }

  // Return the points of all images about origin() and their normals, world axes.
  Vec3 origin() const { return images_.front().prepared().origin(); }
  const std::vector<Vec3f>& positions() const { return points().positions; }
  const std::vector<Vec3f>& normals() const { return points().normals; }
  std::size_t point_count() const;
  // Calls visit(begin, end) for ranges that hold all points in the ball about origin(), and others.
  template <class Visit>
  void for_ranges_in_ball(Vec3 center, double radius, const Visit& visit) const {
    std::uint32_t first = 0;
    for (const DepthBody& body : images_) {
      const PreparedImage& image = body.prepared();
      image.for_ranges_in_ball(
          center + (origin() - image.origin()), radius,
          [&](std::uint32_t begin, std::uint32_t end) { visit(first + begin, first + end); });
      first += static_cast<std::uint32_t>(image.positions().size());
    }
  }
  // Returns a bound of the number of ranges in a ball.
  std::size_t most_ranges() const;

 private:
  struct Points {
    std::once_flag once;
    std::vector<Vec3f> positions, normals;
  };

  struct SpreadCameras {
    std::once_flag once;
    std::vector<RigCamera> all;
  };

  template <class Body>
  void for_each_image(const Body& body) const;
  void place_cameras();
  const std::vector<RigCamera>& spread_cameras() const;
  // Returns the points of all images. The first call makes the list, for few queries read it.
  const Points& points() const;

  std::uint64_t serial_ = next_serial();
  std::vector<DepthBody> images_;
  std::vector<RigCamera> cameras_;
  RigAgreement agreement_;
  std::unique_ptr<SpreadCameras> spread_ = std::make_unique<SpreadCameras>();
  std::unique_ptr<Points> points_ = std::make_unique<Points>();
};

}  // namespace vpm
