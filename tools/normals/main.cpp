// vpm-normals: turns a depth image, or another program's cloud, into a cloud with normals (.vpmc).

#include <vpm/error.h>
#include <vpm/version.h>

#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "libvpm/cloud/cloud.h"
#include "libvpm/file/checksum.h"
#include "libvpm/file/stream.h"
#include "libvpm/import/cloud_export.h"
#include "libvpm/import/import_cloud.h"
#include "libvpm/recording/mcap/mcap_file.h"
#include "libvpm/view/page.h"
#include "tools/common/error_text.h"
#include "tools/common/import_arguments.h"
#include "tools/common/list_run.h"
#include "tools/common/list_worker.h"
#include "tools/common/number_checks.h"
#include "tools/common/program.h"
#include "tools/common/remarks.h"
#include "tools/common/solid_argument.h"
#include "tools/normals/arguments.h"
#include "tools/normals/scan_view.h"

namespace vpm::tools {
namespace {

void declare(CLI::App& app, Arguments& a) {
  app.add_option("depth", a.depth,
                 "Depth image (16-bit PNG, OpenEXR, TIFF, PGM, PFM, NPY) or cloud (PCD, PLY); - is "
                 "standard input. Or a recording: a folder of such files, or an MCAP of ROS 2");
  begin_group(app, "Outputs");
  app.add_option("-o,--output", a.output,
                 "Cloud to write (.vpmc); - is standard output. For a recording, the folder of its "
                 "clouds, for vpm-query --frames");
  app.add_option("--report", a.report, "Write facts about image and cloud here (JSON)");
  app.add_option("--export", a.export_path, "Write the points with normals here too: .ply or .pcd");
  app.add_option("--view", a.view,
                 "Write a page (.html) here that shows surface, normals and unset pixels in a "
                 "browser");
  declare(app, a.import);
  begin_group(app, "Known solids");
  app.add_option(
         "--remove", a.remove,
         "Take this solid, a tool model (.vpmg) or mesh at its pose in the world, out of the "
         "depth image: the robot is no obstacle, and what it hides is unseen. May be given "
         "several times")
      ->allow_extra_args(false)
      ->option_text("FILE[@TX,TY,TZ,QX,QY,QZ,QW]");
  app.add_option("--remove-margin", a.remove_margin,
                 "How far these solids may have been from there, in m: a number, or "
                 "time=S,speed=M/S,calibration=M for the time by which the image may be late times "
                 "their speed, and the error of the camera's pose; 0 if not given")
      ->join(',')
      ->option_text("M or ERRORS");
  begin_group(app, "Recordings", Group::rare);
  app.add_option("--topic", a.topic,
                 "Topic of the depth images of a recording in MCAP, where it has several")
      ->option_text("TOPIC");
  app.add_option("--at", a.at,
                 "Time of the image to read of a recording in MCAP, s: that of a header, or +S "
                 "after the first; else the first image")
      ->option_text("TIME");
  app.add_option("--camera-poses", a.camera_poses,
                 "For a recording, the path of the camera: TUM text or a pose per frame; else "
                 "NAME.pose.txt beside the frames, groundtruth.txt, or TF of a recording");
  app.add_option("--frame-rate", a.frame_rate,
                 "Frames per second of a recording whose names have numbers but no times")
      ->check(number_in(1e-3, 1e6))
      ->capture_default_str()
      ->option_text("R");
}

void check(const Arguments& a, const CommonOptions& common) {
  if (a.depth.empty()) refuse_usage("no depth image is given: name a file, or - for a pipe");
  if (a.output.empty() && a.export_path.empty() && a.report.empty() && a.view.empty())
    refuse_usage("nothing would be written: give -o OUT.vpmc, --export, --report or --view");
  if (!a.camera_poses.empty() && mcap::files_of(a.depth).empty())
    refuse_usage("--camera-poses is for a recording: give one frame's pose by --camera-pose");
  check_camera(a);
  if (!a.export_path.empty()) check_points_path(a.export_path);
  std::vector<std::string> inputs{a.depth};
  for (const std::string& text : a.remove) inputs.push_back(solid_from_text(text, "--remove").name);
  check_files(inputs,
              {{"--output", a.output, file::Kind::cloud},
               {"--report", a.report, std::nullopt, OutputForm::json},
               {"--export", a.export_path, std::nullopt},
               {"--view", a.view, std::nullopt, OutputForm::page}},
              common);
}

nlohmann::json report_of(const ImportedCloud& imported, const Arguments& a, double seconds) {
  nlohmann::json report{{"width", imported.width},
                        {"height", imported.height},
                        {"points", imported.cloud.size()},
                        {"invalid", imported.invalid},
                        {"without_normal", imported.without_normal},
                        {"seconds", seconds}};
  if (!a.remove.empty()) report["removed"] = imported.removed;
  if (imported.normals_estimated) {
    report["method"] = a.import.method;
    report["window"] = a.import.window;
    report["edge_gate"] = a.import.edge_gate;
  } else {
    report["method"] = "file";
  }
  if (imported.cloud.sensor) {
    const Intrinsics& k = imported.cloud.sensor->camera.intrinsics;
    report["intrinsics"] = {k.fx, k.fy, k.cx, k.cy};
  }
  const ScanFacts& facts = imported.facts;
  if (facts.depth)
    report["depth"] = {{"nearest", facts.depth->nearest},
                       {"median", facts.depth->median},
                       {"farthest", facts.depth->farthest}};
  report["measured"] = facts.measured;
  report["extent"] = {{facts.low.x, facts.low.y, facts.low.z},
                      {facts.high.x, facts.high.y, facts.high.z}};
  return report;
}

// Returns the numbers with as many digits as a fit gives.
std::string text_of(const Intrinsics& k) {
  char text[128];
  std::snprintf(text, sizeof text, "%.7g,%.7g,%.7g,%.7g", k.fx, k.fy, k.cx, k.cy);
  return text;
}

void say_facts(const Program& program, const std::string& name, const ImportedCloud& imported) {
  if (imported.intrinsics_recovered) {
    program.note(name + ": intrinsics recovered from its points: " +
                 text_of(imported.cloud.sensor->camera.intrinsics));
  }
  say(program, name, imported.remarks);
  program.detail(name + ": " + words_of(imported.facts));
}

// Returns the options with the numbers that they stand for in place of the names of files.
nlohmann::json parameters_of(const Program& program, const ImportOptions& options) {
  nlohmann::json parameters = program.parameters();
  if (options.intrinsics) {
    const Intrinsics& k = *options.intrinsics;
    parameters["intrinsics"] = {k.fx, k.fy, k.cx, k.cy};
  }
  if (options.to_world) {
    const Quaternion q = quaternion_from_rotation(options.to_world->rotation);
    const Vec3 t = options.to_world->translation;
    parameters["camera-pose"] = {t.x, t.y, t.z, q.x, q.y, q.z, q.w};
  }
  return parameters;
}

void run(const Program& program, const Arguments& a) {
  if (is_recording(a)) return run_recording(program, a);
  check(a, program.common());
  if (!a.view.empty()) view::check_available();
  ImportOptions options = import_options(program, a.import, a.depth);
  const auto removed = remove_solids(program, a, options);
  const auto start = std::chrono::steady_clock::now();
  const auto [name, bytes] = source_of(program, a, options);
  ImportedCloud imported;
  try {
    imported = import_cloud(bytes, name, options);
  } catch (const NothingMeasured&) {  // maybe since a solid hides all
    if (removed) removed->say(program);
    throw;
  }
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  say_facts(program, name, imported);
  if (removed) removed->say(program);
  imported.cloud.provenance = provenance_of(program, options, bytes);
  if (!a.report.empty()) file::write_all(a.report, report_of(imported, a, seconds).dump(2) + "\n");
  if (!a.view.empty()) write_scan_view(a.view, a.depth, imported, options.normals);
  if (!a.export_path.empty())
    say(program, a.export_path, write_points(a.export_path, imported.cloud));
  if (!a.output.empty()) write_cloud(a.output, imported.cloud);
}

}  // namespace

RemovedSolids::RemovedSolids(const Program& program, const Arguments& a)
    : removal(program, a.remove), margin(removal_margin_from_text(a.remove_margin, false)) {}

std::unique_ptr<RemovedSolids> remove_solids(const Program& program, const Arguments& a,
                                             ImportOptions& options) {
  if (a.remove.empty() && !a.remove_margin.empty())
    refuse_usage("--remove-margin needs --remove, which names the solids");
  if (a.remove.empty()) return nullptr;
  auto solids = std::make_unique<RemovedSolids>(program, a);
  const RemovalMargin& m = solids->margin;
  std::vector<SolidPlace> places;
  for (const Pose& pose : solids->removal.poses())
    places.push_back({pose, m.distance + m.seconds * m.speed.value_or(0)});
  options.remove = [places, &removal = solids->removal](CloudSensor& image, double) {
    return removal.remove(places, image);
  };
  return solids;
}

nlohmann::json provenance_of(const Program& program, const ImportOptions& options,
                             std::span<const std::byte> bytes) {
  return {{"tool", program.name()},
          {"version", VPM_VERSION},
          {"parameters", parameters_of(program, options)},
          {"input_hash", file::content_hash({bytes})}};
}

// Does what the command line, or a configuration, says. Returns the exit status.
int run_program(int argc, char** argv) {
  Program program("vpm-normals",
                  "Make a cloud with normals from a depth image or another program's cloud");
  Arguments arguments;
  ListArguments list;
  declare(program.app(), arguments);
  declare_list(program.app(), list);
  program.show_examples({
      "vpm-normals depth.png -o scene.vpmc --intrinsics 525,525,319.5,239.5 --depth-scale 5000",
      "vpm-normals scene.ply -o points.vpmc   # points of another program",
      "vpm-normals frames -o clouds --intrinsics camera.txt --depth-scale 5000   # a recording",
  });
  return program.run(argc, argv, [&] {
    if (!run_list(program, list, {"depth", ".vpmc"})) run(program, arguments);
  });
}

}  // namespace vpm::tools

int main(int argc, char** argv) {
  return vpm::tools::run_or_work(argc, argv, vpm::tools::run_program);
}
