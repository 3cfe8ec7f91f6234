// Finds poses at which points without a camera do not tell whether a tool is inside.
#pragma once

#include <vpm/query_types.h>
#include <vpm/remark.h>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "libvpm/cloud/cloud.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/setup/even_sample.h"

namespace vpm {

// How often an oriented surface, known by points with normals, encloses a place. Some of the points
// stand for all, so that it is only told apart whether a place is inside, outside or beside the
// surface (generalised winding number: Barill et al. 2018, section 3).
class PointWinding {
 public:
  explicit PointWinding(const Cloud& cloud);

  // Returns the winding number at a place in world coordinates: about 1 inside of a closed surface,
  // 0 outside, 1/2 behind a wide wall.
  double at(Vec3 place) const;

 private:
  struct Dipole {
    Vec3 place, area;  // about the cloud's origin
  };

  Vec3 origin_;
  std::vector<Dipole> dipoles_;
};

class EnclosedCheck {
 public:
  // Keeps references to the tools.
  EnclosedCheck(std::span<const ToolModel* const> tools, const Cloud& cloud)
      : tools_(tools), winding_(cloud) {}

  // Notes the answer at a pose of the k-th tool.
  void see(const Pose& pose, std::size_t k, const Result& result);
  // Returns a warning if at some poses a tool is behind points, but hardly any of it counted: the
  // scan is open there, so that nobody knows whether it is inside.
  std::optional<Remark> remark() const;

 private:
  struct ToolPose {
    Pose pose;
    std::size_t tool = 0;
  };

  std::span<const ToolModel* const> tools_;
  PointWinding winding_;
  EvenSample<ToolPose> doubtful_;  // poses at which hardly anything counted
};

}  // namespace vpm
