// vpm-query: how much of the tool is inside the cloud's solid, and what pushes it out.

#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>

#include "libvpm/cloud/cloud_file.h"
#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"
#include "libvpm/file/stream.h"
#include "libvpm/model/tool_model_file.h"
#include "libvpm/query/level_tool_query.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/recording/timed_path.h"
#include "tools/common/number_checks.h"
#include "tools/common/scene_report.h"
#include "tools/common/tool.h"
#include "tools/query/coupled.h"
#include "tools/query/gone_options.h"
#include "tools/query/pose_batches.h"
#include "tools/query/pose_view.h"
#include "tools/query/query_report.h"
#include "tools/query/replay.h"
#include "tools/query/several_tools.h"
#include "tools/query/spheres_out.h"

namespace vpm::tools {
namespace {

struct Arguments {
  std::vector<std::string> tools;
  std::string cloud, pose, poses, measure = "refined", shadows = "near", output = "-", spheres_out,
                                  stats, view;
  std::uint32_t level = 0;
  std::string max_error;
  std::optional<double> deadline_us;
  bool for_scene = false, coherent = false, count_points = false, raw_points = false;
  bool no_points = false;  // has no effect
  std::optional<double> stiffness;
  std::string coupling;
  std::size_t batch = 1;
  ReplayArguments replay;
};

void declare(CLI::App& app, Arguments& a) {
  app.add_option(
         "--tool", a.tools,
         "Tool model (.vpmg). Given several times, every pose is asked of every tool; lines "
         "then have the field tool, from 0")
      ->allow_extra_args(false);
  app.add_option("--cloud", a.cloud, "Point cloud (.vpmc)");
  app.add_option("--pose", a.pose, "One pose of the tool: tx,ty,tz,qx,qy,qz,qw");
  app.add_option("--poses", a.poses, "File of poses: JSON Lines, TUM text or 4x4 text");
  app.add_option("--measure", a.measure, "refined, or paper (as printed in 2017)")
      ->check(CLI::IsMember({"refined", "paper"}))
      ->capture_default_str();
  app.add_option("--level", a.level, "Spheres to use: one of the model's levels; 0 is the finest")
      ->check(whole_number_in(0, std::numeric_limits<std::uint32_t>::max()))
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
                 "N/m^3: scales force and torque; without, or 1, they are in m^3 and m^4");
  app.add_option("--shadows", a.shadows,
                 "What counts of places that a depth image does not show: those near behind what "
                 "it shows, or all: solid")
      ->check(CLI::IsMember({"near", "solid"}))
      ->capture_default_str();
  app.add_flag(
      "--coherent", a.coherent,
      "The poses are one motion: a tool that passes wholly behind the surface stays inside "
      "until it comes out");
  app.add_flag("--count-points", a.count_points,
               "Count the cloud's points in spheres into the field points: slower with many "
               "spheres. --measure paper counts them anyway");
  app.add_flag("--no-points", a.no_points,
               "Has no effect: points are counted only with --count-points or --measure paper");
  app.add_flag("--raw-points", a.raw_points,
               "Take points as they were measured: a cloud is ready sooner, without a camera in a "
               "tenth of the time, but noise errs more, and without a camera edges and thin plates "
               "do too; queries take longer");
  app.add_option("--coupling", a.coupling,
                 "Take --poses or --trajectory for those of a haptic device that holds the tool by "
                 "a spring and "
                 "damper: stiffness=N/m,damping=N s/m[,mass=kg][,rate=Hz]; needs --stiffness");
  app.add_option(
         "--batch", a.batch,
         "Poses that a device takes at once; answers come in their order. Changes no result")
      ->check(whole_number_in(1, 1 << 20))
      ->capture_default_str();
  declare(app, a.replay);
  app.add_option("-o,--output", a.output, "Results, JSON Lines")->capture_default_str();
  app.add_option("--spheres-out", a.spheres_out,
                 "The spheres of the last pose by state: .csv, .ply (balls), .points.ply or .glb");
  app.add_option("--stats", a.stats, "Timings and device (JSON)");
  app.add_option("--view", a.view,
                 "A page (.html) that shows scene, tool, answers and path in any browser");
  declare_gone_options(app);
}

void check(const Arguments& a, const CommonOptions& common) {
  const auto wrong = [](const std::string& message) {
    throw Error(ErrorKind::invalid_argument, message);
  };
  if (a.tools.empty()) wrong("--tool is missing: give the .vpmg that vpm-graph wrote");
  const bool replays = !a.replay.frames.empty();
  if (!replays && a.cloud.empty())
    wrong("--cloud is missing: give the .vpmc that vpm-normals wrote, or --frames");
  if (!replays && a.pose.empty() == a.poses.empty()) wrong("give either --pose or --poses");
  if (std::ranges::count(a.tools, "-") + (a.cloud == "-") + (a.poses == "-") +
          (a.replay.trajectory == "-") >
      1) {
    wrong("only one of --tool, --cloud, --poses and --trajectory can be standard input");
  }
  if ((a.level != 0) + !a.max_error.empty() + a.for_scene > 1 || (a.level != 0 && a.deadline_us))
    wrong(
        "--level, --max-error and --for-scene choose the level: give one of them; --deadline-us "
        "goes with the last two only");
  if (!a.coupling.empty() && ((a.poses.empty() && !replays) || !a.stiffness))
    wrong(
        "--coupling needs the device's path (--poses) and what the scene's volume weighs "
        "(--stiffness in N/m^3)");
  if (a.coherent && (a.batch > 1 || a.deadline_us))
    wrong("--coherent goes pose by pose at one level; leave --batch and --deadline-us out");
  if (a.batch > 1 && (a.deadline_us || !a.coupling.empty() || replays))
    wrong("--batch answers many poses at once; leave --deadline-us, --coupling and --frames out");
  if (a.tools.size() > 1 &&
      (replays || a.deadline_us || !a.coupling.empty() || a.coherent || !a.spheres_out.empty()))
    wrong(
        "several tools are asked for poses in one cloud; leave --frames, --deadline-us, "
        "--coupling, --coherent and --spheres-out out, or give one --tool");
  if (a.deadline_us && !(*a.deadline_us > 0))
    wrong("--deadline-us must be a positive number of microseconds");
  if (!a.spheres_out.empty()) check_spheres_path(a.spheres_out);
  if (!replays && !is_default(a.replay))
    wrong("--method, --window, --edge-gate, --frame-rate and --frame-latency belong to --frames");
  std::vector<std::string> inputs{a.cloud, a.poses, a.replay.frames, a.replay.trajectory,
                                  a.replay.camera_poses};
  inputs.insert(inputs.end(), a.tools.begin(), a.tools.end());
  check_files(inputs,
              {{"--output", a.output, std::nullopt},
               {"--spheres-out", a.spheres_out, std::nullopt},
               {"--stats", a.stats, std::nullopt},
               {"--view", a.view, std::nullopt}},
              common);
}

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
  file::Output& output;
  std::vector<double> seconds;  // of each
  Pose last;
  std::optional<PoseView>& view;

  Result ask(LevelToolQuery& query, const Pose& pose) {
    const Result result = query.run(cloud, pose);
    seconds.push_back(query.seconds());
    last = pose;
    if (view) view->add(0, pose, result, query.query());
    return result;
  }
  void pose(LevelToolQuery& query, const Pose& pose, Measure measure) {
    const std::size_t index = seconds.size();
    const Result result = ask(query, pose);
    output.append(result_line(index, result, query.query().level(), measure, query.reason(), {}));
  }
  void batch(LevelToolQuery& query, const std::vector<Pose>& poses, Measure measure) {
    std::vector<Result> results(poses.size());
    query.run(cloud, jobs_of(poses), results);
    for (const Result& result : results) {
      output.append(
          result_line(seconds.size(), result, query.query().level(), measure, query.reason(), {}));
      seconds.push_back(query.seconds());
    }
    last = poses.back();
    if (view) view->add_batch(query.query(), cloud, poses);
  }
  // From the first pose on all of the reader, if there is one.
  void all(LevelToolQuery& query, std::optional<Pose> next, std::optional<PoseReader>& reader,
           std::size_t at_once, Measure measure) {
    in_batches(next, reader, at_once, [&](const std::vector<Pose>& poses) {
      at_once == 1 ? pose(query, poses.front(), measure) : batch(query, poses, measure);
    });
  }
  void coupled(LevelToolQuery& query, VirtualCoupling coupling, const SampledPath& path) {
    for (std::size_t k = 0; k < path.steps(); ++k) {
      CoupledStep step{k, path.time(k), path.pose(k), coupling.tool(), {}, {}, {}};
      step.contact = ask(query, step.tool);
      step.rendered = coupling.advance(step.device, step.contact.wrench);
      step.energy = coupling.energy();
      output.append(coupled_line(step, ""));
    }
  }
};

// What no device computes is computed on the CPU, unless a device is named.
Device device_of(const Tool& tool, bool coherent) {
  return coherent && tool.common().device == "auto" ? Device{} : tool.device();
}

void write_stats(const Arguments& a, const Device& device, nlohmann::json stats) {
  if (a.stats.empty()) return;
  stats["device"] = device.is_cuda() ? "cuda" : "cpu";
  if (device.is_cuda()) stats["device_name"] = device_name(device);
  stats["batch"] = a.batch;
  stats["threads"] = thread_count();
  stats["measure"] = a.measure;
  file::write_all(a.stats, stats.dump(2) + "\n");
}

void write_rest(const Arguments& a, const ToolModel& model, const LevelToolQuery& query,
                const Device& device, const Pose& last, nlohmann::json stats) {
  const Level& level = query.query().level();
  if (!a.spheres_out.empty())
    write_spheres(a.spheres_out, {model.spheres.data(), level.sphere_count}, query.query().states(),
                  last);
  stats["level"] = level.sphere_count;
  if (query.scale()) stats["scene"] = scene_report(*query.scale());
  write_stats(a, device, std::move(stats));
}

// The measure as printed reads points as they are.
PointReading reading_of_points(const Arguments& a) {
  return a.raw_points || a.measure == "paper" ? PointReading::as_measured : PointReading::settled;
}

// `pose` is the first.
nlohmann::json ask_several(const Tool& tool, const Arguments& a,
                           const std::vector<ToolModel>& models, const QueryOptions& options,
                           const PreparedCloud& cloud, const Pose& pose,
                           std::optional<PoseReader>& reader, double prepare_seconds,
                           std::optional<PoseView>& view) {
  file::Output output(a.output);
  SeveralTools several(models, options, level_request(a), cloud, pose);
  for (std::size_t t = 0; t < models.size(); ++t)
    if (several.query(t).scale())
      note_scale(tool, *several.query(t).scale(), several.query(t).finest());
  several.run(pose, reader, a.batch, output, view);
  output.finish();
  nlohmann::json stats = query_stats(several.seconds(), prepare_seconds, {});
  stats["levels"] = several.levels();
  return stats;
}

void run_poses(const Tool& tool, const Arguments& a, const std::vector<ToolModel>& models,
               const QueryOptions& options, std::optional<PoseView>& view) {
  const ToolModel& model = models.front();
  double deviation = 0;
  std::optional<Pose> pose;
  if (!a.pose.empty()) pose = pose_from_text(a.pose, &deviation);
  const Cloud cloud = read_cloud(a.cloud);
  const auto start = std::chrono::steady_clock::now();
  const PreparedCloud prepared(cloud, reading_of_points(a));
  const double prepare_seconds = seconds_since(start);
  if (view) view->add_cloud(a.cloud, cloud);

  std::optional<PoseReader> reader;
  if (!pose) reader.emplace(a.poses);
  if (models.size() > 1) {
    if (reader) pose = reader->next();
    if (!pose) reader->refuse_empty();
    nlohmann::json stats =
        ask_several(tool, a, models, options, prepared, *pose, reader, prepare_seconds, view);
    note_deviation(tool, "", reader ? reader->largest_deviation() : deviation);
    stats["cloud_points"] = prepared.positions().size();
    write_stats(a, options.device, std::move(stats));
    if (view) view->write();
    return;
  }
  file::Output output(a.output);
  Run run{prepared, output, {}, {}, view};
  std::optional<CouplingParameters> coupling;
  std::optional<SampledPath> path;
  if (!a.coupling.empty()) {
    coupling = coupling_from_text(a.coupling, model, ReplayArguments::kRate);
    path.emplace(TimedPath(*reader), coupling->rate);
    pose = path->pose(0);
  } else if (reader) {
    pose = reader->next();
    if (!pose) reader->refuse_empty();
  }
  LevelToolQuery query(model, options, level_request(a), prepared, *pose);
  if (query.scale()) note_scale(tool, *query.scale(), query.finest());
  if (coupling) {
    say_limits(tool, *coupling, model, options.stiffness);
    run.coupled(query, VirtualCoupling(*coupling, model.center_of_mass, *pose), *path);
  } else {
    run.all(query, pose, reader, a.batch, options.measure);
  }
  output.finish();
  note_deviation(tool, "", reader ? reader->largest_deviation() : deviation);
  if (!a.spheres_out.empty() && a.batch > 1)
    query.run(prepared, run.last);  // batches keep no states
  nlohmann::json stats = query_stats(std::move(run.seconds), prepare_seconds, a.deadline_us);
  stats["cloud_points"] = prepared.positions().size();
  write_rest(a, model, query, options.device, run.last, std::move(stats));
  if (view) view->write();
}

void run_replay(const Tool& tool, const Arguments& a, const ToolModel& model,
                const QueryOptions& options, std::optional<PoseView>& view) {
  std::optional<CouplingParameters> parameters;
  double rate = a.replay.rate.value_or(ReplayArguments::kRate);
  if (!a.coupling.empty()) {
    parameters = coupling_from_text(a.coupling, model, rate);
    if (a.replay.rate && rate != parameters->rate)
      throw Error(ErrorKind::invalid_argument,
                  "--rate and the rate of --coupling differ; give one of them");
    rate = parameters->rate;
  }
  Replay replay(tool, a.replay, rate, options.device, reading_of_points(a));
  const Pose first = replay.path().pose(0);
  LevelToolQuery query(model, options, level_request(a), replay.first_cloud(), first);
  if (query.scale()) note_scale(tool, *query.scale(), query.finest());
  std::optional<VirtualCoupling> coupling;
  if (parameters) {
    say_limits(tool, *parameters, model, options.stiffness);
    coupling.emplace(*parameters, model.center_of_mass, first);
  }
  file::Output output(a.output);
  replay.run(query, coupling, options.measure, output, view);
  output.finish();
  nlohmann::json stats =
      query_stats(replay.query_seconds(), replay.prepare_seconds(), a.deadline_us);
  stats["cloud_points"] = replay.last_cloud().positions().size();
  stats["replay"] = replay.report(a.deadline_us ? 1e-6 * *a.deadline_us : 1 / rate);
  write_rest(a, model, query, options.device, replay.last_pose(), std::move(stats));
  if (view) view->write();
}

void run(const Tool& tool, const Arguments& a) {
  check(a, tool.common());
  level_request(a);
  std::vector<ToolModel> models;
  for (const std::string& name : a.tools) models.push_back(read_tool_model(name));
  QueryOptions options;
  options.measure = a.measure == "paper" ? Measure::paper : Measure::refined;
  options.level = a.level;
  for (const ToolModel& model : models) model.level(a.level);  // it has one
  options.stiffness = a.stiffness.value_or(1);
  options.shadows = a.shadows == "solid" ? Shadows::solid : Shadows::near;
  options.coherent = a.coherent;
  options.counts_points = a.count_points;
  options.device = device_of(tool, a.coherent);
  std::optional<PoseView> view;
  if (!a.view.empty()) view.emplace(a.view, models, a.tools, options);
  a.replay.frames.empty() ? run_poses(tool, a, models, options, view)
                          : run_replay(tool, a, models.front(), options, view);
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
