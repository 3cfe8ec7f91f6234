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
#include "libvpm/view/pose_view.h"
#include "tools/common/error_text.h"
#include "tools/common/mesh_tool.h"
#include "tools/common/recorded_frames.h"
#include "tools/query/cloud_scene.h"
#include "tools/query/contact_lines.h"
#include "tools/query/mode.h"
#include "tools/query/query_report.h"
#include "tools/query/result_output.h"
#include "tools/query/robot_joints.h"

namespace vpm::tools {
namespace {

// Links are packed with as many spheres as a mesh of --tool is; solids of a scene, and pages
// without a scene, ask for none.
constexpr unsigned kSpheres = 1000, kSpheresForSolids = 1;

// What is known of a link at a configuration: its pose, and what it has in the scene and shares
// with other links.
using LinkAnswer = view::PoseView::Answer;

nlohmann::ordered_json seven_of(const Pose& pose) {
  const auto& [x, y, z] = pose.translation;
  const Quaternion q = quaternion_from_rotation(pose.rotation);
  return {x, y, z, q.x, q.y, q.z, q.w};
}

// A robot whose links with geometry are ready to be asked; numbers of links are the robot's.
class ReadyRobot {
 public:
  ReadyRobot(const Program& program, const Arguments& a)
      : files_(read_robot_files(program, a.urdf, {.package_path = a.packages}, a.srdf)),
        options_{.with_force = a.contacts > 0, .contacts = static_cast<std::uint32_t>(a.contacts)} {
    const bool are_tools = !a.solids.empty() || !a.view.empty();
    const unsigned spheres = !a.clouds.empty() ? kSpheres : are_tools ? kSpheresForSolids : 0;
    for (std::size_t k = 0; k < robot().links.size(); ++k) {
      if (robot().links[k].shapes.empty()) continue;
      LinkBodies bodies = bodies_of_link(program, robot(), k, options_.with_force, spheres);
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
  // Returns the paths of the meshes that the URDF names.
  std::vector<std::string> meshes() const {
    std::vector<std::string> paths;
    for (const RobotLink& link : robot().links)
      for (const CollisionShape& shape : link.shapes)
        if (!shape.mesh.empty()) paths.push_back(shape.mesh);
    return paths;
  }

  // Adds what pairs of links share at the links' poses to a line and to the links' answers.
  void add_shared(std::vector<LinkAnswer>& answers, nlohmann::ordered_json& line) {
    double sum = 0;
    nlohmann::ordered_json shared = nlohmann::ordered_json::array();
    for (Pair& pair : pairs_) {
      const Overlap found = overlap_of(pair, answers[pair.first].pose, answers[pair.second].pose);
      if (found.volume <= 0) continue;
      sum += found.volume;
      nlohmann::ordered_json& told = shared.emplace_back();
      told["links"] = {name(pair.first), name(pair.second)};
      told["volume"] = found.volume;
      if (options_.contacts > 0) told["contacts"] = contacts_of_pair(found.contacts, 1);
      add_to(answers[pair.first], found, 1, solids_[pair.first].volume());
      add_to(answers[pair.second], found, -1, solids_[pair.second].volume());
    }
    line["self_volume"] = sum;
    line["self"] = std::move(shared);
  }

 private:
  struct Pair {
    std::size_t first, second;  // among links_
    OverlapQuery query;
  };

  Overlap overlap_of(Pair& pair, const Pose& a, const Pose& b) const {
    const SolidBody &first = solids_[pair.first], &second = solids_[pair.second];
    const double distance = norm(a * first.center_of_mass() - b * second.center_of_mass());
    if (distance > first.radius() + second.radius()) return {};
    return pair.query.run(a, b);
  }

  // Adds to the answer of one of two links the volume that both share, and their contacts. These
  // have normals out of the first link of the pair: `sign` is 1 for that and -1 for the second.
  // `volume` is that of the link, m^3.
  static void add_to(LinkAnswer& answer, const Overlap& found, double sign, double volume) {
    answer.result.volume += found.volume;
    answer.result.volume_fraction += found.volume / volume;
    for (Contact contact : found.contacts) {
      contact.normal = sign * contact.normal;
      answer.contacts.push_back(contact);
    }
  }

  void add_pairs() {
    for (std::size_t i = 0; i < links_.size(); ++i)
      for (std::size_t j = i + 1; j < links_.size(); ++j) {
        const std::array<std::size_t, 2> pair{links_[i], links_[j]};
        if (std::ranges::binary_search(files_.ignored, pair)) continue;
        pairs_.push_back({i, j, OverlapQuery(solids_[i], solids_[j], options_)});
      }
  }

  RobotOfFiles files_;
  OverlapOptions options_;
  std::vector<std::size_t> links_;
  std::vector<SolidBody> solids_;
  std::vector<Tool> tools_;
  std::vector<Pair> pairs_;
};

// The scene that links are asked about.
class SceneOfLinks {
 public:
  SceneOfLinks(QuerySetup& setup, const Pose& first)
      : scene_(setup),
        query_(setup.tools, setup.options, setup.level, scene_.scene(), first),
        tells_contacts_(setup.arguments.contacts > 0),
        is_shown_(setup.view.has_value()) {}

  // Adds what the scene gives for each link to its answer and to a line, and to the line the sum of
  // all, whose torque is about the origin.
  void ask(const std::vector<Tool>& tools, std::vector<LinkAnswer>& answers,
           nlohmann::ordered_json& line) {
    double volume = 0;
    Vec3 force, torque;
    for (std::size_t k = 0; k < tools.size(); ++k) {
      const auto& [pose, result, states, contacts] = answers[k] = answer(k, answers[k].pose);
      scene_.see(pose, k, result);
      add_measures(line["links"][k], result);
      if (tells_contacts_) line["links"][k]["contacts"] = contacts_of_pose(contacts);
      volume += result.volume;
      force += result.wrench.force;
      torque += result.wrench.torque + cross(pose * tools[k].center_of_mass(), result.wrench.force);
    }
    line["volume"] = volume;
    line["force"] = as_json(force);
    line["torque"] = as_json(torque);
  }

  std::uint32_t level(std::size_t link) const { return query_.level(link); }
  void warn_at_end() const { scene_.warn_at_end(); }

 private:
  LinkAnswer answer(std::size_t k, const Pose& pose) {
    LinkAnswer answer{pose, query_.run(scene_.scene(), pose, k), {}, query_.contacts(k)};
    if (!is_shown_) return answer;  // a device would have to fetch the states
    for (const SphereState state : query_.states(k))
      answer.states.push_back(static_cast<std::uint8_t>(state));
    return answer;
  }

  CloudScene scene_;
  LevelQuery query_;
  bool tells_contacts_, is_shown_;
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
      for (const auto& [field, place] : {std::pair{"volume", "volume"},
                                         {"pose", "pose"},
                                         {"contacts", "contacts"},
                                         {"volume_low", "volume_interval/0"},
                                         {"volume_high", "volume_interval/1"}})
        add(links[k] + "_" + field, "/links/" + std::to_string(k) + "/" + place);
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

void note_missing(const Program& program, const std::set<std::string>& missing) {
  if (missing.empty()) return;
  program.note("joints that a line does not name are at 0: " +
               file::listed({missing.begin(), missing.end()}));
}

// Says which joints are beyond their limits, each once.
class JointRemarks {
 public:
  JointRemarks(const Program& program, const Robot& robot) : program_(program), robot_(robot) {}

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

// Asks a robot, alone or in a scene, at configurations, and writes their lines.
class RobotQueries {
 public:
  // `base` maps the robot's root to the world.
  RobotQueries(const Program& program, const Arguments& arguments, ReadyRobot& robot,
               const Pose& base)
      : arguments_(arguments),
        robot_(robot),
        base_(base),
        setup_(program, arguments, robot.tools(), robot.names()),
        columns_(robot.names()),
        remarks_(program, robot.robot()),
        output_(program, arguments, columns_.all(), robot.meshes()) {}

  // Asks those that no run before has told.
  void ask_all(const std::vector<Configuration>& asked) {
    if (!arguments_.clouds.empty() || !arguments_.solids.empty())
      scene_ = std::make_unique<SceneOfLinks>(setup_, answers_at(asked.front()).front().pose);
    for (std::size_t n = output_.pass_over(1); n < asked.size(); ++n) ask(n, asked[n]);
    output_.finish();
    if (scene_) scene_->warn_at_end();
    if (setup_.view) setup_.view->write(arguments_.view);
    setup_.program.note(
        "configurations: " + std::to_string(asked.size()) + ", at " + std::to_string(shared_) +
        " of which links share volume; pairs of links: " + std::to_string(robot_.pairs()));
  }

  // True if a line is above --fail-above.
  bool any_above() const { return any_above_; }

 private:
  std::vector<LinkAnswer> answers_at(const Configuration& configuration) const {
    const std::vector<Pose> poses = link_poses(robot_.robot(), configuration.values, base_);
    std::vector<LinkAnswer> answers;
    for (const std::size_t link : robot_.links()) answers.push_back({poses[link], {}, {}, {}});
    return answers;
  }

  void ask(std::size_t n, const Configuration& configuration) {
    nlohmann::ordered_json line{{"configuration", n}};
    if (!configuration.id.empty()) line["id"] = nlohmann::ordered_json::parse(configuration.id);
    std::vector<LinkAnswer> answers = answers_at(configuration);
    for (std::size_t k = 0; k < answers.size(); ++k)
      line["links"].push_back({{"link", robot_.name(k)}, {"pose", seven_of(answers[k].pose)}});
    if (scene_) scene_->ask(robot_.tools(), answers, line);
    robot_.add_shared(answers, line);
    remarks_.add_beyond(configuration, line);
    if (arguments_.fail_above && is_above(*arguments_.fail_above, line)) any_above_ = true;
    if (!line["self"].empty()) ++shared_;
    output_.append(line);
    if (setup_.view) show(std::move(answers));
  }

  void show(std::vector<LinkAnswer> answers) {
    for (std::uint32_t k = 0; k < answers.size(); ++k) {
      const Job job{answers[k].pose, k, {}};
      view::PoseView::of(*setup_.view)
          .add(job, std::move(answers[k]), scene_ ? scene_->level(k) : 0);
    }
  }

  const Arguments& arguments_;
  ReadyRobot& robot_;
  Pose base_;
  QuerySetup setup_;
  Columns columns_;
  JointRemarks remarks_;
  ResultOutput output_;
  std::unique_ptr<SceneOfLinks> scene_;  // null without bodies
  std::size_t shared_ = 0;               // configurations at which links share volume
  bool any_above_ = false;
};

}  // namespace

void run_robot(Program& program, const Arguments& a) {
  ReadyRobot robot(program, a);
  double deviation = 0;
  const Pose base = a.pose.empty()
                        ? Pose{}
                        : naming("--pose", [&] { return pose_from_text(a.pose, &deviation); });
  std::set<std::string> missing;
  const std::vector<Configuration> asked = read_configurations(a.joints, robot.robot(), missing);
  note_missing(program, missing);
  RobotQueries queries(program, a, robot, base);
  queries.ask_all(asked);
  note_deviation(program, "", deviation);
  if (queries.any_above()) program.end_with(10);
}

}  // namespace vpm::tools
