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
#include "tools/common/scene_report.h"
#include "tools/common/tool.h"
#include "tools/query/coupled.h"
#include "tools/query/device_path.h"
#include "tools/query/level_query.h"
#include "tools/query/pose_reader.h"
#include "tools/query/query_report.h"
#include "tools/query/spheres_out.h"

namespace vpm::tools {
namespace {

struct Arguments {
  std::string tool, cloud, pose, poses, measure = "refined", output = "-", spheres_out, stats;
  std::uint32_t level = 0;
  std::string max_error;
  std::optional<double> deadline_us;
  bool for_scene = false, coherent = false;
  double stiffness = 1;
  std::string coupling;
  std::size_t batch = 1;
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
  app.add_option("--max-error", a.max_error,
                 "Use the coarsest level with at most this error by its calibration: 0.5% or "
                 "0.005 of the tool's volume");
  app.add_option("--deadline-us", a.deadline_us,
                 "Use the finest level that answers in this many microseconds here; results then "
                 "depend on the machine's speed. Wins over --max-error and --for-scene");
  app.add_flag("--for-scene", a.for_scene,
               "Use the finest level without spheres that the cloud's points cannot resolve");
  app.add_option("--stiffness", a.stiffness,
                 "N/m^3: scales force and torque; 1 leaves them in m^3 and m^4")
      ->capture_default_str();
  app.add_flag(
      "--coherent", a.coherent,
      "The poses are one motion: a tool that passes wholly behind the surface stays inside "
      "until it comes out");
  app.add_option("--coupling", a.coupling,
                 "Take --poses for those of a haptic device that holds the tool by a spring and "
                 "damper: stiffness=N/m,damping=N s/m[,mass=kg][,rate=Hz]; needs --stiffness");
  app.add_option(
         "--batch", a.batch,
         "Poses that a device takes at once; answers come in their order. Changes no result")
      ->check(CLI::Range(1, 1 << 20))
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
  if ((a.level != 0) + !a.max_error.empty() + a.for_scene > 1 || (a.level != 0 && a.deadline_us))
    wrong(
        "--level, --max-error and --for-scene choose the level: give one of them; --deadline-us "
        "goes with the last two only");
  if (!a.coupling.empty() && (a.poses.empty() || a.stiffness == 1))
    wrong(
        "--coupling needs the device's path (--poses) and what the scene's volume weighs "
        "(--stiffness in N/m^3)");
  if (a.coherent && (a.batch > 1 || a.deadline_us))
    wrong("--coherent goes pose by pose at one level; leave --batch and --deadline-us out");
  if (a.batch > 1 && (a.deadline_us || !a.coupling.empty()))
    wrong("--batch answers many poses at once; leave --deadline-us and --coupling out");
  if (a.deadline_us && !(*a.deadline_us > 0))
    wrong("--deadline-us must be a positive number of microseconds");
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

LevelRequest level_request(const Arguments& a) {
  LevelRequest request;
  if (!a.max_error.empty()) request.max_error = fraction_from_text(a.max_error, "--max-error");
  if (a.deadline_us) request.deadline_seconds = 1e-6 * *a.deadline_us;
  request.for_scene = a.for_scene;
  return request;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void note_deviation(const Tool& tool, double deviation) {
  if (!(deviation > kRotationRounding)) return;
  char text[96];
  std::snprintf(text, sizeof text,
                "rotations were up to %.2g away from orthonormal and have been normalised",
                deviation);
  tool.note(text);
}

void note_scale(const Tool& tool, const SceneScale& scale, const Level& level) {
  tool.note("the scene resolves " + words_of(scale) + ": the level of " +
            std::to_string(level.sphere_count) + " is enough");
}

void say_limits(const Tool& tool, const CouplingParameters& coupling, const ToolModel& model,
                double stiffness) {
  tool.note("coupling: " + coupling_note(coupling));
  const std::string warning = coupling_warning(coupling, model, stiffness);
  if (!warning.empty()) tool.warn(warning);
}

// Queries one after the other, each answered by a line.
struct Run {
  const PreparedCloud& cloud;
  ResultSink& sink;
  std::vector<double> seconds;  // of each
  Pose last;

  Result ask(LevelQuery& query, const Pose& pose) {
    const Result result = query.run(cloud, pose);
    seconds.push_back(query.seconds());
    last = pose;
    return result;
  }
  void pose(LevelQuery& query, const Pose& pose, Measure measure) {
    const std::size_t index = seconds.size();
    const Result result = ask(query, pose);
    sink.line(result_line(index, result, query.query().level(), measure, query.reason()));
  }
  void batch(LevelQuery& query, const std::vector<Pose>& poses, Measure measure) {
    std::vector<Result> results(poses.size());
    query.run(cloud, poses, results);
    for (const Result& result : results) {
      sink.line(
          result_line(seconds.size(), result, query.query().level(), measure, query.reason()));
      seconds.push_back(query.seconds());
    }
    last = poses.back();
  }
  void coupled(LevelQuery& query, VirtualCoupling coupling, const DevicePath& path) {
    for (std::size_t k = 0; k < path.steps(); ++k) {
      CoupledStep step{k, path.time(k), path.pose(k), coupling.tool(), {}, {}, {}};
      step.contact = ask(query, step.tool);
      step.rendered = coupling.advance(step.device, step.contact.wrench);
      step.energy = coupling.energy();
      sink.line(coupled_line(step));
    }
  }
};

// What no device computes is computed on the CPU, unless a device is named.
Device device_of(const Tool& tool, Measure measure, bool coherent) {
  const bool cpu_only = measure == Measure::paper || coherent;
  return cpu_only && tool.common().device == "auto" ? Device{} : tool.device();
}

void run(const Tool& tool, const Arguments& a) {
  check(a, tool.common());
  const LevelRequest request = level_request(a);
  double pose_deviation = 0;
  std::optional<Pose> single;
  if (!a.pose.empty()) single = pose_from_text(a.pose, &pose_deviation);
  const ToolModel model = read_tool_model(a.tool);
  QueryOptions options;
  options.measure = a.measure == "paper" ? Measure::paper : Measure::refined;
  options.level = model.level(a.level).sphere_count;
  options.stiffness = a.stiffness;
  options.coherent = a.coherent;
  options.device = device_of(tool, options.measure, a.coherent);
  const Cloud cloud = read_cloud(a.cloud);
  const auto start = std::chrono::steady_clock::now();
  const PreparedCloud prepared(cloud);
  const double prepare_seconds = seconds_since(start);

  std::optional<PoseReader> reader;
  if (!single) reader.emplace(a.poses);
  ResultSink sink(a.output);
  Run run{prepared, sink, {}, {}};
  std::optional<Pose> pose = single;
  std::optional<CouplingParameters> coupling;
  std::optional<DevicePath> path;
  if (!a.coupling.empty()) {
    coupling = coupling_from_text(a.coupling, model);
    path.emplace(*reader, coupling->rate);
    pose = path->pose(0);
  } else if (!single) {
    pose = reader->next();
  }
  if (!pose) refuse(a.poses + ": no pose in it");
  LevelQuery query(model, options, request, prepared, *pose);
  if (query.scale()) note_scale(tool, *query.scale(), query.finest());
  if (coupling) {
    say_limits(tool, *coupling, model, a.stiffness);
    run.coupled(query, VirtualCoupling(*coupling, model.center_of_mass, *pose), *path);
  } else {
    const auto next = [&] { return reader ? reader->next() : std::nullopt; };
    for (; pose && a.batch == 1; pose = next()) run.pose(query, *pose, options.measure);
    std::vector<Pose> poses;
    for (; pose; pose = next()) {
      poses.push_back(*pose);
      if (poses.size() < a.batch) continue;
      run.batch(query, poses, options.measure);
      poses.clear();
    }
    if (!poses.empty()) run.batch(query, poses, options.measure);
  }
  sink.finish();
  note_deviation(tool, reader ? reader->largest_deviation() : pose_deviation);
  const Level& level = query.query().level();
  if (!a.spheres_out.empty()) {
    if (a.batch > 1) query.run(prepared, run.last);  // batches keep no states
    write_spheres(a.spheres_out, {model.spheres.data(), level.sphere_count}, query.query().states(),
                  run.last);
  }
  if (!a.stats.empty()) {
    nlohmann::json stats = query_stats(std::move(run.seconds), prepare_seconds, a.deadline_us);
    stats["device"] = options.device.is_cuda() ? "cuda" : "cpu";
    if (options.device.is_cuda()) stats["device_name"] = cuda_device_name(options.device.index);
    stats["batch"] = a.batch;
    stats["threads"] = thread_count();
    stats["cloud_points"] = prepared.positions().size();
    stats["level"] = level.sphere_count;
    stats["measure"] = a.measure;
    if (query.scale()) stats["scene"] = scene_report(*query.scale());
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
  tool.computes_on_devices();
  return tool.run(argc, argv, [&] { run(tool, arguments); });
}
