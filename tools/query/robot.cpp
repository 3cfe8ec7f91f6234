// Mode of vpm-query that asks the links of a robot at configurations of its joints.
#include <vpm/robot.h>
#include <vpm/solid.h>

#include <algorithm>
#include <cstdio>
#include <deque>
#include <memory>
#include <set>
#include <utility>

#include "libvpm/core/pose.h"
#include "libvpm/file/text.h"
#include "libvpm/model/solid.h"
#include "tools/common/error_text.h"
#include "tools/common/mesh_tool.h"
#include "tools/common/recorded_frames.h"
#include "tools/query/cloud_scene.h"
#include "tools/query/mode.h"
#include "tools/query/query_report.h"
#include "tools/query/result_output.h"
#include "tools/query/robot_joints.h"

namespace vpm::tools {
namespace {

// Links are packed with as many spheres as a mesh of --tool is; solids of a scene ask for none.
constexpr unsigned kSpheres = 1000, kSpheresForSolids = 1;

nlohmann::ordered_json seven_of(const Pose& pose) {
  const auto& [x, y, z] = pose.translation;
  const Quaternion q = quaternion_from_rotation(pose.rotation);
  return {x, y, z, q.x, q.y, q.z, q.w};
}

// A robot whose links with geometry are ready to be asked; numbers of links are the robot's.
class ReadyRobot {
 public:
  ReadyRobot(const Program& program, const Arguments& a)
      : files_(read_robot_files(program, a.urdf, {.package_path = a.packages}, a.srdf)) {
    const bool has_scene = !a.clouds.empty() || !a.solids.empty();
    const unsigned spheres = !has_scene ? 0 : a.clouds.empty() ? kSpheresForSolids : kSpheres;
    for (std::size_t k = 0; k < robot().links.size(); ++k) {
      if (robot().links[k].shapes.empty()) continue;
      LinkBodies bodies = bodies_of_link(program, robot(), k, spheres);
      links_.push_back(k);
      solids_.push_back(std::move(bodies.solid));
      if (bodies.tool) tools_.push_back(std::move(*bodies.tool));
    }
    add_pairs();
  }

  const Robot& robot() const { return files_.robot; }
  const std::vector<std::size_t>& links() const { return links_; }
  const std::vector<Tool>& tools() const { return tools_; }
  std::size_t pairs() const { return pairs_.size(); }
  const std::string& name(std::size_t k) const { return robot().links[links_[k]].name; }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (std::size_t k = 0; k < links_.size(); ++k) all.push_back(name(k));
    return all;
  }

  // Adds to a line what pairs of links share at poses of all links.
  void add_shared(const std::vector<Pose>& poses, nlohmann::ordered_json& line) {
    double sum = 0;
    nlohmann::ordered_json shared = nlohmann::ordered_json::array();
    for (Pair& pair : pairs_) {
      const Pose &a = poses[links_[pair.first]], &b = poses[links_[pair.second]];
      const SolidBody &first = solids_[pair.first], &second = solids_[pair.second];
      if (norm(a * first.center_of_mass() - b * second.center_of_mass()) >
          first.radius() + second.radius())
        continue;
      const double volume = pair.query.run(a, b).volume;
      if (volume <= 0) continue;
      sum += volume;
      shared.push_back({{"links", {name(pair.first), name(pair.second)}}, {"volume", volume}});
    }
    line["self_volume"] = sum;
    line["self"] = std::move(shared);
  }

 private:
  struct Pair {
    std::size_t first, second;  // among links_
    OverlapQuery query;
  };

  void add_pairs() {
    for (std::size_t i = 0; i < links_.size(); ++i)
      for (std::size_t j = i + 1; j < links_.size(); ++j) {
        const std::array<std::size_t, 2> pair{links_[i], links_[j]};
        if (std::ranges::binary_search(files_.ignored, pair)) continue;
        pairs_.push_back({i, j, OverlapQuery(solids_[i], solids_[j], {.with_force = false})});
      }
  }

  RobotOfFiles files_;
  std::vector<std::size_t> links_;
  std::vector<SolidBody> solids_;
  std::vector<Tool> tools_;
  std::vector<Pair> pairs_;
};

// The scene that links are asked about.
class SceneOfLinks {
 public:
  SceneOfLinks(QuerySetup& setup, const Pose& first)
      : scene_(setup), query_(setup.tools, setup.options, setup.level, scene_.scene(), first) {}

  // Adds to a line what the scene gives for each link, and the sum of all, whose torque is about
  // the origin.
  void ask(const std::vector<Tool>& tools, const std::vector<Pose>& poses,
           nlohmann::ordered_json& line) {
    double volume = 0;
    Vec3 force, torque;
    for (std::size_t k = 0; k < tools.size(); ++k) {
      const Result result = query_.run(scene_.scene(), poses[k], k);
      scene_.see(poses[k], k, result);
      add_measures(line["links"][k], result);
      volume += result.volume;
      force += result.wrench.force;
      torque +=
          result.wrench.torque + cross(poses[k] * tools[k].center_of_mass(), result.wrench.force);
    }
    line["volume"] = volume;
    line["force"] = as_json(force);
    line["torque"] = as_json(torque);
  }

  void warn_at_end() const { scene_.warn_at_end(); }

 private:
  CloudScene scene_;
  LevelQuery query_;
};

// The columns of CSV: of all, then of each link and of each pair that may be told. Their texts live
// as long as this does.
class Columns {
 public:
  explicit Columns(const std::vector<std::string>& links) {
    for (const auto& [name, place] : {std::pair{"configuration", "/configuration"},
                                      {"id", "/id"},
                                      {"volume", "/volume"},
                                      {"force_x", "/force/0"},
                                      {"force_y", "/force/1"},
                                      {"force_z", "/force/2"},
                                      {"torque_x", "/torque/0"},
                                      {"torque_y", "/torque/1"},
                                      {"torque_z", "/torque/2"},
                                      {"self_volume", "/self_volume"},
                                      {"self", "/self"},
                                      {"beyond_limits", "/beyond_limits"},
                                      {"above", "/above"}})
      columns_.push_back({name, place});
    for (std::size_t k = 0; k < links.size(); ++k)
      for (const char* const field : {"volume", "pose"})
        add(links[k] + "_" + field, "/links/" + std::to_string(k) + "/" + field);
  }

  std::span<const CsvColumn> all() const { return columns_; }

 private:
  void add(const std::string& name, const std::string& place) {
    texts_.push_back(name);
    const char* const kept = texts_.back().c_str();
    texts_.push_back(place);
    columns_.push_back({kept, texts_.back().c_str()});
  }

  std::deque<std::string> texts_;
  std::vector<CsvColumn> columns_;
};

// Says which joints have no value, and which are beyond their limits, each once.
class JointRemarks {
 public:
  JointRemarks(const Program& program, const Robot& robot) : program_(program), robot_(robot) {}

  void note_missing(const std::set<std::string>& missing) const {
    if (missing.empty()) return;
    program_.note("joints that a line does not name are at 0: " +
                  file::listed({missing.begin(), missing.end()}));
  }

  // Adds the joints beyond their limits to the line, and says so of each one once.
  void add_beyond(const Configuration& configuration, nlohmann::ordered_json& line) {
    for (const std::size_t k : beyond_limits(robot_, configuration.values)) {
      const RobotJoint& joint = robot_.joints[k];
      line["beyond_limits"].push_back(joint.name);
      if (!said_.insert(k).second) continue;
      char limits[80];
      std::snprintf(limits, sizeof limits, "%.6g to %.6g", joint.lower, joint.upper);
      program_.warn("configuration " + line["configuration"].dump() + ": joint '" +
                    file::shown(joint.name) + "' is beyond its limits, " + limits +
                    "; are values in radians and metres?");
    }
  }

 private:
  const Program& program_;
  const Robot& robot_;
  std::set<std::size_t> said_;
};

// Says that a line is above --fail-above, in one of its volumes. Returns whether it is.
bool is_above(double limit, nlohmann::ordered_json& line) {
  line["above"] = line.value("volume", 0.0) > limit || line["self_volume"].get<double>() > limit;
  return line["above"].get<bool>();
}

}  // namespace

void run_robot(Program& program, const Arguments& a) {
  ReadyRobot robot(program, a);
  double deviation = 0;
  const Pose base = a.pose.empty()
                        ? Pose{}
                        : naming("--pose", [&] { return pose_from_text(a.pose, &deviation); });
  std::set<std::string> missing;
  const std::vector<Configuration> asked = read_configurations(a.joints, robot.robot(), missing);
  JointRemarks remarks(program, robot.robot());
  remarks.note_missing(missing);
  QuerySetup setup(program, a, robot.tools(), robot.names());
  const auto poses_at = [&](const Configuration& configuration) {
    return link_poses(robot.robot(), configuration.values, base);
  };
  std::unique_ptr<SceneOfLinks> scene;
  if (!robot.tools().empty())
    scene = std::make_unique<SceneOfLinks>(setup, poses_at(asked.front())[robot.links().front()]);
  const Columns columns(robot.names());
  ResultOutput output(program, a, columns.all());
  std::size_t above = 0, shared = 0;
  for (std::size_t n = 0; n < asked.size(); ++n) {
    const std::vector<Pose> poses = poses_at(asked[n]);
    nlohmann::ordered_json line{{"configuration", n}};
    if (!asked[n].id.empty()) line["id"] = nlohmann::ordered_json::parse(asked[n].id);
    std::vector<Pose> of_links;
    for (std::size_t k = 0; k < robot.links().size(); ++k) {
      of_links.push_back(poses[robot.links()[k]]);
      line["links"].push_back({{"link", robot.name(k)}, {"pose", seven_of(of_links.back())}});
    }
    if (scene) scene->ask(robot.tools(), of_links, line);
    robot.add_shared(poses, line);
    remarks.add_beyond(asked[n], line);
    if (a.fail_above && is_above(*a.fail_above, line)) ++above;
    if (!line["self"].empty()) ++shared;
    output.append(line);
  }
  output.finish();
  note_deviation(program, "", deviation);
  if (scene) scene->warn_at_end();
  program.note(std::to_string(asked.size()) + " configurations, at " + std::to_string(shared) +
               " of which links share volume; " + std::to_string(robot.pairs()) +
               " pairs of links were asked");
  if (above > 0) program.end_with(10);
}

}  // namespace vpm::tools
