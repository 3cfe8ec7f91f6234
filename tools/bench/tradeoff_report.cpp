#include "tools/bench/tradeoff_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <tuple>

namespace vpm::bench {
namespace {

// Returns everything but the case.
auto setting_of(const Measured& m) {
  return std::tuple(m.varied, m.noise, m.measure, m.method, m.window, m.stride, m.threads,
                    m.spheres);
}

struct Row {
  const Measured* first = nullptr;
  GroupErrors errors;
  MeanAndWorst force, microseconds;
};

std::vector<Row> rows_of(const std::vector<Measured>& measured) {
  std::map<decltype(setting_of(measured.front())), Row> by_setting;
  for (const Measured& m : measured) {
    Row& row = by_setting[setting_of(m)];
    if (row.first == nullptr) row.first = &m;
    row.errors.add(m.errors);
    row.force.add(m.errors.force.mean());
    row.microseconds.add(m.median_us);
  }
  std::vector<Row> rows;
  rows.reserve(by_setting.size());
  for (auto& [setting, row] : by_setting) rows.push_back(row);
  return rows;
}

nlohmann::json settings_json(const Measured& m) {
  return {{"varied", m.varied},   {"noise", m.noise},    {"measure", m.measure},
          {"method", m.method},   {"window", m.window},  {"stride", m.stride},
          {"threads", m.threads}, {"spheres", m.spheres}};
}

nlohmann::json to_json(const Row& row) {
  nlohmann::json result = settings_json(*row.first);
  result.update({{"mean_us", row.microseconds.mean()},
                 {"volume_mean", row.errors.volume.mean()},
                 {"volume_worst", row.errors.volume_worst.worst()},
                 {"force_mean", row.force.mean()},
                 {"direction_mean_degrees", row.errors.direction.mean()},
                 {"torque_mean", row.errors.torque.mean()},
                 {"jump_worst", row.errors.jump.worst()}});
  return result;
}

// Returns the knee of the refined measure over the number of spheres, for one kind of noise.
const Row* knee_of(const std::vector<Row>& rows, const std::string& noise) {
  std::vector<const Row*> curve;
  for (const Row& row : rows) {
    if (row.first->varied == "spheres" && row.first->noise == noise &&
        row.first->measure == "refined")
      curve.push_back(&row);
  }
  std::vector<double> time, error;
  for (const Row* row : curve) {
    time.push_back(row->microseconds.mean());
    error.push_back(row->errors.volume.mean());
  }
  std::vector<double> front_time, front_error;
  const std::vector<std::size_t> front = pareto_front(time, error);
  if (front.empty()) return nullptr;
  for (const std::size_t k : front) {
    front_time.push_back(time[k]);
    front_error.push_back(error[k]);
  }
  return curve[front[knee(front_time, front_error)]];
}

std::string line_of(const Row& row, bool is_knee) {
  const Measured& m = *row.first;
  char line[200];
  std::snprintf(line, sizeof line,
                "%-8s %-7s %-8s %-13s %6d %6d %7d %7u %9.1f %8.4f %8.3f %8.4f %8.4f %8.3f%s\n",
                m.varied.c_str(), m.noise.c_str(), m.measure.c_str(), m.method.c_str(), m.window,
                m.stride, m.threads, m.spheres, row.microseconds.mean(),
                100 * row.errors.volume.mean(), 100 * row.errors.volume_worst.worst(),
                100 * row.force.mean(), 100 * row.errors.torque.mean(),
                100 * row.errors.jump.worst(), is_knee ? "  knee" : "");
  return line;
}

std::string summary_of(const std::vector<Kept>& kept, const std::vector<Deadline>& deadlines,
                       const std::vector<Fitted>& fitted) {
  std::string text = "\n--max-error: what was asked, and what the level measured\n";
  char line[200];
  for (const Kept& k : kept) {
    std::snprintf(line, sizeof line,
                  "%-14s asked %6.2f %%  %6u spheres  worst %7.4f %%  mean %7.4f %%\n",
                  k.shape.c_str(), 100 * k.asked, k.spheres, 100 * k.worst, 100 * k.mean);
    text += line;
  }
  text += "\n--deadline-us: queries that kept it, and the levels that were used\n";
  for (const Deadline& d : deadlines) {
    std::snprintf(
        line, sizeof line, "%-14s %-14s asked %6.0f us  %6zu of %6zu kept  %u to %u spheres\n",
        d.shape.c_str(), d.scene.c_str(), d.asked_us, d.kept, d.queries, d.coarsest, d.finest);
    text += line;
  }
  text +=
      "\n--for-scene: spheres from, to (mm); level: spheres, us, mean error; own packing: the "
      "same\n";
  for (const Fitted& f : fitted) {
    std::snprintf(line, sizeof line,
                  "%-14s %-7s %5.2f %6.1f   %6u %8.1f %7.4f %%   %6u %8.1f %7.4f %%\n",
                  f.scene.c_str(), f.noise.c_str(), 1e3 * f.scale.smallest_radius(),
                  1e3 * std::min(f.scale.largest_radius(), 9.9), f.level, f.level_us,
                  100 * f.level_errors.volume.mean(), f.packed, f.packed_us,
                  100 * f.packed_errors.volume.mean());
    text += line;
  }
  return text;
}

nlohmann::json to_json(const Kept& k) {
  return {{"varied", "max-error"}, {"shape", k.shape}, {"asked", k.asked},
          {"spheres", k.spheres},  {"worst", k.worst}, {"mean", k.mean}};
}

nlohmann::json to_json(const Deadline& d) {
  return {{"varied", "deadline"}, {"shape", d.shape},       {"scene", d.scene},
          {"noise", d.noise},     {"asked_us", d.asked_us}, {"queries", d.queries},
          {"kept", d.kept},       {"coarsest", d.coarsest}, {"finest", d.finest}};
}

nlohmann::json to_json(const Fitted& f) {
  const auto of = [](std::uint32_t spheres, double us, const Errors& errors) {
    return nlohmann::json{{"spheres", spheres},
                          {"median_us", us},
                          {"volume_mean", errors.volume.mean()},
                          {"volume_worst", errors.volume.worst()}};
  };
  nlohmann::json result{{"varied", "for-scene"},
                        {"shape", f.shape},
                        {"scene", f.scene},
                        {"noise", f.noise},
                        {"spacing", f.scale.spacing},
                        {"scale_noise", f.scale.noise},
                        {"curvature", f.scale.curvature},
                        {"smallest_radius", f.scale.smallest_radius()},
                        {"level", of(f.level, f.level_us, f.level_errors)},
                        {"packing", of(f.packed, f.packed_us, f.packed_errors)}};
  for (const Fixed& fixed : f.fixed) {
    result["fixed"].push_back({{"spheres", fixed.spheres},
                               {"median_us", fixed.median_us},
                               {"volume_mean", fixed.volume_mean}});
  }
  if (std::isfinite(f.scale.largest_radius())) result["largest_radius"] = f.scale.largest_radius();
  return result;
}

void add_table(const std::vector<Measured>& measured, Table& table) {
  table.columns = {"varied",      "shape",       "scene",        "noise",      "measure",
                   "method",      "window",      "stride",       "threads",    "spheres",
                   "median_us",   "volume_mean", "volume_worst", "force_mean", "direction_mean",
                   "torque_mean", "jump_worst"};
  for (const Measured& m : measured) {
    const Errors& e = m.errors;
    table.rows.push_back({m.varied, m.shape, m.scene, m.noise, m.measure, m.method,
                          double(m.window), double(m.stride), double(m.threads), double(m.spheres),
                          m.median_us, e.volume.mean(), e.volume.worst(), e.force.mean(),
                          e.direction.mean(), e.torque.mean(), e.jump.worst()});
  }
}

}  // namespace

std::vector<std::size_t> pareto_front(const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<std::size_t> order(x.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::tuple(x[a], y[a], a) < std::tuple(x[b], y[b], b);
  });
  std::vector<std::size_t> front;
  for (const std::size_t k : order) {
    if (front.empty() || y[k] < y[front.back()]) front.push_back(k);
  }
  return front;
}

std::size_t knee(const std::vector<double>& x, const std::vector<double>& y) {
  const double x0 = std::log(x.front()), y0 = std::log(y.front());
  const double dx = std::log(x.back()) - x0, dy = std::log(y.back()) - y0;
  std::size_t best = 0;
  double deepest = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double below = dy * (std::log(x[k]) - x0) - dx * (std::log(y[k]) - y0);
    if (below > deepest) {
      deepest = below;
      best = k;
    }
  }
  return best;
}

Report tradeoff_report(const TradeoffSettings& settings, const std::vector<Measured>& measured,
                       const std::vector<Kept>& kept, const std::vector<Deadline>& deadlines,
                       const std::vector<Fitted>& fitted) {
  Report report;
  report.suite = "tradeoff";
  const std::vector<Row> rows = rows_of(measured);
  const Row *clean = knee_of(rows, "none"), *noisy = knee_of(rows, "kinect");
  report.settings = {
      {"quick", settings.quick},
      {"levels", settings.levels},
      {"poses", settings.poses},
      {"cases", settings.cases},
      {"time", "mean over the cases of the median over the poses of the fastest of 3 runs"},
      {"precision",
       "double throughout: the query computes in nothing else. Positions and samples "
       "are stored as float32, which moves them by 2^-24 of their distance from the "
       "cloud's origin or the tool's centre, 0.06 um per metre"},
      {"knee", {{"none", clean->first->spheres}, {"kinect", noisy->first->spheres}}}};
  report.summary =
      "Errors in % of the tool's volume (torque: of volume times tool radius)\n"
      "varied   noise   measure  normals       window stride threads spheres        us   volume"
      "    worst    force   torque     jump\n";
  for (const Row& row : rows) {
    report.results.push_back(to_json(row));
    report.summary += line_of(row, &row == clean || &row == noisy);
  }
  for (const Kept& k : kept) report.results.push_back(to_json(k));
  for (const Deadline& d : deadlines) report.results.push_back(to_json(d));
  for (const Fitted& f : fitted) report.results.push_back(to_json(f));
  report.summary += summary_of(kept, deadlines, fitted);
  add_table(measured, report.table);
  return report;
}

}  // namespace vpm::bench
