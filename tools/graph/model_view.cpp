#include "tools/graph/model_view.h"

#include "libvpm/view/page.h"

namespace vpm::tools {
namespace {

constexpr const char *kSolidColor = "#b08d57", *kEdgeColor = "#33445c", *kBridgeColor = "#d55e00";
constexpr std::size_t kMostSamples = 300'000;  // for all levels together

void add_graph(view::Page& page, const ToolModel& model, std::size_t k) {
  const Level& level = model.levels[k];
  std::vector<Vec3> edges, bridges;
  for (std::uint32_t i = 0; i < level.sphere_count; ++i) {
    for (std::uint32_t e = level.graph.begin[i]; e < level.graph.begin[i + 1]; ++e) {
      const std::uint32_t j = level.graph.neighbors[e];
      if (j < i) continue;
      const Sphere &a = model.spheres[i], &b = model.spheres[j];
      const double gap = norm(a.center - b.center) - a.radius - b.radius;
      std::vector<Vec3>& ends = gap > level.epsilon ? bridges : edges;
      ends.insert(ends.end(), {a.center, b.center});
    }
  }
  const std::size_t edge_count = edges.size() / 2, bridge_count = bridges.size() / 2;
  page.add_lines({.name = "edges",
                  .color = kEdgeColor,
                  .ends = std::move(edges),
                  .count = edge_count,
                  .above = true,
                  .step = k});
  if (bridge_count > 0)
    page.add_lines({.name = "bridges",
                    .color = kBridgeColor,
                    .ends = std::move(bridges),
                    .count = bridge_count,
                    .marks = true,
                    .above = true,
                    .step = k});
}

// Adds every n-th sample of each cell, so that a page stays small. Returns the number of the cells.
std::size_t add_cells(view::Page& page, const ToolModel& model, const Level& level,
                      std::size_t every) {
  std::vector<std::uint32_t> begin{0};
  std::vector<Vec3> samples;
  for (std::uint32_t i = 0; i < level.sphere_count; ++i) {
    for (std::uint32_t b = level.block_begin[i]; b < level.block_begin[i + 1]; ++b) {
      for (std::uint32_t s = level.blocks[b].begin; s < level.blocks[b].end; ++s) {
        if (s % every == 0)
          samples.push_back(model.center_of_mass + widen(level.samples[s].center));
      }
    }
    begin.push_back(static_cast<std::uint32_t>(samples.size()));
  }
  return page.add_cells(begin, samples);
}

void add_numbers(view::Page& page, const ToolModel& model) {
  view::Column spheres{"spheres", "", 1, {}}, edges{"edges", "", 1, {}},
      bridges{"bridges", "", 1, {}}, epsilon{"largest gap of an edge", "m", 1, {}},
      error{"mean error of the volume", "%", 1, {}};
  for (std::size_t k = 0; k < model.levels.size(); ++k) {
    const Level& level = model.levels[k];
    spheres.values.push_back(static_cast<float>(level.sphere_count));
    edges.values.push_back(static_cast<float>(level.graph.neighbors.size() / 2));
    bridges.values.push_back(static_cast<float>(level.bridges));
    epsilon.values.push_back(static_cast<float>(level.epsilon));
    if (!model.calibration.empty())
      error.values.push_back(static_cast<float>(100 * model.calibration[k].mean));
  }
  for (const view::Column* column : {&spheres, &edges, &bridges, &epsilon})
    page.add_column(*column);
  if (!error.values.empty()) page.add_column(error);
}

}  // namespace

void write_model_view(const std::string& path, const std::string& packing, const ToolModel& model,
                      const Solid& mesh) {
  view::Page page("vpm-graph", "tool model of " + view::shown_name(packing));
  page.set_origin(model.center_of_mass);
  std::size_t samples = 0;
  for (const Level& level : model.levels) samples += level.samples.size();
  const std::size_t every = samples / kMostSamples + 1;
  view::Json names = view::Json::array();
  for (std::size_t k = 0; k < model.levels.size(); ++k) {
    const Level& level = model.levels[k];
    const std::size_t cells = add_cells(page, model, level, every);
    page.add_spheres({.name = "spheres by radius",
                      .spheres = {model.spheres.data(), level.sphere_count},
                      .step = k,
                      .cells = cells});
    add_graph(page, model, k);
    names.push_back("level of " + std::to_string(level.sphere_count) + " spheres");
  }
  if (!mesh.triangles.empty())
    page.add_mesh({.name = "solid", .color = kSolidColor, .solid = &mesh, .opacity = 0.15});
  add_numbers(page, model);
  page.add_fact("packing", view::shown_name(packing));
  page.add_fact("volume", view::volume_text(model.volume));
  page.add_fact("cells", "click a sphere: the samples of its Voronoi cell");
  if (every > 1) page.add_fact("samples shown", "one in " + std::to_string(every));
  page.steps() = {{"name", "level"},
                  {"count", model.levels.size()},
                  {"start", model.levels.size() - 1},
                  {"names", std::move(names)}};
  page.set_views({"overview", "side"});
  page.write(path);
}

}  // namespace vpm::tools
