// Measures errors of both measures against the truth, and checks the bounds of the refined one.

#include <algorithm>
#include <cstdio>

#include "libvpm/cloud/normals.h"
#include "libvpm/core/error.h"
#include "tools/bench/intervals.h"
#include "tools/bench/random_poses.h"
#include "tools/bench/recorded_images.h"
#include "tools/bench/silhouettes.h"
#include "tools/bench/suite.h"
#include "tools/bench/sweeps.h"

namespace vpm::bench {
namespace {

// Bounds that --measure refined must keep. Volumes are fractions of the tool's, angles degrees,
// torques fractions of volume times tool radius.
struct Bounds {
  const char *noise, *spheres;
  double mean, worst, jump;
};
constexpr Bounds kBounds[] = {{"none", "1000", 0.0015, 0.01, 0.002},
                              {"none", "10000", 0.0006, 0.004, 0.002},
                              {"kinect", "1000", 0.002, 0.015, 0.006},
                              {"kinect", "10000", 0.002, 0.015, 0.006}};
constexpr double kDirectionBound = 1, kTorqueBound = 0.01;

constexpr int kRandomPoses = 10000;
// Spheres of the tools in random poses: so few that points can be fifty times closer than the
// smallest sphere is large.
constexpr std::uint32_t kFew = 20;
// Poses of which intervals are asked in each scene, and images with noise.
constexpr int kIntervalPoses = 80, kIntervalImages = 8;
constexpr double kSpacings[] = {1, 0.2, 0.02};  // in radii of the smallest sphere

const std::vector<std::string> kShapes{"cube", "tetrahedron", "octahedron", "torus",
                                       "twisted-torus"};

class Accuracy {
 public:
  explicit Accuracy(const SuiteOptions& options)
      : options_(options),
        places_(options.quick ? PackedSolid::kFewPlaces : kCountedPlaces),
        sweeps_([&](const std::string& shape) -> const PackedSolid& { return tool(shape); },
                options.noise_seed, options.shadows, options.device, report_) {
    report_.suite = "accuracy";
    report_.settings = {{"quick", options.quick},
                        {"all", options.all},
                        {"noise_seed", options.noise_seed},
                        {"shadows", is_solid() ? "solid" : "near"},
                        {"normals", to_text(NormalOptions{}.method)},
                        {"window", NormalOptions{}.window}};
  }

  Report run_only_intervals() {
    report_.suite = "intervals";
    places_ = std::min(places_, kPlacesOfIntervals);
    levels_ = {options_.quick ? 250u : 1000u};
    steps_ = 1;
    run_intervals();
    summarise_bounds();
    return std::move(report_);
  }

  Report run() {
    if (options_.all) {
      levels_ = {kFew, 1000, 10000};
    } else {
      levels_ = {options_.quick ? 250u : 1000u};
    }
    std::vector<SweepCase> usual = paper_cases();
    if (!options_.quick) {
      const std::vector<SweepCase> more = turned_cases();
      usual.insert(usual.end(), more.begin(), more.end());
    }
    const std::vector<SweepCase> all = options_.all ? all_cases() : std::vector<SweepCase>{};
    steps_ = usual.size() + all.size() + (options_.all ? 21 : 0);
    const std::uint32_t spheres = options_.quick ? 250 : 1000;
    for (const SweepCase& c : usual) {
      sweeps_.run(c, {{spheres}, {CloudKind::camera}, options_.quick ? 15 : 60});
      step();
    }
    std::vector<CloudKind> kinds{CloudKind::camera};
    if (!is_solid()) kinds.push_back(CloudKind::points);  // they have no occluded space
    for (const SweepCase& c : all) {
      sweeps_.run(c, {{1000, 10000}, kinds, 51});
      step();
    }
    summarise_sweeps();
    if (options_.all) {
      run_poses();
      run_edges();
      if (!is_solid()) run_intervals();
      if (!options_.data.empty()) run_frames();
      check_sweeps();
      summarise_bounds();
    }
    return std::move(report_);
  }

 private:
  bool is_solid() const { return options_.shadows == Shadows::solid; }

  const PackedSolid& tool(const std::string& shape) {
    const auto found = tools_.find(shape);
    if (found != tools_.end()) return found->second;
    return tools_.try_emplace(shape, make_packed(shape, levels_, places_)).first->second;
  }

  void step() {
    if (options_.progress)
      options_.progress(static_cast<double>(++done_) / static_cast<double>(steps_));
  }

  void run_poses() {
    double smallest = HUGE_VAL;
    std::vector<const PackedSolid*> tools;
    for (const std::string& shape : kShapes) {
      tools.push_back(&tool(shape));
      smallest = std::min(smallest, tools.back()->model.spheres[kFew - 1].radius);
    }
    report_.summary += "\nRandom poses, " + std::to_string(kFew) + " spheres, smallest radius " +
                       text("%.1f mm", 1e3 * smallest) +
                       ": leaks (error above 2 %) and worst error\n"
                       "scene            spacing      poses    refined             paper\n";
    int leaks = 0;
    for (const char* name : {"tilted-wall", "inverted-ball", "ball", "groove", "step", "plate"}) {
      for (const double spacing : kSpacings) {
        synthetic::Scene scene = synthetic::make_scene(name);
        scene.camera = camera_of_spacing(spacing * smallest);
        const RandomPoses found = run_random_poses(scene, tools, kFew, kRandomPoses, kNoiseSeed,
                                                   options_.shadows, options_.device);
        leaks += found.leaks[0];
        report_.results.push_back({{"group", "random poses"},
                                   {"scene", name},
                                   {"spacing_per_radius", spacing},
                                   {"spheres", kFew},
                                   {"poses", found.poses},
                                   {"leaks", found.leaks[0]},
                                   {"volume_mean", found.error[0].mean()},
                                   {"volume_worst", found.error[0].worst()},
                                   {"paper_poses", found.paper_poses},
                                   {"paper_leaks", found.leaks[1]},
                                   {"paper_volume_mean", found.error[1].mean()},
                                   {"paper_volume_worst", found.error[1].worst()}});
        report_.summary += text("%-13s %6.2f radii %8d %6d %8.2f %% %8d %8.2f %%\n", name, spacing,
                                found.poses, found.leaks[0], 100 * found.error[0].worst(),
                                found.leaks[1], 100 * found.error[1].worst());
        step();
      }
    }
    check("leaks among random poses", leaks, 0);
  }

  void run_intervals() {
    std::vector<const PackedSolid*> tools;
    for (const std::string& shape : kShapes) tools.push_back(&tool(shape));
    add_intervals(tools, options_.quick ? 250 : 1000, options_.quick ? 5 : kIntervalPoses,
                  options_.quick ? 1 : kIntervalImages, report_);
    step();
  }

  void run_edges() {
    constexpr int kPoses = 121;
    report_.summary +=
        "\nSilhouettes and holes, in % of the tool\n"
        "path                       worst    jump   shadows solid: worst    jump   counted in free "
        "space   paper worst    jump\n";
    int counted = 0;
    MeanAndWorst jump, solid, solid_jump;
    for (const char* shape : {"cube", "torus"}) {
      for (const SilhouetteResult& r :
           run_silhouettes(tool(shape), 1000, kPoses, options_.device)) {
        report_.results.push_back({{"group", "silhouettes"},
                                   {"shape", shape},
                                   {"path", r.path},
                                   {"volume_worst", r.volume_worst[0]},
                                   {"jump_worst", r.jump_worst[0]},
                                   {"solid_worst", r.solid_worst},
                                   {"solid_jump_worst", r.solid_jump_worst},
                                   {"counted_in_free_space", r.counted_in_free_space},
                                   {"paper_volume_worst", r.volume_worst[1]},
                                   {"paper_jump_worst", r.jump_worst[1]}});
        report_.summary +=
            text("%-6s %-24s %6.2f %7.2f %20.2f %7.2f %12d %23.1f %7.1f\n", shape, r.path.c_str(),
                 100 * r.volume_worst[0], 100 * r.jump_worst[0], 100 * r.solid_worst,
                 100 * r.solid_jump_worst, r.counted_in_free_space, 100 * r.volume_worst[1],
                 100 * r.jump_worst[1]);
        counted += r.counted_in_free_space;
        jump.add(r.jump_worst[0]);
        solid.add(r.solid_worst);
        solid_jump.add(r.solid_jump_worst);
      }
    }
    check("spheres counted in seen free space, silhouettes and holes", counted, 0);
    if (!is_solid())
      check("jump at silhouettes and holes, shadows near", jump.worst(), kBounds[0].jump);
    check("jump at silhouettes, shadows solid, beyond that of the count", solid_jump.worst(),
          kBounds[0].jump);
    check("difference from the count at silhouettes, shadows solid", solid.worst(),
          kBounds[0].worst);
    step();
  }

  void run_frames() {
    constexpr int kPoses = 500;
    report_.summary +=
        "\nRecorded images, shallow poses: difference from the count of what is behind the image,\n"
        "% of the tool; shadows solid, near, near without places in shadows, and paper\n"
        "frame                                    poses   mean   worst  > 5 %   mean   worst  > 5 %"
        "   mean   worst  > 5 %   in free space   paper mean   worst\n";
    int counted = 0;
    MeanAndWorst solid, near, without_occluded;
    for (const FrameResult& r :
         run_real_frames(options_.data, tool("twisted-torus"), 1000, kPoses, options_.device)) {
      nlohmann::json row = {{"group", "recorded images"},
                            {"frame", r.frame},
                            {"poses", r.poses},
                            {"counted_in_free_space", r.counted_in_free_space}};
      report_.summary += text("%-40s %5d", r.frame.c_str(), r.poses);
      const auto say = [&](const char* name, const FrameResult::Difference& of) {
        row[name] = {
            {"mean", of.all.mean()}, {"worst", of.all.worst()}, {"poses_beyond", of.beyond}};
        report_.summary +=
            text(" %6.2f %7.2f %6d", 100 * of.all.mean(), 100 * of.all.worst(), of.beyond);
      };
      say("solid", r.solid);
      say("near", r.near);
      say("near_without_shadows", r.without_occluded);
      row["paper"] = {{"mean", r.paper.all.mean()}, {"worst", r.paper.all.worst()}};
      report_.summary += text(" %15d %12.2f %7.2f\n", r.counted_in_free_space,
                              100 * r.paper.all.mean(), 100 * r.paper.all.worst());
      report_.results.push_back(std::move(row));
      counted += r.counted_in_free_space;
      solid.add(r.solid.all.worst());
      near.add(r.near.all.worst());
      without_occluded.add(r.without_occluded.all.worst());
    }
    check("spheres counted in seen free space, recorded images", counted, 0);
    check("difference from what is behind recorded images, shadows solid", solid.worst(),
          kFrameBound);
    if (is_solid()) return step();
    check("difference from what is behind recorded images, shadows near", near.worst(),
          kFrameBound);
    check("the same, without places in shadows", without_occluded.worst(), kFrameBound);
    step();
  }

  void summarise_sweeps() {
    report_.summary =
        "Errors in % of the tool's volume (torque: of volume times tool radius)\n"
        "group   cloud   noise   measure  spheres   volume mean    worst     jump"
        "   torque mean   worst   direction mean   worst\n";
    for (const auto& [key, e] : sweeps_.groups()) {
      const auto& [group, cloud, noise, measure, spheres] = key;
      report_.summary += text(
          "%-7s %-7s %-7s %-8s %7s %13.3f %8.2f %8.2f %13.3f %7.2f %16.2f %7.2f\n", group.c_str(),
          cloud.c_str(), noise.c_str(), measure.c_str(), spheres.c_str(), 100 * e.volume.mean(),
          100 * e.volume_worst.worst(), 100 * e.jump.worst(), 100 * e.torque.mean(),
          100 * e.torque_worst.worst(), e.direction.mean(), e.direction_worst.worst());
      report_.settings["summary"].push_back(
          {{"group", group},
           {"cloud", cloud},
           {"noise", noise},
           {"measure", measure},
           {"spheres", std::stoi(spheres)},
           {"volume_mean", e.volume.mean()},
           {"volume_worst", e.volume_worst.worst()},
           {"jump_worst", e.jump.worst()},
           {"torque_mean", e.torque.mean()},
           {"torque_worst", e.torque_worst.worst()},
           {"direction_mean_degrees", e.direction.mean()},
           {"direction_worst_degrees", e.direction_worst.worst()}});
    }
  }

  void check_sweeps() {
    for (const char* cloud : {"camera", "points"}) {
      for (const Bounds& b : kBounds) {
        const auto found = sweeps_.groups().find({"all", cloud, b.noise, "refined", b.spheres});
        if (found == sweeps_.groups().end()) continue;  // no points with solid occluded space
        const GroupErrors& e = found->second;
        const std::string which =
            std::string(", ") + cloud + ", noise " + b.noise + ", " + b.spheres + " spheres";
        check("volume mean" + which, e.volume.mean(), b.mean);
        check("volume worst" + which, e.volume_worst.worst(), b.worst);
        check("jump" + which, e.jump.worst(), b.jump);
        check("torque worst" + which, e.torque_worst.worst(), kTorqueBound);
        check("direction worst" + which, e.direction_worst.worst(), kDirectionBound);
      }
    }
  }

  void check(const std::string& what, double value, double bound) {
    report_.settings["bounds"].push_back(
        {{"what", what}, {"value", value}, {"bound", bound}, {"holds", value <= bound}});
  }

  void summarise_bounds() {
    report_.summary += "\nBounds of the refined measure\n";
    for (const nlohmann::json& b : report_.settings["bounds"]) {
      report_.summary += text("%-62s %9.5f <= %-8.4g %s\n", b["what"].get<std::string>().c_str(),
                              b["value"].get<double>(), b["bound"].get<double>(),
                              b["holds"].get<bool>() ? "holds" : "FAILS");
    }
  }

  template <class... Values>
  static std::string text(const char* format, Values... values) {
    char line[240];
    std::snprintf(line, sizeof line, format, values...);
    return line;
  }

  const SuiteOptions& options_;
  std::size_t places_;  // counted in each tool
  std::vector<std::uint32_t> levels_;
  std::map<std::string, PackedSolid> tools_;
  Report report_;
  Sweeps sweeps_;
  std::size_t done_ = 0, steps_ = 0;
};

}  // namespace

Report run_accuracy(const SuiteOptions& options) {
  if (!options.data.empty() && !options.all)
    throw Error(ErrorKind::invalid_argument,
                "accuracy asks recorded images with --all only; give it, too");
  if (!options.data.empty()) require_recorded_images(options.data);
  return Accuracy(options).run();
}

Report run_intervals(const SuiteOptions& options) {
  return Accuracy(options).run_only_intervals();
}

}  // namespace vpm::bench
