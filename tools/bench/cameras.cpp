// Suite of several cameras around one scene: errors of one to four cameras, as they are and with
// noise, holes and wrong poses, also after these were registered; the time of queries, and that in
// which four images become ready for them.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <span>
#include <thread>

#include "libvpm/cloud/normals.h"
#include "libvpm/core/error.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/scene/depth_frames.h"
#include "libvpm/scene/rig/rig_body.h"
#include "libvpm/setup/registration.h"
#include "libvpm/synthetic/render.h"
#include "libvpm/synthetic/surface.h"
#include "tools/bench/errors.h"
#include "tools/bench/penetration_case.h"
#include "tools/bench/random_draws.h"
#include "tools/bench/statistics.h"
#include "tools/bench/suite.h"

namespace vpm::bench {
namespace {

constexpr std::uint64_t kCalibrationSeed = 21, kPatchSeed = 22, kTurnSeed = 23;
constexpr std::size_t kMostCameras = 4;
constexpr double kDegree = 3.14159265358979323846 / 180;

struct CameraScene {
  std::string name;
  synthetic::SurfacePtr surface;
  Vec3 target;  // tools move toward it
  bool is_seen_from_below = false;
};

Pose turned_about_z(double degrees, Vec3 at) {
  return {rotation_from_vector({0, 0, degrees * kDegree}), at};
}

// Returns scenes of about .2 m on a floor, z upward, and an object of a hand's size in a room.
std::vector<CameraScene> make_scenes() {
  constexpr double kFar = 20;
  const auto on_floor = [](synthetic::SurfacePtr thing) {
    return synthetic::make_union({std::move(thing), synthetic::make_wall({}, {0, 0, 1})});
  };
  return {{"ball", on_floor(synthetic::make_ball({0, 0, 0.12}, 0.1)), {0, 0, 0.12}},
          {"box",
           on_floor(synthetic::make_block({0.24, 0.18, 0.16}, turned_about_z(25, {0, 0, 0.1}))),
           {0, 0, 0.12}},
          {"plate",
           on_floor(synthetic::make_block({0.3, 0.004, 0.2}, turned_about_z(35, {0, 0, 0.12}))),
           {0, 0, 0.16}},
          {"step",
           synthetic::make_prism(
               {{-kFar, 0.05}, {-0.03, 0.05}, {-0.03, 0}, {kFar, 0}, {kFar, -kFar}, {-kFar, -kFar}},
               turned_about_z(15, {})),
           {-0.03, 0, 0.03}},
          {"groove",
           synthetic::make_prism({{-kFar, 0.1},
                                  {-0.1, 0.1},
                                  {0, 0},
                                  {0.1, 0.1},
                                  {kFar, 0.1},
                                  {kFar, -kFar},
                                  {-kFar, -kFar}},
                                 turned_about_z(15, {})),
           {0, 0, 0.07}},
          {"hand-sized",
           synthetic::make_union(
               {synthetic::make_block({0.09, 0.18, 0.06}, turned_about_z(20, {0, 0, 0.08})),
                synthetic::make_inverted_ball({0, 0, 0.08}, 1.6)}),
           {0, 0, 0.08},
           true}};
}

// Returns cameras .85 to 1.2 m from the scene, in the order in which they are added.
std::vector<Camera> cameras_around(const CameraScene& scene) {
  struct CameraPlace {
    double around, above, distance;  // degrees, m
  };
  constexpr CameraPlace kPlaces[] = {
      {20, 42, 0.95}, {200, 36, 1.1}, {112, 48, 0.85}, {290, 40, 1.2}};
  const Vec3 middle{0, 0, 0.08};
  std::vector<Camera> cameras;
  for (const CameraPlace& place : kPlaces) {
    const bool is_below = scene.is_seen_from_below && cameras.size() % 2 == 1;
    const double around = place.around * kDegree,
                 above = (is_below ? -place.above : place.above) * kDegree;
    const Vec3 out{std::cos(around) * std::cos(above), std::sin(around) * std::cos(above),
                   std::sin(above)};
    const Vec3 x = normalized_or_zero(cross(-out, {0, 0, 1})), y = cross(-out, x);
    Camera camera = synthetic::default_camera();
    camera.to_world = {transpose(Rotation{x, y, -out}), middle + place.distance * out};
    cameras.push_back(camera);
  }
  return cameras;
}

struct Condition {
  const char* name;
  bool has_noise = false, has_holes = false;
  double off = 0, turned = 0;  // m, degrees: by which each camera's pose is wrong
  bool is_registered = false;  // cameras are moved until their images agree
};
constexpr Condition kConditions[] = {{"clean"},
                                     {"noise", true},
                                     {"holes", false, true},
                                     {"small", false, false, 0.001, 0.1},
                                     {"large", false, false, 0.005, 0.5},
                                     {"clean, registered", false, false, 0, 0, true},
                                     {"noise, registered", true, false, 0, 0, true},
                                     {"small, registered", false, false, 0.001, 0.1, true},
                                     {"large, registered", false, false, 0.005, 0.5, true}};

Vec3 any_direction(synthetic::NormalNumbers& numbers) {
  const double x = numbers.next(), y = numbers.next(), z = numbers.next();
  return normalized_or_zero({x, y, z});
}

void unset_patches(DepthImage& image, std::uint64_t seed) {
  constexpr int kPatches = 60;
  for (int k = 0; k < kPatches; ++k) {
    synthetic::NormalNumbers numbers(seed, static_cast<std::uint64_t>(k));
    const double u0 = image.width * (0.5 + 0.15 * numbers.next()),
                 v0 = image.height * (0.5 + 0.15 * numbers.next()),
                 radius = std::clamp(7.5 + 3 * numbers.next(), 3.0, 12.0);
    for (std::size_t i = 0; i < image.depth.size(); ++i) {
      const double u = static_cast<double>(i % image.width) - u0,
                   v = static_cast<double>(i / image.width) - v0;
      if (u * u + v * v < radius * radius) image.depth[i] = 0;
    }
  }
}

// Returns what the cameras deliver, each with the pose that is told of it.
std::vector<CloudSensor> images_of(const CameraScene& scene, const std::vector<Camera>& cameras,
                                   const Condition& condition) {
  std::vector<CloudSensor> images;
  for (std::uint64_t k = 0; k < cameras.size(); ++k) {
    DepthImage image = condition.has_noise ? synthetic::render_with_kinect_noise(
                                                 *scene.surface, cameras[k], 100 + k)
                                           : synthetic::render(*scene.surface, cameras[k]);
    if (condition.has_holes) unset_patches(image, kPatchSeed + 100 * k);
    Camera told = cameras[k];
    synthetic::NormalNumbers numbers(kCalibrationSeed, k);
    told.to_world.translation += condition.off * any_direction(numbers);
    told.to_world.rotation =
        rotation_from_vector(condition.turned * kDegree * any_direction(numbers)) *
        told.to_world.rotation;
    images.push_back({told, std::move(image)});
  }
  return images;
}

std::vector<DepthBody> bodies_of(std::span<const CloudSensor> images) {
  std::vector<DepthBody> bodies;
  for (const auto& [camera, image] : images) bodies.emplace_back(make_cloud(image, camera, {}));
  return bodies;
}

// Moves cameras until their images agree, as --register does. Where they share too little for that,
// they stay.
void move_to_agree(std::vector<CloudSensor>& images) {
  try {
    const Registration found = register_images(bodies_of(images));
    for (std::size_t k = 0; k < images.size(); ++k) images[k].camera.to_world = found.to_world[k];
  } catch (const Error& fault) {
    if (fault.kind() != ErrorKind::refused) throw;
  }
}

AnyBody body_of(std::vector<CloudSensor> images, std::size_t cameras, bool is_registered) {
  images.resize(cameras);
  if (is_registered) move_to_agree(images);
  return body_of_cameras(bodies_of(images));
}

// Returns the fraction of a tool that is inside the scene, roughly.
double roughly_inside(const PackedSolid& tool, const Pose& pose,
                      const synthetic::Surface& surface) {
  constexpr std::size_t kPlaces = 2000;
  const auto places = std::span(tool.places).first(kPlaces);
  const auto inside = std::ranges::count_if(
      places, [&](const Vec3& place) { return surface.distance(pose * place) < 0; });
  return static_cast<double>(inside) / kPlaces;
}

// Returns poses on a way into the scene, from the first contact until most of the tool is inside.
std::vector<Pose> way_into(const CameraScene& scene, const PackedSolid& tool, std::size_t way,
                           int poses) {
  struct Direction {
    double around, above;  // degrees
  };
  constexpr Direction kWays[] = {{15, 18}, {135, 12}, {255, 30}, {75, 55}, {300, 22}, {0, 90}};
  const Direction& direction = kWays[way % std::size(kWays)];
  const double around = direction.around * kDegree, above = direction.above * kDegree;
  const Vec3 out{std::cos(around) * std::cos(above), std::sin(around) * std::cos(above),
                 std::sin(above)};
  synthetic::NormalNumbers numbers(kTurnSeed, way);
  const Rotation turned = random_rotation(numbers);
  const auto pose = [&](double distance) { return Pose{turned, scene.target + distance * out}; };
  constexpr double kFirst = 0.45, kLast = -0.05, kStep = 0.005, kDeep = 0.8;
  double first = kFirst, last = kLast;
  while (first > kLast && roughly_inside(tool, pose(first), *scene.surface) == 0) first -= kStep;
  for (double at = first; at > kLast; at -= kStep) {
    if (roughly_inside(tool, pose(at), *scene.surface) < kDeep) continue;
    last = at;
    break;
  }
  std::vector<Pose> path;
  for (int k = 0; k < poses; ++k)
    path.push_back(pose(first + kStep + (last - first - kStep) * k / (poses - 1)));
  return path;
}

// What a tool's path into a scene should measure, and what so many cameras can know of it.
struct WayIn {
  std::string scene;
  const PackedSolid* tool;
  std::vector<Pose> poses;
  std::vector<synthetic::Penetration> truth;
  std::array<std::vector<Unseen>, kMostCameras> unseen;
};

std::vector<WayIn> ways_into(const CameraScene& scene, const std::vector<Camera>& cameras,
                             const std::vector<PackedSolid>& tools, int ways, int poses) {
  std::vector<WayIn> all_ways;
  std::vector<Sight> sights;
  for (const Camera& camera : cameras) sights.emplace_back(*scene.surface, camera);
  for (const PackedSolid& tool : tools) {
    for (int way = 0; way < ways; ++way) {
      WayIn path{
          scene.name, &tool, way_into(scene, tool, static_cast<std::size_t>(way), poses), {}, {}};
      path.truth = truth_along(tool.solid, path.poses, *scene.surface);
      for (std::size_t k = 0; k < kMostCameras; ++k) {
        const std::vector<Sight> some(sights.begin(), sights.begin() + std::ptrdiff_t(k) + 1);
        for (const Pose& pose : path.poses)
          path.unseen[k].push_back(unseen_parts(tool.few_places(), pose, *scene.surface, some));
      }
      all_ways.push_back(std::move(path));
    }
  }
  return all_ways;
}

// Errors and times of a number of cameras under one condition, by scene and together.
struct Group {
  std::map<std::string, GroupErrors> of_scene;
  GroupErrors all;
  std::vector<double> microseconds;           // of queries
  std::vector<double> core_ready, two_ready;  // ms, in which all images become ready
  std::vector<double> device_ready;           // ms, to the first answer there
};

std::vector<DepthFrames> frames_of(const std::vector<CloudSensor>& images, const Device& device) {
  std::vector<DepthFrames> frames;
  for (const auto& [camera, image] : images)
    frames.emplace_back(
        DepthFrameOptions{camera.intrinsics, camera.width, camera.height, {}, {}, device});
  return frames;
}

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Adds the time from images in the frames' own memory to the first answer of a device, with all
// threads of the host.
void time_on_device(const std::vector<CloudSensor>& images, int runs, const Device& device,
                    const ToolModel& tool, Group& group) {
  const ThreadCap cap({}, static_cast<int>(std::thread::hardware_concurrency()));
  std::vector<DepthFrames> frames = frames_of(images, device);
  QueryOptions options;
  options.device = device;
  ToolQuery query(tool, options);
  constexpr int kWarmUps = 5;
  for (int run = -kWarmUps; run < runs; ++run) {
    for (std::size_t k = 0; k < images.size(); ++k)
      std::ranges::copy(images[k].depth.depth, frames[k].metres().begin());
    const double start = wall_seconds();
    std::vector<DepthBody> bodies;
    for (std::size_t k = 0; k < images.size(); ++k)
      bodies.push_back(frames[k].prepare(images[k].camera.to_world));
    query.run(RigBody(std::move(bodies)), Pose{});
    if (run >= 0) group.device_ready.push_back(1e3 * (wall_seconds() - start));
  }
}

// Makes images ready for queries again and again, as they come from cameras. Adds the time of a
// core that this takes, and the time that it takes on two.
void time_preparation(const std::vector<CloudSensor>& images, int runs, Group& group) {
  std::vector<DepthFrames> frames = frames_of(images, {});
  std::optional<RigBody> rig;  // the last one, as long as nothing replaces it
  const auto prepare = [&] {
    std::vector<DepthBody> bodies;
    for (std::size_t k = 0; k < images.size(); ++k) {
      std::ranges::copy(images[k].depth.depth, frames[k].metres().begin());
      bodies.push_back(frames[k].prepare(images[k].camera.to_world));
    }
    rig.emplace(std::move(bodies));
  };
  const auto milliseconds_of = [&](int threads, const auto& clock) {
    const ThreadCap cap({}, threads);
    const double start = clock();
    prepare();
    return 1e3 * (clock() - start);
  };
  constexpr int kWarmUps = 2;
  for (int k = 0; k < kWarmUps; ++k) prepare();
  for (int k = 0; k < runs; ++k) {
    group.core_ready.push_back(milliseconds_of(1, process_seconds));
    group.two_ready.push_back(milliseconds_of(2, wall_seconds));
  }
}

void measure(const WayIn& path, const AnyBody& body, std::size_t cameras, Group& group) {
  ToolQuery query(path.tool->model, {});
  std::vector<Result> found;
  for (const Pose& pose : path.poses) {
    const double start = thread_seconds();
    found.push_back(query.run(body, pose));
    group.microseconds.push_back(1e6 * (thread_seconds() - start));
  }
  const Errors errors = compare(found, path.truth, path.unseen[cameras - 1], path.tool->solid);
  group.of_scene[path.scene].add(errors);
  group.all.add(errors);
}

nlohmann::json to_json(const GroupErrors& errors) {
  return {{"volume_mean", errors.volume.mean()},
          {"volume_worst", errors.volume_worst.worst()},
          {"jump_worst", errors.jump.worst()},
          {"direction_mean_degrees", errors.direction.mean()},
          {"direction_worst_degrees", errors.direction_worst.worst()}};
}

using Groups = std::map<std::pair<std::string, std::size_t>, Group>;  // condition, cameras

// Measures all ways into a scene before one to four cameras, and under all conditions.
void measure(const CameraScene& scene, const std::vector<PackedSolid>& tools, int ways, int poses,
             const Device& device, Groups& groups) {
  const std::vector<Camera> cameras = cameras_around(scene);
  const std::vector<WayIn> all_ways = ways_into(scene, cameras, tools, ways, poses);
  for (const Condition& condition : kConditions) {
    const std::vector<CloudSensor> images = images_of(scene, cameras, condition);
    for (std::size_t count = condition.is_registered ? 2 : 1; count <= kMostCameras; ++count) {
      const AnyBody body = body_of(images, count, condition.is_registered);
      for (const WayIn& way_in : all_ways)
        measure(way_in, body, count, groups[{condition.name, count}]);
    }
    if (condition.is_registered || condition.off != 0) continue;
    Group& group = groups[{condition.name, kMostCameras}];
    time_preparation(images, ways, group);
    if (device.is_cuda()) time_on_device(images, ways, device, tools.front().model, group);
  }
}

void add_rows(const std::string& condition, std::size_t count, const Group& group, Table& table) {
  const auto add = [&](const std::string& scene, const GroupErrors& errors) {
    table.rows.push_back({condition, static_cast<double>(count), scene, errors.volume.mean(),
                          errors.volume_worst.worst(), errors.jump.worst(),
                          errors.direction.mean()});
  };
  add("all", group.all);
  for (const auto& [scene, errors] : group.of_scene) add(scene, errors);
}

nlohmann::json to_json(const std::string& condition, std::size_t count, const Group& group) {
  nlohmann::json result = to_json(group.all);
  result["condition"] = condition;
  result["cameras"] = count;
  result["query_us"] = spread_of(group.microseconds).median;
  if (!group.core_ready.empty()) {
    result["ready_core_ms"] = spread_of(group.core_ready).median;
    result["ready_two_cores_ms"] = spread_of(group.two_ready).median;
  }
  if (!group.device_ready.empty()) result["ready_device_ms"] = spread_of(group.device_ready).median;
  for (const auto& [scene, errors] : group.of_scene) result["scenes"][scene] = to_json(errors);
  return result;
}

std::string line_of(const std::string& condition, std::size_t count, const Group& group) {
  char line[240], ready[80] = "", on_device[40] = "";
  if (!group.core_ready.empty())
    std::snprintf(ready, sizeof ready, "  %5.1f %5.1f", spread_of(group.core_ready).median,
                  spread_of(group.two_ready).median);
  if (!group.device_ready.empty())
    std::snprintf(on_device, sizeof on_device, " %5.2f", spread_of(group.device_ready).median);
  std::snprintf(line, sizeof line, "%-17s %zu  %6.3f %6.2f  %5.1f  %5.0f%s%s\n", condition.c_str(),
                count, 100 * group.all.volume.mean(), 100 * group.all.volume_worst.worst(),
                group.all.direction.mean(), spread_of(group.microseconds).median, ready, on_device);
  return line;
}

}  // namespace

Report run_cameras(const SuiteOptions& options) {
  const ThreadCap cap(options, 1);
  const int ways = options.quick ? 1 : 6, poses = options.quick ? 5 : 9;
  const std::uint32_t spheres = options.quick ? 200 : 1000;
  constexpr std::size_t kPlaces = 65536;
  std::vector<PackedSolid> tools;
  for (const char* name : {"cube", "torus"}) tools.push_back(make_packed(name, {spheres}, kPlaces));
  Groups groups;
  const std::vector<CameraScene> scenes = make_scenes();
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    measure(scenes[k], tools, ways, poses, options.device, groups);
    if (options.progress)
      options.progress(static_cast<double>(k + 1) / static_cast<double>(scenes.size()));
  }
  Report report;
  report.suite = "cameras";
  report.settings = {
      {"tools", {"cube", "torus"}}, {"spheres", spheres}, {"ways", ways}, {"poses", poses}};
  report.table.columns = {"condition",
                          "cameras",
                          "scene",
                          "volume_mean",
                          "volume_worst",
                          "jump_worst",
                          "direction_mean_degrees"};
  report.summary =
      "condition, cameras; volume, % of the tool: mean, worst; direction, degrees; query, us; "
      "ready, ms of a core, on two, and on a device\n";
  for (const auto& [key, group] : groups) {
    const auto& [condition, count] = key;
    report.results.push_back(to_json(condition, count, group));
    add_rows(condition, count, group, report.table);
    report.summary += line_of(condition, count, group);
  }
  return report;
}

}  // namespace vpm::bench
