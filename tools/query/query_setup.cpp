#include "tools/query/query_setup.h"

#include <vpm/device.h>
#include <vpm/error.h>

#include <algorithm>
#include <utility>

#include "libvpm/file/stream.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/view/pose_view.h"
#include "libvpm/view/sphere_files.h"
#include "tools/common/mesh_tool.h"
#include "tools/common/number_checks.h"
#include "tools/common/scene_report.h"
#include "tools/query/solid_scene.h"

namespace vpm::tools {
namespace {

LevelRequest level_request(const Arguments& a) {
  LevelRequest request;
  if (!a.max_error.empty()) request.max_error = fraction_from_text(a.max_error, "--max-error");
  if (a.deadline_us) {
    if (!(*a.deadline_us > 0))
      throw Error(ErrorKind::invalid_argument,
                  "--deadline-us must be a positive number of microseconds");
    request.deadline_seconds = 1e-6 * *a.deadline_us;
  }
  request.for_scene = a.for_scene;
  return request;
}

std::vector<Tool> read_tools(const Program& program, const std::vector<std::string>& names) {
  std::vector<Tool> tools;
  for (const std::string& name : names)
    tools.push_back(is_mesh_file(name) ? tool_of_mesh(program, name) : Tool::read(name));
  return tools;
}

// Returns the CPU for what no device computes (coherent poses, the measure as printed, solids,
// contacts, intervals), unless a device is named.
Device device_of(const Program& program, const Arguments& a) {
  const bool has_solids_only = !a.solids.empty() && a.clouds.empty();
  const bool is_on_cpu =
      a.coherent || a.measure == "paper" || a.contacts > 0 || a.interval || has_solids_only;
  return is_on_cpu && program.common().device == "auto" ? Device{} : program.device();
}

QueryOptions query_options(const Program& program, const Arguments& a) {
  QueryOptions options;
  options.measure = a.measure == "paper" ? Measure::paper : Measure::refined;
  options.level = a.level;
  options.stiffness = a.stiffness.value_or(1);
  options.shadows = a.shadows == "solid" ? Shadows::solid : Shadows::near;
  options.coherent = a.coherent;
  options.contacts = static_cast<std::uint32_t>(a.contacts);
  options.interval = a.interval;
  options.device = device_of(program, a);
  return options;
}

// Returns how points are read: as they are for the measure as printed.
Denoising denoising_of(const Arguments& a) {
  return a.raw_points || a.measure == "paper" ? Denoising::off : Denoising::on;
}

// Writes the spheres, which are in the tool's coordinates, at the pose in world coordinates, each
// with its state. The suffix chooses the format (formats/spheres.md).
void write_spheres(const std::string& path, std::span<const Sphere> spheres,
                   std::span<const SphereState> states, const Pose& pose) {
  std::vector<Sphere> placed;
  std::vector<std::uint8_t> numbers;
  for (std::size_t k = 0; k < spheres.size(); ++k) {
    placed.push_back({pose * spheres[k].center, spheres[k].radius});
    numbers.push_back(static_cast<std::uint8_t>(states[k]));
  }
  file::write_all(path, view::spheres_as(*view::sphere_format(path), placed, numbers));
}

}  // namespace

QuerySetup::QuerySetup(const Program& p, const Arguments& a)
    : QuerySetup(p, a, read_tools(p, a.tools), a.tools) {}

QuerySetup::QuerySetup(const Program& p, const Arguments& a, std::vector<Tool> named,
                       const std::vector<std::string>& names)
    : program(p),
      arguments(a),
      level(level_request(a)),
      tools(std::move(named)),
      solids(read_solids(p, a.solids)),
      points(denoising_of(a)),
      collisions(a.collides, a.unseen_limit, a.fail_above) {
  if (!solids.empty()) check_surfaces(tools, names);
  options = query_options(program, a);
  if (a.view.empty()) return;
  view.emplace(tools, names, options, "vpm-query");
  for (std::size_t k = 0; k < a.tools.size(); ++k)
    if (a.tools[k] != "-" && !is_mesh_file(a.tools[k]))
      view::PoseView::of(*view).set_mesh(k, read_display_mesh(a.tools[k]));
  for (std::size_t k = 0; k < solids.size(); ++k)
    view->add_solid(solid_from_text(a.solids[k], "--solid").name, solids[k]);
}

void say(const Program& program, const Remarks& remarks) {
  for (const Remark& remark : remarks)
    remark.is_warning ? program.warn(remark.text) : program.note(remark.text);
}

void note_scale(const Program& program, const LevelQuery& query, std::size_t tool) {
  const std::optional<SceneScale> scale = query.scale(tool);
  if (!scale) return;
  program.note("the scene resolves " + words_of(*scale) + ": the level of " +
               std::to_string(query.finest_level(tool)) + " is enough");
}

void write_last_spheres(const QuerySetup& setup, const LevelQuery& query, const Pose& last) {
  const std::string& path = setup.arguments.spheres_out;
  if (path.empty()) return;
  std::vector<Sphere> spheres = setup.tools.front().spheres();
  spheres.resize(query.level());
  write_spheres(path, spheres, query.states(), last);
}

void add_levels(nlohmann::json& stats, const LevelQuery& query, std::size_t tools) {
  if (tools > 1) {
    for (std::size_t tool = 0; tool < tools; ++tool) stats["levels"].push_back(query.level(tool));
    return;
  }
  stats["level"] = query.level();
  if (query.scale()) stats["scene"] = scene_report(*query.scale());
}

void write_stats_and_view(const QuerySetup& setup, nlohmann::json stats) {
  const Arguments& a = setup.arguments;
  if (!a.stats.empty()) {
    const Device& device = setup.options.device;
    stats["device"] = device.is_cuda() ? "cuda" : "cpu";
    if (device.is_cuda()) stats["device_name"] = device_name(device);
    stats["batch"] = a.batch;
    stats["threads"] = thread_count();
    stats["measure"] = a.measure;
    file::write_all(a.stats, stats.dump(2) + "\n");
  }
  if (setup.view) setup.view->write(a.view);
}

}  // namespace vpm::tools
