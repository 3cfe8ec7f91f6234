// Both measures against the truth: the six cases of the paper (cube, tetrahedron, octahedron into a
// wall and into an inverted sphere, moved along z), and turned tools in four other scenes.

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>

#include "libvpm/cloud/normals.h"
#include "libvpm/query/query.h"
#include "libvpm/synthetic/kinect_noise.h"
#include "tools/bench/penetration_case.h"
#include "tools/bench/statistics.h"
#include "tools/bench/suite.h"

namespace vpm::bench {
namespace {

constexpr std::uint64_t kNoiseSeed = 1;

// A force direction means something from this part of the tool's volume on.
constexpr double kForceMatters = 0.01;

struct Settings {
  std::size_t spheres;
  int poses;
};

struct Case {
  std::string group, shape, scene;
  Rotation rotation;
};

std::vector<Case> make_cases(bool quick) {
  const Rotation turned = rotation_from_quaternion({0.18, -0.37, 0.29, std::sqrt(1 - 0.2534)});
  std::vector<Case> cases;
  for (const char* scene : {"wall", "inverted-ball"})
    for (const char* shape : {"cube", "tetrahedron", "octahedron"})
      cases.push_back({"paper", shape, scene, {}});
  if (quick) return cases;
  for (const char* scene : {"tilted-wall", "inverted-ball", "ball", "groove"})
    for (const char* shape : {"cube", "tetrahedron", "octahedron", "torus"})
      cases.push_back({"turned", shape, scene, turned});
  return cases;
}

// Errors relative to the tool's volume (torque: times its reach), angles in degrees.
struct Errors {
  MeanAndWorst volume, jump, force, direction, torque;
};

double angle_degrees(Vec3 a, Vec3 b) {
  return std::atan2(norm(cross(a, b)), dot(a, b)) * 180 / kPi;
}

Errors compare(const std::vector<Result>& measured,
               const std::vector<synthetic::Penetration>& truth, const synthetic::TrueSolid& tool) {
  Errors errors;
  const double volume = tool.mass().volume;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const Vec3 force = measured[k].wrench.force, torque = measured[k].wrench.torque;
    errors.volume.add(std::abs(measured[k].volume - truth[k].volume) / volume);
    errors.force.add(norm(force - truth[k].force) / volume);
    errors.torque.add(norm(torque - truth[k].torque) / (volume * tool.reach()));
    if (norm(truth[k].force) > kForceMatters * volume)
      errors.direction.add(angle_degrees(force, truth[k].force));
    if (k == 0) continue;
    const double step = std::abs(measured[k].volume - measured[k - 1].volume);
    const double true_step = std::abs(truth[k].volume - truth[k - 1].volume);
    errors.jump.add(std::max(step - true_step, 0.0) / volume);
  }
  return errors;
}

nlohmann::json to_json(const Errors& e) {
  return {{"volume_mean", e.volume.mean()},
          {"volume_worst", e.volume.worst()},
          {"jump_worst", e.jump.worst()},
          {"force_mean", e.force.mean()},
          {"force_worst", e.force.worst()},
          {"direction_mean_degrees", e.direction.mean()},
          {"direction_worst_degrees", e.direction.worst()},
          {"torque_mean", e.torque.mean()},
          {"torque_worst", e.torque.worst()}};
}

// Mean of means and worst of worsts over the cases of a group.
struct GroupErrors {
  MeanAndWorst mean, worst, jump, direction, torque;
  void add(const Errors& e) {
    mean.add(e.volume.mean());
    worst.add(e.volume.worst());
    jump.add(e.jump.worst());
    direction.add(e.direction.mean());
    torque.add(e.torque.mean());
  }
};

class Accuracy {
 public:
  Accuracy(const SuiteOptions& options)
      : options_(options), settings_(options.quick ? Settings{250, 15} : Settings{1000, 60}) {
    report_.suite = "accuracy";
    report_.settings = {{"quick", options.quick},
                        {"spheres", settings_.spheres},
                        {"poses", settings_.poses},
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
    const std::vector<Case> cases = make_cases(options_.quick);
    for (std::size_t k = 0; k < cases.size(); ++k) {
      if (options_.progress)
        options_.progress(static_cast<double>(k) / static_cast<double>(cases.size()));
      run_case(cases[k]);
    }
    summarise();
    return std::move(report_);
  }

 private:
  struct Tool {
    synthetic::TrueSolid solid;
    ToolModel model;
  };
  const Tool& tool(const std::string& shape) {
    const auto found = tools_.find(shape);
    if (found != tools_.end()) return found->second;
    const Solid solid = make_shape(shape);
    return tools_
        .try_emplace(shape, Tool{synthetic::TrueSolid(solid), make_tool(solid, settings_.spheres)})
        .first->second;
  }

  const PreparedCloud& cloud(const synthetic::Scene& scene, const std::string& noise) {
    const std::string key = scene.name + " " + noise;
    const auto found = clouds_.find(key);
    if (found != clouds_.end()) return found->second;
    const DepthImage depth = noise == "none" ? synthetic::render(*scene.surface, scene.camera)
                                             : synthetic::render_with_kinect_noise(
                                                   *scene.surface, scene.camera, kNoiseSeed);
    return clouds_.try_emplace(key, make_cloud(depth, scene.camera, NormalOptions{})).first->second;
  }

  void run_case(const Case& c) {
    const synthetic::Scene scene = synthetic::make_scene(c.scene);
    const Tool& t = tool(c.shape);
    const std::vector<Pose> path = make_path(t.solid, c.rotation, *scene.surface, settings_.poses);
    const auto truth = truth_along(t.solid, path, *scene.surface);
    for (const char* noise : {"none", "kinect"}) {
      for (const Measure measure : {Measure::paper, Measure::refined}) {
        QueryOptions query_options;
        query_options.measure = measure;
        Query query(t.model, query_options);
        std::vector<Result> measured;
        for (const Pose& pose : path) measured.push_back(query.run(cloud(scene, noise), pose));
        record(c, noise, measure == Measure::paper ? "paper" : "refined", path, measured, truth);
      }
    }
  }

  void record(const Case& c, const std::string& noise, const std::string& measure,
              const std::vector<Pose>& path, const std::vector<Result>& measured,
              const std::vector<synthetic::Penetration>& truth) {
    const Errors errors = compare(measured, truth, tool(c.shape).solid);
    nlohmann::json result = to_json(errors);
    result.update({{"group", c.group},
                   {"shape", c.shape},
                   {"scene", c.scene},
                   {"noise", noise},
                   {"measure", measure}});
    report_.results.push_back(result);
    groups_[{c.group, noise, measure}].add(errors);
    for (std::size_t k = 0; k < path.size(); ++k) {
      const Vec3 f = truth[k].force, g = measured[k].wrench.force, t = truth[k].torque,
                 u = measured[k].wrench.torque;
      report_.table.rows.push_back({c.group,
                                    c.shape,
                                    c.scene,
                                    noise,
                                    measure,
                                    static_cast<double>(k),
                                    path[k].translation.z,
                                    truth[k].volume,
                                    measured[k].volume,
                                    f.x,
                                    f.y,
                                    f.z,
                                    g.x,
                                    g.y,
                                    g.z,
                                    t.x,
                                    t.y,
                                    t.z,
                                    u.x,
                                    u.y,
                                    u.z});
    }
  }

  void summarise() {
    report_.summary =
        "Errors in % of the tool's volume (torque: of volume times reach)\n"
        "group   noise   measure   volume mean   worst    jump   torque mean   force direction\n";
    for (const auto& [key, e] : groups_) {
      char line[160];
      std::snprintf(
          line, sizeof line, "%-7s %-7s %-9s %10.3f %% %5.2f %% %5.2f %% %11.3f %% %12.2f deg\n",
          key[0].c_str(), key[1].c_str(), key[2].c_str(), 100 * e.mean.mean(),
          100 * e.worst.worst(), 100 * e.jump.worst(), 100 * e.torque.mean(), e.direction.mean());
      report_.summary += line;
      report_.settings["summary"].push_back({{"group", key[0]},
                                             {"noise", key[1]},
                                             {"measure", key[2]},
                                             {"volume_mean", e.mean.mean()},
                                             {"volume_worst", e.worst.worst()},
                                             {"jump_worst", e.jump.worst()},
                                             {"torque_mean", e.torque.mean()},
                                             {"direction_mean_degrees", e.direction.mean()}});
    }
  }

  const SuiteOptions& options_;
  Settings settings_;
  Report report_;
  std::map<std::string, Tool> tools_;
  std::map<std::string, PreparedCloud> clouds_;
  std::map<std::array<std::string, 3>, GroupErrors> groups_;
};

}  // namespace

Report run_accuracy(const SuiteOptions& options) {
  return Accuracy(options).run();
}

}  // namespace vpm::bench
