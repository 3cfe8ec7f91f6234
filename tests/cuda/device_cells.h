// Cells measured on a CUDA device by the functions of libvpm/query/cell.h.
#pragma once

#include <vector>

#include "libvpm/core/pose.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/query/cell.h"
#include "libvpm/surface/prepared_cloud.h"

namespace vpm::testing {

bool has_device();

// What one sphere's cell comes to: its side, the part behind the surface, and the whole of it.
struct CellAnswer {
  Side side = Side::free;
  CellResult cut;
  ToolSum whole;
};

// `to_surface` maps coordinates about the tool's centre of mass to the surface's frame.
std::vector<CellAnswer> cells_on_host(const PreparedCloud& cloud, const ToolModel& tool,
                                      const Level& level, const Pose& to_surface);
std::vector<CellAnswer> cells_on_device(const PreparedCloud& cloud, const ToolModel& tool,
                                        const Level& level, const Pose& to_surface);

}  // namespace vpm::testing
