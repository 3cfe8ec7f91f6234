#include "tools/query/replay_report.h"

namespace vpm::tools {
namespace {

constexpr double kMicro = 1e6, kMilli = 1e3;

nlohmann::json quantiles(const Durations& d) {
  return {{"p50", kMicro * d.quantile(0.5)},
          {"p99", kMicro * d.quantile(0.99)},
          {"p99.9", kMicro * d.quantile(0.999)},
          {"max", kMicro * d.quantile(1)}};
}

// Returns the number of steps up to 1, 2, 5, 10, ... microseconds, until all are counted.
nlohmann::json histogram(const Durations& latency) {
  nlohmann::json bins = nlohmann::json::array();
  std::size_t left = latency.size();
  for (double decade = 1; left > 0; decade *= 10) {
    for (const double factor : {1, 2, 5}) {
      const std::size_t longer = latency.longer_than(factor * decade / kMicro);
      bins.push_back({{"up_to_us", factor * decade}, {"steps", left - longer}});
      left = longer;
      if (left == 0) break;
    }
  }
  return bins;
}

}  // namespace

nlohmann::json replay_report(const LoopClock& clock, double rate, double wall, double deadline) {
  const Durations latency(clock.latencies());
  const double lasts = static_cast<double>(latency.size()) / rate;
  nlohmann::json report{{"steps", latency.size()},
                        {"rate", rate},
                        {"path_seconds", lasts},
                        {"wall_seconds", wall},
                        {"real_time_factor", lasts / wall},
                        {"load", latency.mean() * rate},
                        {"deadline_us", kMicro * deadline},
                        {"deadline_misses", latency.longer_than(deadline)},
                        {"latency_us", quantiles(latency)},
                        {"latency_histogram", histogram(latency)},
                        {"jitter_us", kMicro * latency.deviation()}};
  if (!clock.delays().empty()) report["start_delay_us"] = quantiles(Durations(clock.delays()));
  return report;
}

nlohmann::json frames_report(const Recording& recording, const FrameCounts& counts) {
  const Durations preparation(counts.seconds);
  return {
      {"listed", recording.frames.size()},
      {"used", counts.used},
      {"unseen", counts.unseen},
      {"missing", recording.missing},
      {"late", counts.late},
      {"lost", counts.lost},
      {"empty", counts.empty},
      {"broken", counts.broken},
      {"prepare_ms",
       {{"median", kMilli * preparation.quantile(0.5)}, {"max", kMilli * preparation.quantile(1)}}},
      {"waits", counts.waits},
      {"longest_wait_ms", kMilli * counts.longest_wait}};
}

}  // namespace vpm::tools
