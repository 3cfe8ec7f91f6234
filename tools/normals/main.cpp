// vpm-normals: a depth image or a cloud of another program becomes a cloud with normals (.vpmc).

#include <chrono>
#include <cmath>
#include <optional>

#include "libvpm/cloud/cloud_file.h"
#include "libvpm/core/error.h"
#include "libvpm/file/checksum.h"
#include "libvpm/file/stream.h"
#include "libvpm/import/cloud_export.h"
#include "libvpm/import/import_cloud.h"
#include "tools/common/tool.h"

namespace vpm::tools {
namespace {

struct Arguments {
  std::string depth, output, report, export_path, camera_pose, method = "inverse-depth";
  std::vector<double> intrinsics;
  std::optional<double> depth_scale;
  int window = 7;
  double edge_gate = kEdgeGate;
};

void declare(CLI::App& app, Arguments& a) {
  app.add_option("depth", a.depth,
                 "Depth image (16-bit PNG, OpenEXR) or cloud (PCD, PLY); - is standard input");
  app.add_option("-o,--output", a.output, "Cloud to write (.vpmc); - is standard output");
  app.add_option("--intrinsics", a.intrinsics,
                 "fx,fy,cx,cy of the camera, pixels; an organised PCD tells its own")
      ->delimiter(',')
      ->expected(4)
      ->allow_extra_args(false);
  app.add_option("--depth-scale", a.depth_scale, "Units of the file per metre (PNG: 1000, else 1)");
  app.add_option("--method", a.method, "Normals by: inverse-depth, or pca as printed in 2017")
      ->check(CLI::IsMember({"inverse-depth", "pca"}))
      ->capture_default_str();
  app.add_option("--window", a.window, "Side of the window of a normal, pixels, odd, 3 to 31")
      ->capture_default_str();
  app.add_option("--edge-gate", a.edge_gate,
                 "Difference of inverse depth, relative, that is still one surface; 0: no edges")
      ->capture_default_str();
  app.add_option("--camera-pose", a.camera_pose,
                 "Camera (or the cloud's frame) in the world: tx,ty,tz,qx,qy,qz,qw");
  app.add_option("--report", a.report, "Facts and figures (JSON)");
  app.add_option("--export", a.export_path, "Also write the points with normals, .ply or .pcd");
}

void check(const Arguments& a, const CommonOptions& common) {
  const auto wrong = [](const std::string& message) { throw Error(ErrorKind::usage, message); };
  if (a.depth.empty()) wrong("no depth image is given: name a file, or - for a pipe");
  if (a.output.empty() && a.export_path.empty() && a.report.empty())
    wrong("nothing would be written: give -o OUT.vpmc, --export or --report");
  if ((a.output == "-") && (a.report == "-")) wrong("only one output can be standard output");
  if (a.depth_scale && !(*a.depth_scale > 0 && std::isfinite(*a.depth_scale)))
    wrong("--depth-scale must be finite and greater than 0");
  if (!a.export_path.empty()) check_points_path(a.export_path);
  check_output(a.output, file::Kind::cloud, common);
  check_output(a.report, common);
  check_output(a.export_path, common);
}

ImportOptions import_options(const Tool& tool, const Arguments& a) {
  ImportOptions options;
  options.normals = {normal_method_from_text(a.method), a.window, a.edge_gate};
  check_normal_options(options.normals);
  options.units_per_metre = a.depth_scale;
  if (!a.intrinsics.empty()) {
    options.intrinsics = {a.intrinsics[0], a.intrinsics[1], a.intrinsics[2], a.intrinsics[3]};
    check_intrinsics(*options.intrinsics);
  }
  if (!a.camera_pose.empty()) {
    double deviation = 0;
    options.to_world = pose_from_text(a.camera_pose, &deviation);
    if (deviation > kRotationRounding)
      tool.note("--camera-pose: its quaternion is not of unit length and has been normalised");
  }
  return options;
}

nlohmann::json report_of(const ImportedCloud& imported, const Arguments& a, double seconds) {
  nlohmann::json report{{"width", imported.width},
                        {"height", imported.height},
                        {"points", imported.cloud.size()},
                        {"invalid", imported.invalid},
                        {"without_normal", imported.without_normal},
                        {"seconds", seconds}};
  if (imported.normals_estimated) {
    report["method"] = a.method;
    report["window"] = a.window;
    report["edge_gate"] = a.edge_gate;
  } else {
    report["method"] = "file";
  }
  if (imported.cloud.sensor) {
    const Intrinsics& k = imported.cloud.sensor->camera.intrinsics;
    report["intrinsics"] = {k.fx, k.fy, k.cx, k.cy};
  }
  return report;
}

void say_notes(const Tool& tool, const std::string& name, const ImportedCloud& imported) {
  if (!imported.cloud.sensor) return;
  const Camera& camera = imported.cloud.sensor->camera;
  const Intrinsics& k = camera.intrinsics;
  const std::string text = std::to_string(k.fx) + "," + std::to_string(k.fy) + "," +
                           std::to_string(k.cx) + "," + std::to_string(k.cy);
  if (imported.intrinsics_recovered)
    tool.note(name + ": intrinsics recovered from its points: " + text);
  if (!(k.cx >= 0 && k.cy >= 0 && k.cx < camera.width && k.cy < camera.height)) {
    tool.warn(name + ": the principal point of " + text + " lies outside of the image of " +
              std::to_string(camera.width) + " x " + std::to_string(camera.height) +
              " pixels; are these the intrinsics of this image's size?");
  }
}

void run(const Tool& tool, const Arguments& a) {
  check(a, tool.common());
  const ImportOptions options = import_options(tool, a);
  const auto start = std::chrono::steady_clock::now();
  const std::string name = a.depth == "-" ? "standard input" : a.depth;
  const std::vector<std::byte> bytes = file::read_all(a.depth);
  ImportedCloud imported = import_cloud(bytes, name, options);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  say_notes(tool, name, imported);
  imported.cloud.provenance = {{"tool", tool.name()},
                               {"version", VPM_VERSION},
                               {"parameters", tool.parameters()},
                               {"input_hash", file::content_hash({bytes})}};
  if (!a.report.empty()) file::write_all(a.report, report_of(imported, a, seconds).dump(2) + "\n");
  if (!a.export_path.empty()) write_points(a.export_path, imported.cloud);
  if (!a.output.empty()) write_cloud(a.output, imported.cloud);
}

}  // namespace
}  // namespace vpm::tools

int main(int argc, char** argv) {
  using namespace vpm::tools;
  Tool tool("vpm-normals", "Points with normals of a depth image or of another program's cloud");
  Arguments arguments;
  declare(tool.app(), arguments);
  return tool.run(argc, argv, [&] { run(tool, arguments); });
}
