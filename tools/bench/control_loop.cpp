// control-loop TOOL.vpmg CLOUD.vpmc [option=value ...]: times the queries of a haptic or robot
// controller. The tool slides over the surface in the middle of the cloud, turning, 5 to 10 % of
// its volume inside. Every pose is one query, and its answer is awaited before the next.
//   at=path       or clutter: random poses about points of the cloud
//   device=auto   cpu, cuda, cuda:1, cuda:all
//   queries=10000
//   measure=refined  or paper; the path is the same
//   level=0       spheres; 0 is the finest level
//   rotate=1      number of copies of tool and cloud that take turns, so that caches do not help
//   frames=none   counts or metres: every query sees a new depth image of the cloud's camera, which
//                 lies in the frames' own memory when the time begins
//   behind=0      1: a query sees the image before the newest, which is made ready meanwhile
//   method=inverse-depth   or pca: normals of the images
//   batch=1       number of poses asked at once, as planners do; copies of the tool share them
//   json=FILE     writes the figures as JSON too
//   poses=FILE    writes the first path=400 poses, for vpm-query --poses
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <deque>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "libvpm/cloud/cloud.h"
#include "libvpm/core/error.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/scene/depth_frames.h"
#include "tools/bench/poses_in_clutter.h"

namespace {

using namespace vpm;
using Options = std::map<std::string, std::string>;

constexpr int kWarmUp = 200;  // queries before the timed ones
// Poses that are computed before each query, of which the last is asked: one takes no longer than
// reading the clock.
constexpr int kPaceOf = 32;
constexpr double kPi2 = 6.28318530717958648;

constexpr int kFirst = kWarmUp + kPaceOf;  // poses before that of number 0

// Path of the tool. `shallow` and `deep` are heights of its centre of mass above the point on which
// it slides, metres.
struct Path {
  Vec3 place, normal, side;
  double shallow = 0, deep = 0, swing = 0;

  // Poses that are taken one after another instead, if there are any.
  std::vector<Pose> poses;

  Pose at(const ToolModel& tool, double height, double turn, Vec3 aside) const {
    const double half = turn / 2, s = std::sin(half);
    const Pose pose{
        rotation_from_quaternion({s * normal.x, s * normal.y, s * normal.z, std::cos(half)}), {}};
    return {pose.rotation, place + height * normal + aside - pose.rotation * tool.center_of_mass};
  }
  // Returns the k-th pose, which is one of the warm-up below 0.
  Pose at(const ToolModel& tool, int k) const {
    if (!poses.empty()) return poses[static_cast<std::size_t>(k + kFirst) % poses.size()];
    const double along = 1e-3 * k;
    const double height = (shallow + deep) / 2 + (shallow - deep) / 2 * std::sin(kPi2 * 3 * along);
    const Vec3 aside = swing * std::sin(kPi2 * along) * side +
                       swing * std::sin(kPi2 * 1.4 * along) * cross(normal, side);
    return at(tool, height, 0.3 * std::sin(kPi2 * 0.7 * along), aside);
  }
};

// Returns the height at which this fraction of the tool is inside, by bisection.
double height_for(ToolQuery& query, const AnyBody& cloud, const ToolModel& tool, const Path& path,
                  double fraction) {
  double low = -tool.radius, high = tool.radius;
  for (int step = 0; step < 24; ++step) {
    const double middle = 0.5 * (low + high);
    const Pose pose = path.at(tool, middle, 0, {});
    (query.run(cloud, pose).volume_fraction > fraction ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// Returns the index of the point nearest to the mean of all.
std::size_t middle_of(const std::vector<Vec3f>& points) {
  Vec3 mean;
  for (const Vec3f& p : points) mean += widen(p) / static_cast<double>(points.size());
  const auto nearer = [&](const Vec3f& a, const Vec3f& b) {
    return squared_norm(widen(a) - mean) < squared_norm(widen(b) - mean);
  };
  return static_cast<std::size_t>(std::min_element(points.begin(), points.end(), nearer) -
                                  points.begin());
}

Path make_path(ToolQuery& query, const AnyBody& cloud, const ToolModel& tool) {
  const std::size_t middle = middle_of(cloud.positions());
  Path path;
  path.place = cloud.origin() + widen(cloud.positions()[middle]);
  path.normal = normalized_or_zero(widen(cloud.normals()[middle]));
  path.side = normalized_or_zero(
      cross(path.normal, std::abs(path.normal.x) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
  path.swing = 0.2 * tool.radius;
  path.shallow = height_for(query, cloud, tool, path, 0.05);
  path.deep = height_for(query, cloud, tool, path, 0.10);
  return path;
}

using Clock = std::chrono::steady_clock;
double microseconds_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
}

double quantile(const std::vector<double>& sorted, double q) {
  return sorted[static_cast<std::size_t>(q * static_cast<double>(sorted.size() - 1))];
}

struct Figures {
  std::vector<double> microseconds;  // sorted
  std::vector<double> steady;        // those measured while the host kept its pace, sorted
  double fraction = 0;               // mean fraction of the tool inside
};

// Sorts the times and finds the steady ones. Some machines slow down as a whole for some hundredths
// of a second, tenfold and more. `host_us[k]` is the time of the host's own work before query k,
// which is the same each time; where it takes twice the usual time the machine was slow.
Figures figures_of(std::vector<double> microseconds, const std::vector<double>& host_us,
                   double fraction) {
  constexpr double kSlowed = 2;
  std::vector<double> sorted_host = host_us;
  std::sort(sorted_host.begin(), sorted_host.end());
  const double slow = kSlowed * quantile(sorted_host, 0.5);
  Figures figures;
  for (std::size_t k = 0; k < microseconds.size(); ++k)
    if (host_us[k] <= slow) figures.steady.push_back(microseconds[k]);
  std::sort(figures.steady.begin(), figures.steady.end());
  std::sort(microseconds.begin(), microseconds.end());
  figures.microseconds = std::move(microseconds);
  figures.fraction = fraction;
  return figures;
}

// Returns poses per second, asked `batch` at a time. Several tools take turns.
double run_batches(std::deque<ToolQuery>& tools, const AnyBody& cloud, const ToolModel& tool,
                   const Path& path, int count, int batch) {
  std::vector<ToolQuery*> together;
  for (ToolQuery& query : tools) together.push_back(&query);
  std::vector<Pose> poses;
  std::vector<Job> of_tools;
  for (int k = 0; k < batch; ++k) {
    poses.push_back(path.at(tool, k));
    of_tools.push_back(
        {poses.back(), static_cast<std::uint32_t>(k) % static_cast<std::uint32_t>(tools.size())});
  }
  std::vector<Result> results(poses.size());
  const auto run = [&] {
    if (tools.size() == 1)
      tools.front().run(cloud, jobs_of(poses), results);
    else
      ToolQuery::run(together, cloud, of_tools, results);
  };
  run();
  const auto begin = Clock::now();
  const int batches = (count + batch - 1) / batch;
  for (int k = 0; k < batches; ++k) run();
  return 1e6 * batches * batch / microseconds_since(begin);
}

Figures run(std::deque<ToolQuery>& queries, const std::deque<AnyBody>& clouds,
            const ToolModel& tool, const Path& path, int count) {
  std::vector<double> microseconds, host_us;
  microseconds.reserve(static_cast<std::size_t>(count));
  host_us.reserve(static_cast<std::size_t>(count));
  double fraction = 0;
  for (int k = -kWarmUp; k < count; ++k) {
    const std::size_t copy = static_cast<std::size_t>(k + kWarmUp) % queries.size();
    Pose pose;
    const auto asked = Clock::now();
    for (int before = kPaceOf; before > 0; --before) pose = path.at(tool, k + 1 - before);
    const double host = microseconds_since(asked);
    const auto begin = Clock::now();
    const Result result = queries[copy].run(clouds[copy], pose);
    const double took = microseconds_since(begin);
    if (k < 0) continue;
    host_us.push_back(host);
    microseconds.push_back(took);
    fraction += result.volume_fraction / count;
  }
  return figures_of(std::move(microseconds), host_us, fraction);
}

// Depth images of a camera that looks at one scene.
class CameraStream {
 public:
  CameraStream(const CloudSensor& sensor, bool in_counts, const NormalOptions& normals,
               const Device& device)
      : sensor_(sensor),
        in_counts_(in_counts),
        frames_({sensor.camera.intrinsics, sensor.camera.width, sensor.camera.height,
                 in_counts ? std::optional(kCountsPerMetre) : std::nullopt, normals, device}) {}

  void receive() {
    const std::vector<float>& depth = sensor_.depth.depth;
    if (in_counts_)
      std::transform(depth.begin(), depth.end(), frames_.counts().begin(), [](float z) {
        return static_cast<std::uint16_t>(std::min(z * kCountsPerMetre + 0.5, 65535.0));
      });
    else
      std::copy(depth.begin(), depth.end(), frames_.metres().begin());
  }
  DepthBody prepare() { return frames_.prepare(sensor_.camera.to_world); }

 private:
  static constexpr double kCountsPerMetre = 5000;
  const CloudSensor& sensor_;
  bool in_counts_;
  DepthFrames frames_;
};

// Times queries with a new image for each. Copies of the camera take turns like those of the tool.
Figures run_frames(std::deque<ToolQuery>& queries, std::deque<CameraStream>& cameras,
                   const ToolModel& tool, const Path& path, int count, bool behind) {
  std::vector<double> microseconds, host_us;
  double fraction = 0;
  std::optional<DepthBody> last;
  for (int k = -kWarmUp; k < count; ++k) {
    const std::size_t copy = static_cast<std::size_t>(k + kWarmUp) % queries.size();
    const auto asked = Clock::now();
    const Pose pose = path.at(tool, k);
    cameras[copy].receive();
    const double host = microseconds_since(asked);
    const auto begin = Clock::now();
    const DepthBody newest = cameras[copy].prepare();
    const Result result = queries[copy].run(behind && last ? *last : newest, pose);
    const double took = microseconds_since(begin);
    last = newest;
    if (k < 0) continue;
    host_us.push_back(host);
    microseconds.push_back(took);
    fraction += result.volume_fraction / count;
  }
  return figures_of(std::move(microseconds), host_us, fraction);
}

// Returns the median time until an image is ready, without a query, in microseconds.
double prepare_microseconds(std::deque<CameraStream>& cameras, int count) {
  std::vector<double> microseconds;
  for (int k = -kWarmUp; k < count; ++k) {
    CameraStream& camera = cameras[static_cast<std::size_t>(k + kWarmUp) % cameras.size()];
    camera.receive();
    const auto begin = Clock::now();
    camera.prepare().points();
    const double took = microseconds_since(begin);
    if (k >= 0) microseconds.push_back(took);
  }
  std::sort(microseconds.begin(), microseconds.end());
  return quantile(microseconds, 0.5);
}

// Measures how often the machine interrupts a thread that only reads the clock. Queries are
// interrupted as well, whatever the library does.
nlohmann::json interruptions() {
  using Microseconds = std::chrono::duration<double, std::micro>;
  constexpr double kLeast = 5, kWatched = 5e5;  // microseconds
  const Clock::time_point begin = Clock::now();
  int count = 0;
  double longest = 0, lost = 0;
  for (Clock::time_point last = begin; Microseconds(last - begin).count() < kWatched;) {
    const Clock::time_point next = Clock::now();
    const double gap = Microseconds(next - last).count();
    if (gap >= kLeast) {
      ++count;
      lost += gap;
      longest = std::max(longest, gap);
    }
    last = next;
  }
  return {{"per_second", count * 1e6 / kWatched},
          {"mean_us", count > 0 ? lost / count : 0},
          {"longest_us", longest}};
}

// Prints bars over classes of time that widen by a fifth.
void print_histogram(const Figures& figures) {
  const std::vector<double>& times = figures.microseconds;
  double low = quantile(times, 0.001);
  for (std::size_t at = 0; at < times.size(); low *= 1.2) {
    const auto end = static_cast<std::size_t>(
        std::upper_bound(times.begin(), times.end(), low * 1.2) - times.begin());
    const double fraction = static_cast<double>(end - at) / static_cast<double>(times.size());
    if (end > at) {
      std::printf("%9.1f us  %6zu  %s\n", low * 1.2, end - at,
                  std::string(static_cast<std::size_t>(std::ceil(60 * fraction)), '#').c_str());
    }
    at = end;
  }
}

nlohmann::json about(const QueryOptions& options, const Level& level, const AnyBody& cloud) {
  return {{"device", device_name(options.device)},
          {"measure", options.measure == Measure::paper ? "paper" : "refined"},
          {"spheres", level.sphere_count},
          {"points", cloud.positions().size()}};
}

nlohmann::json to_json(const Figures& figures) {
  const std::vector<double>& times = figures.microseconds;
  return {{"queries", times.size()},
          {"mean_fraction", figures.fraction},
          {"median_us", quantile(times, 0.5)},
          {"p99_us", quantile(times, 0.99)},
          {"min_us", times.front()},
          {"max_us", times.back()},
          {"host_slowed", times.size() - figures.steady.size()},
          {"p99_steady_us", quantile(figures.steady, 0.99)}};
}

void write_poses(const std::string& name, const ToolModel& tool, const Path& path, int count) {
  std::ofstream file(name);
  for (int k = 0; k < count; ++k) {
    const Pose pose = path.at(tool, k);
    const Quaternion q = quaternion_from_rotation(pose.rotation);
    const Vec3 t = pose.translation;
    file << nlohmann::json{t.x, t.y, t.z, q.x, q.y, q.z, q.w}.dump() << '\n';
  }
  if (!file) throw Error(ErrorKind::cannot_write, "cannot write " + name);
}

Options parse(int argc, char** argv) {
  Options options{{"device", "auto"}, {"measure", "refined"}, {"queries", "10000"},
                  {"level", "0"},     {"rotate", "1"},        {"batch", "1"},
                  {"json", ""},       {"poses", ""},          {"path", "400"},
                  {"frames", "none"}, {"behind", "0"},        {"method", "inverse-depth"},
                  {"at", "path"}};
  for (int k = 3; k < argc; ++k) {
    const std::string text = argv[k];
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || options.count(text.substr(0, equals)) == 0)
      throw Error(ErrorKind::invalid_argument,
                  text +
                      ": the options are device= measure= queries= level= "
                      "rotate= frames= behind= method= batch= json= poses= path= at=");
    options[text.substr(0, equals)] = text.substr(equals + 1);
  }
  return options;
}

int number(const Options& options, const std::string& name, int least) {
  const int value = std::atoi(options.at(name).c_str());
  if (value < least)
    throw Error(ErrorKind::invalid_argument,
                name + "= must be a number of at least " + std::to_string(least));
  return value;
}

QueryOptions query_options(const Options& options) {
  QueryOptions query_options;
  query_options.device = device_from_text(options.at("device"));
  query_options.level = static_cast<std::uint32_t>(number(options, "level", 0));
  return query_options;
}

Measure measure_of(const Options& options) {
  const std::string& measure = options.at("measure");
  if (measure == "paper") return Measure::paper;
  if (measure == "refined") return Measure::refined;
  throw Error(ErrorKind::invalid_argument, "measure=" + measure + ": there are refined and paper");
}

// Returns the poses that are taken instead of the path's; none with at=path.
std::vector<Pose> poses_of(const std::string& at, const Cloud& cloud) {
  constexpr std::size_t kPoses = 4096;
  if (at == "clutter") return bench::poses_in_clutter(cloud, kPoses);
  if (at == "path") return {};
  throw Error(ErrorKind::invalid_argument, "at=" + at + ": there are path and clutter");
}

// Makes one camera for each copy of the tool, or none with frames=none.
std::deque<CameraStream> make_cameras(const Options& options, const Cloud& cloud,
                                      const Device& device) {
  std::deque<CameraStream> cameras;
  const std::string& frames = options.at("frames");
  if (frames == "none") return cameras;
  if (!cloud.sensor || (frames != "counts" && frames != "metres"))
    throw Error(ErrorKind::invalid_argument,
                "frames= takes counts or metres, and a cloud with a camera");
  const NormalOptions normals{normal_method_from_text(options.at("method"))};
  for (int k = number(options, "rotate", 1); k > 0; --k)
    cameras.emplace_back(*cloud.sensor, frames == "counts", normals, device);
  return cameras;
}

// Times single queries, in new images where there are cameras, and adds the figures to `json`.
void time_single(const Options& options, std::deque<ToolQuery>& queries,
                 const std::deque<AnyBody>& clouds, std::deque<CameraStream>& cameras,
                 const ToolModel& tool, const Path& path, nlohmann::json& json) {
  const int count = number(options, "queries", 1), behind = number(options, "behind", 0);
  if (!cameras.empty()) {
    json["frames"] = options.at("frames");
    json["behind"] = behind;
    json["method"] = options.at("method");
    json["prepare_us"] = prepare_microseconds(cameras, count);
  }
  const Figures figures = cameras.empty()
                              ? run(queries, clouds, tool, path, count)
                              : run_frames(queries, cameras, tool, path, count, behind != 0);
  print_histogram(figures);
  json.update(to_json(figures));
  json["copies"] = queries.size();
  json["interruptions"] = interruptions();
}

void control(int argc, char** argv) {
  if (argc < 3)
    throw Error(ErrorKind::invalid_argument,
                "usage: control-loop TOOL.vpmg CLOUD.vpmc [option=value ...]");
  const Options options = parse(argc, argv);
  QueryOptions asked = query_options(options);
  const int copies = number(options, "rotate", 1), batch = number(options, "batch", 1);
  const ToolModel tool = read_tool_model(argv[1]);
  const Cloud cloud = read_cloud(argv[2]);
  if (cloud.size() == 0) refuse(std::string(argv[2]) + ": the cloud has no points");
  std::deque<AnyBody> clouds{AnyBody(cloud)};
  ToolQuery refined(tool, asked);
  Path path = make_path(refined, clouds[0], tool);
  path.poses = poses_of(options.at("at"), cloud);
  asked.measure = measure_of(options);
  std::deque<ToolQuery> queries;
  for (int k = 0; k < copies; ++k) {
    if (k > 0) clouds.emplace_back(cloud);
    queries.emplace_back(tool, asked);
  }
  if (!options.at("poses").empty())
    write_poses(options.at("poses"), tool, path, number(options, "path", 1));

  nlohmann::json json = about(asked, queries[0].level(), clouds[0]);
  if (batch > 1) {
    const int count = number(options, "queries", 1);
    json.update({{"batch", batch}, {"poses", count}, {"tools", copies}});
    json["poses_per_second"] = run_batches(queries, clouds[0], tool, path, count, batch);
  } else {
    std::deque<CameraStream> cameras = make_cameras(options, cloud, asked.device);
    time_single(options, queries, clouds, cameras, tool, path, json);
  }
  std::cout << json.dump() << '\n';
  if (!options.at("json").empty()) std::ofstream(options.at("json")) << json.dump(2) << '\n';
}

}  // namespace

int main(int argc, char** argv) {
  try {
    control(argc, argv);
    return 0;
  } catch (const vpm::Error& fault) {
    std::cerr << "control-loop: error: " << fault.what() << '\n';
    return static_cast<int>(fault.kind());
  }
}
