// Time of a query on a CUDA device against the number of spheres, and along a path of the tool
// (figures 7 and 9 of the paper): the refined measure, the measure as printed and, with `baseline`,
// the latter by the algorithm as printed, on the same data. A twisted torus of 0.2 m in a tilted
// wall with Kinect noise, 307 200 points.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>

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

std::vector<std::uint32_t> levels_of(const SuiteOptions& options) {
  if (options.quick) return {250, 1000};
  std::vector<std::uint32_t> levels{1000, 2000, 4000, 8000, kPathLevel, 100000};
  if (options.all) levels.push_back(1000000);
  return levels;
}

// Poses of the path for a level: fewer where the algorithm as printed takes a second for each.
std::vector<Pose> part_of(const std::vector<Pose>& path, std::uint32_t spheres) {
  constexpr std::uint32_t kSpheresOfAll = 100000;
  const std::size_t step = std::max(1U, spheres / kSpheresOfAll);
  std::vector<Pose> part;
  for (std::size_t k = 0; k < path.size(); k += step) part.push_back(path[k]);
  return part;
}

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

Device device_of(const SuiteOptions& options) {
  if (cuda_device_count() == 0) {
    throw Error(ErrorKind::unavailable,
                is_built_with_cuda()
                    ? "scaling: this machine has no CUDA device, or no driver for it; run the "
                      "suite where there is one"
                    : "scaling: this build has no CUDA; build with cmake --preset cuda");
  }
  if (!options.device.is_cuda() || options.device.index == Device::kAll) {
    throw Error(ErrorKind::usage,
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
    report_.table.columns = {"spheres", "refined_us", "refined_flood_us", "paper_us",
                             "paper_flood_us"};
    if (options.baseline) {
      for (const char* column :
           {"baseline_us", "boundary_us", "flood_us", "launched_us", "launched_flood_us", "ratio"})
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
    report_.settings = {{"quick", options_.quick}, {"shape", "twisted-torus"},
                        {"scene", scene.name},     {"points", cloud.positions().size()},
                        {"poses", path.size()},    {"rounds", rounds_},
                        {"spheres", levels_}};
    for (std::size_t k = 0; k < levels_.size(); ++k) {
      measure(tool, tool.level(levels_[k]), cloud, part_of(path, levels_[k]));
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

  // Adds to `row` what a measure takes on the device.
  Times measure_ours(const ToolModel& tool, const Level& level, Measure measure,
                     const std::string& name, const PreparedCloud& cloud,
                     const std::vector<Pose>& path, nlohmann::json& row) const {
    const auto query = make_device_measure(
        tool, level, {.measure = measure, .device = device_, .counts_points = false});
    std::vector<double> flood;
    Times times = time(path, [&](const Pose& pose) {
      query->run(cloud, pose);
      flood.push_back(query->flood_microseconds());
    });
    row.update(in_words(name, times));
    row[name + "_flood_us"] = median_of(flood);
    return times;
  }

  void measure(const ToolModel& tool, const Level& level, const PreparedCloud& cloud,
               const std::vector<Pose>& path) {
    nlohmann::json row = {
        {"part", "spheres"}, {"spheres", level.sphere_count}, {"poses", path.size()}};
    const Times refined = measure_ours(tool, level, Measure::refined, "refined", cloud, path, row);
    const Times paper = measure_ours(tool, level, Measure::paper, "paper", cloud, path, row);
    Printed baseline;
    if (options_.baseline) baseline = measure_baseline(tool, level, cloud, path, row);
    compare(tool, level, cloud, path, row);
    report_.results.push_back(row);
    write_line(row);
    write_row(row);
    if (level.sphere_count != kPathLevel && !options_.quick) return;
    QueryOptions options;
    options.level = level.sphere_count;
    Query query(tool, options);
    for (std::size_t k = 0; k < path.size(); ++k) {
      report_.results.push_back({{"part", "frame"},
                                 {"spheres", level.sphere_count},
                                 {"frame", k},
                                 {"volume_fraction", query.run(cloud, path[k]).volume_fraction},
                                 {"refined_us", median_of(refined[k])},
                                 {"paper_us", median_of(paper[k])}});
      if (!options_.baseline) continue;
      report_.results.back()["baseline_us"] = median_of(baseline.in_one_kernel[k]);
      report_.results.back()["launched_us"] = median_of(baseline.launched[k]);
    }
  }

  // The algorithm as printed, its traversals in one kernel or launched by the device.
  Times measure_printed(PaperBaseline& baseline, const std::string& name, const std::string& prefix,
                        const std::vector<Pose>& path, nlohmann::json& row) const {
    Times times = time(path, [&](const Pose& pose) { baseline.run(pose); });
    std::vector<double> boundary, flood;
    for (const Pose& pose : path) {
      const PaperBaseline::Phases phases = baseline.run_in_phases(pose);
      boundary.push_back(phases.boundary);
      flood.push_back(phases.flood);
    }
    row.update(in_words(name, times));
    row[prefix + "boundary_us"] = median_of(boundary);
    row[prefix + "flood_us"] = median_of(flood);
    return times;
  }

  struct Printed {
    Times in_one_kernel, launched;
  };

  // The ratio is that of the faster one.
  Printed measure_baseline(const ToolModel& tool, const Level& level, const PreparedCloud& cloud,
                           const std::vector<Pose>& path, nlohmann::json& row) const {
    const auto measured = [&](Traversals traversals, const std::string& name,
                              const std::string& prefix) {
      const auto baseline = make_paper_baseline(tool, level, cloud, traversals, device_.index);
      return measure_printed(*baseline, name, prefix, path, row);
    };
    Printed printed{measured(Traversals::in_one_kernel, "baseline", ""),
                    measured(Traversals::launched, "launched", "launched_")};
    const auto median = [&](const char* name) { return row[name].get<double>(); };
    row["ratio"] = std::min(median("baseline_median_us"), median("launched_median_us")) /
                   median("refined_median_us");
    return printed;
  }

  // Poses whose results on the device are those of the measure as printed on the CPU: all of them
  // from our algorithm, volume, counts and states from the baseline.
  void compare(const ToolModel& tool, const Level& level, const PreparedCloud& cloud,
               const std::vector<Pose>& path, nlohmann::json& row) {
    QueryOptions options;
    options.measure = Measure::paper;
    options.level = level.sphere_count;
    Query on_cpu(tool, options);
    options.device = device_;
    Query on_device(tool, options);
    std::vector<std::unique_ptr<PaperBaseline>> baselines;
    if (options_.baseline)
      for (const Traversals traversals : {Traversals::in_one_kernel, Traversals::launched})
        baselines.push_back(make_paper_baseline(tool, level, cloud, traversals, device_.index));
    std::size_t same_of_ours = 0, same = 0;
    for (const Pose& pose : path) {
      const Result expected = on_cpu.run(cloud, pose);
      same_of_ours += expected == on_device.run(cloud, pose);
      same += std::ranges::all_of(baselines, [&](const auto& baseline) {
        const Result result = baseline->run(pose);
        return result.volume == expected.volume && result.points == expected.points &&
               result.boundary == expected.boundary && result.inside == expected.inside &&
               std::ranges::equal(baseline->states(), on_cpu.states());
      });
    }
    row["same_poses_of_paper"] = same_of_ours;
    if (same_of_ours != path.size())
      report_.failure = "the measure as printed differs between CPU and device";
    if (baselines.empty()) return;
    row["same_poses"] = same;
    if (same != path.size()) report_.failure = "the baseline is not the measure as printed";
  }

  void write_row(const nlohmann::json& row) {
    std::vector<Table::Value> values;
    for (const char* name : {"spheres", "refined_median_us", "refined_flood_us", "paper_median_us",
                             "paper_flood_us", "baseline_median_us", "boundary_us", "flood_us",
                             "launched_median_us", "launched_flood_us", "ratio"})
      if (row.contains(name)) values.push_back(row[name].get<double>());
    report_.table.rows.push_back(std::move(values));
  }

  void write_line(const nlohmann::json& row) {
    const auto value = [&](const char* name) { return row[name].get<double>(); };
    char line[200];
    std::snprintf(line, sizeof line,
                  "%7u spheres  refined %7.1f us (flood %7.1f)  paper %7.1f us (flood %7.1f)",
                  row["spheres"].get<unsigned>(), value("refined_median_us"),
                  value("refined_flood_us"), value("paper_median_us"), value("paper_flood_us"));
    report_.summary += line;
    if (options_.baseline) {
      std::snprintf(line, sizeof line,
                    "   as printed %8.1f us (boundary %8.1f, flood %8.1f), launched by the device "
                    "%8.1f, %5.1f times",
                    value("baseline_median_us"), value("boundary_us"), value("flood_us"),
                    value("launched_median_us"), value("ratio"));
      report_.summary += line;
    }
    report_.summary += '\n';
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
