#include "tools/bench/sweeps.h"

#include <utility>

#include "libvpm/query/tool_query.h"

namespace vpm::bench {
namespace {

// Offset from the optical axis, so that no symmetry hides an error, m.
constexpr Vec3 kStartAside{0.012, -0.007, 0};

std::string to_text(Measure measure) {
  return measure == Measure::paper ? "paper" : "refined";
}

}  // namespace

std::vector<SweepCase> paper_cases() {
  std::vector<SweepCase> cases;
  for (const char* scene : {"wall", "inverted-ball"})
    for (const char* shape : {"cube", "tetrahedron", "octahedron"})
      cases.push_back({"paper", shape, scene, {}});
  return cases;
}

std::vector<SweepCase> turned_cases() {
  std::vector<SweepCase> cases;
  for (const char* scene : {"tilted-wall", "inverted-ball", "ball", "groove"})
    for (const char* shape : {"cube", "tetrahedron", "octahedron", "torus"})
      cases.push_back({"turned", shape, scene, turned()});
  return cases;
}

std::vector<SweepCase> all_cases() {
  std::vector<SweepCase> cases;
  for (const char* scene : {"tilted-wall", "inverted-ball", "ball", "groove", "step", "plate"}) {
    for (const char* shape : {"cube", "tetrahedron", "octahedron", "torus", "twisted-torus"}) {
      cases.push_back({"all", shape, scene, {}});
      cases.push_back({"all", shape, scene, turned()});
    }
  }
  return cases;
}

Sweeps::Sweeps(ToolOf tool, std::uint64_t noise_seed, Shadows shadows, const Device& device,
               Report& report)
    : tool_(std::move(tool)),
      noise_seed_(noise_seed),
      shadows_(shadows),
      device_(device),
      report_(report) {
  report_.table.columns = {
      "group",    "shape",       "scene",   "noise",         "measure",       "pose",
      "z",        "volume_true", "volume",  "force_true_x",  "force_true_y",  "force_true_z",
      "force_x",  "force_y",     "force_z", "torque_true_x", "torque_true_y", "torque_true_z",
      "torque_x", "torque_y",    "torque_z"};
}

const View& Sweeps::view(const synthetic::Scene& scene, CloudKind kind, Noise noise) {
  const std::array<std::string, 3> key{scene.name, bench::to_text(kind), bench::to_text(noise)};
  const auto found = views_.find(key);
  if (found != views_.end()) return found->second;
  return views_.try_emplace(key, make_view(scene, kind, noise, noise_seed_)).first->second;
}

std::vector<Unseen> Sweeps::unseen_along(const PackedSolid& tool, const std::vector<Pose>& poses,
                                         const synthetic::Scene& scene, CloudKind kind) {
  std::vector<Sight> sights;
  for (const Camera& camera : view(scene, kind, Noise::none).cameras)
    sights.emplace_back(*scene.surface, camera);
  std::vector<Unseen> unseen;
  unseen.reserve(poses.size());
  for (const Pose& pose : poses)
    unseen.push_back(unseen_parts(tool.places, pose, *scene.surface, sights));
  return unseen;
}

void Sweeps::run(const SweepCase& c, const SweepSettings& settings) {
  const synthetic::Scene scene = synthetic::make_scene(c.scene);
  const PackedSolid& tool = tool_(c.shape);
  Path path;
  path.poses = c.group == "all" ? make_sweep(tool.solid, {c.rotation, kStartAside}, *scene.surface,
                                             settings.poses)
                                : make_path(tool.solid, c.rotation, *scene.surface, settings.poses);
  path.truth = truth_along(tool.solid, path.poses, *scene.surface);
  for (const CloudKind kind : settings.kinds) {
    const auto unseen = unseen_along(tool, path.poses, scene, kind);
    for (const Noise noise : {Noise::none, Noise::kinect})
      for (const std::uint32_t spheres : settings.spheres)
        for (const Measure m : {Measure::paper, Measure::refined})
          measure(c, path, unseen, kind, noise, m, spheres);
  }
}

void Sweeps::measure(const SweepCase& c, const Path& path, const std::vector<Unseen>& unseen,
                     CloudKind kind, Noise noise, Measure measure, std::uint32_t spheres) {
  const PackedSolid& tool = tool_(c.shape);
  const View& seen = view(synthetic::make_scene(c.scene), kind, noise);
  ToolQuery query(tool.model, {.measure = measure,
                               .level = spheres,
                               .device = device_for(measure, device_),
                               .shadows = measure == Measure::refined ? shadows_ : Shadows::near});
  std::vector<Result> measured;
  for (const Pose& pose : path.poses) measured.push_back(query.run(seen.cloud, pose));
  const Errors errors = compare(measured, path.truth, unseen, tool.solid);
  nlohmann::json result = to_json(errors);
  result.update({{"group", c.group},
                 {"shape", c.shape},
                 {"scene", c.scene},
                 {"turned", !(c.rotation.row0 == Vec3{1, 0, 0})},
                 {"cloud", bench::to_text(kind)},
                 {"noise", bench::to_text(noise)},
                 {"measure", to_text(measure)},
                 {"spheres", spheres}});
  report_.results.push_back(std::move(result));
  groups_[{c.group, bench::to_text(kind), bench::to_text(noise), to_text(measure),
           std::to_string(spheres)}]
      .add(errors);
  if (c.group != "all") add_rows(c, noise, to_text(measure), path, measured);
}

void Sweeps::add_rows(const SweepCase& c, Noise noise, const std::string& measure, const Path& path,
                      const std::vector<Result>& measured) {
  for (std::size_t k = 0; k < path.poses.size(); ++k) {
    std::vector<Table::Value> row{c.group,
                                  c.shape,
                                  c.scene,
                                  bench::to_text(noise),
                                  measure,
                                  static_cast<double>(k),
                                  path.poses[k].translation.z,
                                  path.truth[k].volume,
                                  measured[k].volume};
    for (const Vec3 v : {path.truth[k].force, measured[k].wrench.force, path.truth[k].torque,
                         measured[k].wrench.torque})
      row.insert(row.end(), {v.x, v.y, v.z});
    report_.table.rows.push_back(std::move(row));
  }
}

}  // namespace vpm::bench
