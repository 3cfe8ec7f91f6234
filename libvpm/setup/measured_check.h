// Finds poses at which a tool is behind the surface where its camera has measured nothing.
#pragma once

#include <vpm/remark.h>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "libvpm/cloud/cloud.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/scene/depth/depth_surface.h"
#include "libvpm/setup/even_sample.h"

namespace vpm {

// Depths of an image, continued to where nothing was measured: across holes to the farther side,
// and as far as a tool is long where a side is open; not to the pixels `removed`.
class ContinuedDepth {
 public:
  ContinuedDepth(const DepthSurface& surface, std::span<const std::size_t> removed, double length);

  // Returns the depth in the direction of a place in camera coordinates, also next to the image; 0
  // where none is near.
  double toward(Vec3 place) const;

 private:
  double& at(std::int32_t u, std::int32_t v) {
    return depth_[static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) +
                  static_cast<std::size_t>(u)];
  }
  // Continues the depths along a row or column of `count` pixels. `size` is the length at 1 m in
  // pixels.
  template <class At>
  static void continue_line(const At& at, std::int32_t count, double size);

  Intrinsics k_;
  std::int32_t width_, height_;
  double length_;
  std::vector<double> depth_;  // m, row by row
};

class MeasuredCheck {
 public:
  // Keeps references to the tools and to the image of the sensor that the surface shows.
  MeasuredCheck(std::span<const ToolModel* const> tools, const DepthSurface& surface,
                const CloudSensor& sensor);

  // Notes a pose of the k-th tool.
  void see(const Pose& pose, std::size_t k) { poses_.add({pose, k, seen_[k]++}); }
  // Returns how many of the noted poses were looked at, and at how many of these a quarter or more
  // of what a tool has behind the surface lies at holes of the image or out of it, where no volume
  // counts; and the numbers of these poses, from 0, ascending and once if it is so of several
  // tools.
  struct Found {
    std::size_t poses = 0, unmeasured = 0;
    std::vector<std::size_t> numbers;
  };
  Found found() const;
  // Returns a warning that names such poses, if there are some.
  std::optional<Remark> remark(const Found& found) const;

 private:
  struct ToolPose {
    Pose pose;
    std::size_t tool = 0, number = 0;
  };

  bool is_unmeasured(const ContinuedDepth& continued, const ToolPose& at) const;

  std::span<const ToolModel* const> tools_;
  DepthSurface surface_;
  Pose camera_to_world_;
  std::vector<std::size_t> removed_;  // pixels of known solids, of which nobody expects more
  std::vector<std::size_t> seen_;     // poses of each tool so far
  EvenSample<ToolPose> poses_;
};

}  // namespace vpm
