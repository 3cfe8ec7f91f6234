// Sums volume, force and torque over parts of a tool, with the same bits in any order.
#pragma once

#include "libvpm/core/fixed_sum.h"
#include "libvpm/core/pose.h"
#include "libvpm/include/vpm/query_types.h"
#include "libvpm/model/tool_model.h"

namespace vpm {

// Sums in units of the tool: volumes in parts of its volume, arms in parts of its radius. Parts of
// a tool do not overlap, so every sum lies in [-1, 1]; 60 fractional bits hold up to 8.
struct ToolSum {
  using Sum = FixedSum<60>;
  Sum volume, force[3], torque[3];

  VPM_HD void add(double part, Vec3 normal, Vec3 arm) { add_moment(part, part * arm, normal); }
  // Adds parts that are pushed along one normal: the sum of their volumes, and the sum of each
  // volume times its arm. Skips what rounds to no volume, so that such parts change no sum.
  VPM_HD void add_moment(double part, Vec3 moment, Vec3 normal) {
    Sum resolved;
    resolved.add(part);
    if (resolved.value == 0) return;
    const Vec3 f = part * normal, t = cross(moment, normal);
    volume.add(resolved);
    force[0].add(f.x), force[1].add(f.y), force[2].add(f.z);
    torque[0].add(t.x), torque[1].add(t.y), torque[2].add(t.z);
  }
  VPM_HD void add(const ToolSum& other) {
    volume.add(other.volume);
    for (int k = 0; k < 3; ++k) force[k].add(other.force[k]), torque[k].add(other.torque[k]);
  }

  // Adds `other`; many threads may do so at once.
  void add_atomically(const ToolSum& other) {
    vpm::add_atomically(volume.value, other.volume.value);
    for (int k = 0; k < 3; ++k) {
      vpm::add_atomically(force[k].value, other.force[k].value);
      vpm::add_atomically(torque[k].value, other.torque[k].value);
    }
  }

  // Writes the sums in SI units and world axes; `rotation` maps tool axes to the world's.
  VPM_HD void write(const ToolModel& tool, const Rotation& rotation, Result& result) const {
    result.volume_fraction = volume.real() < 1 ? volume.real() : 1;  // rounding may pass 1
    result.volume = tool.volume * result.volume_fraction;
    result.wrench.force =
        tool.volume * (rotation * Vec3{force[0].real(), force[1].real(), force[2].real()});
    result.wrench.torque =
        tool.volume *
        (tool.reach * (rotation * Vec3{torque[0].real(), torque[1].real(), torque[2].real()}));
  }
};

}  // namespace vpm
