// Times queries on a CUDA device against the number of spheres, and along a path of the tool
// (figures 7 and 9 of the paper). The scene is a twisted torus of 0.2 m in a tilted wall with
// Kinect noise, 307 200 points.

#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>

#include "libvpm/cloud/normals.h"
#include "libvpm/core/error.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/recording/loop_clock.h"
#include "libvpm/synthetic/render.h"
#include "libvpm/synthetic/scenes.h"
#include "tools/bench/penetration_case.h"
#include "tools/bench/statistics.h"
#include "tools/bench/suite.h"
#include "tools/bench/view.h"

namespace vpm::bench {
namespace {

constexpr double kMicro = 1e6;  // microseconds per second

// Spheres of the level that figure 9 uses.
constexpr std::uint32_t kPathLevel = 17000;

std::vector<std::uint32_t> levels_of(const SuiteOptions& options) {
  if (options.quick) return {250, 1000};
  std::vector<std::uint32_t> levels{1000, 2000, 4000, 8000, kPathLevel, 100000};
  if (options.all) levels.push_back(1000000);
  return levels;
}

// Returns the z at which this fraction of the tool is inside, by bisection from far in front of the
// wall.
double z_of_fraction(ToolQuery& query, const AnyBody& cloud, const Rotation& rotation, Vec3 aside,
                     double fraction) {
  const auto is_deeper = [&](double z) {
    return query.run(cloud, {rotation, {aside.x, aside.y, z}}).volume_fraction > fraction;
  };
  constexpr double kStep = 0.005, kFirst = 0.6, kLast = 1.2;
  double deep = kFirst;
  while (!is_deeper(deep)) {
    deep += kStep;
    if (deep > kLast) refuse("scaling: the tool never meets the wall");
  }
  double shallow = deep - kStep;
  constexpr int kHalvings = 16;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (shallow + deep);
    (is_deeper(middle) ? deep : shallow) = middle;
  }
  return deep;
}

// Returns poses of a tool that turns and slides over the wall, 5 to 10 % of it inside.
std::vector<Pose> sliding_path(const ToolModel& tool, const AnyBody& cloud, int count) {
  QueryOptions options;
  options.level = tool.levels.front().sphere_count;
  ToolQuery query(tool, options);
  std::vector<Pose> path;
  for (int k = 0; k < count; ++k) {
    const double along = 2 * kPi * k / count;
    const double half = 0.15 * std::sin(3 * along);
    const Rotation rotation =
        turned() * rotation_from_quaternion({0, std::sin(half), 0, std::cos(half)});
    const Vec3 aside{0.03 * std::sin(along), 0.03 * std::sin(2 * along), 0};
    const double fraction = 0.075 + 0.025 * std::sin(5 * along);
    path.push_back(
        {rotation, {aside.x, aside.y, z_of_fraction(query, cloud, rotation, aside, fraction)}});
  }
  return path;
}

// Holds the times of a path's poses in seconds, round by round.
using Rounds = std::vector<std::vector<double>>;

double median_of(const std::vector<double>& samples) {
  return spread_of(samples).median;
}

// Times a query from the call to the result; poses are in the body's frame.
Rounds time(DeviceMeasure& query, const AnyBody& cloud, const std::vector<Pose>& path, int count) {
  Rounds rounds;
  for (int round = 0; round < count; ++round) {
    query.run(cloud, path.back());  // warms the caches up
    std::vector<double>& took = rounds.emplace_back();
    for (const Pose& pose : path) {
      const auto begin = std::chrono::steady_clock::now();
      query.run(cloud, pose);
      took.push_back(
          std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
  }
  return rounds;
}

// Returns medians of the rounds' medians and of their p99.
nlohmann::json in_words(const Rounds& rounds) {
  std::vector<double> medians, p99s;
  for (const std::vector<double>& took : rounds) {
    medians.push_back(median_of(took));
    p99s.push_back(Durations(took).quantile(0.99));
  }
  return {{"refined_median_us", kMicro * median_of(medians)},
          {"refined_p99_us", kMicro * median_of(p99s)}};
}

double microseconds_at(const Rounds& rounds, std::size_t pose) {
  std::vector<double> of_pose;
  for (const std::vector<double>& took : rounds) of_pose.push_back(took[pose]);
  return kMicro * median_of(of_pose);
}

Device device_of(const SuiteOptions& options) {
  if (cuda_device_count() == 0) {
    throw Error(ErrorKind::unavailable,
                is_built_with_cuda()
                    ? "scaling: this machine has no CUDA device, or no driver for it; run the "
                      "suite where there is one"
                    : "scaling: this build has no CUDA; build with cmake --preset cuda");
  }
  if (!options.device.is_cuda() || options.device.index == Device::kAll) {
    throw Error(ErrorKind::invalid_argument,
                "scaling times one CUDA device; use --device cuda or cuda:N, or leave the option "
                "out");
  }
  return options.device;
}

class Scaling {
 public:
  explicit Scaling(const SuiteOptions& options)
      : options_(options),
        device_(device_of(options)),
        levels_(levels_of(options)),
        poses_(options.quick ? 20 : 200),
        rounds_(options.quick ? 2 : 5) {
    report_.suite = "scaling";
    report_.table.columns = {"spheres", "refined_us", "refined_flood_us"};
  }

  Report run() {
    const ToolModel tool = make_tool(make_shape("twisted-torus"), levels_);
    const synthetic::Scene scene = synthetic::make_scene("tilted-wall");
    const AnyBody cloud(
        make_cloud(synthetic::render_with_kinect_noise(*scene.surface, scene.camera, kNoiseSeed),
                   scene.camera, NormalOptions{}));
    const std::vector<Pose> path = sliding_path(tool, cloud, poses_);
    report_.settings = {{"quick", options_.quick}, {"shape", "twisted-torus"},
                        {"scene", scene.name},     {"points", cloud.positions().size()},
                        {"poses", path.size()},    {"rounds", rounds_},
                        {"spheres", levels_}};
    for (std::size_t k = 0; k < levels_.size(); ++k) {
      measure(tool, tool.level(levels_[k]), cloud, path);
      if (options_.progress)
        options_.progress(static_cast<double>(k + 1) / static_cast<double>(levels_.size()));
    }
    return std::move(report_);
  }

 private:
  void measure(const ToolModel& tool, const Level& level, const AnyBody& cloud,
               const std::vector<Pose>& path) {
    nlohmann::json row = {
        {"part", "spheres"}, {"spheres", level.sphere_count}, {"poses", path.size()}};
    const auto query = make_device_measure(tool, level, {.device = device_});
    std::vector<Pose> placed;
    for (const Pose& pose : path)
      placed.push_back(pose_in_body(cloud.to_world(), pose, tool.center_of_mass));
    const Rounds rounds = time(*query, cloud, placed, rounds_);
    row.update(in_words(rounds));
    row["refined_flood_us"] = flood_of(*query, cloud, placed);
    compare(tool, level, cloud, path, row);
    report_.results.push_back(row);
    write_line(row);
    write_row(row);
    if (level.sphere_count == kPathLevel || options_.quick)
      add_frames(tool, level, cloud, path, rounds);
  }

  // Returns the median time of the flood on the device's clock, microseconds.
  static double flood_of(DeviceMeasure& measure, const AnyBody& cloud,
                         const std::vector<Pose>& path) {
    std::vector<double> flood;
    for (const Pose& pose : path) {
      measure.run(cloud, pose);
      flood.push_back(measure.flood_microseconds());
    }
    return median_of(flood);
  }

  // Counts the poses whose results on the device are those of the CPU in every field.
  void compare(const ToolModel& tool, const Level& level, const AnyBody& cloud,
               const std::vector<Pose>& path, nlohmann::json& row) {
    QueryOptions options;
    options.level = level.sphere_count;
    ToolQuery on_cpu(tool, options);
    options.device = device_;
    ToolQuery on_device(tool, options);
    std::size_t same = 0;
    for (const Pose& pose : path) same += on_cpu.run(cloud, pose) == on_device.run(cloud, pose);
    row["same_poses"] = same;
    if (same != path.size()) report_.failure = "the measure differs between CPU and device";
  }

  void add_frames(const ToolModel& tool, const Level& level, const AnyBody& cloud,
                  const std::vector<Pose>& path, const Rounds& rounds) {
    QueryOptions options;
    options.level = level.sphere_count;
    ToolQuery query(tool, options);
    for (std::size_t k = 0; k < path.size(); ++k)
      report_.results.push_back({{"part", "frame"},
                                 {"spheres", level.sphere_count},
                                 {"frame", k},
                                 {"volume_fraction", query.run(cloud, path[k]).volume_fraction},
                                 {"refined_us", microseconds_at(rounds, k)}});
  }

  void write_row(const nlohmann::json& row) {
    std::vector<Table::Value> values;
    for (const char* name : {"spheres", "refined_median_us", "refined_flood_us"})
      values.push_back(row[name].get<double>());
    report_.table.rows.push_back(std::move(values));
  }

  void write_line(const nlohmann::json& row) {
    char line[100];
    std::snprintf(line, sizeof line, "%7u spheres  refined %7.1f us (flood %7.1f)\n",
                  row["spheres"].get<unsigned>(), row["refined_median_us"].get<double>(),
                  row["refined_flood_us"].get<double>());
    report_.summary += line;
  }

  const SuiteOptions& options_;
  Device device_;
  std::vector<std::uint32_t> levels_;
  int poses_, rounds_;
  Report report_;
};

}  // namespace

Report run_scaling(const SuiteOptions& options) {
  return Scaling(options).run();
}

}  // namespace vpm::bench
