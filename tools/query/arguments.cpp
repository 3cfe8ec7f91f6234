#include "tools/query/arguments.h"

#include <algorithm>
#include <limits>

#include "libvpm/core/error.h"
#include "tools/common/number_checks.h"
#include "tools/query/gone_options.h"
#include "tools/query/spheres_out.h"

namespace vpm::tools {
namespace {

void declare_inputs(CLI::App& app, Arguments& a) {
  app.add_option(
         "--tool", a.tools,
         "Tool model (.vpmg). Given several times, every pose is asked of every tool; lines "
         "then have the field tool, from 0")
      ->allow_extra_args(false);
  app.add_option("--cloud", a.cloud, "Point cloud (.vpmc)");
  app.add_option("--pose", a.pose, "One pose of the tool: tx,ty,tz,qx,qy,qz,qw");
  app.add_option("--poses", a.poses, "File of poses: JSON Lines, TUM text or 4x4 text");
}

void declare_measure(CLI::App& app, Arguments& a) {
  app.add_option("--measure", a.measure, "refined, or paper (as printed in 2017)")
      ->check(CLI::IsMember({"refined", "paper"}))
      ->capture_default_str();
  app.add_option("--stiffness", a.stiffness,
                 "N/m^3: scales force and torque; without, or 1, they are in m^3 and m^4");
  app.add_option("--shadows", a.shadows,
                 "What counts of places that a depth image does not show: those near behind what "
                 "it shows, or all: solid")
      ->check(CLI::IsMember({"near", "solid"}))
      ->capture_default_str();
  app.add_flag("--count-points", a.count_points,
               "Count the cloud's points in spheres into the field points: slower with many "
               "spheres. --measure paper counts them anyway");
  app.add_flag("--no-points", a.no_points,
               "Has no effect: points are counted only with --count-points or --measure paper");
  app.add_flag("--raw-points", a.raw_points,
               "Take points as they were measured: a cloud is ready sooner, without a camera in a "
               "tenth of the time, but noise errs more, and without a camera edges and thin plates "
               "do too; queries take longer");
}

void declare_level(CLI::App& app, Arguments& a) {
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
}

void declare_motion(CLI::App& app, Arguments& a) {
  app.add_flag(
      "--coherent", a.coherent,
      "The poses are one motion: a tool that passes wholly behind the surface stays inside "
      "until it comes out");
  app.add_option("--coupling", a.coupling,
                 "Take --poses or --trajectory for those of a haptic device that holds the tool by "
                 "a spring and "
                 "damper: stiffness=N/m,damping=N s/m[,mass=kg][,rate=Hz]; needs --stiffness");
}

void declare_outputs(CLI::App& app, Arguments& a) {
  app.add_option("-o,--output", a.output, "Results, JSON Lines")->capture_default_str();
  app.add_option("--spheres-out", a.spheres_out,
                 "The spheres of the last pose by state: .csv, .ply (balls), .points.ply or .glb");
  app.add_option("--stats", a.stats, "Timings and device (JSON)");
  app.add_option("--view", a.view,
                 "A page (.html) that shows scene, tool, answers and path in any browser");
}

}  // namespace

void declare(CLI::App& app, Arguments& a) {
  declare_inputs(app, a);
  declare_measure(app, a);
  declare_level(app, a);
  declare_motion(app, a);
  app.add_option(
         "--batch", a.batch,
         "Poses that a device takes at once; answers come in their order. Changes no result")
      ->check(whole_number_in(1, 1 << 20))
      ->capture_default_str();
  declare(app, a.replay);
  declare_outputs(app, a);
  declare_gone_options(app);
}

void check_names(const Arguments& a, const CommonOptions& common) {
  if (std::ranges::count(a.tools, "-") + (a.cloud == "-") + (a.poses == "-") +
          (a.replay.trajectory == "-") >
      1) {
    throw Error(ErrorKind::invalid_argument,
                "only one of --tool, --cloud, --poses and --trajectory can be standard input");
  }
  if (!a.spheres_out.empty()) check_spheres_path(a.spheres_out);
  std::vector<std::string> inputs{a.cloud, a.poses, a.replay.frames, a.replay.trajectory,
                                  a.replay.camera_poses};
  inputs.insert(inputs.end(), a.tools.begin(), a.tools.end());
  check_files(inputs,
              {{"--output", a.output, std::nullopt},
               {"--spheres-out", a.spheres_out, std::nullopt},
               {"--stats", a.stats, std::nullopt},
               {"--view", a.view, std::nullopt, true}},
              common);
}

}  // namespace vpm::tools
