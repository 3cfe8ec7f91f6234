// Defines the body that several cameras' depth images are together.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "libvpm/scene/rig/prepared_rig.h"

namespace vpm {
namespace cuda {
class DeviceRigBody;
}

// Handle of immutable images of several cameras that are ready for queries; copies share them.
// Thread-safe.
class RigBody {
 public:
  using Surface = RigSurface;
  using OnDevice = cuda::DeviceRigBody;

  // Throws what PreparedRig throws.
  explicit RigBody(std::vector<DepthBody> images)
      : rig_(std::make_shared<const PreparedRig>(std::move(images))) {}

  // Returns what maps the surface's frame, which is that of one of the cameras, to the world's.
  const Pose& to_world() const { return rig_->to_world(); }
  std::size_t points() const { return rig_->point_count(); }
  const PreparedRig& prepared() const { return *rig_; }
  RigSurface surface() const { return rig_->surface(); }
  std::uint64_t serial() const { return rig_->serial(); }

 private:
  std::shared_ptr<const PreparedRig> rig_;
};

}  // namespace vpm
