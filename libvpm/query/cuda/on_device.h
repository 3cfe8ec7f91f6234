// A tool's level and a cloud in the memory of a device.
#pragma once

#include <memory>

#include "libvpm/query/cuda/cloud_room.h"
#include "libvpm/query/cuda/device_array.h"
#include "libvpm/query/cuda/views.h"
#include "libvpm/query/image_part.h"
#include "libvpm/query/prepared_cloud.h"

namespace vpm::cuda {

// Makes a device the current one of this thread for a scope.
class CurrentDevice {
 public:
  explicit CurrentDevice(int index) : before_(current_device()) {
    if (index != before_) check(cudaSetDevice(index));
  }
  ~CurrentDevice() { cudaSetDevice(before_); }
  CurrentDevice(const CurrentDevice&) = delete;
  CurrentDevice& operator=(const CurrentDevice&) = delete;

 private:
  int before_ = 0;
};

// No point of a level's spheres is further from the centre of mass.
double reach_of_spheres(const ToolModel& tool, const Level& level);

class DeviceLevel {
 public:
  DeviceLevel(const ToolModel& tool, const Level& level, Shadows shadows)
      : DeviceLevel(tool, level, {tool.reach, shadows}, cluster_shares(tool, level)) {}
  const LevelView& view() const { return view_; }
  // By queries that count no points.
  const LookSizes& looks() const { return looks_; }

 private:
  DeviceLevel(const ToolModel& tool, const Level& level, ToolReach reach,
              const ShareClusters& clusters);

  DeviceArray<Sphere> spheres_;
  DeviceArray<Vec3> centers_;
  DeviceArray<double> reach_;
  DeviceArray<std::uint32_t> block_begin_, grid_begin_, grid_spheres_;
  DeviceArray<CellBlock> blocks_;
  DeviceArray<BlockMass> block_masses_, share_masses_;
  DeviceArray<CellSample> samples_;
  DeviceArray<Unit> units_;
  DeviceArray<Chunk> chunks_;
  DeviceArray<Edge> edges_;
  DeviceArray<std::uint32_t> edge_begin_;
  LevelView view_;
  LookSizes looks_;
};

class DeviceCloud {
 public:
  explicit DeviceCloud(const PreparedCloud& cloud);
  // Room for the cloud of an image, which kernels make (cloud_prepare.h, cloud_settle.h).
  explicit DeviceCloud(const Camera& camera);
  void stand_at(const Pose& camera_to_world);
  CloudRoom room() const;

  // Different for any two of a process, and not 0. What kernels see of the surface stays the same.
  std::uint64_t serial() const { return serial_; }
  const CloudFrame& frame() const { return frame_; }
  const PointsView& points() const { return points_; }
  const DepthSurface& depth_surface() const { return depth_; }  // of organised clouds
  const DiskSurface& disk_surface() const { return disks_; }    // of the others

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

// The copy of a cloud on the current device, shared by all queries that hold it.
std::shared_ptr<const DeviceCloud> on_device(const PreparedCloud& cloud);

}  // namespace vpm::cuda
