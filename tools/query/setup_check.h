// Finds tools that no pose brings to the scene, which mistakes of units and poses cause.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libvpm/cloud/cloud.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/query/tool_query.h"
#include "tools/common/tool.h"

namespace vpm::tools {

// Ball about a tool, in world coordinates.
struct ToolBall {
  Vec3 center;
  double radius = 0;  // m
};

class SetupCheck {
 public:
  // Warns if a tool and the scene differ 100 times in size.
  SetupCheck(const Tool& tool, const Cloud& cloud, std::span<const ToolModel> models);

  // Notes the answer at a pose of the k-th tool.
  void see(const Pose& pose, std::size_t k, const Result& result);
  // Warns if at no pose a tool was in the camera's view, or none came near the surface, and says
  // whether inverse poses would be.
  void warn_at_end() const;

 private:
  // Pose that is kept, of a tool.
  struct Kept {
    Pose pose;
    std::size_t tool = 0;
  };

  ToolBall ball(const Pose& pose, std::size_t tool) const;
  bool any_in_view(const Camera& camera, bool inverted) const;
  bool all_behind() const;
  double nearest_gap(bool inverted, const Pose& motion = {}) const;
  std::string inversion_hint() const;

  const Tool& tool_;
  Vec3 origin_;
  std::vector<Vec3f> positions_;  // about the origin
  std::optional<Camera> camera_;
  std::vector<ToolBall> tools_;  // in their own coordinates
  std::vector<Kept> kept_;       // every stride_-th pose
  std::size_t seen_ = 0, stride_ = 1;
  bool has_touched_ = false;
};

}  // namespace vpm::tools
