#include "tools/query/setup_check.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "libvpm/cloud/kd_tree.h"
#include "libvpm/core/box.h"
#include "libvpm/core/error.h"

namespace vpm::tools {
namespace {

constexpr std::size_t kMostScenes = 64;     // chosen from those that the kept poses were in
constexpr std::size_t kMostPixels = 20000;  // chosen from a scan

double diagonal_of(std::span<const Vec3f> points) {
  if (points.empty()) return 0;
  Box box;
  for (const Vec3f& p : points) box.add(widen(p));
  return norm(box.size());
}

// Returns the distance of `along` from the plane through the axis `slope` of the camera, positive
// on the side of larger slopes.
double side_of_plane(double along, double z, double slope) {
  return (along - slope * z) / std::sqrt(1 + slope * slope);
}

// True if a part of the ball may be before the camera and within the image.
bool is_in_view(const ToolBall& ball, const Camera& camera) {
  const Vec3 c = inverse(camera.to_world) * ball.center;
  const Intrinsics& k = camera.intrinsics;
  const double left = (-0.5 - k.cx) / k.fx, right = (camera.width - 0.5 - k.cx) / k.fx,
               top = (-0.5 - k.cy) / k.fy, bottom = (camera.height - 0.5 - k.cy) / k.fy;
  return c.z > -ball.radius && side_of_plane(c.x, c.z, left) > -ball.radius &&
         side_of_plane(c.x, c.z, right) < ball.radius &&
         side_of_plane(c.y, c.z, top) > -ball.radius &&
         side_of_plane(c.y, c.z, bottom) < ball.radius;
}

bool is_identity(const Pose& pose) {
  const Quaternion q = quaternion_from_rotation(pose.rotation);
  return pose.translation == Vec3{} && q.x == 0 && q.y == 0 && q.z == 0;
}

}  // namespace

// Counts the poses at which a tool is where it is meant to be.
struct PoseFit {
  std::size_t in_view = 0;   // in a camera's view
  std::size_t near = 0;      // and within the tool's size of the surface
  std::size_t touching = 0;  // and its ball holds a point
};

// Mistakes that would explain why no tool is at the scene.
enum class Mistake { poses_inverted, camera_inverted, poses_of_camera, camera_w_first, axes };

struct Suspicion {
  Mistake mistake = Mistake::axes;
  CameraAxes axes = CameraAxes::opencv;  // those that the scene would have
};

// A scene with what its poses are compared by.
struct PlacedScene {
  explicit PlacedScene(CheckedScene s) : scene(std::move(s)), tree(scene.positions) {}

  // Returns the pose of the frame of camera or points in the world, without the turn of its axes.
  Pose frame(const SceneSource& source) const {
    if (!scene.camera) return source.points_to_world.value_or(Pose{});
    const Pose to_world = scene.camera->to_world;
    // An image without a pose has this library's axes, whatever is told.
    if (is_identity(to_world)) return to_world;
    return to_world * Pose{transpose(to_axes(source.axes)), {}};
  }
  void count(const ToolBall& ball, PoseFit& fit) const {
    if (scene.camera && !is_in_view(ball, *scene.camera)) return;
    ++fit.in_view;
    const Vec3f center = narrow(ball.center - scene.origin);
    const double gap = std::sqrt(tree.squared_distance(center, 1)) - ball.radius;
    fit.near += gap <= 2 * ball.radius;
    fit.touching += gap <= 0;
  }

  // True if the whole ball is behind the camera.
  bool is_behind(const ToolBall& ball) const {
    return scene.camera && (inverse(scene.camera->to_world) * ball.center).z <= -ball.radius;
  }

  CheckedScene scene;
  KdTree tree;
};

namespace {

// Returns the pose whose quaternion was written with w first, and read with w last.
Pose with_w_first(const Pose& read) {
  const Quaternion q = quaternion_from_rotation(read.rotation);
  return {rotation_from_quaternion({q.y, q.z, q.w, q.x}), read.translation};
}

// Returns the motion that takes the scene, if the mistake is put right, to where it is now: moves
// the tool instead of the points. Returns nothing where the mistake cannot have been made.
std::optional<Pose> motion_of(const Suspicion& suspicion, const PlacedScene& place,
                              const SceneSource& source) {
  const Pose frame = place.frame(source);
  const Pose turn{to_axes(source.axes), {}}, other_turn{to_axes(suspicion.axes), {}};
  const bool has_pose = !is_identity(frame);
  std::optional<Pose> motion;
  switch (suspicion.mistake) {
    case Mistake::poses_inverted:
      return Pose{};
    case Mistake::camera_inverted:
      if (has_pose) motion = frame * frame;
      break;
    case Mistake::poses_of_camera:
      if (has_pose) motion = frame * turn;
      break;
    case Mistake::camera_w_first:
      if (has_pose) motion = frame * inverse(with_w_first(frame));
      break;
    case Mistake::axes:
      if (place.scene.camera)
        motion = place.scene.camera->to_world * inverse(frame * other_turn);
      else if (!has_pose)  // a pose that is told takes the points to the world as they are
        motion = inverse(turn) * other_turn;
      break;
  }
  return motion && !is_identity(*motion) ? motion : std::nullopt;
}

// Returns the mistake and its cure: "if ...: ...".
std::string words_of(const Suspicion& suspicion, const PlacedScene& place,
                     const SceneSource& source) {
  const std::string tool = source.are_frames ? "" : "vpm-normals ";
  switch (suspicion.mistake) {
    case Mistake::poses_inverted:
      return "if the poses are inverted: a pose must map the tool's coordinates to the world's";
    case Mistake::camera_inverted:
      return "if the camera's pose is inverted: " +
             (source.are_frames ? "it" : tool + "--camera-pose") +
             " must map the camera's coordinates to the world's";
    case Mistake::poses_of_camera:
      return "if the poses are in the camera's frame: " +
             (source.are_frames ? "they must be in the world's"
                                : "leave " + tool + "--camera-pose out");
    case Mistake::camera_w_first:
      return "if the quaternion of the camera's pose begins with w: " +
             (source.are_frames ? "it must be" : "give " + tool + "--camera-pose") +
             " tx,ty,tz,qx,qy,qz,qw";
    case Mistake::axes:
      break;
  }
  const std::string axes = name_of(suspicion.axes);
  const bool needs_pose = place.scene.camera && is_identity(place.scene.camera->to_world);
  return "if the " + std::string(place.scene.camera ? "camera" : "cloud") + " has the axes of " +
         axes + ": give " + tool + "--axes " + axes +
         (needs_pose ? " --camera-pose 0,0,0,0,0,0,1" : "");
}

}  // namespace

CheckedScene checked_scene(const Cloud& cloud) {
  CheckedScene scene{cloud.origin, cloud.positions, std::nullopt};
  if (cloud.sensor) scene.camera = cloud.sensor->camera;
  return scene;
}

CheckedScene checked_scene(const ImportedScan& scan) {
  if (!scan.image) return checked_scene(scan.points);
  const auto& [camera, depth] = *scan.image;
  CheckedScene scene{camera.to_world.translation, {}, camera};
  const Intrinsics& k = camera.intrinsics;
  const std::size_t every = depth.depth.size() / kMostPixels + 1;
  for (std::size_t at = 0; at < depth.depth.size(); at += every) {
    const double z = depth.depth[at];
    if (!is_measured(depth.depth[at])) continue;
    const double u = static_cast<double>(at % depth.width),
                 v = static_cast<double>(at / depth.width);
    const Vec3 ray{(u - k.cx) / k.fx, (v - k.cy) / k.fy, 1};
    scene.positions.push_back(narrow(camera.to_world.rotation * (z * ray)));
  }
  return scene;
}

SceneSource source_of(const Cloud& cloud) {
  SceneSource source;
  if (!cloud.provenance.is_object() || !cloud.provenance.contains("parameters")) return source;
  const nlohmann::json& told = cloud.provenance["parameters"];
  if (!told.is_object()) return source;
  if (told.contains("axes") && told["axes"].is_string())
    source.axes = axes_named(told["axes"].get<std::string>()).value_or(source.axes);
  if (cloud.sensor || !told.contains("camera-pose")) return source;
  try {
    source.points_to_world = pose_from_text(told["camera-pose"].dump());
  } catch (const Error&) {  // it was not this program's vpm-normals that wrote it
  }
  return source;
}

SetupCheck::SetupCheck(const Tool& tool, std::span<const ToolModel> models,
                       std::span<const Vec3f> positions, SceneSource source, SceneOf scene_of)
    : tool_(tool), source_(std::move(source)), scene_of_(std::move(scene_of)) {
  const double scene = diagonal_of(positions);
  for (const ToolModel& model : models) {
    constexpr double kMuch = 100;
    tools_.push_back({model.center_of_mass, model.reach});
    const double size = 2 * model.reach;
    if (scene > 0 && (size > kMuch * scene || scene > kMuch * size)) {
      doubts_sizes_ = true;
      tool_.warn("the tool is " + metres_text(size) + " across and the scene " +
                 metres_text(scene) +
                 ": is one of them in other units than metres? vpm-pack --scale and " +
                 (source_.are_frames ? "" : "vpm-normals ") + "--unit tell them");
    }
  }
}

void SetupCheck::see(const Pose& pose, std::size_t k, const Result& result, std::size_t scene) {
  has_touched_ = has_touched_ || result.volume > 0 || result.boundary > 0 || result.inside > 0;
  if (!has_touched_) kept_.add({pose, k, scene});
}

std::map<std::size_t, PlacedScene> SetupCheck::places() const {
  std::set<std::size_t> scenes;
  for (const Kept& kept : kept_.kept()) scenes.insert(kept.scene);
  const std::size_t every = (scenes.size() + kMostScenes - 1) / kMostScenes;
  std::map<std::size_t, PlacedScene> places;
  std::size_t number = 0;
  for (const std::size_t scene : scenes) {
    if (number++ % every != 0) continue;
    PlacedScene place(scene_of_(scene));
    if (!place.scene.positions.empty()) places.emplace(scene, std::move(place));
  }
  return places;
}

PoseFit SetupCheck::fit_of(const std::map<std::size_t, PlacedScene>& places,
                           const std::optional<Suspicion>& suspicion) const {
  PoseFit fit;
  for (const Kept& kept : kept_.kept()) {
    const auto found = places.find(kept.scene);
    if (found == places.end()) continue;
    const PlacedScene& place = found->second;
    const auto motion = suspicion ? motion_of(*suspicion, place, source_) : Pose{};
    if (!motion) continue;
    const bool inverts = suspicion && suspicion->mistake == Mistake::poses_inverted;
    const Pose pose = inverts ? inverse(kept.pose) : kept.pose;
    const auto& [center, radius] = tools_[kept.tool];
    place.count({*motion * (pose * center), radius}, fit);
  }
  return fit;
}

// Returns the mistakes that would explain it, with their cures. Names those that put the tool to
// the surface at more than half as many poses as the best of them: fewer are no match for it.
std::string SetupCheck::hint(const std::map<std::size_t, PlacedScene>& places) const {
  std::vector<Suspicion> suspicions{{Mistake::poses_inverted},
                                    {Mistake::camera_inverted},
                                    {Mistake::poses_of_camera},
                                    {Mistake::camera_w_first}};
  for (const CameraAxes axes : {CameraAxes::opengl, CameraAxes::ros, CameraAxes::opencv})
    suspicions.push_back({Mistake::axes, axes});
  std::vector<PoseFit> fits;
  PoseFit best;
  for (const Suspicion& suspicion : suspicions) {
    fits.push_back(fit_of(places, suspicion));
    best.near = std::max(best.near, fits.back().near);
    best.touching = std::max(best.touching, fits.back().touching);
  }
  std::string hint;
  for (std::size_t k = 0; k < fits.size(); ++k) {
    const bool fits_well =
        best.touching > 0 ? 2 * fits[k].touching > best.touching : 2 * fits[k].near > best.near;
    if (fits_well)
      hint += (hint.empty() ? "; it would be there " : "; or ") +
              words_of(suspicions[k], places.begin()->second, source_);
  }
  return hint.empty() ? "; are poses and scene in the same frame and unit?" : hint;
}

void SetupCheck::warn_at_end() const {
  if (has_touched_ || kept_.kept().empty()) return;
  const std::map<std::size_t, PlacedScene> places = this->places();
  const PoseFit now = fit_of(places, std::nullopt);
  if (places.empty() || now.near > 0) return;
  const bool are_behind = std::ranges::all_of(kept_.kept(), [&](const Kept& kept) {
    const auto place = places.find(kept.scene);
    if (place == places.end()) return true;
    const auto& [center, radius] = tools_[kept.tool];
    return place->second.is_behind({kept.pose * center, radius});
  });
  const char* const what = now.in_view > 0 ? "at no pose is the tool within its size of the surface"
                           : are_behind    ? "at every pose the tool is behind the camera"
                                           : "at no pose is the tool in the camera's view";
  tool_.warn(what + hint(places));
}

}  // namespace vpm::tools
