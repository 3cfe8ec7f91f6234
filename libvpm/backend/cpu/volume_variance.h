// Finds how uncertain the volume inside a body is: by noise of its surface, and by the samples and
// planes of the tool.
#pragma once

#include <optional>

#include "libvpm/backend/cpu/cell_states.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/scene/depth/depth_surface.h"
#include "libvpm/scene/points/disk_surface.h"
#include "libvpm/scene/rig/rig_surface.h"

namespace vpm {

// Return the variance of the volume, in squares of the tool's, by the cells that the surface cuts:
// 0 if it cuts none. Cells are taken in the order of rows, so that the number of threads changes no
// bit. Return nothing where the noise of the surface is not known.
std::optional<double> volume_variance(const PoseWork<DepthSurface>& work, const ToolModel& tool);
std::optional<double> volume_variance(const PoseWork<DiskSurface>& work, const ToolModel& tool);
std::optional<double> volume_variance(const PoseWork<RigSurface>& work, const ToolModel& tool);

// True for a surface of which that is known.
template <class Surface>
concept TellsVariance = requires(const PoseWork<Surface>& work, const ToolModel& tool) {
  volume_variance(work, tool);
};

}  // namespace vpm
