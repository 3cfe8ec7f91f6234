#include "tools/graph/graph_report.h"

#include <cmath>

#include "libvpm/graph/hierarchy.h"

namespace vpm::tools {
namespace {

nlohmann::ordered_json level_report(const Level& level, const VoronoiQuality& quality) {
  double share_sum = 0;
  for (const double volume : level.cell_volume) share_sum += volume;
  return {
      {"spheres", level.sphere_count},
      {"edges", level.graph.neighbors.size() / 2},
      {"bridges", level.bridges},
      {"components_before", level.components_before},
      {"epsilon", level.epsilon},
      {"hierarchy", {{"nodes", level.hierarchy.nodes.size()}, {"depth", depth(level.hierarchy)}}},
      {"grid",
       {{"cells", {level.grid.nx, level.grid.ny, level.grid.nz}},
        {"entries", level.grid.spheres.size()}}},
      {"share_sum", share_sum},
      {"share_sum_relative_error", quality.volume_sum_error},
      {"gap_fraction", quality.gap_fraction},
      {"gap_sampling_error", std::abs(quality.volume_error)},
      {"centroid_sampling_error", quality.centroid_error},
      {"blocks", level.blocks.size()},
      {"samples", level.samples.size()}};
}

}  // namespace

nlohmann::ordered_json graph_report(const ToolModel& model,
                                    const std::vector<VoronoiQuality>& quality, double seconds) {
  nlohmann::ordered_json levels = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < model.levels.size(); ++k) {
    levels.push_back(level_report(model.levels[k], quality[k]));
    if (!model.calibration.empty()) {
      const LevelError& error = model.calibration[k];
      levels.back()["calibration"] = {
          {"mean", error.mean}, {"p95", error.p95}, {"worst", error.worst}};
    }
  }
  nlohmann::ordered_json report = levels.back();
  report["volume"] = model.volume;
  report["center_of_mass"] = {model.center_of_mass.x, model.center_of_mass.y,
                              model.center_of_mass.z};
  report["reach"] = model.radius;
  report["solid_hash"] = model.solid_hash;
  report["levels"] = std::move(levels);
  report["seconds"] = seconds;
  return report;
}

}  // namespace vpm::tools
