// Holds a cloud in the memory of a device.
#pragma once

#include <memory>

#include "libvpm/device/cuda/device_array.h"
#include "libvpm/scene/cuda/cloud_room.h"
#include "libvpm/scene/cuda/cloud_views.h"
#include "libvpm/scene/prepared_cloud.h"

namespace vpm::cuda {

class DeviceCloud {
 public:
  explicit DeviceCloud(const PreparedCloud& cloud);
  // Allocates a cloud for an image, which kernels fill (cloud_prepare.h, cloud_denoise.h).
  explicit DeviceCloud(const Camera& camera);
  void stand_at(const Pose& camera_to_world);
  CloudRoom room() const;

  // Returns a number unique in the process, not 0. The views of the surface stay the same for it.
  std::uint64_t serial() const { return serial_; }
  const CloudFrame& frame() const { return frame_; }
  const PointsView& points() const { return points_; }
  const DepthSurface& depth_surface() const { return depth_; }  // requires an organised cloud
  const DiskSurface& disk_surface() const { return disks_; }    // requires an unorganised cloud

 private:
  void make_room(const DepthSurface& image);
  std::size_t tile_count(int level) const;
  void copy_image(const PreparedCloud& cloud);
  void copy_points(const PreparedCloud& cloud);

  static std::uint64_t next_serial();

  std::uint64_t serial_ = next_serial();
  DeviceArray<Vec3f> positions_, normals_, pixel_normals_;
  DeviceArray<float> measured_;
  DeviceArray<InverseDepthRange> tiles_;  // all levels, one after another
  std::size_t tile_begin_[DepthSurface::kMaxLevels] = {};
  DeviceArray<BoxQuad> boxes_, foot_boxes_;
  DeviceArray<Vec3f> feet_, disk_normals_;
  DeviceArray<std::uint32_t> second_of_;
  DeviceArray<SecondPlane> seconds_;
  DeviceArray<ConeQuad> cones_;
  DeviceArray<float> radii_, largest_radii_;
  CloudFrame frame_;
  PointsView points_;
  DepthSurface depth_;
  DiskSurface disks_;
};

// Returns the copy of a cloud on the current device, shared by all queries that hold it.
std::shared_ptr<const DeviceCloud> on_device(const PreparedCloud& cloud);

}  // namespace vpm::cuda
