// Runs every extreme case. A case fails by a result that is not finite, a crash, or a zero without
// meaning.
#include "tools/bench/extremes.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>

#include "libvpm/core/error.h"
#include "libvpm/synthetic/render.h"
#include "tools/bench/suite.h"

namespace vpm::bench {
namespace {

struct Outcome {
  std::string said = "right";  // right, refused or wrong
  bool holds = false;
  Deviation deviation{std::numeric_limits<double>::quiet_NaN(), 0, 0};
  std::string message;  // text of the refusal
  double seconds = 0;
};

Outcome outcome_of(const ExtremeCase& c) {
  Outcome outcome;
  const auto begin = std::chrono::steady_clock::now();
  try {
    const Deviation d = outcome.deviation = c.run();
    if (!(std::abs(d.value - d.truth) <= d.bound)) outcome.said = "wrong";
  } catch (const Error& fault) {
    outcome.said = "refused";
    outcome.message = fault.what();
  }
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  outcome.holds = outcome.said == (c.refused ? "refused" : "right");
  return outcome;
}

nlohmann::json to_json(const ExtremeCase& c, const Outcome& outcome) {
  nlohmann::json json{{"group", c.group},
                      {"case", c.name},
                      {"expected", c.refused ? "refused" : "right"},
                      {"outcome", outcome.said},
                      {"holds", outcome.holds},
                      {"seconds", outcome.seconds}};
  if (outcome.said == "refused") {
    json["message"] = outcome.message;
  } else {
    const Deviation& d = outcome.deviation;
    json.update({{"value", d.value}, {"truth", d.truth}, {"bound", d.bound}});
  }
  return json;
}

}  // namespace

double sound_fraction(const Result& r) {
  constexpr double kRounding = 1e-6;
  const bool sound = std::isfinite(r.volume) && is_finite(r.wrench.force) &&
                     is_finite(r.wrench.torque) && r.volume_fraction >= 0 &&
                     r.volume_fraction <= 1 + kRounding;
  return sound ? r.volume_fraction : std::numeric_limits<double>::quiet_NaN();
}

Cloud plane_points(std::vector<Vec3f> positions, std::vector<Vec3f> normals) {
  constexpr float kHuge = 10;  // m; the tools measure 2 m
  Cloud cloud;
  cloud.positions = std::move(positions);
  cloud.normals = std::move(normals);
  cloud.radii.assign(cloud.positions.size(), kHuge);
  return cloud;
}

double ask(const Device& device, const ToolModel& tool, const Cloud& cloud, Measure measure,
           const Pose& pose) {
  ToolQuery query(tool, {.measure = measure, .device = device_for(measure, device)});
  return sound_fraction(query.run(AnyBody(cloud), pose));
}

Camera small_camera() {
  Camera camera = synthetic::default_camera();
  camera.intrinsics = {131.25, 131.25, 79.5, 59.5};
  camera.width = 160;
  camera.height = 120;
  return camera;
}

Cloud see(const synthetic::Surface& surface, const Camera& camera) {
  return make_cloud(synthetic::render(surface, camera), camera, {});
}

Report run_extremes(const SuiteOptions& options) {
  std::vector<ExtremeCase> cases;
  for (const auto& list : {extreme_scales(options.device, options.quick),
                           extreme_clouds(options.device, options.quick),
                           extreme_tools(options.device, options.quick)})
    cases.insert(cases.end(), list.begin(), list.end());
  Report report;
  report.suite = "extremes";
  report.settings = {{"quick", options.quick}, {"cases", cases.size()}};
  report.table.columns = {"group", "case",  "expected", "outcome",
                          "value", "truth", "bound",    "seconds"};
  std::size_t broken = 0;
  std::string lines;
  for (std::size_t k = 0; k < cases.size(); ++k) {
    if (options.progress)
      options.progress(static_cast<double>(k) / static_cast<double>(cases.size()));
    const ExtremeCase& c = cases[k];
    const Outcome outcome = outcome_of(c);
    const Deviation& d = outcome.deviation;
    report.results.push_back(to_json(c, outcome));
    report.table.rows.push_back({c.group, c.name, std::string(c.refused ? "refused" : "right"),
                                 outcome.said, d.value, d.truth, d.bound, outcome.seconds});
    if (outcome.holds) continue;
    ++broken;
    char numbers[96];
    std::snprintf(numbers, sizeof numbers, "%.9g, should be %.9g within %.3g", d.value, d.truth,
                  d.bound);
    lines += "  " + c.group + ": " + c.name + ": " +
             (outcome.said == "refused" ? outcome.message : numbers) + "\n";
  }
  report.summary = std::to_string(cases.size() - broken) + " of " + std::to_string(cases.size()) +
                   " cases right, or refused with a message\n" + lines;
  if (broken > 0) report.failure = std::to_string(broken) + " extreme cases are neither";
  return report;
}

}  // namespace vpm::bench
