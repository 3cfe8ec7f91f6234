// The part of `vpm-bench replay` in clutter: single queries beside a distance grid of the tool, and
// batches of poses.

#include <algorithm>
#include <cstdio>
#include <optional>
#include <utility>

#include "libvpm/query/tool_query.h"
#include "tools/bench/clutter.h"
#include "tools/bench/poses_in_clutter.h"
#include "tools/bench/recorded_images.h"
#include "tools/bench/replay_parts.h"
#include "tools/bench/replay_peers.h"

namespace vpm::bench {
namespace {

// What a camera sees of many things, and poses of the tool among them.
struct ClutteredScene {
  std::string name;
  AnyBody body;
  PixelCloud pixels;
  std::vector<Pose> poses;  // the whole tool is before the camera's plane, as the grid needs it
};

ClutteredScene make_scene(const std::string& name, const Cloud& cloud, const ToolModel& tool,
                          std::size_t count) {
  const Camera& camera = cloud.sensor->camera;
  std::vector<Pose> poses = poses_in_clutter(cloud, 2 * count);
  const Pose to_camera = inverse(camera.to_world);
  std::erase_if(poses, [&](const Pose& pose) {
    return (to_camera * (pose * tool.center_of_mass)).z < 2 * tool.radius;
  });
  poses.resize(std::min(count, poses.size()));
  return {name, AnyBody(cloud), make_pixel_cloud(cloud.sensor->depth, camera), std::move(poses)};
}

// Holds the microseconds of each pose, the shortest of some rounds: other programs only make it
// longer.
struct PoseTimes {
  std::vector<double> measure, grid;
};

// Asks the measure and the grid in turn for each pose; no grid, no times of it.
PoseTimes time_poses(const ClutteredScene& scene, ToolQuery& query, const Peers* grid, int rounds) {
  PoseTimes best;
  const auto keep_least = [](std::vector<double>& times, std::size_t k, double us) {
    if (times.size() <= k) times.push_back(us);
    times[k] = std::min(times[k], us);
  };
  const Pose& camera = scene.pixels.camera.to_world;
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t k = 0; k < scene.poses.size(); ++k) {
      const Pose& pose = scene.poses[k];
      keep_least(best.measure, k, 1e6 * seconds_of([&] { query.run(scene.body, pose); }));
      if (grid == nullptr) continue;
      const Pose seen = relative_to(camera, pose);
      keep_least(best.grid, k, 1e6 * seconds_of([&] { grid->penalty(scene.pixels, seen); }));
    }
  }
  return best;
}

void add_times(const ClutteredScene& scene, std::uint32_t spheres, PoseTimes times,
               Report& report) {
  nlohmann::json row{{"part", "clutter"},
                     {"scene", scene.name},
                     {"spheres", spheres},
                     {"poses", scene.poses.size()}};
  std::string text;
  for (auto [name, of] : {std::pair("", &times.measure), std::pair("grid_", &times.grid)}) {
    if (of->empty()) continue;
    const Durations us(std::move(*of));
    row[name + std::string("median_us")] = us.quantile(0.5);
    row[name + std::string("p99_us")] = us.quantile(0.99);
    char part[80];
    std::snprintf(part, sizeof part, "%s%.1f us (p99 %.1f)", *name ? ", distance grid " : "",
                  us.quantile(0.5), us.quantile(0.99));
    text += part;
  }
  report.results.push_back(std::move(row));
  report.summary +=
      "clutter, " + scene.name + ", " + std::to_string(spheres) + " spheres: " + text + "\n";
}

// Times batches of poses until at least as many as in the largest have been asked.
void time_batches(const ClutteredScene& scene, ToolQuery& query, std::uint32_t spheres,
                  const std::vector<std::size_t>& sizes, Report& report) {
  report.summary += "  batches, us a pose:";
  for (const std::size_t size : sizes) {
    std::vector<Pose> poses;
    for (std::size_t k = 0; k < size; ++k) poses.push_back(scene.poses[k % scene.poses.size()]);
    std::vector<Result> results(size);
    const auto run = [&] { query.run(scene.body, jobs_of(poses), results); };
    run();
    const std::size_t batches = std::max<std::size_t>(3, sizes.back() / size / 4);
    const double us = 1e6 * seconds_of([&] {
                        for (std::size_t k = 0; k < batches; ++k) run();
                      }) /
                      static_cast<double>(batches * size);
    report.results.push_back({{"part", "batches in clutter"},
                              {"scene", scene.name},
                              {"spheres", spheres},
                              {"batch", size},
                              {"us_a_pose", us},
                              {"poses_per_second", 1e6 / us}});
    char text[60];
    std::snprintf(text, sizeof text, " %zu: %.2f", size, us);
    report.summary += text;
  }
  report.summary += "\n";
}

}  // namespace

void time_clutter(const ReplayTool& tool, const SuiteOptions& suite, Report& report) {
  const ThreadCap cap(suite, 1);
  const bool on_device = suite.device.is_cuda();
  const std::size_t poses = suite.quick ? 30 : 700;
  std::vector<ClutteredScene> scenes;
  scenes.push_back(make_scene("things on a table", make_clutter(), tool.model, poses));
  if (!suite.data.empty()) {
    for (const RecordedImage& image : recorded_images(suite.data))
      if (image.cloud.sensor)
        scenes.push_back(make_scene(image.name, image.cloud, tool.model, poses));
  }
  std::optional<Peers> grid;
  if (!on_device) grid.emplace(tool.solid);  // which the host reads
  const std::vector<std::size_t> batches =
      suite.quick ? std::vector<std::size_t>{1, 16}
                  : std::vector<std::size_t>{1, 4, 16, 64, 256, 1024, 4096, 16384};
  for (const ClutteredScene& scene : scenes) {
    for (const std::uint32_t level : tool.levels) {
      ToolQuery query(tool.model, {.level = level, .device = suite.device});
      add_times(scene, level,
                time_poses(scene, query, grid ? &*grid : nullptr, suite.quick ? 1 : 3), report);
      if (on_device) time_batches(scene, query, level, batches, report);
    }
  }
}

}  // namespace vpm::bench
