// vpm-query: how much of the tool is inside the cloud's solid, and what pushes it out.

#include <chrono>
#include <cstdio>
#include <optional>

#include "libvpm/cloud/cloud_file.h"
#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"
#include "libvpm/file/stream.h"
#include "libvpm/model/tool_model_file.h"
#include "libvpm/query/query.h"
#include "tools/common/tool.h"
#include "tools/query/pose_reader.h"
#include "tools/query/query_report.h"
#include "tools/query/spheres_out.h"

namespace vpm::tools {
namespace {

struct Arguments {
  std::string tool, cloud, pose, poses, measure = "refined", output = "-", spheres_out, stats;
  std::uint32_t level = 0;
  double stiffness = 1;
};

void declare(CLI::App& app, Arguments& a) {
  app.add_option("--tool", a.tool, "Tool model (.vpmg)");
  app.add_option("--cloud", a.cloud, "Point cloud (.vpmc)");
  app.add_option("--pose", a.pose, "One pose of the tool: tx,ty,tz,qx,qy,qz,qw");
  app.add_option("--poses", a.poses, "File of poses: JSON Lines, TUM text or 4x4 text");
  app.add_option("--measure", a.measure, "refined, or paper (as printed in 2017)")
      ->check(CLI::IsMember({"refined", "paper"}))
      ->capture_default_str();
  app.add_option("--level", a.level, "Spheres to use: one of the model's levels; 0 is the finest")
      ->capture_default_str();
  app.add_option("--stiffness", a.stiffness,
                 "N/m^3: scales force and torque; 1 leaves them in m^3 and m^4")
      ->capture_default_str();
  app.add_option("-o,--output", a.output, "Results, JSON Lines")->capture_default_str();
  app.add_option("--spheres-out", a.spheres_out,
                 "The spheres of the last pose by state (.ply or .csv)");
  app.add_option("--stats", a.stats, "Timings and device (JSON)");
}

void check(const Arguments& a, const CommonOptions& common) {
  const auto wrong = [](const std::string& message) { throw Error(ErrorKind::usage, message); };
  if (a.tool.empty()) wrong("--tool is missing: give the .vpmg that vpm-graph wrote");
  if (a.cloud.empty()) wrong("--cloud is missing: give the .vpmc that vpm-normals wrote");
  if (a.pose.empty() == a.poses.empty()) wrong("give either --pose or --poses");
  if ((a.tool == "-") + (a.cloud == "-") + (a.poses == "-") > 1) {
    wrong("only one of --tool, --cloud and --poses can be standard input");
  }
  if (!a.spheres_out.empty()) check_spheres_path(a.spheres_out);
  check_output(a.output, common);
  check_output(a.spheres_out, common);
  check_output(a.stats, common);
}

// Results to a pipe or terminal line by line, to a file whole at the end.
class ResultSink {
 public:
  explicit ResultSink(const std::string& path) : path_(path) {}
  void line(const std::string& text) {
    if (path_ != "-") {
      held_ += text;
    } else if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() ||
               std::fflush(stdout) != 0) {
      throw Error(ErrorKind::cannot_write,
                  "standard output cannot be written: the reader is gone, or the disk is full");
    }
  }
  void finish() const {
    if (path_ != "-") file::write_all(path_, held_);
  }

 private:
  std::string path_, held_;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void run(const Tool& tool, const Arguments& a) {
  check(a, tool.common());
  double pose_deviation = 0;
  std::optional<Pose> single;
  if (!a.pose.empty()) single = pose_from_text(a.pose, &pose_deviation);
  const ToolModel model = read_tool_model(a.tool);
  QueryOptions options;
  options.measure = a.measure == "paper" ? Measure::paper : Measure::refined;
  options.level = a.level;
  options.stiffness = a.stiffness;
  Query query(model, options);
  const Cloud cloud = read_cloud(a.cloud);
  const auto start = std::chrono::steady_clock::now();
  const PreparedCloud prepared(cloud);
  const double prepare_seconds = seconds_since(start);

  std::optional<PoseReader> reader;
  if (!single) reader.emplace(a.poses);
  ResultSink sink(a.output);
  std::vector<double> seconds;
  std::optional<Pose> last;
  for (std::size_t index = 0;; ++index) {
    const std::optional<Pose> pose = reader ? reader->next() : (index == 0 ? single : std::nullopt);
    if (!pose) break;
    const auto begin = std::chrono::steady_clock::now();
    const Result result = query.run(prepared, *pose);
    seconds.push_back(seconds_since(begin));
    sink.line(result_line(index, result, query.level(), options.measure));
    last = pose;
  }
  if (!last) refuse(a.poses + ": no pose in it");
  sink.finish();

  if (reader) pose_deviation = reader->largest_deviation();
  if (pose_deviation > kRotationRounding) {
    char text[96];
    std::snprintf(text, sizeof text,
                  "rotations were up to %.2g away from orthonormal and have been normalised",
                  pose_deviation);
    tool.note(text);
  }
  if (!a.spheres_out.empty()) {
    write_spheres(a.spheres_out, {model.spheres.data(), query.level().sphere_count}, query.states(),
                  *last);
  }
  if (!a.stats.empty()) {
    nlohmann::json stats = query_stats(std::move(seconds), prepare_seconds);
    stats["device"] = "cpu";
    stats["threads"] = thread_count();
    stats["cloud_points"] = prepared.positions().size();
    stats["level"] = query.level().sphere_count;
    stats["measure"] = a.measure;
    file::write_all(a.stats, stats.dump(2) + "\n");
  }
}

}  // namespace
}  // namespace vpm::tools

int main(int argc, char** argv) {
  using namespace vpm::tools;
  Tool tool("vpm-query", "Penetration volume, force and torque of a tool in a point cloud");
  Arguments arguments;
  declare(tool.app(), arguments);
  return tool.run(argc, argv, [&] { run(tool, arguments); });
}
