// Times each stage of the main job on a synthetic scene: a twisted torus of 0.25 m with 7200
// triangles, a noisy depth image of a tilted wall with 307 200 points, and the same points without
// their camera. Queries are also timed at random poses in clutter, pose by pose, and if recorded
// images are given, in these.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <optional>

#include "libvpm/cloud/normals.h"
#include "libvpm/core/parallel.h"
#include "libvpm/graph/build_tool_model.h"
#include "libvpm/packing/packer.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/scene/frame_preparation.h"
#include "libvpm/solid/depth_remover.h"
#include "libvpm/solid/solid_surface.h"
#include "libvpm/synthetic/render.h"
#include "libvpm/synthetic/scenes.h"
#include "libvpm/synthetic/shapes.h"
#include "tools/bench/clutter.h"
#include "tools/bench/penetration_case.h"
#include "tools/bench/poses_in_clutter.h"
#include "tools/bench/recorded_images.h"
#include "tools/bench/statistics.h"
#include "tools/bench/suite.h"
#include "tools/bench/view.h"

namespace vpm::bench {
namespace {

// Numbers of runs for a median: many for fast stages, few for slow ones.
struct Runs {
  int slow, fast;
};

// Number of runs from which on a stage is run once unmeasured, to warm up caches and memory.
constexpr int kRunsWithWarmUp = 5;

std::vector<double> milliseconds_of(int runs, const std::function<void()>& stage) {
  if (runs >= kRunsWithWarmUp) stage();
  std::vector<double> times;
  for (int k = 0; k < runs; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    stage();
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    times.push_back(took.count());
  }
  return times;
}

class Timing {
 public:
  explicit Timing(const SuiteOptions& options)
      : options_(options),
        runs_(options.quick ? Runs{1, 5} : Runs{3, 31}),
        sizes_(options.quick ? std::vector<std::size_t>{250}
                             : std::vector<std::size_t>{1000, 10000}) {
    report_.suite = "timing";
    report_.settings = {{"quick", options.quick},           {"runs_slow", runs_.slow},
                        {"runs_fast", runs_.fast},          {"spheres", sizes_},
                        {"shape", "twisted torus"},         {"scene", "tilted-wall"},
                        {"recorded", !options.data.empty()}};
    report_.table.columns = {"stage",        "spheres", "threads", "median_ms", "quartile1_ms",
                             "quartile3_ms", "min_ms",  "max_ms",  "runs"};
    report_.summary =
        "stage                                      spheres threads: median [quartiles] ms, and "
        "the ratio of the first to the last\n";
  }

  Report run() {
    time_cloud();
    if (!options_.data.empty()) prepare_recorded();
    for (const std::size_t spheres : sizes_) time_tool(spheres);
    return std::move(report_);
  }

 private:
  // Times one stage with each number of threads; the time is per call if the stage makes `times`
  // calls.
  void time(const std::string& stage, std::size_t spheres, int runs,
            const std::function<void()>& body, std::size_t times = 1) {
    report_times(stage, spheres, [&] {
      std::vector<double> took = milliseconds_of(runs, body);
      for (double& of_run : took) of_run /= static_cast<double>(times);
      return took;
    });
  }
  // Reports the spread of the times, ms, that `measure` returns with each number of threads.
  void report_times(const std::string& stage, std::size_t spheres,
                    const std::function<std::vector<double>()>& measure) {
    std::vector<double> medians;
    char text[160];
    std::snprintf(text, sizeof text, "%-42s %7zu", stage.c_str(), spheres);
    std::string line = text;
    for (const int threads : compared_threads(options_)) {
      const ThreadCap cap(options_, threads);
      const std::vector<double> took = measure();
      const Spread s = spread_of(took);
      const auto runs = static_cast<double>(took.size());
      report_.table.rows.push_back({stage, static_cast<double>(spheres),
                                    static_cast<double>(threads), s.median, s.quartile1,
                                    s.quartile3, s.min, s.max, runs});
      report_.results.push_back({{"stage", stage},
                                 {"spheres", spheres},
                                 {"threads", threads},
                                 {"median_ms", s.median},
                                 {"quartile1_ms", s.quartile1},
                                 {"quartile3_ms", s.quartile3},
                                 {"min_ms", s.min},
                                 {"max_ms", s.max},
                                 {"runs", runs}});
      std::snprintf(text, sizeof text, " %3d: %10.3f [%.3f, %.3f]", threads, s.median, s.quartile1,
                    s.quartile3);
      line += text;
      medians.push_back(s.median);
    }
    std::snprintf(text, sizeof text, " %7.2f\n", medians.front() / medians.back());
    report_.summary += line + text;
    if (options_.progress) {
      const double recorded = options_.data.empty() ? 0 : 1;
      const double stages = 9 + recorded + (11 + 3 * recorded) * static_cast<double>(sizes_.size());
      options_.progress(static_cast<double>(++done_) / stages);
    }
  }

  void time_cloud() {
    const DepthImage depth =
        synthetic::render_with_kinect_noise(*scene_.surface, scene_.camera, kNoiseSeed);
    std::vector<Vec3f> normals;
    for (const NormalMethod method : {NormalMethod::pca, NormalMethod::inverse_depth}) {
      NormalOptions options;
      options.method = method;
      time("normals " + to_text(method), 0, runs_.fast,
           [&] { normals = estimate_normals(depth, scene_.camera.intrinsics, options); });
    }
    time("cloud assembly", 0, runs_.fast,
         [&] { cloud_ = assemble_cloud(depth, scene_.camera, normals); });
    time("cloud preparation", 0, runs_.fast, [&] { AnyBody prepared(cloud_); });
    points_ = without_camera(cloud_);
    time("cloud preparation, points", 0, runs_.slow, [&] { AnyBody prepared(points_); });
    const auto time_frame = [&](const char* stage, Denoising points) {
      FramePreparation preparation(NormalOptions{}, points);
      PreparedImage frame;
      time(stage, 0, runs_.fast, [&] { preparation.prepare(depth, scene_.camera, frame); });
    };
    time_frame("frame, all at once", Denoising::on);
    time_frame("frame, all at once, as measured", Denoising::off);
    time_removal(depth);
  }

  // Times how the links of an arm before the wall are taken out of the frame.
  void time_removal(const DepthImage& seen) {
    constexpr int kLinks = 7;
    constexpr double kMargins[] = {0, 0.02};  // m
    const Solid link = synthetic::make_torus(0.05, 0.025, 100, 50);
    const auto surface = std::make_shared<const SolidSurface>(link, false);
    DepthRemover remover(std::vector<std::shared_ptr<const SolidSurface>>(kLinks, surface));
    for (const double margin : kMargins) {
      std::vector<SolidPlace> places;
      for (int k = 0; k < kLinks; ++k) {
        const Pose to_camera{rotation_from_vector({0.3 * k, 0.2 * k, 0.1}),
                             {0.09 * k - 0.27, 0.04 * k - 0.12, 0.65 + 0.02 * k}};
        places.push_back({scene_.camera.to_world * to_camera, margin});
      }
      char stage[80];
      std::snprintf(stage, sizeof stage, "%d links of %zu triangles taken out, margin %g mm",
                    kLinks, link.triangles.size(), 1e3 * margin);
      time(stage, 0, runs_.fast, [&] {
        DepthImage depth = seen;
        remover.remove(places, scene_.camera, depth.depth);
      });
    }
  }

  // Prepares recorded rooms and random poses in them, since a query's time depends on what is near.
  void prepare_recorded() {
    const ToolModel tool = make_tool(solid_, {kScoutSpheres});
    ToolQuery query(tool, {});
    for (const RecordedImage& image : recorded_images(options_.data)) {
      recorded_.push_back({AnyBody(image.cloud),
                           AnyBody(image.cloud, Denoising::off),
                           without_camera(image.cloud),
                           {}});
      Recorded& room = recorded_.back();
      for (std::uint64_t k = 0; room.poses.size() < kPosesInRoom && k < kMostTries; ++k) {
        const Pose pose = random_pose_before(image.cloud, k, tool.radius);
        const double inside = query.run(room.seen, pose).volume_fraction;
        if (inside > kLeastInside && inside < kMostInside) room.poses.push_back(pose);
      }
      poses_in_rooms_ += room.poses.size();
    }
    if (recorded_.empty()) return;  // this build can read none
    time(
        "cloud preparation, points, recorded rooms", 0, runs_.slow,
        [&] {
          for (Recorded& room : recorded_) room.points.emplace(room.cloud);
        },
        recorded_.size());
  }

  void time_tool(std::size_t spheres) {
    Packing packing;
    packing.solid = solid_;
    PackOptions pack_options;
    pack_options.spheres = spheres;
    time("pack", spheres, runs_.slow,
         [&] { packing.spheres = pack(packing.solid, pack_options).spheres; });
    ToolModel model;
    time("graph", spheres, runs_.slow, [&] { model = build_tool_model(packing, GraphOptions{}); });

    const AnyBody cloud(cloud_), measured(cloud_, Denoising::off), points(points_);
    const Pose pose =
        make_path(synthetic::TrueSolid(solid_), {}, *scene_.surface, kPoses)[kPoses / 2];
    // Places most of the tool further behind the surface than the tool radius.
    const Pose deep{pose.rotation,
                    pose.translation - model.radius * scene_.surface->gradient(pose.translation)};
    const auto time_query = [&](const char* stage, const AnyBody& seen, const Pose& at,
                                Measure measure = Measure::refined) {
      ToolQuery query(model, {.measure = measure});
      time(stage, spheres, runs_.fast, [&] { query.run(seen, at); });
    };
    time_query("query refined", cloud, pose);
    time_query("query refined, as measured", measured, pose);
    time_query("query refined, points", points, pose);
    time_query("query refined, deep", cloud, deep);
    time_query("query refined, points, deep", points, deep);
    time_clutter(model, spheres);
    if (poses_in_rooms_ > 0) time_rooms(model, spheres);
    time_query("query paper", cloud, pose, Measure::paper);
  }

  // Times queries in clutter: the spread over poses, and that over the dearest hundredth of them.
  // Of each pose the shortest of some runs counts, since other programs only make it longer.
  void time_clutter(const ToolModel& model, std::size_t spheres) {
    const std::vector<Pose> poses =
        poses_in_clutter(clutter_cloud_, options_.quick ? kPosesInClutter / 10 : kPosesInClutter);
    const AnyBody clutter(clutter_cloud_);
    ToolQuery query(model, {});
    std::vector<double> took;
    const auto time_all = [&] {
      took.clear();
      for (const Pose& pose : poses) {
        const std::vector<double> runs =
            milliseconds_of(runs_.slow, [&] { query.run(clutter, pose); });
        took.push_back(*std::min_element(runs.begin(), runs.end()));
      }
      return took;
    };
    const auto time_dearest = [&] {
      time_all();
      std::sort(took.begin(), took.end());
      return std::vector<double>(took.end() - static_cast<std::ptrdiff_t>((took.size() + 99) / 100),
                                 took.end());
    };
    report_times("query refined, clutter", spheres, time_all);
    report_times("query refined, clutter, dearest 1 %", spheres, time_dearest);
  }

  // Times queries in the recorded rooms, by their image, as measured, and by their points alone.
  void time_rooms(const ToolModel& model, std::size_t spheres) {
    const auto time_room = [&](const char* stage, const auto& cloud_of) {
      ToolQuery query(model, {});
      time(
          stage, spheres, runs_.slow,
          [&] {
            for (const Recorded& room : recorded_) {
              for (const Pose& p : room.poses) query.run(cloud_of(room), p);
            }
          },
          poses_in_rooms_);
    };
    time_room("query refined, recorded rooms",
              [](const Recorded& room) -> const AnyBody& { return room.seen; });
    time_room("query refined, as measured, recorded rooms",
              [](const Recorded& room) -> const AnyBody& { return room.measured; });
    time_room("query refined, points, recorded rooms",
              [](const Recorded& room) -> const AnyBody& { return *room.points; });
  }

  static constexpr int kPoses = 9;  // the middle one is 3/8 of the tool's height deep
  static constexpr std::size_t kPosesInRoom = 32, kPosesInClutter = 700;
  static constexpr std::uint64_t kMostTries = 10000;
  static constexpr std::uint32_t kScoutSpheres = 250;
  static constexpr double kLeastInside = 0.005, kMostInside = 0.3;  // parts of the tool, in rooms

  struct Recorded {
    AnyBody seen, measured;
    Cloud cloud;  // without camera
    std::vector<Pose> poses;
    std::optional<AnyBody> points = {};
  };

  const SuiteOptions& options_;
  Runs runs_;
  std::vector<std::size_t> sizes_;
  Report report_;
  int done_ = 0;
  const synthetic::Scene scene_ = synthetic::make_scene("tilted-wall");
  const Solid solid_ = synthetic::make_twisted_torus(0.09, 0.05, 3, 900);
  const Cloud clutter_cloud_ = make_clutter();
  Cloud cloud_, points_;  // points_: the same without camera
  std::vector<Recorded> recorded_;
  std::size_t poses_in_rooms_ = 0;
};

}  // namespace

Report run_timing(const SuiteOptions& options) {
  if (!options.data.empty()) require_recorded_images(options.data);
  return Timing(options).run();
}

}  // namespace vpm::bench
