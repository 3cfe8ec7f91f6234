// Defines what a handle of a body holds.
#pragma once

#include <variant>

#include "libvpm/api/handle_access.h"
#include "libvpm/include/vpm/scene.h"
#include "libvpm/scene/depth_frames.h"

namespace vpm {

class SceneBody {
 public:
  explicit SceneBody(PreparedCloud cloud) : held_(std::move(cloud)) {}
  explicit SceneBody(DepthFrame frame) : held_(std::move(frame)) {}

  SceneView view() const {
    return std::visit([](const auto& held) { return SceneView(held); }, held_);
  }
  std::size_t points() const {
    const auto* const frame = std::get_if<DepthFrame>(&held_);
    return frame != nullptr ? frame->points() : std::get<PreparedCloud>(held_).positions().size();
  }

 private:
  std::variant<PreparedCloud, DepthFrame> held_;
};

// Returns the scene's only body.
inline SceneView view_of(const Scene& scene) {
  return HandleAccess::held(scene.bodies().front()).view();
}

}  // namespace vpm
