// All checks of a setup whose scene is one cloud, and which of their findings is said.
#pragma once

#include <vpm/query_types.h>
#include <vpm/remark.h>

#include <cstddef>
#include <optional>
#include <vector>

#include "libvpm/cloud/cloud.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/scene/depth/depth_surface.h"
#include "libvpm/setup/enclosed_check.h"
#include "libvpm/setup/measured_check.h"
#include "libvpm/setup/pose_check.h"

namespace vpm {

// One cause explains a setup that is wrong, and the first of these that holds is said: sizes that
// cannot be, since they move everything; tools behind points of one side, and tools where the
// camera measured nothing, which both are at the scene; poses that miss it.
class CloudChecks {
 public:
  // Keeps references to the tools. Looks for what the camera has not measured only if `measured` is
  // given, whose image must outlive this.
  CloudChecks(std::vector<const ToolModel*> tools, const Cloud& cloud,
              std::optional<DepthSurface> measured);
  CloudChecks(const CloudChecks&) = delete;
  CloudChecks& operator=(const CloudChecks&) = delete;

  // Notes the answer at a pose of the k-th tool.
  void see(const Pose& pose, std::size_t k, const Result& result);
  // Returns what the poses so far tell, at most one warning; before the first pose, what sizes
  // tell.
  Remarks remarks() const;

 private:
  std::vector<const ToolModel*> tools_;
  CheckedScene scene_;
  std::optional<Remark> sizes_;
  PoseCheck poses_;
  std::optional<MeasuredCheck> measured_;
  std::optional<EnclosedCheck> enclosed_;
};

}  // namespace vpm
