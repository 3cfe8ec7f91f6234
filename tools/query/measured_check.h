// Finds poses at which a tool is behind the surface where its camera has measured nothing.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "libvpm/model/tool_model.h"
#include "libvpm/scene/any_body.h"
#include "tools/common/tool.h"
#include "tools/query/even_sample.h"

namespace vpm::tools {

// Depths of an image, continued to where nothing was measured: across holes to the farther side,
// and as far as a tool is long where a side is open.
class ContinuedDepth {
 public:
  ContinuedDepth(const DepthSurface& surface, double length);

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
  // Keeps references to all of them. Clouds without a camera are never warned about.
  MeasuredCheck(const Tool& tool, std::span<const ToolModel> models, const AnyBody& cloud)
      : tool_(tool), models_(models), cloud_(cloud) {}

  // Notes a pose of the k-th tool.
  void see(const Pose& pose, std::size_t k) { poses_.add({pose, k}); }
  // Warns if at some poses a quarter or more of what a tool has behind the surface lies at holes of
  // the image or out of it, where no volume counts.
  void warn_at_end() const;

 private:
  struct ToolPose {
    Pose pose;
    std::size_t tool = 0;
  };

  bool is_unmeasured(const DepthSurface& surface, const ContinuedDepth& continued,
                     const ToolPose& at) const;

  const Tool& tool_;
  std::span<const ToolModel> models_;
  const AnyBody& cloud_;
  EvenSample<ToolPose> poses_;
};

}  // namespace vpm::tools
