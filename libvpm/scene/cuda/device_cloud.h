// Holds a cloud in the memory of a device, and describes it as kernels take it: plain pointers and
// numbers.
#pragma once

#include <cstdint>
#include <memory>

#include "libvpm/cloud/camera.h"
#include "libvpm/device/cuda/device_array.h"
#include "libvpm/scene/depth/depth_surface.h"
#include "libvpm/scene/points/point_tree.h"
#include "libvpm/scene/prepared_cloud.h"

namespace vpm::cuda {

// Points to the device memory for the cloud of an image, by pixel.
struct CloudRoom {
  Vec3f* pixel_normals = nullptr;  // camera axes, as DepthSurface reads them
  float* measured = nullptr;       // inverse depth, 1/m, holes closed
  InverseDepthRange* tiles[DepthSurface::kMaxLevels] = {};
  std::int32_t levels = 0;
};

class DeviceCloud {
 public:
  explicit DeviceCloud(const PreparedCloud& cloud);
  // Allocates a cloud for an image, which kernels fill (cloud_prepare.h).
  explicit DeviceCloud(const Camera& camera);
  void stand_at(const Pose& camera_to_world);
  const CloudRoom& room() const { return room_; }

  bool is_organised() const { return is_organised_; }
  // Returns what maps the surface's frame to the world's.
  const Pose& to_world() const { return to_world_; }
  const DepthSurface& depth_surface() const { return depth_; }  // requires an organised cloud
  const DiskSurface& disk_surface() const { return disks_; }    // requires an unorganised cloud

 private:
  // Takes the arrays of an image; `tiles` holds all levels, one after another.
  void set_image(const DepthSurface& image, const CloudRoom& room, InverseDepthRange* tiles);
  void copy_image(const PreparedCloud& cloud);
  void copy_points(const PreparedCloud& cloud);

  DeviceMemory memory_;
  CloudRoom room_;
  bool is_organised_ = false;
  Pose to_world_;
  DepthSurface depth_;
  DiskSurface disks_;
};

// Returns the copy of a cloud on the current device, shared by all queries that hold it.
std::shared_ptr<const DeviceCloud> on_device(const PreparedCloud& cloud);

}  // namespace vpm::cuda
