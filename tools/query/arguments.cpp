#include "tools/query/arguments.h"

#include <vpm/error.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "libvpm/file/overwrite.h"
#include "libvpm/view/sphere_files.h"
#include "tools/common/length_units.h"
#include "tools/common/number_checks.h"
#include "tools/common/program.h"
#include "tools/query/kept_lines.h"
#include "tools/query/solid_scene.h"

namespace vpm::tools {
namespace {

struct GoneOption {
  const char* name;
  const char* reason;
};

constexpr GoneOption kGone[] = {
    {"--count-points", "--measure paper counts them"},
    {"--no-points", "points are counted by --measure paper only"},
    {"--reuse", "a coarser --level trades accuracy for speed"},
    {"--standby-us", "a device no longer stands by between poses, and results are the same"},
};

// Options that say how the files of frames are read, which is vpm-normals' subject.
constexpr const char* kOfFrames[] = {"--depth-scale", "--invalid", "--range",    "--along-ray",
                                     "--decode",      "--channel", "--axes",     "--flip",
                                     "--method",      "--window",  "--edge-gate"};

void refuse_option_of_frames(const std::string& name) {
  throw Error(ErrorKind::invalid_argument, name +
                                               " is gone from vpm-query: make clouds of the frames "
                                               "first, by vpm-normals FRAMES -o CLOUDS " +
                                               name + ", and give --frames CLOUDS");
}

// Adds the options that earlier versions had; --help does not show them. Parsing one of them throws
// Error(invalid_argument) that says what to do instead.
void declare_gone_options(CLI::App& app) {
  for (const char* const name : kOfFrames)
    app.add_option_function<std::string>(
           name, [name](const std::string&) { refuse_option_of_frames(name); })
        ->expected(0, 1)
        ->group("");
  for (const GoneOption& gone : kGone) {
    const auto refuse_it = [gone](const std::string&) {
      throw Error(ErrorKind::invalid_argument,
                  std::string(gone.name) + " is gone: leave it out; " + gone.reason);
    };
    app.add_option_function<std::string>(gone.name, refuse_it)->expected(0, 1)->group("");
  }
}

void declare_inputs(CLI::App& app, Arguments& a) {
  begin_group(app, "Inputs");
  app.add_option("--tool", a.tools,
                 "Tool model (.vpmg), or a mesh, which is packed with 1000 spheres. Given several "
                 "times, every pose is asked of every tool; lines "
                 "then have the field tool, from 0")
      ->allow_extra_args(false)
      ->option_text("MODEL");
  app.add_option("--cloud", a.clouds,
                 "Point cloud (.vpmc). Given several times: depth images of cameras that may see "
                 "the same things, which are one body")
      ->allow_extra_args(false)
      ->option_text("CLOUD");
  app.add_flag(
      "--register", a.registers,
      "Move the cameras of several --cloud, or by the first images of several --frames, by so "
      "little that their images agree, as far as these tell, and say by how much");
  app.add_option(
         "--solid", a.solids,
         "Tool model (.vpmg) or mesh of a solid in the scene, with its pose after an @ where "
         "that is not the origin. Given several times, the scene has all of them")
      ->allow_extra_args(false)
      ->option_text("FILE[@TX,TY,TZ,QX,QY,QZ,QW]");
  app.add_option("--pose", a.pose, "One pose of the tool: tx,ty,tz,qx,qy,qz,qw")
      ->join(',')
      ->type_name("FLOAT")
      ->option_text("POSE");
  // --trajectory is its name of earlier versions.
  app.add_option("--poses,--trajectory", a.poses,
                 "File of poses: JSON Lines, TUM text or 4x4 text, or those in a recording: "
                 "REC.mcap:/TOPIC, REC.mcap:FRAME of TF. With --frames, the path of the "
                 "tool. Given several times there, a path for each --tool")
      ->allow_extra_args(false)
      ->option_text("FILE");
  app.add_option(
         "--frames", a.replay.frames,
         "Instead of --cloud: folder of depth images with their times (TUM RGB-D, 7-Scenes), "
         "or of the clouds that vpm-normals made of them, or a list of \"time file\" "
         "lines, or a recording of ROS 2 in MCAP; goes with --poses. Given several times, cameras "
         "of one scene, on one clock")
      ->allow_extra_args(false)
      ->option_text("FOLDER or FILE");
}

void declare_assembly(CLI::App& app, Arguments& a) {
  begin_group(app, "Assemblies");
  app.add_option("--pairs", a.pairs,
                 "Instead of --tool: a folder of closed meshes or models, or a description of an "
                 "assembly (.json). All pairs of parts are measured, and those that share volume "
                 "are told")
      ->option_text("FOLDER");
  app.add_option("--unit", a.unit,
                 "Unit of the meshes, poses and results of --pairs: m, cm, mm, um, in or ft")
      ->check(CLI::IsMember(names_of_units()))
      ->option_text("U");
  app.add_option("--repair", a.repair,
                 "Repair those meshes of --pairs that are no solid, as vpm-pack does: holes, which "
                 "is meant if no "
                 "value follows, voxel[=RES] or flood[=RES]")
      ->expected(0, 1)
      ->default_str("holes")
      ->option_text("[holes|voxel|flood]");
}

void declare_robot(CLI::App& app, Arguments& a) {
  begin_group(app, "Robots");
  app.add_option(
      "--urdf", a.urdf,
      "Instead of --tool: a robot (URDF), whose links are asked at the configurations of "
      "--joints, and which of them share volume");
  app.add_option(
      "--joints", a.joints,
      "Configurations of --urdf, a line of JSON each: an object of joints' names and values "
      "(rad, m), or an array of the values of all movable joints in the order of the URDF");
  app.add_option("--srdf", a.srdf,
                 "Pairs of links that are not asked whether they share volume; if not given, those "
                 "that a joint joins");
  app.add_option("--package-path", a.packages,
                 "Folder that holds the packages which package:// names in a URDF, or that is one. "
                 "Can be given several times")
      ->allow_extra_args(false)
      ->option_text("FOLDER");
}

void declare_requests(CLI::App& app, Arguments& a) {
  begin_group(app, "How it is asked");
  app.add_option(
         "--batch", a.batch,
         "Poses that a device takes at once; answers come in their order. Changes no result")
      ->check(whole_number_in(1, 1 << 20))
      ->capture_default_str();
  app.add_flag("--serve", a.serve,
               "Answer requests on standard input, one line of JSON for each, until it ends");
}

void declare_measure(CLI::App& app, Arguments& a) {
  begin_group(app, "What is measured");
  app.add_option("--measure", a.measure, "refined, or paper (as printed in 2017)")
      ->check(CLI::IsMember({"refined", "paper"}))
      ->capture_default_str();
  app.add_option("--stiffness", a.stiffness,
                 "N/m^3: scales force and torque; without, or 1, they are in m^3 and m^4")
      ->option_text("K");
  app.add_option("--shadows", a.shadows,
                 "What counts of the places that a depth image does not show. near: those at most "
                 "the tool radius behind what it shows, and further behind those that a surface "
                 "which cuts the tool supports. solid: all of them")
      ->check(CLI::IsMember({"near", "solid"}))
      ->capture_default_str();
  app.add_flag("--raw-points", a.raw_points,
               "Take points as they were measured: a cloud is ready sooner, without a camera in a "
               "tenth of the time, but noise errs more, and without a camera edges and thin plates "
               "do too; queries take longer");
}

void declare_collisions(CLI::App& app, Arguments& a) {
  app.add_flag("--collides", a.collides,
               "Say whether the tool collides: yes, no, or unknown where too much of it is unseen, "
               "or where a scan is open; exit status 10 of a hit, else 11 if a pose is unknown");
  app.add_flag("--collides-only", a.collides_only,
               "The same, and nothing else: lines have no volume, force or torque, and the answer "
               "comes as soon as it is sure");
  app.add_option("--unseen", a.unseen_limit,
                 "Part of the tool that may be unseen or out of view where --collides says no")
      ->check(number_in(0, 1))
      ->capture_default_str();
  app.add_option(
         "--fail-above", a.fail_above,
         "Exit status 10 if at a pose, or of a pair, the volume is more than this, in m³ or "
         "the cube of --unit; 0: any volume. Pairs that an assembly allows have limits of "
         "their own")
      ->check(number_in(0, 1e300))
      ->option_text("VOLUME");
}

void declare_level(CLI::App& app, Arguments& a) {
  begin_group(app, "Level of detail", Group::rare);
  app.add_option("--level", a.level, "Spheres to use: one of the model's levels; 0 is the finest")
      ->check(whole_number_in(0, std::numeric_limits<std::uint32_t>::max()))
      ->capture_default_str();
  app.add_option("--max-error", a.max_error,
                 "Use the coarsest level with at most this error by its calibration: 0.5% or "
                 "0.005 of the tool's volume")
      ->option_text("E");
  app.add_option("--deadline-us", a.deadline_us,
                 "Use the finest level that answers in this many microseconds here; results then "
                 "depend on the machine's speed. Wins over --max-error and --for-scene")
      ->option_text("T");
  app.add_flag("--for-scene", a.for_scene,
               "Use the finest level without spheres that the cloud's points cannot resolve");
}

void declare_motion(CLI::App& app, Arguments& a) {
  begin_group(app, "Poses that follow each other", Group::rare);
  app.add_flag(
      "--coherent", a.coherent,
      "The poses are one motion: a tool that passes wholly behind the surface stays inside "
      "until it comes out");
  app.add_option("--coupling", a.coupling,
                 "Take --poses for those of a haptic device that holds the tool by a spring and "
                 "damper: stiffness=N/m,damping=N s/m[,mass=kg][,rate=Hz]; needs --stiffness")
      ->option_text("VALUES");
}

void declare_frames(CLI::App& app, ReplayArguments& a) {
  begin_group(app, "Recorded frames", Group::rare);
  app.add_option("--rate", a.rate, "Steps per second along --poses with --frames (1000)")
      ->check(number_in(1, 1e6))
      ->option_text("R");
  app.add_option("--topic", a.topic,
                 "Topic of the depth images of a recording in MCAP, where it has several. One for "
                 "each --frames, in their order")
      ->allow_extra_args(false)
      ->option_text("TOPIC");
  app.add_option("--camera-poses", a.camera_poses,
                 "Path of the camera: TUM text or a pose per frame. Default: NAME.pose.txt beside "
                 "the frames, groundtruth.txt, or TF of a recording. One for each --frames, in "
                 "their order")
      ->allow_extra_args(false)
      ->option_text("FILE");
  app.add_option(
         "--remove", a.remove,
         "Take known solids, such as the robot and what it holds, out of each frame: a file "
         "(JSON Lines) that names them and tells their poses. What they hide is unseen")
      ->option_text("FILE");
  app.add_option(
         "--remove-margin", a.remove_margin,
         "How far these solids may have been from there, in m: a number, or "
         "time=S,calibration=M for the time by which a frame may be late times the speed of "
         "each, and the error of the camera's pose; 0 if not given")
      ->join(',')
      ->option_text("M or ERRORS");
  app.add_option("--frame-rate", a.frame_rate,
                 "Frames per second, where their names have numbers but no times")
      ->check(number_in(1e-3, 1e6))
      ->capture_default_str()
      ->option_text("R");
  app.add_option("--frame-latency", a.frame_latency,
                 "Seconds from the time of a frame until a step can see it")
      ->check(number_in(0, 3600))
      ->capture_default_str()
      ->option_text("T");
  app.add_flag("--align-starts", a.align_starts,
               "Path and frames begin together, whatever their times say");
  app.add_flag("--repeat-frames", a.repeat_frames,
               "Frames go back and forth as long as the path lasts; otherwise the last one stays");
  app.add_flag("--realtime", a.realtime,
               "Steps wait for the clock; otherwise as fast as it goes, with the same results");
  declare_camera(app, a.import);
}

void declare_outputs(CLI::App& app, Arguments& a) {
  begin_group(app, "Outputs");
  app.add_option("-o,--output", a.output, "Results: JSON Lines, or CSV if the name ends in .csv")
      ->capture_default_str();
  app.add_flag(
      "--bodies", a.bodies,
      "Each line also lists what each body of the scene gives: cloud, or what several cameras see, "
      "first, then solids");
  app.add_option(
         "--contacts", a.contacts,
         "Each line also lists its contacts, connected patches of what the tool shares with "
         "a body, or the parts of a pair with each other: the largest N, 16 if no number "
         "follows, and the rest in one")
      ->expected(0, 1)
      ->default_str("16")
      ->check(whole_number_in(1, 1 << 20))
      ->option_text("[N]");
  app.add_flag("--interval", a.interval,
               "Each line also tells between which volumes the true one lies, 95 times of 100");
  app.add_flag("--resume", a.resume,
               "Go on after the lines that an interrupted run with the same options left beside "
               "--output");
  app.add_option("--spheres-out", a.spheres_out,
                 "The spheres of the last pose by state: .csv, .ply (balls), .points.ply or .glb");
  app.add_option("--stats", a.stats, "Timings and device (JSON)");
  app.add_option("--view", a.view,
                 "A page (.html) that shows scene, tool, answers and path in any browser");
}

// Throws Error(invalid_argument) if the path has none of the suffixes of formats/spheres.md.
void check_spheres_path(const std::string& path) {
  if (!view::sphere_format(path)) {
    throw Error(ErrorKind::invalid_argument,
                "--spheres-out " + path +
                    ": the name must end in .csv, .ply (balls), .points.ply or "
                    ".glb");
  }
}

}  // namespace

void declare(CLI::App& app, Arguments& a) {
  declare_inputs(app, a);
  declare_outputs(app, a);
  declare_assembly(app, a);
  declare_robot(app, a);
  declare_requests(app, a);
  declare_measure(app, a);
  declare_collisions(app, a);
  declare_level(app, a);
  declare_motion(app, a);
  declare_frames(app, a.replay);
  declare_gone_options(app);
}

Leftover leftover_of(const Arguments& a, const CommonOptions& common) {
  if (a.resume) return Leftover::resume;
  return common.force ? Leftover::discard : Leftover::refuse;
}

// Refuses inputs and other outputs that a run would lose by keeping its lines there, even with
// --force: they would be gone before they are read.
void check_kept_lines(const Arguments& a, const std::vector<std::string>& inputs) {
  for (const std::string& kept : KeptLines::beside(a.output)) {
    const std::string reason =
        "--output keeps its lines in " + kept + " until they are done, which ";
    for (const std::string& input : inputs)
      if (file::is_same_file(kept, input))
        throw Error(ErrorKind::invalid_argument, reason + "is the input " + input, {},
                    "name another output");
    for (const auto& [option, path] :
         {std::pair{"--spheres-out", a.spheres_out}, {"--stats", a.stats}, {"--view", a.view}})
      if (file::is_same_file(kept, path))
        throw Error(ErrorKind::invalid_argument, reason + option + " names", {},
                    "name another file");
  }
}

void check_names(const Arguments& a, const CommonOptions& common) {
  std::vector<std::string> solids;
  for (const std::string& text : a.solids) solids.push_back(solid_from_text(text, "--solid").name);
  if (std::ranges::count(solids, "-") > 0)
    throw Error(ErrorKind::invalid_argument, "--solid is a file: standard input holds none");
  if (std::ranges::count(a.tools, "-") + std::ranges::count(a.clouds, "-") + (a.pairs == "-") +
          std::ranges::count(a.poses, "-") + (a.joints == "-") >
      1)
    throw Error(ErrorKind::invalid_argument,
                "only one of --tool, --cloud, --pairs, --poses and --joints can be standard input");
  if (a.serve && std::ranges::count(a.tools, "-") + std::ranges::count(a.clouds, "-") > 0)
    throw Error(
        ErrorKind::invalid_argument,
        "--serve reads its requests from standard input: name files for --tool and --cloud");
  if (a.serve && a.output.ends_with(".csv"))
    throw Error(ErrorKind::invalid_argument,
                "--serve answers in JSON: let the name of --output end in .jsonl");
  KeptLines::check(a.output, leftover_of(a, common));
  if (!a.spheres_out.empty()) check_spheres_path(a.spheres_out);
  std::vector<std::string> inputs{a.pairs, a.urdf, a.joints, a.srdf};
  inputs.insert(inputs.end(), a.replay.frames.begin(), a.replay.frames.end());
  inputs.insert(inputs.end(), a.replay.camera_poses.begin(), a.replay.camera_poses.end());
  inputs.insert(inputs.end(), a.clouds.begin(), a.clouds.end());
  inputs.insert(inputs.end(), a.tools.begin(), a.tools.end());
  inputs.insert(inputs.end(), solids.begin(), solids.end());
  inputs.insert(inputs.end(), a.poses.begin(), a.poses.end());
  check_files(inputs,
              {{"--output", a.output, std::nullopt, OutputForm::results},
               {"--spheres-out", a.spheres_out, std::nullopt},
               {"--stats", a.stats, std::nullopt, OutputForm::json},
               {"--view", a.view, std::nullopt, OutputForm::page}},
              common);
  check_kept_lines(a, inputs);
}

}  // namespace vpm::tools
