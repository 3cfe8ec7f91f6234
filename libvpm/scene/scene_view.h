// Refers to a scene as queries take it: one body, a prepared cloud or a frame of a depth camera.
#pragma once

#include "libvpm/scene/depth_frames.h"
#include "libvpm/scene/prepared_cloud.h"

namespace vpm {

// Points to a cloud or a frame, which must outlive it.
class SceneView {
 public:
  SceneView(const PreparedCloud& cloud) : cloud_(&cloud) {}
  SceneView(const DepthFrame& frame) : frame_(&frame) {}

  // Returns the frame, or null if the scene is a cloud.
  const DepthFrame* frame() const { return frame_; }
  // Returns the cloud; a frame's is prepared by the CPU when first asked for.
  const PreparedCloud& cloud() const { return frame_ != nullptr ? frame_->cloud() : *cloud_; }

 private:
  const PreparedCloud* cloud_ = nullptr;
  const DepthFrame* frame_ = nullptr;
};

}  // namespace vpm
