// Puts the neighbours beside the measure: voxmap-pointshell, distance grids, OpenVDB, FCL, spheres
// against spheres. See peers/contest.h for what is measured, and README.md for who wins where.

#include <cstdio>

#include "tools/bench/peers/contest.h"
#include "tools/bench/peers/fcl_pair.h"
#include "tools/bench/recorded_images.h"
#include "tools/bench/suite.h"

namespace vpm::bench {
namespace {

constexpr const char* kHead =
    "peer and setting                                    median [p99] us       MB  volume: mean "
    "worst   force: mean  worst  torque: mean  worst   jitter   (%)\n";

// Writes the mean or the worst in %, or a dash where the peer does not tell.
std::string percent(const nlohmann::json& of, const char* which) {
  if (of.is_null()) return "-";
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", 100 * of[which].get<double>());
  return text;
}

double number(const nlohmann::json& of, const char* which) {
  return of.is_null() ? NAN : of[which].get<double>();
}

void add_row(const nlohmann::json& r, Report& report) {
  const std::string who = r["peer"].get<std::string>() + ", " + r["setting"].get<std::string>();
  const double mb = 1e-6 * r["bytes"].get<double>();
  char line[240];
  std::snprintf(line, sizeof line, "%-48s %9.1f [%7.1f] %8.2f %8s %8s %12s %8s %11s %8s %8s\n",
                who.c_str(), r["median_us"].get<double>(), r["p99_us"].get<double>(), mb,
                percent(r["volume"], "mean").c_str(), percent(r["volume"], "worst").c_str(),
                percent(r["force"], "mean").c_str(), percent(r["force"], "worst").c_str(),
                percent(r["torque"], "mean").c_str(), percent(r["torque"], "worst").c_str(),
                percent(r["jitter"], "mean").c_str());
  report.summary += line;
  report.table.rows.push_back(
      {r["kind"].get<std::string>(), r["scene"].get<std::string>(), r["peer"].get<std::string>(),
       r["setting"].get<std::string>(), r["median_us"].get<double>(), r["p99_us"].get<double>(), mb,
       number(r["volume"], "mean"), number(r["volume"], "worst"), number(r["force"], "mean"),
       number(r["force"], "worst"), number(r["torque"], "mean"), number(r["torque"], "worst"),
       number(r["jitter"], "mean")});
}

}  // namespace

Report run_peers(const SuiteOptions& options) {
  if (!options.data.empty()) require_recorded_images(options.data);
  const ThreadCap cap(options, 1);
  Report report;
  report.suite = "peers";
  report.settings = {{"quick", options.quick}, {"fcl", kHasFcl}, {"budgets_us", kBudgets}};
  report.table.columns = {"kind",         "scene",      "peer",        "setting",
                          "median_us",    "p99_us",     "memory_mb",   "volume_mean",
                          "volume_worst", "force_mean", "force_worst", "torque_mean",
                          "torque_worst", "jitter"};
  if (!kHasFcl) report.summary += "FCL was not found when this was built: it is left out\n";
  // Walls, clutter, rooms and pairs; how many there are depends on the folders.
  const double expected =
      options.quick ? 3 : 4 + (options.data.empty() ? 0 : 4) + (options.meshes.empty() ? 3 : 6);
  double done = 0;
  const auto run = [&](const Contest& contest) {
    const std::size_t first = report.results.size();
    run_contest(contest, options, report.results);
    report.summary += "\n" + contest.kind + ": " + contest.name + "\n" + kHead;
    for (std::size_t k = first; k < report.results.size(); ++k) add_row(report.results[k], report);
    if (options.progress) options.progress(std::min(1.0, ++done / expected));
  };
  contests_of_depth(options, run);
  contests_of_pairs(options, run);
  return report;
}

}  // namespace vpm::bench
