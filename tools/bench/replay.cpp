// vpm-bench replay: a haptic loop on a recorded stream of frames.

#include <cmath>
#include <filesystem>

#include "libvpm/file/stream.h"
#include "libvpm/file/temporary_folder.h"
#include "libvpm/recording/recording.h"
#include "libvpm/synthetic/render.h"
#include "libvpm/synthetic/scenes.h"
#include "libvpm/synthetic/shapes.h"
#include "tools/bench/penetration_case.h"
#include "tools/bench/replay_parts.h"
#include "tools/bench/suite.h"

namespace vpm::bench {
namespace {

namespace fs = std::filesystem;

// Returns an organised PCD of a depth image.
std::string pcd_of(const DepthImage& depth, const Intrinsics& k) {
  const std::string size = std::to_string(depth.width), rows = std::to_string(depth.height);
  std::string text = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " +
                     size + "\nHEIGHT " + rows + "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " +
                     std::to_string(depth.depth.size()) + "\nDATA binary\n";
  for (std::uint32_t v = 0; v < depth.height; ++v) {
    for (std::uint32_t u = 0; u < depth.width; ++u) {
      const float z = depth.depth[depth.index(u, v)];
      const Vec3f p = z > 0 ? narrow(unproject(k, u, v, z)) : Vec3f{NAN, NAN, NAN};
      for (const float x : {p.x, p.y, p.z})
        text.append(reinterpret_cast<const char*>(&x), sizeof x);
    }
  }
  return text;
}

// Writes a recording for runs without one: a camera that passes a ball, 15 frames with Kinect
// noise. Its destructor removes the folder.
class SyntheticRecording {
 public:
  SyntheticRecording() {
    synthetic::Scene scene = synthetic::make_scene("ball");
    constexpr int kImages = 15;
    constexpr double kStep = 0.01;  // m between frames
    for (int k = 0; k < kImages; ++k) {
      scene.camera.to_world.translation = {kStep * k, 0, 0};
      const std::string stem = folder_.path("frame-" + std::to_string(100 + k));
      const DepthImage depth = synthetic::render_with_kinect_noise(
          *scene.surface, scene.camera, static_cast<std::uint64_t>(k) + 1);
      file::write_all(stem + ".pcd", pcd_of(depth, scene.camera.intrinsics));
      file::write_all(stem + ".pose.txt",
                      "1 0 0 " + std::to_string(kStep * k) + "\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
    }
    const Intrinsics& i = scene.camera.intrinsics;
    file::write_all(folder_.path("camera-intrinsics.txt"),
                    std::to_string(i.fx) + " 0 " + std::to_string(i.cx) + "\n0 " +
                        std::to_string(i.fy) + " " + std::to_string(i.cy) + "\n0 0 1\n");
  }
  std::string folder() const { return folder_.path().string(); }

 private:
  file::TemporaryFolder folder_;
};

// Returns the folder of the recording: the red kitchen in a folder of depth images, or the folder
// itself.
std::string recording_in(const std::string& data) {
  const fs::path kitchen = fs::path(data) / "depth" / "redkitchen_seq";
  return fs::is_directory(kitchen) ? kitchen.string() : data;
}

ReplayTool make_replay_tool(bool quick) {
  constexpr std::uint32_t kSoakLevel = 250;
  const std::vector<std::uint32_t> levels = quick ? std::vector<std::uint32_t>{kSoakLevel, 1000}
                                                  : std::vector<std::uint32_t>{1000, 17000, 100000};
  std::vector<std::uint32_t> all = levels;
  if (!quick) all.insert(all.begin(), kSoakLevel);
  const Solid solid = synthetic::make_twisted_torus(0.09, 0.05, 3, 900);
  return {solid, make_tool(solid, all), levels, kSoakLevel};
}

}  // namespace

Report run_replay(const SuiteOptions& options) {
  Report report;
  report.suite = "replay";
  std::optional<SyntheticRecording> synthetic;
  if (options.data.empty()) synthetic.emplace();
  const std::string folder = synthetic ? synthetic->folder() : recording_in(options.data);
  if (!synthetic) read_recording(folder, {});  // refuses before minutes have passed
  const ReplayTool tool = make_replay_tool(options.quick);
  report.settings = {{"quick", options.quick},
                     {"shape", "twisted torus, 0.25 m"},
                     {"spheres", tool.levels},
                     {"recording", synthetic ? "synthetic" : fs::path(folder).filename().string()}};
  const bool on_cpu = !options.device.is_cuda();
  std::vector<std::function<void()>> parts;
  if (on_cpu) parts.emplace_back([&] { time_frames(options, report); });
  parts.emplace_back([&] { time_queries(tool, options, report); });
  parts.emplace_back([&] { time_clutter(tool, options, report); });
  if (on_cpu) parts.emplace_back([&] { time_coherence(tool, options, report); });
  parts.emplace_back([&] { time_points_outside(tool, options, report); });
  parts.emplace_back([&] { run_stream(tool, folder, options, report); });
  parts.emplace_back([&] { run_soak(tool, folder, options, report); });
  for (std::size_t k = 0; k < parts.size(); ++k) {
    parts[k]();
    if (options.progress)
      options.progress(static_cast<double>(k + 1) / static_cast<double>(parts.size()));
  }
  return report;
}

}  // namespace vpm::bench
