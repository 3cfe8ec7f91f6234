// Measures one solid against another: the error of the volume, closure, jumps along a path, time at
// poses where both share 0, 5 and 30 % of the smaller solid, memory, and time to prepare. Measures
// the same poses by the spheres of both solids, too, as --measure paper does. On a device it also
// times volumes there, one by one and in batches.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>

#include "libvpm/core/exact_pose.h"
#include "libvpm/graph/hierarchy.h"
#include "libvpm/packing/packer.h"
#include "libvpm/solid/device_solids.h"
#include "libvpm/solid/solid_pair.h"
#include "libvpm/solid/sphere_pair.h"
#include "libvpm/synthetic/shared_volume.h"
#include "tools/bench/solid_pairs.h"
#include "tools/bench/statistics.h"
#include "tools/bench/suite.h"

namespace vpm::bench {
namespace {

constexpr double kMaxVolumeError = 1e-6;  // of the smaller solid; more is a failure
constexpr double kMicrometre = 1e-6;
// Pairs with more triangles than this compare fewer poses with the truth, which takes seconds.
constexpr std::size_t kLarge = 50000;
constexpr std::uint32_t kSpheresOfEach = 1000, kSpheresIfQuick = 30;

// Pose of b against a: turned, with its centre of mass at a distance along a direction.
struct Approach {
  Rotation turn;
  Vec3 way;  // unit length

  Pose at(double distance) const { return {turn, distance * way}; }
};

// Returns as much of a tool model as spheres against spheres asks for.
ToolModel packed(const Solid& solid, std::uint32_t spheres) {
  PackOptions options;
  options.spheres = spheres;
  const MassProperties mass = mass_properties(solid);
  ToolModel model;
  model.volume = mass.volume, model.center_of_mass = mass.center_of_mass;
  model.radius = bounding_radius(solid, mass.center_of_mass);
  model.solid_hash = content_hash(solid);
  model.spheres = pack(solid, options).spheres;
  Level& level = model.levels.emplace_back();
  level.sphere_count = static_cast<std::uint32_t>(model.spheres.size());
  level.hierarchy = build_hierarchy(model.spheres);
  return model;
}

class MeasuredPair {
 public:
  MeasuredPair(const PairOfSolids& solids, const SuiteOptions& options)
      : solids_(about_centers(solids)), options_(options) {
    const double start = process_seconds();
    a_ = std::make_shared<const SolidSurface>(solids_.a);
    b_ = std::make_shared<const SolidSurface>(solids_.b);
    build_seconds_ = process_seconds() - start;
    pair_.emplace(a_, b_);
    smaller_ = std::min(a_->volume(), b_->volume());
    const std::uint32_t spheres = options.quick ? kSpheresIfQuick : kSpheresOfEach;
    packed_a_ = packed(solids_.a, spheres), packed_b_ = packed(solids_.b, spheres);
  }

  nlohmann::json run() {
    const Approach approach{exact_rotation(rotation_from_vector(solids_.turn)),
                            normalized_or_zero(solids_.way)};
    compare(approach);
    follow_path(approach);
    json_.update({{"pair", solids_.name},
                  {"triangles", {a_->triangles(), b_->triangles()}},
                  {"volume_error", worst_error_},
                  {"volume_error_of_spheres", worst_of_spheres_},
                  {"closure", worst_closure_},
                  {"build_seconds", build_seconds_},
                  {"bytes", a_->bytes() + b_->bytes()}});
    for (const double fraction : {0.0, .05, .3}) time_at(fraction);
    return std::move(json_);
  }

  double worst_error() const { return worst_error_; }
  bool is_same_on_device() const { return is_same_on_device_; }

 private:
  static PairOfSolids about_centers(PairOfSolids pair) {
    for (Solid* solid : {&pair.a, &pair.b}) {
      const Vec3 center = mass_properties(*solid).center_of_mass;
      for (Vec3& v : solid->vertices) v = v - center;
    }
    return pair;
  }

  SharedSolid spheres(const Pose& pose) {
    return sphere_pair_.measure({packed_a_, packed_a_.levels.back()}, {},
                                {packed_b_, packed_b_.levels.back()}, pose);
  }

  double volume(const Pose& pose) { return pair_->measure({}, pose, false).volume; }

  // Returns the distance at which both share a fraction of the smaller solid, from afar; 0 stands
  // for the first contact, and for what is never reached.
  double distance_of(const Approach& approach, double fraction) {
    const double shared = fraction * smaller_, far = a_->reach() + b_->reach(), step = far / 64;
    double apart = far;
    while (apart > 0 && !(volume(approach.at(apart)) > shared)) apart -= step;
    double low = std::max(apart, 0.0), high = low + step;
    for (int k = 0; k < 40 && high - low > 1e-9 * far; ++k) {
      const double middle = 0.5 * (low + high);
      (volume(approach.at(middle)) > shared ? low : high) = middle;
    }
    return low;
  }

  // Compares with the truth from 10 um of overlap to concentric solids.
  void compare(const Approach& approach) {
    const double first = distance_of(approach, 0);
    std::vector<double> distances{first + 10 * kMicrometre, first - 10 * kMicrometre,
                                  first - 100 * kMicrometre, first - 500 * kMicrometre};
    for (const double part : {.8, .6, .4, .2, 0.0}) distances.push_back(part * first);
    if (solids_.a.triangles.size() + solids_.b.triangles.size() > kLarge) distances.resize(5);
    for (const double distance : distances) {
      const Pose pose = approach.at(distance);
      const SharedSolid shared = pair_->measure({}, pose);
      worst_closure_ = std::max(worst_closure_, shared.closure);
      Solid moved = solids_.b;
      for (Vec3& v : moved.vertices) v = pose * v;
      const double truth = synthetic::shared_volume(solids_.a, moved);
      const double error = std::abs(shared.volume - truth) / smaller_;
      worst_error_ = std::isnan(error) ? error : std::max(worst_error_, error);
      const double by_spheres = spheres(pose).volume;
      worst_of_spheres_ = std::max(worst_of_spheres_, std::abs(by_spheres - truth) / smaller_);
      if (distance == distances[1])
        json_["error_at_10_um"] = std::abs(shared.volume - truth) / truth;  // of the volume itself
    }
  }

  // Second differences along steps of reach / 4000, relative to the smaller solid.
  void follow_path(const Approach& approach) {
    const double start = distance_of(approach, .05),
                 step = std::min(a_->reach(), b_->reach()) / 4000;
    std::vector<SharedSolid> path;
    for (int k = 0; k < (options_.quick ? 20 : 200); ++k)
      path.push_back(pair_->measure({}, approach.at(start - k * step)));
    double of_volume = 0, of_force = 0;
    for (std::size_t k = 2; k < path.size(); ++k) {
      const SharedSolid &p = path[k - 2], &q = path[k - 1], &r = path[k];
      of_volume = std::max(of_volume, std::abs(p.volume - 2 * q.volume + r.volume));
      of_force = std::max(of_force, norm(p.force - 2 * q.force + r.force));
    }
    json_["volume_jump"] = of_volume / smaller_;
    json_["force_jump"] = of_force / smaller_;
  }

  // Times queries at random rotations and directions; 0 stands for 10 um before the contact.
  void time_at(double fraction) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> turn(-2, 2);
    const auto vector = [&] { return Vec3{turn(random), turn(random), turn(random)}; };
    std::vector<Pose> poses;
    for (int k = 0; k < (options_.quick ? 3 : 32); ++k) {
      const Approach approach{exact_rotation(rotation_from_vector(vector())),
                              normalized_or_zero(vector())};
      const double apart = fraction > 0 ? 0 : 10 * kMicrometre;
      poses.push_back(approach.at(distance_of(approach, fraction) + apart));
    }
    const std::string place = std::to_string(std::lround(100 * fraction)) + " %";
    json_["us"][place] = {
        {"volume", times_of(poses, [&](const Pose& p) { pair_->measure({}, p, false); })},
        {"force", times_of(poses, [&](const Pose& p) { pair_->measure({}, p); })},
        {"spheres", times_of(poses, [&](const Pose& p) { spheres(p); })}};
    if (fraction > 0 && fraction < .1 && options_.device.is_cuda()) time_on_device(poses);
  }

  // Times volumes on the device by the wall's clock, one by one and in a batch that takes the poses
  // again and again, and compares them with the CPU's.
  void time_on_device(const std::vector<Pose>& poses) {
    const auto wall_seconds = [] {
      return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
          .count();
    };
    DeviceSolids device(options_.device, {a_, b_});
    const std::size_t count = options_.quick ? 64 : 32768;
    std::vector<SolidJob> jobs(count);
    for (std::size_t k = 0; k < count; ++k) jobs[k] = {0, 1, {}, poses[k % poses.size()]};
    std::size_t left = 0;  // to the host
    std::vector<double> batches, singles;
    for (int run = 0; run < (options_.quick ? 2 : 5); ++run) {
      double start = wall_seconds();
      const auto answers = device.run(jobs);
      batches.push_back(1e6 * (wall_seconds() - start) / static_cast<double>(count));
      for (std::size_t k = 0; k < poses.size(); ++k) {
        start = wall_seconds();
        const auto alone = device.run({&jobs[k], 1}).front();
        singles.push_back(1e6 * (wall_seconds() - start));
        left += run == 0 && !alone;
        const double expected = volume(poses[k]);
        for (const auto& answer : {alone, answers[k]})
          is_same_on_device_ = is_same_on_device_ && (!answer || answer->volume == expected);
      }
    }
    json_["us_on_device"] = {{"launched", spread_of(singles).median},
                             {"in_batch", spread_of(batches).median},
                             {"left_to_host", left}};
  }

  // Returns the median and the worst over the poses, of the median of several runs each, us.
  template <class Ask>
  nlohmann::json times_of(const std::vector<Pose>& poses, const Ask& ask) {
    const int runs = options_.quick ? 3 : 9;
    std::vector<std::vector<double>> samples(poses.size());
    for (int run = 0; run < runs; ++run)
      for (std::size_t k = 0; k < poses.size(); ++k) {
        const double start = thread_seconds();
        ask(poses[k]);
        samples[k].push_back(1e6 * (thread_seconds() - start));
      }
    std::vector<double> medians;
    for (auto& of_pose : samples) medians.push_back(spread_of(of_pose).median);
    const Spread spread = spread_of(medians);
    return {{"median", spread.median}, {"worst", spread.max}};
  }

  PairOfSolids solids_;
  const SuiteOptions& options_;
  std::shared_ptr<const SolidSurface> a_, b_;
  std::optional<SolidPair> pair_;
  ToolModel packed_a_, packed_b_;
  SpherePair sphere_pair_;
  double smaller_ = 0, build_seconds_ = 0, worst_error_ = 0, worst_closure_ = 0;
  double worst_of_spheres_ = 0;
  bool is_same_on_device_ = true;
  nlohmann::json json_;
};

void add_line(const nlohmann::json& r, Report& report) {
  const auto us = [&](const char* place, const char* what, const char* of) {
    return r["us"][place][what][of].get<double>();
  };
  report.table.rows.push_back(
      {r["pair"].get<std::string>(), r["triangles"][0].get<double>(),
       r["triangles"][1].get<double>(), r["volume_error"].get<double>(), r["closure"].get<double>(),
       r["force_jump"].get<double>(), us("0 %", "volume", "median"), us("5 %", "volume", "median"),
       us("5 %", "volume", "worst"), us("5 %", "force", "median"), us("5 %", "force", "worst"),
       us("30 %", "volume", "median"), us("30 %", "force", "median"),
       r["build_seconds"].get<double>(), 1e-6 * r["bytes"].get<double>(),
       r["volume_error_of_spheres"].get<double>(), us("5 %", "spheres", "median")});
  if (r.contains("us_on_device"))
    for (const char* how : {"launched", "in_batch"})
      report.table.rows.back().push_back(r["us_on_device"][how].get<double>());
  char line[160];
  std::snprintf(
      line, sizeof line, "%-24s %9.1e %9.1e %7.1f %7.1f [%5.0f] %7.1f [%5.0f] %7.1f %7.0e %6.1f\n",
      r["pair"].get<std::string>().c_str(), r["volume_error"].get<double>(),
      r["closure"].get<double>(), us("0 %", "force", "median"), us("5 %", "volume", "median"),
      us("5 %", "volume", "worst"), us("5 %", "force", "median"), us("5 %", "force", "worst"),
      us("30 %", "force", "median"), r["volume_error_of_spheres"].get<double>(),
      us("5 %", "spheres", "median"));
  report.summary += line;
}

}  // namespace

Report run_pairs(const SuiteOptions& options) {
  Report report;
  report.suite = "pairs";
  report.table.columns = {"pair",
                          "triangles_a",
                          "triangles_b",
                          "volume_error",
                          "closure",
                          "force_jump",
                          "us_0_volume",
                          "us_5_volume",
                          "us_5_volume_worst",
                          "us_5_force",
                          "us_5_force_worst",
                          "us_30_volume",
                          "us_30_force",
                          "build_seconds",
                          "memory_mb",
                          "volume_error_spheres",
                          "us_5_spheres"};
  if (options.device.is_cuda())
    report.table.columns.insert(report.table.columns.end(), {"us_5_launched", "us_5_in_batch"});
  report.summary =
      "pair                     volume    closure  us: 0 %  5 % volume [worst] 5 % force [worst] "
      "30 %  spheres: volume, us\n";
  const std::vector<PairOfSolids> pairs = pairs_of_solids(options.quick, options.meshes);
  report.settings = {{"quick", options.quick}, {"pairs", pairs.size()}};
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (options.progress)
      options.progress(static_cast<double>(k) / static_cast<double>(pairs.size()));
    MeasuredPair pair(pairs[k], options);
    report.results.push_back(pair.run());
    add_line(report.results.back(), report);
    if (!(pair.worst_error() <= kMaxVolumeError))
      report.failure = "the volume of " + pairs[k].name + " is wrong by more than a millionth";
    if (!pair.is_same_on_device())
      report.failure = "the volume of " + pairs[k].name + " has other bits on the device";
  }
  return report;
}

}  // namespace vpm::bench
