#include "libvpm/setup/pose_check.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "libvpm/cloud/kd_tree.h"

namespace vpm {
namespace {

constexpr std::size_t kMostScenes = 64;  // chosen from those that the kept poses were in

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
enum class Mistake {
  poses_inverted,
  poses_of_camera,       // in the camera's frame, not the world's
  poses_w_first,         // their quaternions begin with w
  poses_in_millimetres,  // their translations
  camera_inverted,
  camera_w_first,
  camera_in_millimetres,
  all_in_millimetres,  // poses and the camera's pose
  axes
};

struct Suspicion {
  Mistake mistake = Mistake::axes;
  CameraAxes axes = CameraAxes::opencv;  // those that the scene would have
};

// Scene with the search tree of its points and its size, by which poses of the tool are judged.
struct PlacedScene {
  explicit PlacedScene(CheckedScene s)
      : scene(std::move(s)), tree(scene.positions), size(size_of(scene)) {}

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
  // True if a length is so far beyond the scene that it may be told in millimetres.
  bool is_far(Vec3 translation, double radius) const {
    constexpr double kFar = 20;  // times the scene and the tool: real poses stay nearer
    return norm(translation) > kFar * (size + radius);
  }

  CheckedScene scene;
  KdTree tree;
  double size;  // m
};

namespace {

constexpr double kMillimetre = 0.001;

// Returns the pose whose quaternion was written with w first, and read with w last.
Pose with_w_first(const Pose& read) {
  const Quaternion q = quaternion_from_rotation(read.rotation);
  return {rotation_from_quaternion({q.y, q.z, q.w, q.x}), read.translation};
}

Pose in_millimetres(const Pose& pose) {
  return {pose.rotation, kMillimetre * pose.translation};
}

// Returns the tool's pose, if the mistake is put right; nothing where it cannot have been made.
std::optional<Pose> mended_pose(const Suspicion& suspicion, const PlacedScene& place,
                                const Pose& pose, double radius) {
  switch (suspicion.mistake) {
    case Mistake::poses_inverted:
      return inverse(pose);
    case Mistake::poses_w_first:
      return with_w_first(pose);
    case Mistake::poses_in_millimetres:
    case Mistake::all_in_millimetres:
      if (!place.is_far(pose.translation, radius)) return std::nullopt;
      return in_millimetres(pose);
    default:
      return pose;
  }
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
    case Mistake::poses_w_first:
    case Mistake::poses_in_millimetres:
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
    case Mistake::camera_in_millimetres:
    case Mistake::all_in_millimetres:
      if (place.is_far(frame.translation, 0)) motion = frame * inverse(in_millimetres(frame));
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

// Returns what would bring the tool to the scene: "with ...", as short as can be.
std::string words_of(const Suspicion& suspicion, const PlacedScene& place,
                     const SceneSource& source) {
  const std::string import = source.are_frames ? "" : "`import_cloud` ";
  const std::string camera = source.are_frames ? "the camera's pose" : import + "`camera_pose`";
  switch (suspicion.mistake) {
    case Mistake::poses_inverted:
      return "inverse poses (from tool to world)";
    case Mistake::poses_of_camera:
      return source.are_frames ? "poses in the world's frame, not the camera's"
                               : "no " + camera + ", if poses are in the camera's frame";
    case Mistake::poses_w_first:
      return "poses whose quaternions end in w, not begin";
    case Mistake::poses_in_millimetres:
      return "x, y, z of the poses divided by 1000, if they are millimetres";
    case Mistake::camera_inverted:
      return "the inverse of " + camera + " (from camera to world)";
    case Mistake::camera_w_first:
      return camera + " as tx,ty,tz,qx,qy,qz,qw (w last)";
    case Mistake::camera_in_millimetres:
      return "x, y, z of " + camera + " divided by 1000, if they are millimetres";
    case Mistake::all_in_millimetres:
      return "x, y, z of the poses and " + camera + " divided by 1000, if in millimetres";
    case Mistake::axes:
      break;
  }
  const bool needs_pose = place.scene.camera && is_identity(place.scene.camera->to_world);
  return import + "`axes` " + name_of(suspicion.axes) +
         (needs_pose ? " `camera_pose` 0,0,0,0,0,0,1" : "");
}

bool is_of_millimetres(Mistake mistake) {
  return mistake == Mistake::poses_in_millimetres || mistake == Mistake::camera_in_millimetres ||
         mistake == Mistake::all_in_millimetres;
}

std::vector<Suspicion> all_suspicions() {
  std::vector<Suspicion> suspicions;
  for (const Mistake mistake :
       {Mistake::poses_inverted, Mistake::camera_inverted, Mistake::poses_of_camera,
        Mistake::poses_in_millimetres, Mistake::all_in_millimetres, Mistake::camera_in_millimetres,
        Mistake::camera_w_first, Mistake::poses_w_first})
    suspicions.push_back({mistake});
  for (const CameraAxes axes : {CameraAxes::opengl, CameraAxes::ros, CameraAxes::opencv})
    suspicions.push_back({Mistake::axes, axes});
  return suspicions;
}

}  // namespace

PoseCheck::PoseCheck(std::span<const ToolModel* const> tools, SceneSource source, SceneOf scene_of)
    : source_(std::move(source)), scene_of_(std::move(scene_of)) {
  for (const ToolModel* const model : tools)
    tools_.push_back({model->center_of_mass, model->radius});
}

void PoseCheck::see(const Pose& pose, std::size_t k, const Result& result, std::size_t scene) {
  const bool is_inside = result.volume > 0 || result.inside > 0;
  const bool is_buried = is_inside && result.boundary == 0 && result.inside > 0;
  has_touched_ = has_touched_ || result.boundary > 0 || (is_inside && !is_buried);
  has_buried_ = has_buried_ || is_buried;
  if (!has_touched_) kept_.add({pose, k, scene});
}

std::map<std::size_t, PlacedScene> PoseCheck::places() const {
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

PoseFit PoseCheck::fit_of(const std::map<std::size_t, PlacedScene>& places,
                          const std::optional<Suspicion>& suspicion) const {
  PoseFit fit;
  for (const Kept& kept : kept_.kept()) {
    const auto found = places.find(kept.scene);
    if (found == places.end()) continue;
    const PlacedScene& place = found->second;
    const auto& [center, radius] = tools_[kept.tool];
    const auto motion = suspicion ? motion_of(*suspicion, place, source_) : Pose{};
    const auto pose = suspicion ? mended_pose(*suspicion, place, kept.pose, radius) : kept.pose;
    if (motion && pose) place.count({*motion * (*pose * center), radius}, fit);
  }
  return fit;
}

// Names at most two mistakes, since more is a guess: those that put the tool to the surface at more
// than half as many poses as the best of them; fewer are no match for it. Of a tool that was inside
// unseen space, as it may be meant to be, only lengths that are far beyond the scene are doubted.
std::string PoseCheck::hint(const std::map<std::size_t, PlacedScene>& places) const {
  using Fitting = std::pair<PoseFit, Suspicion>;
  std::vector<Fitting> fitting;
  for (const Suspicion& suspicion : all_suspicions()) {
    if (has_buried_ && !is_of_millimetres(suspicion.mistake)) continue;
    if (const PoseFit fit = fit_of(places, suspicion); fit.near > 0)
      fitting.push_back({fit, suspicion});
  }
  std::ranges::stable_sort(fitting, [](const Fitting& a, const Fitting& b) {
    return std::pair(a.first.touching, a.first.near) > std::pair(b.first.touching, b.first.near);
  });
  if (fitting.empty()) return "";
  const auto words = [&](const Fitting& mistake) {
    return "with " + words_of(mistake.second, places.begin()->second, source_);
  };
  const PoseFit& best = fitting.front().first;
  const bool has_other = fitting.size() > 1 && [&](const PoseFit& other) {
    return best.touching > 0 ? 2 * other.touching > best.touching : 2 * other.near > best.near;
  }(fitting[1].first);
  return "; it would be there " + words(fitting[0]) +
         (has_other ? ", or " + words(fitting[1]) : "");
}

bool PoseCheck::are_all_behind(const std::map<std::size_t, PlacedScene>& places) const {
  return std::ranges::all_of(kept_.kept(), [&](const Kept& kept) {
    const auto place = places.find(kept.scene);
    if (place == places.end()) return true;
    const auto& [center, radius] = tools_[kept.tool];
    return place->second.is_behind({kept.pose * center, radius});
  });
}

std::optional<Remark> PoseCheck::remark() const {
  if (has_touched_ || kept_.kept().empty()) return std::nullopt;
  const std::map<std::size_t, PlacedScene> places = this->places();
  const PoseFit now = fit_of(places, std::nullopt);
  if (places.empty() || now.near > 0) return std::nullopt;
  const char* const what = now.in_view > 0 ? "at no pose is the tool within its size of the surface"
                           : are_all_behind(places) ? "at every pose the tool is behind the camera"
                                                    : "at no pose is the tool in the camera's view";
  const std::string open_question = "; are poses and scene in the same frame and unit?";
  const std::string cures = hint(places);
  if (cures.empty() && has_buried_) return std::nullopt;
  return Remark{true, what + (cures.empty() ? open_question : cures)};
}

}  // namespace vpm
