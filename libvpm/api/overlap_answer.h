// What a program is told of what two solids share.
#pragma once

#include <vpm/solid.h>

#include "libvpm/solid/device_solids.h"

namespace vpm {

class OverlapAnswer {
 public:
  // Throws what OverlapQuery throws of the options and bodies.
  OverlapAnswer(const SolidSurface& a, const SolidSurface& b, const OverlapOptions& options);

  Overlap of(const SharedSolid& shared) const;
  const OverlapOptions& options() const { return options_; }

 private:
  Wrench wrench(Vec3 force, Vec3 torque) const;

  OverlapOptions options_;
  double force_step_, torque_step_;
};

// Returns whether a device measures what the options ask for.
inline bool is_for_device(const OverlapOptions& options) {
  return options.device.is_cuda() && !options.with_force && options.contacts == 0;
}

}  // namespace vpm
