// vpm-graph: turns a packing into the tool model that queries load.

#include <vpm/version.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "libvpm/graph/build_tool_model.h"
#include "libvpm/graph/calibration.h"
#include "libvpm/mesh/mesh_check.h"
#include "libvpm/mesh/mesh_reader.h"
#include "libvpm/model/packing.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/view/page.h"
#include "libvpm/view/simplify.h"
#include "tools/common/number_checks.h"
#include "tools/common/program.h"
#include "tools/common/repair_option.h"
#include "tools/graph/graph_report.h"
#include "tools/graph/model_view.h"

namespace vpm::tools {
namespace {

struct Arguments {
  std::string packing, output, mesh, report, view;
  GraphOptions options;
  bool calibrate = false, no_surface = false;
};

void declare(CLI::App& app, Arguments& a) {
  app.add_option("packing", a.packing, "Packing (.vpmp); - is standard input")->required();
  begin_group(app, "Outputs");
  app.add_option("-o,--output", a.output, "Tool model to write (.vpmg); - is standard output")
      ->required();
  app.add_option("--report", a.report, "Write facts about the model here (JSON)");
  app.add_option("--view", a.view,
                 "Write a page (.html) here that shows spheres, edges, bridges and cells of each "
                 "level in a browser");
  begin_group(app, "Model");
  app.add_option("--mesh", a.mesh, "Refuse the packing unless it was made of this mesh")
      ->option_text("MESH");
  app.add_option(
         "--epsilon", a.options.epsilon,
         "Join spheres whose gap is at most this, metres; a tenth of the smallest radius if "
         "not given")
      ->check(positive_number())
      ->option_text("E");
  app.add_option("--levels", a.options.levels,
                 "Make further levels of detail with these sphere counts, e.g. 250,1000,4000")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(whole_number_in(1, std::numeric_limits<std::uint32_t>::max()))
      ->option_text("N,N,...");
  app.add_flag("--calibrate", a.calibrate,
               "Measure each level's error against the solid and keep it in the model, for "
               "vpm-query --max-error");
  app.add_flag("--no-surface", a.no_surface,
               "Leave the solid's surface out of the model, which then is smaller but cannot be "
               "measured against solids");
}

// Returns the options by which vpm-pack read the mesh, so that reading it again gives the same
// solid.
SolidOptions options_of(const nlohmann::json& provenance, const std::string& packing) {
  SolidOptions options;
  const auto number = [&](const char* key) -> std::optional<double> {
    const nlohmann::json::json_pointer at(std::string("/parameters/") + key);
    if (!provenance.contains(at)) return std::nullopt;
    if (!provenance.at(at).is_number())
      refuse(packing + ": says that it was packed with " + key + " " + provenance.at(at).dump() +
             ", which is no number; pack the mesh again, or leave --mesh out");
    return provenance.at(at).get<double>();
  };
  options.scale = number("scale").value_or(1);
  options.weld = number("weld");
  options.max_hole = number("max-hole");
  const nlohmann::json::json_pointer repair("/parameters/repair");
  if (provenance.contains(repair) && provenance.at(repair).is_string())
    parse_repair(provenance.at(repair).get<std::string>(), options);
  return options;
}

void check_mesh(const Packing& packing, const Arguments& a) {
  const nlohmann::json::json_pointer node_at("/parameters/node");
  const bool has_node = packing.provenance.json().contains(node_at) &&
                        packing.provenance.json().at(node_at).is_string();
  const std::string node = has_node ? packing.provenance.json().at(node_at).get<std::string>() : "";
  const RawMesh mesh = parse_mesh(file::read_all(a.mesh), a.mesh, node);
  const std::string expected = content_hash(packing.solid);
  const std::string found =
      content_hash(make_solid(mesh, options_of(packing.provenance.json(), a.packing)).solid);
  if (found != expected) {
    refuse(a.packing + " was not made of " + a.mesh + ": their solids have the hashes " + expected +
           " and " + found + "; pack this mesh, or leave --mesh out");
  }
}

void run(const Program& program, Arguments& a) {
  if (a.packing == "-" && a.mesh == "-") {
    throw Error(ErrorKind::invalid_argument,
                "only one of the packing and --mesh can be standard input");
  }
  check_files({a.packing, a.mesh},
              {{"--output", a.output, file::Kind::tool_model},
               {"--report", a.report, std::nullopt, OutputForm::json},
               {"--view", a.view, std::nullopt, OutputForm::page}},
              program.common());
  if (!a.view.empty()) view::check_available();
  const Packing packing = read_packing(a.packing);
  if (!a.mesh.empty()) check_mesh(packing, a);
  const std::size_t spheres = packing.spheres.size();
  if (std::ranges::any_of(a.options.levels, [&](std::uint32_t n) { return n > spheres; }))
    program.note("--levels: the packing has " + std::to_string(spheres) +
                 " spheres; larger levels are left out");

  Progress progress("levels", program.common());
  a.options.progress = [&](double fraction) { progress.update(fraction); };
  a.options.surface = !a.no_surface;
  std::vector<VoronoiQuality> quality;
  const auto start = std::chrono::steady_clock::now();
  ToolModel model = build_tool_model(packing, a.options, &quality);
  if (a.calibrate) model.calibration = calibrate(model, packing.solid);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  if (a.options.surface && model.surface.triangles.empty())
    program.warn(a.packing +
                 ": the pieces of its crossing surface do not close, so the model keeps none and "
                 "cannot be measured against solids; pack the mesh with --repair voxel for that");
  model.provenance.json() = {{"tool", program.name()},
                             {"version", VPM_VERSION},
                             {"parameters", program.parameters()},
                             {"packing", packing.provenance.json()}};
  const Solid mesh = view::simplified(packing.solid, view::kMostTriangles);
  write_tool_model(a.output, model, mesh);
  if (!a.view.empty()) write_model_view(a.view, a.packing, model, mesh);
  if (!a.report.empty()) {
    file::write_all(a.report, graph_report(model, quality, seconds.count()).dump(2) + "\n");
  }
}

}  // namespace
}  // namespace vpm::tools

int main(int argc, char** argv) {
  using namespace vpm::tools;
  Program program("vpm-graph", "Make a tool model for penetration queries from a sphere packing");
  Arguments arguments;
  declare(program.app(), arguments);
  program.show_examples({
      "vpm-graph tool.vpmp -o tool.vpmg",
      "vpm-graph tool.vpmp -o levels.vpmg --levels 30,100 --calibrate   # for --max-error",
      "vpm-graph tool.vpmp -o seen.vpmg --mesh tool.off --view graph.html   # to look at",
  });
  return program.run(argc, argv, [&] { run(program, arguments); });
}
