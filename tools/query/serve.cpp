// Mode of vpm-query that answers requests on standard input, one line for each, while tool, device
// and scene stay ready.
#include <vpm/error.h>
#include <vpm/level_query.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "libvpm/api/handle_access.h"
#include "libvpm/core/error.h"
#include "libvpm/file/json_text.h"
#include "libvpm/file/nearest_word.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"
#include "libvpm/import/import_cloud.h"
#include "libvpm/recording/pose_json.h"
#include "libvpm/recording/pose_numbers.h"
#include "tools/common/error_text.h"
#include "tools/common/import_arguments.h"
#include "tools/query/cloud_scene.h"
#include "tools/query/contact_lines.h"
#include "tools/query/mode.h"
#include "tools/query/query_report.h"
#include "tools/query/result_output.h"
#include "tools/query/solid_scene.h"

namespace vpm::tools {
namespace {

using Json = nlohmann::json;
using Line = nlohmann::ordered_json;

constexpr const char* kRequest =
    "write {\"pose\": [tx,ty,tz,qx,qy,qz,qw]} or {\"cloud\": \"scene.vpmc\"}, with an \"id\" if "
    "wanted";

// Returns the request of a line. Throws Error(refused) if it is none.
Json request_of(const std::string& line) {
  Json request = json_or_print(line);
  if (request.is_discarded()) {
    try {
      file::parse_json(line);
    } catch (const Error& fault) {
      // The line of the place is always the first.
      const bool is_json = !fault.problem().starts_with("not JSON");
      refuse(is_json ? fault.problem() : "not JSON", {}, is_json ? fault.hint() : kRequest);
    }
  }
  if (request.is_array()) return {{"pose", std::move(request)}};
  if (!request.is_object()) refuse("a request is an object of JSON", {}, kRequest);
  return request;
}

// Throws Error(refused) for what no answer is known to: a key that is none of a request's, of a
// pose's (pose_json.h), or of a message of ROS.
void check(const Json& request) {
  static const std::vector<std::string> kKnown = [] {
    std::vector<std::string> known{"cloud", "camera_pose", "header", "frame_id", "child_frame_id"};
    known.insert(known.begin(), keys_of_poses().begin(), keys_of_poses().end());
    return known;
  }();
  for (const auto& [key, value] : request.items()) {
    if (std::ranges::count(kKnown, key) > 0) continue;
    const std::string guess = file::guess_of_word(key, kKnown);
    refuse("there is no key '" + file::shown(key) + "'", {}, guess.empty() ? kRequest : guess);
  }
  if (request.contains("camera_pose") && !request.contains("cloud"))
    refuse("a camera's pose without its image", {}, "give \"cloud\" beside it");
}

// True if the request has more than a new scene.
bool has_pose(const Json& request) {
  for (const auto& [key, value] : request.items())
    if (key != "id" && key != "cloud" && key != "camera_pose") return true;
  return !request.contains("cloud");
}

Pose pose_of(const Json& request) {
  ObjectPose pose = pose_of_object(request);
  if (pose.numbers.size() == kTimedPose && !pose.are_named)
    pose.numbers.erase(pose.numbers.begin());
  return from_untimed(pose.numbers, nullptr);
}

// Returns the poses of a request's solids; none if it has none.
std::vector<Pose> solids_of(const Json& request, std::size_t solids) {
  if (!request.contains("solids")) return {};
  double deviation = 0;
  std::vector<Pose> poses = poses_of_solids(request["solids"], deviation);
  if (poses.size() != solids) refuse(misfit_of_solids(poses.size(), solids), {}, kSolidsAdvice);
  return poses;
}

std::string id_of(const Json& request) {
  return request.contains("id") ? request["id"].dump() : std::string();
}

Line with_id(const std::string& id) {
  Line line = Line::object();
  if (!id.empty()) line["id"] = Line::parse(id);
  return line;
}

class Server {
 public:
  explicit Server(QuerySetup& setup)
      : setup_(setup), output_(setup.program, setup.arguments, result_columns()) {
    std::vector<NamedCloud> clouds;
    for (const std::string& name : setup.arguments.clouds)
      clouds.push_back({name, read_scene(name, {})});
    if (!clouds.empty() || !setup.solids.empty())
      scene_ = std::make_unique<CloudScene>(setup, clouds);
  }

  // Answers until the input ends. Throws only what concerns the streams.
  void run() {
    file::LineStream lines(std::cin);
    while (const std::optional<std::string> line = lines.next())
      if (line->find_first_not_of(" \t\r") != line->npos) output_.append(answer(*line));
    output_.finish();
    if (scene_) scene_->warn_at_end();
  }

  // Returns the statistics of the answers.
  Json stats() const {
    const double prepare_seconds = scene_ ? scene_->prepare_seconds() : 0;
    return query_stats(seconds_, prepare_seconds, setup_.arguments.deadline_us);
  }

 private:
  // Returns the answer of a request, or what is wrong with it, which ends nothing else.
  Line answer(const std::string& line) {
    std::string id;
    try {
      const Json request = request_of(line);
      id = id_of(request);
      check(request);
      if (request.contains("cloud")) see_cloud(request);
      return has_pose(request) ? ask(pose_of(request), solids_of(request, setup_.solids.size()), id)
                               : seen(request, id);
    } catch (const Error& fault) {
      const std::string where = fault.where().empty() ? "" : fault.where() + ": ";
      return failure(id, where + fault.problem(), fault.hint());
    } catch (const std::bad_alloc&) {
      return failure(id, "not enough memory", {});
    }
  }

  Line failure(const std::string& id, const std::string& what, const std::string& hint) const {
    Line line = with_id(id);
    line["error"] = setup_.program.in_words_of_options(what);
    if (!hint.empty()) line["hint"] = setup_.program.in_words_of_options(hint);
    return line;
  }

  Line seen(const Json& request, const std::string& id) const {
    Line line = with_id(id);
    line["cloud"] = request["cloud"].get<std::string>();
    line["points"] = scene_->points();
    return line;
  }

  Line ask(const Pose& pose, const std::vector<Pose>& solids, const std::string& id) {
    if (!scene_) refuse("there is no scene yet", {}, "give \"cloud\", here or in a request before");
    if (!query_) make_query(pose);
    const Result result = query_->run(scene_->scene(), pose, 0, solids);
    scene_->see(pose, 0, result);
    seconds_.push_back(query_->seconds());
    Line line = result_line(seconds_.size() - 1, id, result, query_->level(),
                            setup_.options.measure, query_->reason(), {});
    if (setup_.arguments.contacts > 0) line["contacts"] = contacts_of_pose(query_->contacts());
    setup_.collisions.answer(result, line);
    return line;
  }

  void make_query(const Pose& first) {
    query_ = std::make_unique<LevelQuery>(setup_.tools.front(), setup_.options, setup_.level,
                                          scene_->scene(), first);
    note_scale(setup_.program, *query_);
  }

  void see_cloud(const Json& request) {
    if (!request["cloud"].is_string()) refuse("\"cloud\" is no name of a file", {}, kRequest);
    std::optional<Pose> camera;
    if (request.contains("camera_pose"))
      camera = from_untimed(numbers_of(request["camera_pose"]), nullptr);
    const std::string name = request["cloud"].get<std::string>();
    see(name, read_scene(name, camera));
  }

  void see(const std::string& name, const PointCloud& cloud) {
    auto next = std::make_unique<CloudScene>(setup_, std::vector{NamedCloud{name, cloud}});
    if (scene_) scene_->warn_at_end();
    scene_ = std::move(next);
    if (setup_.level.asks() && !setup_.level.max_error) query_.reset();  // chosen by the scene
  }

  // Reads a cloud as it is, and images and points of others as the options say.
  PointCloud read_scene(const std::string& name, const std::optional<Pose>& camera) {
    if (name == "-") refuse("standard input holds the requests", {}, "name a file");
    if (name.ends_with(".vpmc")) {
      if (camera) refuse("a cloud knows its camera's pose", name, "leave \"camera_pose\" out");
      return PointCloud::read(name);
    }
    ImportOptions options = import_options(setup_.program, setup_.arguments.replay.import, name);
    if (camera) options.to_world = camera;
    options.depth.looks_for_mistakes = !has_imported_;  // those of one image are said
    ImportedCloud imported = import_cloud(file::read_all(name), name, options);
    if (!std::exchange(has_imported_, true)) say(setup_.program, name, imported.remarks);
    return HandleAccess::make<PointCloud>(std::move(imported.cloud));
  }

  QuerySetup& setup_;
  ResultOutput output_;
  std::unique_ptr<CloudScene> scene_;
  std::unique_ptr<LevelQuery> query_;
  std::vector<double> seconds_;
  bool has_imported_ = false;
};

}  // namespace

void run_server(QuerySetup& setup) {
  Server server(setup);
  server.run();
  write_stats_and_view(setup, server.stats());
}

}  // namespace vpm::tools
