// Times queries on a CUDA device against the number of spheres, and along a path of the tool
// (figures 7 and 9 of the paper): the refined measure, the measure as printed and, with `baseline`,
// the latter by the algorithm as printed, on the same data. The scene is a twisted torus of 0.2 m
// in a tilted wall with Kinect noise, 307 200 points.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <utility>

#include "libvpm/cloud/normals.h"
#include "libvpm/core/error.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/recording/loop_clock.h"
#include "libvpm/synthetic/render.h"
#include "libvpm/synthetic/scenes.h"
#include "tools/bench/paper_baseline.h"
#include "tools/bench/penetration_case.h"
#include "tools/bench/statistics.h"
#include "tools/bench/suite.h"

namespace vpm::bench {
namespace {

constexpr std::uint64_t kNoiseSeed = 1;

constexpr double kMicro = 1e6;  // microseconds per second

// Spheres of the level that figure 9 uses.
constexpr std::uint32_t kPathLevel = 17000;

// Names of the algorithm as printed in the report: traversals in one kernel, and launched by the
// device.
constexpr const char* kPrinted[] = {"baseline", "launched"};

std::vector<std::uint32_t> levels_of(const SuiteOptions& options) {
  if (options.quick) return {250, 1000};
  std::vector<std::uint32_t> levels{1000, 2000, 4000, 8000, kPathLevel, 100000};
  if (options.all) levels.push_back(1000000);
  return levels;
}

// Returns the poses for a level: fewer where the algorithm as printed takes a second for each.
std::vector<Pose> part_of(const std::vector<Pose>& path, std::uint32_t spheres) {
  constexpr std::uint32_t kSpheresOfAll = 100000;
  const std::size_t step = std::max(1U, spheres / kSpheresOfAll);
  std::vector<Pose> part;
  for (std::size_t k = 0; k < path.size(); k += step) part.push_back(path[k]);
  return part;
}

// Returns the z at which this fraction of the tool is inside, by bisection from far in front of the
// wall.
double z_of_fraction(ToolQuery& query, const PreparedCloud& cloud, const Rotation& rotation,
                     Vec3 aside, double fraction) {
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
std::vector<Pose> sliding_path(const ToolModel& tool, const PreparedCloud& cloud, int count) {
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

// One way to compute a pose's result, and its times in seconds, round by round and pose by pose.
struct Contender {
  std::string name;
  std::function<void(const Pose&)> run;
  std::vector<std::vector<double>> rounds;
};

double median_of(const std::vector<double>& samples) {
  return spread_of(samples).median;
}

// Times contenders from the call to the result. Rounds take turns, so that a slow moment of the
// machine, which outlasts a round of the fastest, affects one of its rounds only.
void time(std::vector<Contender>& contenders, const std::vector<Pose>& path, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    for (Contender& contender : contenders) {
      contender.run(path.back());  // warms the caches up after the other contenders
      std::vector<double>& took = contender.rounds.emplace_back();
      for (const Pose& pose : path) {
        const auto begin = std::chrono::steady_clock::now();
        contender.run(pose);
        took.push_back(
            std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
      }
    }
  }
}

// Returns medians of the rounds' medians and of their p99.
nlohmann::json in_words(const Contender& contender) {
  std::vector<double> medians, p99s;
  for (const std::vector<double>& took : contender.rounds) {
    medians.push_back(median_of(took));
    p99s.push_back(Durations(took).quantile(0.99));
  }
  return {{contender.name + "_median_us", kMicro * median_of(medians)},
          {contender.name + "_p99_us", kMicro * median_of(p99s)}};
}

double microseconds_at(const Contender& contender, std::size_t pose) {
  std::vector<double> of_pose;
  for (const std::vector<double>& took : contender.rounds) of_pose.push_back(took[pose]);
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
  // The algorithm as printed, with traversals in one kernel and launched by the device.
  using Printed = std::vector<std::unique_ptr<PaperBaseline>>;

  void measure(const ToolModel& tool, const Level& level, const PreparedCloud& cloud,
               const std::vector<Pose>& path) {
    nlohmann::json row = {
        {"part", "spheres"}, {"spheres", level.sphere_count}, {"poses", path.size()}};
    const auto ours = [&](Measure measure) {
      return make_device_measure(tool, level, {.measure = measure, .device = device_});
    };
    const auto refined = ours(Measure::refined), paper = ours(Measure::paper);
    Printed printed;
    if (options_.baseline)
      for (const Traversals traversals : {Traversals::in_one_kernel, Traversals::launched})
        printed.push_back(make_paper_baseline(tool, level, cloud, traversals, device_.index));

    std::vector<Contender> contenders;
    for (const auto& [name, query] : {std::pair{"refined", refined.get()}, {"paper", paper.get()}})
      contenders.push_back({name, [&, query](const Pose& pose) { query->run(cloud, pose); }, {}});
    for (std::size_t k = 0; k < printed.size(); ++k)
      contenders.push_back({kPrinted[k], [&, k](const Pose& pose) { printed[k]->run(pose); }, {}});
    time(contenders, path, rounds_);

    for (const Contender& contender : contenders) row.update(in_words(contender));
    row["refined_flood_us"] = flood_of(*refined, cloud, path);
    row["paper_flood_us"] = flood_of(*paper, cloud, path);
    add_phases(printed, path, row);
    compare(tool, level, cloud, path, printed, row);
    report_.results.push_back(row);
    write_line(row);
    write_row(row);
    if (level.sphere_count == kPathLevel || options_.quick)
      add_frames(tool, level, cloud, path, contenders);
  }

  // Returns the median time of the flood on the device's clock, microseconds.
  static double flood_of(DeviceMeasure& measure, const PreparedCloud& cloud,
                         const std::vector<Pose>& path) {
    std::vector<double> flood;
    for (const Pose& pose : path) {
      measure.run(cloud, pose);
      flood.push_back(measure.flood_microseconds());
    }
    return median_of(flood);
  }

  // Adds the times of the phases of the algorithm as printed, and the ratio of its faster form.
  static void add_phases(const Printed& printed, const std::vector<Pose>& path,
                         nlohmann::json& row) {
    for (std::size_t k = 0; k < printed.size(); ++k) {
      std::vector<double> boundary, flood;
      for (const Pose& pose : path) {
        const PaperBaseline::Phases phases = printed[k]->run_in_phases(pose);
        boundary.push_back(phases.boundary);
        flood.push_back(phases.flood);
      }
      const std::string prefix = k == 0 ? "" : "launched_";
      row[prefix + "boundary_us"] = median_of(boundary);
      row[prefix + "flood_us"] = median_of(flood);
    }
    if (printed.empty()) return;
    const auto median = [&](const char* name) { return row[name].get<double>(); };
    row["ratio"] = std::min(median("baseline_median_us"), median("launched_median_us")) /
                   median("refined_median_us");
  }

  // Counts the poses whose results on the device are those of the measure as printed on the CPU:
  // every field for our algorithm; volume, counts and states for the algorithm as printed.
  void compare(const ToolModel& tool, const Level& level, const PreparedCloud& cloud,
               const std::vector<Pose>& path, const Printed& printed, nlohmann::json& row) {
    QueryOptions options;
    options.measure = Measure::paper;
    options.level = level.sphere_count;
    ToolQuery on_cpu(tool, options);
    options.device = device_;
    ToolQuery on_device(tool, options);
    std::size_t same_of_ours = 0, same = 0;
    for (const Pose& pose : path) {
      const Result expected = on_cpu.run(cloud, pose);
      same_of_ours += expected == on_device.run(cloud, pose);
      same += std::ranges::all_of(printed, [&](const auto& baseline) {
        const Result result = baseline->run(pose);
        return result.volume == expected.volume && result.points == expected.points &&
               result.boundary == expected.boundary && result.inside == expected.inside &&
               std::ranges::equal(baseline->states(), on_cpu.states());
      });
    }
    row["same_poses_of_paper"] = same_of_ours;
    if (same_of_ours != path.size())
      report_.failure = "the measure as printed differs between CPU and device";
    if (printed.empty()) return;
    row["same_poses"] = same;
    if (same != path.size()) report_.failure = "the baseline is not the measure as printed";
  }

  void add_frames(const ToolModel& tool, const Level& level, const PreparedCloud& cloud,
                  const std::vector<Pose>& path, const std::vector<Contender>& contenders) {
    QueryOptions options;
    options.level = level.sphere_count;
    ToolQuery query(tool, options);
    for (std::size_t k = 0; k < path.size(); ++k) {
      nlohmann::json frame = {{"part", "frame"},
                              {"spheres", level.sphere_count},
                              {"frame", k},
                              {"volume_fraction", query.run(cloud, path[k]).volume_fraction}};
      for (const Contender& contender : contenders)
        frame[contender.name + "_us"] = microseconds_at(contender, k);
      report_.results.push_back(std::move(frame));
    }
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
