#include "libvpm/setup/size_check.h"

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

namespace vpm {
namespace {

// Sizes in metres, and ratios of a tool's size and the scene's, that are rarely passed. A ratio
// alone tells little: a screw may be scanned for a hammer. A size beyond those of its kind, beside
// a ratio that hardly occurs, does.
constexpr double kLargestHandled = 3;    // a table, a robot's link
constexpr double kLargestTool = 10;      // a vehicle
constexpr double kSmallestTool = 0.003;  // a burr, a needle's tip
constexpr double kSmallestView = 0.02;   // a close-up of a depth camera
constexpr double kLargestRoom = 30;      // a hall has points as fine as tools
constexpr double kSeveral = 6, kMuch = 100;

enum class Doubt { none, tool_too_large, tool_too_small, scene_too_large, scene_too_small };

Doubt doubt_of(double tool, double scene, const CheckedScene& points) {
  const double most = tool > kLargestTool ? scene : kSeveral * scene;
  if (tool > kLargestHandled && tool > most) return Doubt::tool_too_large;
  const bool is_speck = points.camera && scene < kSmallestView;
  if (tool > kMuch * scene || (is_speck && tool > 10 * scene)) return Doubt::scene_too_small;
  if (scene < kMuch * tool) return Doubt::none;
  // Points further apart than the tool is long show no more of it than whether it is behind them.
  if (tool < kSmallestTool && (points.spacing > tool || scene > kMuch * kMuch * tool))
    return Doubt::tool_too_small;
  return points.spacing > 2 * tool && scene > kLargestRoom ? Doubt::scene_too_large : Doubt::none;
}

// Returns the `scale` that the mesh was read with, as far as the model's provenance tells it.
double told_scale(const ToolModel& model) {
  const nlohmann::json::json_pointer place("/packing/parameters/scale");
  const nlohmann::json& told = model.provenance.json();
  return told.contains(place) && told[place].is_number() ? told[place].get<double>() : 1;
}

// Returns "if the mesh is in millimetres, give `scale` 0.001", in the unit that fits.
std::string scale_cure(double scale) {
  char text[120];
  const char* const unit = scale == 1 ? "metres" : scale == 0.001 ? "millimetres" : nullptr;
  std::snprintf(text, sizeof text, "if the mesh is in %s, give `scale` %.6g",
                unit != nullptr ? unit : "another unit", scale);
  return text;
}

std::string cure_of(Doubt doubt, const ToolModel& model, bool are_frames) {
  const std::string import = are_frames ? "" : "`import_cloud` ";
  switch (doubt) {
    case Doubt::tool_too_large:
      return scale_cure(told_scale(model) / 1000);
    case Doubt::tool_too_small:
      return scale_cure(told_scale(model) * 1000);
    case Doubt::scene_too_large:
      return "if the scene is in millimetres, give " + import + "`depth_scale` 1000";
    default:
      return "if the scene is in metres, give " + import + "`depth_scale` 1";
  }
}

}  // namespace

std::optional<Remark> improbable_sizes(std::span<const ToolModel* const> tools,
                                       const CheckedScene& scene, bool are_frames) {
  const double shown = size_of(scene);
  if (!(shown > 0)) return std::nullopt;
  for (const ToolModel* const model : tools) {
    const double size = 2 * model->radius;
    const Doubt doubt = doubt_of(size, shown, scene);
    if (doubt == Doubt::none) continue;
    char sizes[96];
    std::snprintf(sizes, sizeof sizes, "the tool is %.3g m across and the scene %.3g m: ", size,
                  shown);
    return Remark{true, sizes + cure_of(doubt, *model, are_frames)};
  }
  return std::nullopt;
}

}  // namespace vpm
