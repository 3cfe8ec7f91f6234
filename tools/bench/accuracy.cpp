// Both measures against the truth. The six cases of the paper (cube, tetrahedron, octahedron into a
// wall and into an inverted sphere, moved along z) and turned tools in four other scenes; with
// --all every tool, scene, kind of cloud and number of spheres, and more (accuracy_suites.h).

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>

#include "libvpm/cloud/normals.h"
#include "libvpm/query/query.h"
#include "tools/bench/errors.h"
#include "tools/bench/penetration_case.h"
#include "tools/bench/suite.h"
#include "tools/bench/view.h"

namespace vpm::bench {
namespace {

constexpr std::size_t kPlaces = 8192;  // of a tool, to count what cameras cannot know

struct Case {
  std::string group, shape, scene;
  Rotation rotation;
};

// What a case is run with: every combination.
struct Settings {
  std::vector<std::uint32_t> spheres;
  std::vector<CloudKind> kinds;
  int poses;
};

Rotation turned() {
  return rotation_from_quaternion({0.18, -0.37, 0.29, std::sqrt(1 - 0.2534)});
}

std::vector<Case> usual_cases(bool quick) {
  std::vector<Case> cases;
  for (const char* scene : {"wall", "inverted-ball"})
    for (const char* shape : {"cube", "tetrahedron", "octahedron"})
      cases.push_back({"paper", shape, scene, {}});
  if (quick) return cases;
  for (const char* scene : {"tilted-wall", "inverted-ball", "ball", "groove"})
    for (const char* shape : {"cube", "tetrahedron", "octahedron", "torus"})
      cases.push_back({"turned", shape, scene, turned()});
  return cases;
}

std::vector<Case> sweep_cases() {
  std::vector<Case> cases;
  for (const char* scene : {"tilted-wall", "inverted-ball", "ball", "groove", "step", "plate"}) {
    for (const char* shape : {"cube", "tetrahedron", "octahedron", "torus", "twisted-torus"}) {
      cases.push_back({"sweep", shape, scene, {}});
      cases.push_back({"sweep", shape, scene, turned()});
    }
  }
  return cases;
}

class Accuracy {
 public:
  Accuracy(const SuiteOptions& options)
      : options_(options) {
    report_.suite = "accuracy";
    report_.settings = {{"quick", options.quick},
                        {"all", options.all},
                        {"noise_seed", kNoiseSeed},
                        {"normals", to_text(NormalOptions{}.method)},
                        {"window", NormalOptions{}.window}};
    report_.table.columns = {
        "group",    "shape",       "scene",   "noise",         "measure",       "pose",
        "z",        "volume_true", "volume",  "force_true_x",  "force_true_y",  "force_true_z",
        "force_x",  "force_y",     "force_z", "torque_true_x", "torque_true_y", "torque_true_z",
        "torque_x", "torque_y",    "torque_z"};
  }

  Report run() {
    if (options_.all) {
      levels_ = {1000, 10000};
      run_cases(sweep_cases(), {{1000, 10000}, {CloudKind::camera, CloudKind::points}, 51});
    } else {
    levels_ = {options_.quick ? 250u : 1000u};
    run_cases(usual_cases(options_.quick), {levels_, {CloudKind::camera}, options_.quick ? 15 : 60});
    }
    summarise();
    return std::move(report_);
  }

 private:
  struct Tool {
    synthetic::TrueSolid solid;
    ToolModel model;
    std::vector<Vec3> places;
  };
  const Tool& tool(const std::string& shape) {
    const auto found = tools_.find(shape);
    if (found != tools_.end()) return found->second;
    const Solid solid = make_shape(shape);
    return tools_
        .try_emplace(shape, Tool{synthetic::TrueSolid(solid), make_tool(solid, levels_),
                                 places_in(solid, kPlaces)})
        .first->second;
  }

  const View& view(const synthetic::Scene& scene, CloudKind kind, Noise noise) {
    const std::array<std::string, 3> key{scene.name, to_text(kind), to_text(noise)};
    const auto found = views_.find(key);
    if (found != views_.end()) return found->second;
    return views_.try_emplace(key, make_view(scene, kind, noise)).first->second;
  }

  void run_cases(const std::vector<Case>& cases, const Settings& settings) {
    for (std::size_t k = 0; k < cases.size(); ++k) {
      if (options_.progress)
        options_.progress(static_cast<double>(k) / static_cast<double>(cases.size()));
      run_case(cases[k], settings);
    }
  }

  void run_case(const Case& c, const Settings& settings) {
    const synthetic::Scene scene = synthetic::make_scene(c.scene);
    const Tool& t = tool(c.shape);
    const std::vector<Pose> path = c.group == "sweep" ? make_sweep(t.solid, {c.rotation, {0.012, -0.007, 0}}, *scene.surface, settings.poses)
    : make_path(t.solid, c.rotation, *scene.surface, settings.poses);
    const auto truth = truth_along(t.solid, path, *scene.surface);
    for (const CloudKind kind : settings.kinds) {
      const auto unseen = unseen_along(t, path, scene, kind);
      for (const Noise noise : {Noise::none, Noise::kinect}) {
        for (const std::uint32_t spheres : settings.spheres) {
      for (const Measure measure : {Measure::paper, Measure::refined}) {
        QueryOptions query_options;
        query_options.measure = measure;
        query_options.level = spheres;
        Query query(t.model, query_options);
        std::vector<Result> measured;
        for (const Pose& pose : path) measured.push_back(query.run(view(scene, kind, noise).cloud, pose));
        const Errors errors = compare(measured, truth, unseen, t.solid);
        std::printf("%s %s %s %d %s %s %s %u | %.4f %.3f jump %.3f  dir %.2f %.2f (%d) tq %.3f %.3f\n", c.group.c_str(), c.shape.c_str(), c.scene.c_str(), c.rotation.row0.x!=1, to_text(kind).c_str(), to_text(noise).c_str(), measure==Measure::paper?"paper":"refined", spheres, 100*errors.volume.mean(), 100*errors.volume.worst(), 100*errors.jump.worst(), errors.direction.mean(), errors.direction.worst(), errors.direction.count(), 100*errors.torque.mean(), 100*errors.torque.worst());
        groups_[{c.group, to_text(kind), to_text(noise), measure==Measure::paper?"paper":"refined", std::to_string(spheres)}].add(errors);
      }
      }
      }
    }
  }

  std::vector<Unseen> unseen_along(const Tool& t, const std::vector<Pose>& path, const synthetic::Scene& scene, CloudKind kind) {
    std::vector<Sight> sights;
    for (const Camera& camera : view(scene, kind, Noise::none).cameras) sights.emplace_back(*scene.surface, camera);
    std::vector<Unseen> unseen;
    for (const Pose& pose : path) unseen.push_back(unseen_parts(t.places, pose, *scene.surface, sights));
    return unseen;
  }

  void summarise() {
    for (const auto& [key, e] : groups_) {
      char line[300];
      std::snprintf(
          line, sizeof line, "%-7s %-7s %-7s %-9s %6s %10.4f %% %6.3f %% %6.3f %% %7.3f %6.3f %% %8.3f %8.2f deg\n",
          key[0].c_str(), key[1].c_str(), key[2].c_str(), key[3].c_str(), key[4].c_str(), 100 * e.volume.mean(),
          100 * e.volume_worst.worst(), 100 * e.jump.worst(), 100 * e.torque.mean(), 100*e.torque_worst.worst(), e.direction.mean(), e.direction_worst.worst());
      report_.summary += line;
    }
  }

  const SuiteOptions& options_;
  std::vector<std::uint32_t> levels_;
  Report report_;
  std::map<std::string, Tool> tools_;
  std::map<std::array<std::string, 3>, View> views_;
  std::map<std::array<std::string, 5>, GroupErrors> groups_;
};

}  // namespace

Report run_accuracy(const SuiteOptions& options) {
  return Accuracy(options).run();
}

}  // namespace vpm::bench
