#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "libvpm/graph/voronoi_cells.h"
#include "libvpm/model/tool_model.h"

namespace vpm::tools {

// Returns the content of --report (formats/schemas/graph-report.json): the finest level at the top,
// all of them in `levels`.
nlohmann::ordered_json graph_report(const ToolModel& model,
                                    const std::vector<VoronoiQuality>& quality, double seconds);

}  // namespace vpm::tools
