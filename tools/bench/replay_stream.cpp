// The parts of `vpm-bench replay` that run on a recording.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <span>

#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"
#include "libvpm/core/pose.h"
#include "libvpm/file/checksum.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/recording/frame_feed.h"
#include "libvpm/recording/timed_path.h"
#include "tools/bench/peak_memory.h"
#include "tools/bench/replay_parts.h"
#include "tools/bench/suite.h"

namespace vpm::bench {
namespace {

constexpr double kRate = 1000;             // steps per second
constexpr std::size_t kProfileEvery = 10;  // steps between two points of a volume profile

struct Stream {
  Recording recording;
  ImportOptions import;
  Device device;  // the suite's
};

Stream read_stream(const std::string& folder, const Device& device) {
  Stream stream{read_recording(folder, {}), {}, device};
  if (stream.recording.intrinsics)
    stream.import.intrinsics = stream.recording.intrinsics->intrinsics;
  if (!stream.import.intrinsics)
    refuse(folder + ": camera-intrinsics.txt (3x3: fx 0 cx, 0 fy cy, 0 0 1) is missing in it");
  return stream;
}

PreparedChange prepare_frame(FrameReader& reader, std::size_t frame) {
  PreparedChange prepared = reader.prepare({0, {frame}, false});
  if (!prepared.body) refuse(prepared.unusable.front().message);
  return prepared;
}

// Returns the point nearest to the image's middle that is nearer than half of its neighbourhood.
std::size_t middle_point(const AnyBody& cloud) {
  const Vec3 camera = cloud.to_world().translation - cloud.origin();
  const std::size_t count = cloud.positions().size();
  std::vector<std::size_t> around;
  for (std::size_t k = count * 2 / 5; k < count * 3 / 5; ++k) around.push_back(k);
  const auto distance = [&](std::size_t k) {
    return squared_norm(widen(cloud.positions()[k]) - camera);
  };
  const auto middle = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2);
  std::nth_element(around.begin(), middle, around.end(), [&](std::size_t a, std::size_t b) {
    const double da = distance(a), db = distance(b);
    return da != db ? da < db : a < b;
  });
  return *middle;
}

// Returns a path in and out of the surface twice a period, wandering over it and turning.
TimedPath haptic_path(const AnyBody& cloud, const ToolModel& tool, double seconds) {
  constexpr double kPeriod = 2.5, kPosesPerSecond = 100, kWander = 0.05;  // s, 1/s, m
  const std::size_t at = middle_point(cloud);
  const Vec3 place = cloud.origin() + widen(cloud.positions()[at]);
  const Vec3 n = normalized_or_zero(cloud.to_world().translation - place);
  const Vec3 side =
      normalized_or_zero(cross(n, std::abs(n.x) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
  std::vector<double> times;
  std::vector<Pose> poses;
  for (int k = 0; k <= static_cast<int>(seconds * kPosesPerSecond); ++k) {
    const double t = k / kPosesPerSecond, phase = 2 * kPi * t / kPeriod;
    const double height = tool.radius * (0.6 + 0.4 * std::cos(2 * phase));
    const Vec3 center = place + height * n +
                        kWander * (std::sin(phase) * side + (std::cos(phase) - 1) * cross(n, side));
    const Rotation rotation = rotation_from_vector(phase / 2 * n);
    poses.push_back({rotation, center - rotation * tool.center_of_mass});
    times.push_back(t);
  }
  return TimedPath(std::move(times), std::move(poses));
}

// Returns the path through the stream, placed by its first frame.
SampledPath path_through(const Stream& stream, const ToolModel& tool, double seconds) {
  FrameReader reader(stream.recording, stream.import);  // the CPU reads its cloud here
  return SampledPath(haptic_path(*prepare_frame(reader, 0).body, tool, seconds), kRate);
}

// Results of one pass over the stream.
struct Pass {
  std::vector<double> profile;               // volume fraction, every kProfileEvery steps
  std::vector<double> query_us, prepare_ms;  // one per frame
  std::vector<double> latencies;             // s, one per step
  double seconds = 0;
  FrameCounts frames;
};

Pass pass_over(const Stream& stream, const SampledPath& path, ToolQuery& query) {
  Pass pass;
  FrameFeed feed(stream.recording,
                 {kRate, path.steps(), stream.recording.frames.front().time, 0, true},
                 stream.import, stream.device);
  feed.wait_for_first();
  LoopClock clock(kRate, false);
  std::size_t begin = 0;  // step at which the frame begins
  const auto close_frame = [&](std::size_t end) {
    double sum = 0;
    for (std::size_t k = begin; k < end; ++k) sum += clock.latencies()[k];
    if (end > begin) pass.query_us.push_back(1e6 * sum / static_cast<double>(end - begin));
    begin = end;
  };
  for (std::size_t k = 0; k < path.steps(); ++k) {
    if (const PreparedChange* change = feed.advance_to(k)) {
      close_frame(k);
      pass.prepare_ms.push_back(1e3 * change->seconds);
    }
    clock.begin_step();
    const Result result = query.run(feed.body(), path.pose(k));
    clock.end_step();
    if (k % kProfileEvery == 0) pass.profile.push_back(result.volume_fraction);
  }
  close_frame(path.steps());
  pass.seconds = clock.seconds();
  pass.latencies = clock.latencies();
  pass.frames = feed.counts();
  return pass;
}

void add_pass(const Pass& pass, std::uint32_t level, Report& report) {
  const Durations latency(pass.latencies);
  const Durations preparation(pass.frames.seconds);
  const double lasts = static_cast<double>(latency.size()) / kRate;
  report.results.push_back({{"part", "stream"},
                            {"spheres", level},
                            {"steps", latency.size()},
                            {"frames", pass.frames.used},
                            {"p50_us", 1e6 * latency.quantile(0.5)},
                            {"p99_us", 1e6 * latency.quantile(0.99)},
                            {"p99.9_us", 1e6 * latency.quantile(0.999)},
                            {"max_us", 1e6 * latency.quantile(1)},
                            {"deadline_us", 1e6 / kRate},
                            {"deadline_misses", latency.longer_than(1 / kRate)},
                            {"real_time_factor", lasts / pass.seconds},
                            {"prepare_ms", 1e3 * preparation.quantile(0.5)},
                            {"profile_seconds", kProfileEvery / kRate},
                            {"profile", pass.profile},
                            {"frame_query_us", pass.query_us},
                            {"frame_prepare_ms", pass.prepare_ms}});
  for (std::size_t k = 0; k < pass.profile.size(); ++k)
    report.table.rows.push_back({static_cast<double>(level),
                                 static_cast<double>(k * kProfileEvery) / kRate, pass.profile[k]});
  char line[200];
  std::snprintf(line, sizeof line,
                "stream                 %7u spheres: %.1f us median, %.1f p99, %.1f p99.9, %.1f "
                "max; %zu of %zu steps over 1 ms; frames in %.1f ms; %.2f times real time\n",
                level, 1e6 * latency.quantile(0.5), 1e6 * latency.quantile(0.99),
                1e6 * latency.quantile(0.999), 1e6 * latency.quantile(1),
                latency.longer_than(1 / kRate), latency.size(), 1e3 * preparation.quantile(0.5),
                lasts / pass.seconds);
  report.summary += line;
}

// Hashes the bits of many results.
class ResultHash {
 public:
  void add(const Result& r) {
    for (const double number : {r.volume, r.wrench.force.x, r.wrench.force.y, r.wrench.force.z,
                                r.wrench.torque.x, r.wrench.torque.y, r.wrench.torque.z})
      words_.push_back(std::bit_cast<std::uint64_t>(number));
    for (const std::uint32_t count : {r.boundary, r.inside, r.points.value_or(0)})
      words_.push_back(count);
  }
  std::string value() const { return file::content_hash({std::as_bytes(std::span(words_))}); }

 private:
  std::vector<std::uint64_t> words_;
};

// Queries every frame of the recording once, prepared anew, along its part of the path. Returns the
// hash of the results.
std::string soak_round(const Stream& stream, FrameReader& reader, const SampledPath& path,
                       ToolQuery& query) {
  ResultHash hash;
  query.forget();
  const std::size_t frames = stream.recording.frames.size();
  for (std::size_t f = 0; f < frames; ++f) {
    const PreparedChange frame = prepare_frame(reader, f);
    for (std::size_t k = f * path.steps() / frames; k < (f + 1) * path.steps() / frames; ++k)
      hash.add(query.run(*frame.body, path.pose(k)));
  }
  return hash.value();
}

}  // namespace

void run_stream(const ReplayTool& tool, const std::string& folder, const SuiteOptions& suite,
                Report& report) {
  const Stream stream = read_stream(folder, suite.device);
  const SampledPath path = path_through(stream, tool.model, suite.quick ? 1 : 5);
  const ThreadCap cap(suite, 1);  // for the loop; another thread prepares frames
  report.table.columns = {"spheres", "time", "volume_fraction"};
  for (const std::uint32_t level : tool.levels) {
    ToolQuery query(tool.model,
                    {.level = level, .device = suite.device, .coherent = !suite.device.is_cuda()});
    add_pass(pass_over(stream, path, query), level, report);
  }
}

void run_soak(const ReplayTool& tool, const std::string& folder, const SuiteOptions& suite,
              Report& report) {
  const Stream stream = read_stream(folder, suite.device);
  const std::size_t rounds = suite.quick ? 3 : 100, queries = suite.quick ? 2000 : 10000;
  const SampledPath path = path_through(stream, tool.model, static_cast<double>(queries) / kRate);
  constexpr double kGrowth = 8;  // MB: less than half of a frame, so it shows a leak of frames
  ToolQuery query(
      tool.model,
      {.level = tool.soak_level, .device = suite.device, .coherent = !suite.device.is_cuda()});
  FrameReader reader(stream.recording, stream.import, stream.device);
  const std::string hash = soak_round(stream, reader, path, query);
  const double before = resident_memory_mb();
  std::size_t others = 0;
  for (std::size_t k = 1; k < rounds; ++k)
    others += soak_round(stream, reader, path, query) != hash;
  const double after = resident_memory_mb();
  report.results.push_back({{"part", "soak"},
                            {"spheres", tool.soak_level},
                            {"queries", rounds * path.steps()},
                            {"frames", rounds * stream.recording.frames.size()},
                            {"rounds", rounds},
                            {"rounds_with_other_results", others},
                            {"hash", hash},
                            {"memory_before_mb", before},
                            {"memory_after_mb", after}});
  char line[200];
  std::snprintf(line, sizeof line,
                "soak: %zu queries, %zu frames: %.1f MB after the first round, %.1f MB at the end; "
                "%zu rounds with other results\n",
                rounds * path.steps(), rounds * stream.recording.frames.size(), before, after,
                others);
  report.summary += line;
  if (others > 0) report.failure = "results drifted in the soak";
  if (after > before + kGrowth) report.failure = "memory grew in the soak";
}

}  // namespace vpm::bench
