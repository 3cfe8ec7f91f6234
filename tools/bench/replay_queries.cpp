// The parts of `vpm-bench replay` that need no recording: they query one frame of a synthetic
// scene.

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "libvpm/cloud/normals.h"
#include "libvpm/core/parallel.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/scene/frame_preparation.h"
#include "libvpm/synthetic/render.h"
#include "libvpm/synthetic/scenes.h"
#include "tools/bench/penetration_case.h"
#include "tools/bench/replay_parts.h"
#include "tools/bench/replay_peers.h"
#include "tools/bench/suite.h"
#include "tools/bench/view.h"

namespace vpm::bench {
namespace {

constexpr double kInside = 0.05;          // in parts of the tool's volume
constexpr double kCoherentStep = 0.5e-3;  // m

synthetic::Scene the_scene() {
  return synthetic::make_scene("tilted-wall");
}

DepthImage noisy_depth(const synthetic::Scene& scene) {
  return synthetic::render_with_kinect_noise(*scene.surface, scene.camera, kNoiseSeed);
}

// Returns the pose along the optical axis at which kInside of the tool is inside, by bisection.
Pose pose_inside(const ToolModel& tool, const AnyBody& cloud) {
  ToolQuery query(tool, {});
  double clear = 1 - 2 * tool.radius, deep = 1 + tool.radius;
  constexpr int kHalvings = 30;
  for (int k = 0; k < kHalvings; ++k) {
    const double z = 0.5 * (clear + deep);
    (query.run(cloud, {turned(), {0, 0, z}}).volume_fraction > kInside ? deep : clear) = z;
  }
  return {turned(), {0, 0, deep}};
}

// Returns poses on a circle of this radius around `middle`, no two of them the same.
std::vector<Pose> circle(const Pose& middle, double radius, int poses) {
  std::vector<Pose> path(static_cast<std::size_t>(poses), middle);
  for (std::size_t k = 0; k < path.size(); ++k) {
    const double angle = 2 * kPi * static_cast<double>(k) / poses;
    path[k].translation += Vec3{radius * std::cos(angle), radius * std::sin(angle), 0};
  }
  return path;
}

void add_query(Report& report, const std::string& what, std::uint32_t spheres, int threads,
               const Durations& d, double volume_fraction) {
  report.results.push_back({{"part", "query"},
                            {"what", what},
                            {"spheres", spheres},
                            {"threads", threads},
                            {"median_us", 1e6 * d.quantile(0.5)},
                            {"p99_us", 1e6 * d.quantile(0.99)},
                            {"volume_fraction", volume_fraction},
                            {"runs", d.size()}});
  char line[160];
  std::snprintf(line, sizeof line, "%-22s %7u spheres, %d thread%s %10.1f us (p99 %.1f)\n",
                what.c_str(), spheres, threads, threads > 1 ? "s:" : ": ", 1e6 * d.quantile(0.5),
                1e6 * d.quantile(0.99));
  report.summary += line;
}

// Times two functions in alternating calls, so that whatever the machine does meanwhile affects
// both.
std::pair<Durations, Durations> timed_in_turn(int calls, int warm_up,
                                              const std::function<void(int)>& first,
                                              const std::function<void(int)>& second) {
  std::vector<double> a, b;
  for (int k = 0; k < warm_up + calls; ++k) {
    for (auto [body, seconds] : {std::pair(&first, &a), std::pair(&second, &b)}) {
      const double took = seconds_of([&] { (*body)(k); });
      if (k >= warm_up) seconds->push_back(took);
    }
  }
  return {Durations(std::move(a)), Durations(std::move(b))};
}

// Returns a wall seen by a camera of this width; the left part of the image is the same for all
// widths.
Cloud wide_view(std::uint32_t width, bool keeps_camera) {
  synthetic::Scene scene = synthetic::make_scene("wall");
  scene.camera.width = width;
  Cloud cloud =
      make_cloud(synthetic::render(*scene.surface, scene.camera), scene.camera, NormalOptions{});
  return keeps_camera ? cloud : without_camera(cloud);
}

// Returns a wall 80 degrees off the optical axis, seen by every eighth pixel: points far apart,
// with disks larger than the tool.
Cloud sparse_grazing_view() {
  constexpr double kTilt = 80 * kPi / 180;
  constexpr std::uint32_t kStep = 8;
  const Vec3 normal{0, std::sin(kTilt), -std::cos(kTilt)};
  const Camera camera = the_scene().camera;
  Cloud cloud;
  for (std::uint32_t v = 0; v < camera.height; v += kStep) {
    for (std::uint32_t u = 0; u < camera.width; u += kStep) {
      const Vec3 ray = unproject(camera.intrinsics, u, v, 1);
      const double z = normal.z / dot(normal, ray);  // on the plane through (0, 0, 1)
      if (!(z > 0 && z < 5)) continue;
      cloud.positions.push_back(narrow(z * ray));
      cloud.normals.push_back(narrow(normal));
      cloud.radii.push_back(static_cast<float>(10 * kStep * z / camera.intrinsics.fx));
    }
  }
  return cloud;
}

}  // namespace

double seconds_of(const std::function<void()>& body) {
  const auto start = std::chrono::steady_clock::now();
  body();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Durations timed(int calls, int warm_up, const std::function<void(int call)>& body) {
  std::vector<double> seconds;
  for (int k = 0; k < warm_up + calls; ++k) {
    const double took = seconds_of([&] { body(k); });
    if (k >= warm_up) seconds.push_back(took);
  }
  return Durations(std::move(seconds));
}

namespace {

// Frame, poses and hand-written alternatives of the timed queries.
struct QueryScene {
  explicit QueryScene(const ReplayTool& tool, const SuiteOptions& suite)
      : scene(the_scene()),
        depth(noisy_depth(scene)),
        cloud(make_cloud(depth, scene.camera, NormalOptions{})),
        prepared(cloud),
        poses(circle(pose_inside(tool.model, prepared), kRadius, 64)),
        calls(suite.quick ? 64 : 1280),
        few(suite.quick ? 3 : 31) {}

  Pose pose(int k) const { return poses[static_cast<std::size_t>(k) % poses.size()]; }

  static constexpr double kRadius = 1e-3;  // m
  static constexpr int kWarmUp = 16;
  synthetic::Scene scene;
  DepthImage depth;
  Cloud cloud;
  AnyBody prepared;
  std::vector<Pose> poses;
  int calls, few;  // calls of fast and of slow queries
};

void time_level(const ReplayTool& tool, const SuiteOptions& suite, const QueryScene& seen,
                std::uint32_t level, int threads, Report& report) {
  ToolQuery query(tool.model, {.level = level, .device = suite.device});
  Result result;
  const auto add = [&](const char* what, const Durations& durations) {
    add_query(report, what, level, threads, durations, result.volume_fraction);
  };
  add("refined", timed(seen.calls, QueryScene::kWarmUp,
                       [&](int k) { result = query.run(seen.prepared, seen.pose(k)); }));
  add("refined, cold cloud", timed(seen.few, 1, [&](int k) {
        const AnyBody anew(seen.cloud);
        result = query.run(anew, seen.pose(k));
      }));
}

void time_sparse_points(const ReplayTool& tool, const SuiteOptions& suite, const QueryScene& seen,
                        const AnyBody& sparse, int threads, Report& report) {
  ToolQuery query(tool.model, {.level = tool.levels.front(), .device = suite.device});
  Result result;
  const Durations durations = timed(seen.few, 1, [&](int k) {
    result = query.run(sparse, {seen.pose(k).rotation, {0, 0, 1}});
  });
  add_query(report, "refined, sparse points", tool.levels.front(), threads, durations,
            result.volume_fraction);
}

void time_peers(const ReplayTool& tool, const SuiteOptions& suite, const QueryScene& seen,
                const Peers& peers, const PixelCloud& pixels, int threads, Report& report) {
  const auto to_camera = [&](int k) {
    return relative_to(seen.scene.camera.to_world, seen.pose(k));
  };
  Wrench force;
  const Durations of_grid = timed(seen.calls, QueryScene::kWarmUp,
                                  [&](int k) { force = peers.penalty(pixels, to_camera(k)); });
  add_query(report, "distance grid", 0, threads, of_grid, 0);
  double volume = 0;
  const Durations of_count = timed(suite.quick ? 16 : 320, QueryScene::kWarmUp, [&](int k) {
    volume = peers.count_voxels(pixels, to_camera(k));
  });
  add_query(report, "voxel count", 0, threads, of_count, volume / tool.model.volume);
}

}  // namespace

void time_queries(const ReplayTool& tool, const SuiteOptions& suite, Report& report) {
  const QueryScene seen(tool, suite);
  const AnyBody sparse(sparse_grazing_view());
  const Peers peers(tool.solid);
  const PixelCloud pixels = make_pixel_cloud(seen.depth, seen.scene.camera);
  for (const int threads : compared_threads(suite)) {
    const ThreadCap cap(suite, threads);
    for (const std::uint32_t level : tool.levels)
      time_level(tool, suite, seen, level, threads, report);
    time_sparse_points(tool, suite, seen, sparse, threads, report);
    time_peers(tool, suite, seen, peers, pixels, threads, report);
  }
  report.settings["query"] = {{"points", seen.prepared.positions().size()},
                              {"scene", seen.scene.name},
                              {"noise", "kinect"},
                              {"inside", kInside},
                              {"peer_voxels", kPeerVoxels}};
}

struct CoherentPath {
  std::string name;
  std::vector<Pose> poses;
};

// Queries every pose by a query that remembers the poses before, and by one that does not.
void time_coherence(const ReplayTool& tool, const AnyBody& cloud, const CoherentPath& path,
                    std::uint32_t level, int rounds, Report& report) {
  const int poses = static_cast<int>(path.poses.size());
  ToolQuery stateless(tool.model, {.level = level}),
      coherent(tool.model, {.level = level, .coherent = true});
  Result alone, following;
  bool same = true;
  const auto pose = [&](int k) {
    return path.poses[static_cast<std::size_t>(k) % path.poses.size()];
  };
  const auto [a, b] = timed_in_turn(
      rounds * poses, poses / 4,
      [&](int k) {
        same = same && alone == following;
        alone = stateless.run(cloud, pose(k));
      },
      [&](int k) { following = coherent.run(cloud, pose(k)); });
  const double ratio = b.mean() / a.mean();
  report.results.push_back({{"part", "coherent"},
                            {"path", path.name},
                            {"spheres", level},
                            {"step_mm", 1e3 * kCoherentStep},
                            {"stateless_us", 1e6 * a.mean()},
                            {"stateless_p99_us", 1e6 * a.quantile(0.99)},
                            {"coherent_us", 1e6 * b.mean()},
                            {"coherent_p99_us", 1e6 * b.quantile(0.99)},
                            {"ratio", ratio},
                            {"same_bits", same},
                            {"runs", a.size()}});
  char line[200];
  std::snprintf(
      line, sizeof line, "coherent, %-12s %7u spheres: %.1f us, stateless %.1f us: %.2f; %s bits\n",
      path.name.c_str(), level, 1e6 * b.mean(), 1e6 * a.mean(), ratio, same ? "same" : "other");
  report.summary += line;
}

void time_coherence(const ReplayTool& tool, const SuiteOptions& suite, Report& report) {
  const synthetic::Scene scene = the_scene();
  const AnyBody cloud(make_cloud(noisy_depth(scene), scene.camera, NormalOptions{}));
  constexpr double kRadius = 20e-3;
  const int poses = static_cast<int>(2 * kPi * kRadius / kCoherentStep),
            rounds = suite.quick ? 1 : 8;
  const Pose inside = pose_inside(tool.model, cloud);
  const Pose before{inside.rotation, inside.translation - Vec3{0, 0, 1.5 * tool.model.radius}};
  const CoherentPath contact{"in contact", circle(inside, kRadius, poses)},
      free{"free", circle(before, kRadius, poses)};
  const ThreadCap cap(suite, 1);
  for (const std::uint32_t level : tool.levels) {
    time_coherence(tool, cloud, free, level, rounds, report);
    time_coherence(tool, cloud, contact, level, rounds, report);
  }
}

void time_points_outside(const ReplayTool& tool, const SuiteOptions& suite, Report& report) {
  const ThreadCap cap(suite, 1);
  for (const bool camera : {true, false}) {
    const AnyBody once(wide_view(640, camera)), twice(wide_view(1280, camera));
    const std::uint32_t level = tool.levels[camera ? 1 : 0];
    const std::vector<Pose> poses = circle(pose_inside(tool.model, once), 1e-3, 64);
    const QueryOptions options{.level = level, .device = suite.device};
    // Keeps a query for each cloud, since a device holds one cloud per query.
    ToolQuery of_once(tool.model, options), of_twice(tool.model, options);
    const auto pose = [&](int k) { return poses[static_cast<std::size_t>(k) % poses.size()]; };
    const auto [a, b] = timed_in_turn(
        suite.quick ? 64 : 1280, 8, [&](int k) { of_once.run(once, pose(k)); },
        [&](int k) { of_twice.run(twice, pose(k)); });
    const double change = b.quantile(0.5) / a.quantile(0.5) - 1;
    report.results.push_back({{"part", "outside"},
                              {"cloud", camera ? "camera" : "points"},
                              {"spheres", level},
                              {"points", once.positions().size()},
                              {"points_doubled", twice.positions().size()},
                              {"once_us", 1e6 * a.quantile(0.5)},
                              {"doubled_us", 1e6 * b.quantile(0.5)},
                              {"change", change},
                              {"runs", a.size()}});
    char line[160];
    std::snprintf(line, sizeof line,
                  "twice the points, %s %7u spheres: %.1f us, before %.1f us: %+.1f %%\n",
                  camera ? "camera" : "points", level, 1e6 * b.quantile(0.5), 1e6 * a.quantile(0.5),
                  100 * change);
    report.summary += line;
  }
}

void time_frames(const SuiteOptions& suite, Report& report) {
  const synthetic::Scene scene = the_scene();
  const DepthImage depth = noisy_depth(scene);
  const int calls = suite.quick ? 5 : 101, warm_up = 2;
  for (const int threads : compared_threads(suite)) {
    const ThreadCap cap(suite, threads);
    const auto add = [&](const std::string& what, const std::function<void(int)>& body) {
      const Durations d = timed(calls, warm_up, body);
      report.results.push_back({{"part", "frame"},
                                {"what", what},
                                {"threads", threads},
                                {"median_ms", 1e3 * d.quantile(0.5)},
                                {"p99_ms", 1e3 * d.quantile(0.99)},
                                {"runs", d.size()}});
      char line[120];
      std::snprintf(line, sizeof line, "frame: %-24s %d thread%s %8.2f ms\n", what.c_str(), threads,
                    threads > 1 ? "s:" : ": ", 1e3 * d.quantile(0.5));
      report.summary += line;
    };
    const Intrinsics& k = scene.camera.intrinsics;
    std::vector<Vec3f> normals;
    NormalOptions pca;
    pca.method = NormalMethod::pca;
    add("normals pca", [&](int) { normals = estimate_normals(depth, k, pca); });
    add("normals inverse-depth", [&](int) { normals = estimate_normals(depth, k, {}); });
    Cloud cloud;
    add("cloud assembly", [&](int) { cloud = assemble_cloud(depth, scene.camera, normals); });
    add("cloud preparation", [&](int) { AnyBody prepared(cloud); });
    FramePreparation preparation{NormalOptions{}};
    PreparedImage frame;
    add("all, inverse-depth", [&](int) { preparation.prepare(depth, scene.camera, frame); });
  }
}

}  // namespace vpm::bench
