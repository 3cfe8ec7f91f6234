// Time of a query on a CUDA device against the number of spheres, and along a path of the tool
// (figures 7 and 9 of the paper): the refined measure and, with `baseline`, the measure as printed
// by the algorithm as printed, in turns and on the same data. A twisted torus of 0.2 m in a tilted
// wall with Kinect noise, 307 200 points.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "libvpm/cloud/normals.h"
#include "libvpm/core/error.h"
#include "libvpm/query/query.h"
#include "libvpm/synthetic/kinect_noise.h"
#include "libvpm/synthetic/scenes.h"
#include "tools/bench/paper_baseline.h"
#include "tools/bench/penetration_case.h"
#include "tools/bench/statistics.h"
#include "tools/bench/suite.h"

namespace vpm::bench {
namespace {

constexpr std::uint64_t kNoiseSeed = 1;

// The level of figure 9.
constexpr std::uint32_t kPathLevel = 17000;

// From far in front of the wall until this part of the tool is inside, then by bisection.
double z_of_fraction(Query& query, const PreparedCloud& cloud, const Rotation& rotation, Vec3 aside,
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

// The tool turns and slides over the wall, 5 to 10 % of it inside.
std::vector<Pose> sliding_path(const ToolModel& tool, const PreparedCloud& cloud, int count) {
  QueryOptions options;
  options.level = tool.levels.front().sphere_count;
  Query query(tool, options);
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

// Microseconds of each round of each pose.
using Times = std::vector<std::vector<double>>;

double median_of(const std::vector<double>& samples) {
  return spread_of(samples).median;
}

std::vector<double> all_of(const Times& times) {
  std::vector<double> all;
  for (const auto& of_pose : times) all.insert(all.end(), of_pose.begin(), of_pose.end());
  std::sort(all.begin(), all.end());
  return all;
}

nlohmann::json in_words(const std::string& name, const Times& times) {
  const std::vector<double> all = all_of(times);
  const auto p99 = static_cast<std::size_t>(0.99 * static_cast<double>(all.size() - 1));
  return {{name + "_median_us", median_of(all)}, {name + "_p99_us", all[p99]}};
}

class Scaling {
 public:
  explicit Scaling(const SuiteOptions& options)
      : options_(options),
        levels_(options.quick
                    ? std::vector<std::uint32_t>{250, 1000}
                    : std::vector<std::uint32_t>{1000, 2000, 4000, 8000, kPathLevel, 100000}),
        poses_(options.quick ? 20 : 200),
        rounds_(options.quick ? 2 : 5) {
    if (cuda_device_count() == 0) {
      throw Error(ErrorKind::unavailable,
                  is_built_with_cuda()
                      ? "scaling: this machine has no CUDA device, or no driver for it; run the "
                        "suite where there is one"
                      : "scaling: this build has no CUDA; build with cmake --preset cuda");
    }
    report_.suite = "scaling";
    report_.table.columns = {"spheres", "refined_us"};
    if (options.baseline) {
      for (const char* column : {"baseline_us", "boundary_us", "flood_us", "ratio"})
        report_.table.columns.push_back(column);
    }
  }

  Report run() {
    const ToolModel tool = make_tool(make_shape("twisted-torus"), levels_);
    const synthetic::Scene scene = synthetic::make_scene("tilted-wall");
    const PreparedCloud cloud(
        make_cloud(synthetic::render_with_kinect_noise(*scene.surface, scene.camera, kNoiseSeed),
                   scene.camera, NormalOptions{}));
    const std::vector<Pose> path = sliding_path(tool, cloud, poses_);
    report_.settings = {{"quick", options_.quick},
                        {"device", cuda_device_name(0)},
                        {"shape", "twisted-torus"},
                        {"scene", scene.name},
                        {"points", cloud.positions().size()},
                        {"poses", path.size()},
                        {"rounds", rounds_},
                        {"spheres", levels_}};
    for (std::size_t k = 0; k < levels_.size(); ++k) {
      measure(tool, tool.level(levels_[k]), cloud, path);
      if (options_.progress)
        options_.progress(static_cast<double>(k + 1) / static_cast<double>(levels_.size()));
    }
    return std::move(report_);
  }

 private:
  // From the call to the result.
  template <class Body>
  Times time(const std::vector<Pose>& path, const Body& body) const {
    Times times(path.size());
    for (int round = -1; round < rounds_; ++round) {  // the first warms up
      for (std::size_t k = 0; k < path.size(); ++k) {
        const auto begin = std::chrono::steady_clock::now();
        body(path[k]);
        const std::chrono::duration<double, std::micro> took =
            std::chrono::steady_clock::now() - begin;
        if (round >= 0) times[k].push_back(took.count());
      }
    }
    return times;
  }

  void measure(const ToolModel& tool, const Level& level, const PreparedCloud& cloud,
               const std::vector<Pose>& path) {
    QueryOptions options;
    options.level = level.sphere_count;
    options.device = {Device::Kind::cuda, 0};
    Query query(tool, options);
    const Times refined = time(path, [&](const Pose& pose) { query.run(cloud, pose); });
    nlohmann::json row = {{"part", "spheres"}, {"spheres", level.sphere_count}};
    row.update(in_words("refined", refined));
    Times baseline;
    if (options_.baseline) baseline = measure_baseline(tool, level, cloud, path, row);
    report_.results.push_back(row);
    write_line(row);
    write_row(row);
    if (level.sphere_count == kPathLevel || options_.quick) {
      for (std::size_t k = 0; k < path.size(); ++k) {
        report_.results.push_back({{"part", "frame"},
                                   {"spheres", level.sphere_count},
                                   {"frame", k},
                                   {"volume_fraction", query.run(cloud, path[k]).volume_fraction},
                                   {"refined_us", median_of(refined[k])}});
        if (options_.baseline) report_.results.back()["baseline_us"] = median_of(baseline[k]);
      }
    }
  }

  Times measure_baseline(const ToolModel& tool, const Level& level, const PreparedCloud& cloud,
                         const std::vector<Pose>& path, nlohmann::json& row) {
    const auto baseline = make_paper_baseline(tool, level, cloud);
    const Times times = time(path, [&](const Pose& pose) { baseline->run(pose); });
    std::vector<double> boundary, flood;
    for (const Pose& pose : path) {
      const PaperBaseline::Phases phases = baseline->run_in_phases(pose);
      boundary.push_back(phases.boundary);
      flood.push_back(phases.flood);
    }
    row.update(in_words("baseline", times));
    row["boundary_us"] = median_of(boundary);
    row["flood_us"] = median_of(flood);
    row["ratio"] = row["baseline_median_us"].get<double>() / row["refined_median_us"].get<double>();
    row["same_poses"] = same_poses(tool, level, cloud, path, *baseline);
    if (row["same_poses"] != path.size())
      report_.failure = "the baseline is not the measure as printed";
    return times;
  }

  // Poses whose volume, counts and states are those of the measure as printed on the CPU.
  std::size_t same_poses(const ToolModel& tool, const Level& level, const PreparedCloud& cloud,
                         const std::vector<Pose>& path, PaperBaseline& baseline) const {
    QueryOptions options;
    options.measure = Measure::paper;
    options.level = level.sphere_count;
    Query on_cpu(tool, options);
    std::size_t same = 0;
    for (const Pose& pose : path) {
      const Result expected = on_cpu.run(cloud, pose), result = baseline.run(pose);
      same += result.volume == expected.volume && result.points == expected.points &&
              result.boundary == expected.boundary && result.inside == expected.inside &&
              std::ranges::equal(baseline.states(), on_cpu.states());
    }
    return same;
  }

  void write_row(const nlohmann::json& row) {
    const auto value = [&](const char* name) { return row[name].get<double>(); };
    if (options_.baseline) {
      report_.table.rows.push_back({value("spheres"), value("refined_median_us"),
                                    value("baseline_median_us"), value("boundary_us"),
                                    value("flood_us"), value("ratio")});
    } else {
      report_.table.rows.push_back({value("spheres"), value("refined_median_us")});
    }
  }

  void write_line(const nlohmann::json& row) {
    char line[160];
    std::snprintf(line, sizeof line, "%7u spheres  refined %7.1f us, p99 %7.1f",
                  row["spheres"].get<unsigned>(), row["refined_median_us"].get<double>(),
                  row["refined_p99_us"].get<double>());
    report_.summary += line;
    if (options_.baseline) {
      std::snprintf(line, sizeof line,
                    "   as printed %8.1f us (boundary %8.1f, flood %8.1f), %5.1f times",
                    row["baseline_median_us"].get<double>(), row["boundary_us"].get<double>(),
                    row["flood_us"].get<double>(), row["ratio"].get<double>());
      report_.summary += line;
    }
    report_.summary += '\n';
  }

  const SuiteOptions& options_;
  std::vector<std::uint32_t> levels_;
  int poses_, rounds_;
  Report report_;
};

}  // namespace

Report run_scaling(const SuiteOptions& options) {
  return Scaling(options).run();
}

}  // namespace vpm::bench
