#include "tools/query/setup_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "libvpm/cloud/kd_tree.h"
#include "libvpm/core/box.h"

namespace vpm::tools {
namespace {

constexpr std::size_t kMostKept = 512;  // poses

std::string metres_text(double length) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g m", length);
  return text;
}

double diagonal_of(const std::vector<Vec3f>& points) {
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

}  // namespace

SetupCheck::SetupCheck(const Tool& tool, const Cloud& cloud, std::span<const ToolModel> models)
    : tool_(tool), origin_(cloud.origin), positions_(cloud.positions) {
  if (cloud.sensor) camera_ = cloud.sensor->camera;
  const double scene = diagonal_of(positions_);
  for (const ToolModel& model : models) {
    constexpr double kMuch = 100;
    tools_.push_back({model.center_of_mass, model.reach});
    const double size = 2 * model.reach;
    if (scene > 0 && (size > kMuch * scene || scene > kMuch * size)) {
      tool_.warn("the tool is " + metres_text(size) + " across and the scene " +
                 metres_text(scene) +
                 ": is one of them in other units than metres? vpm-pack --scale and vpm-normals "
                 "--unit tell them");
    }
  }
}

void SetupCheck::see(const Pose& pose, std::size_t k, const Result& result) {
  has_touched_ = has_touched_ || result.volume > 0 || result.boundary > 0 || result.inside > 0;
  if (seen_++ % stride_ != 0) return;
  kept_.push_back({pose, k});
  if (kept_.size() < kMostKept) return;
  for (std::size_t i = 0; 2 * i < kept_.size(); ++i) kept_[i] = kept_[2 * i];
  kept_.resize(kept_.size() / 2);
  stride_ *= 2;
}

ToolBall SetupCheck::ball(const Pose& pose, std::size_t tool) const {
  return {pose * tools_[tool].center, tools_[tool].radius};
}

bool SetupCheck::any_in_view(const Camera& camera, bool inverted) const {
  return std::any_of(kept_.begin(), kept_.end(), [&](const Kept& kept) {
    return is_in_view(ball(inverted ? inverse(kept.pose) : kept.pose, kept.tool), camera);
  });
}

bool SetupCheck::all_behind() const {
  return std::all_of(kept_.begin(), kept_.end(), [&](const Kept& kept) {
    const ToolBall tool = ball(kept.pose, kept.tool);
    return (inverse(camera_->to_world) * tool.center).z <= -tool.radius;
  });
}

// Returns the smallest distance of a tool's ball, moved by `motion`, from the points, in units of
// its diameter; negative where they overlap.
double SetupCheck::nearest_gap(bool inverted, const Pose& motion) const {
  const KdTree tree(positions_);
  double nearest = HUGE_VAL;
  for (const Kept& kept : kept_) {
    const ToolBall tool = ball(inverted ? inverse(kept.pose) : kept.pose, kept.tool);
    const Vec3 center = motion * tool.center;
    const double distance = std::sqrt(tree.squared_distance(narrow(center - origin_), 1));
    nearest = std::min(nearest, (distance - tool.radius) / (2 * tool.radius));
  }
  return nearest;
}

std::string SetupCheck::inversion_hint() const {
  const bool inverse_is_near = nearest_gap(true) <= 1;
  if (inverse_is_near && (!camera_ || any_in_view(*camera_, true)))
    return "; with the poses inverted it would be there: a pose must map the tool's coordinates to "
           "the world's";
  if (camera_) {
    Camera turned = *camera_;
    turned.to_world = inverse(turned.to_world);
    // Moves the tool instead of the points: from where the turned camera sees it, to where this one
    // has what the other one saw.
    const Pose motion = camera_->to_world * camera_->to_world;
    if (any_in_view(turned, false) &&
        (!any_in_view(*camera_, false) || nearest_gap(false, motion) <= 1))
      return "; with the camera's pose inverted it would be: vpm-normals --camera-pose must map "
             "the camera's coordinates to the world's";
  }
  return "; are poses and scene in the same frame and unit?";
}

void SetupCheck::warn_at_end() const {
  if (has_touched_ || kept_.empty() || positions_.empty()) return;
  if (camera_ && !any_in_view(*camera_, false)) {
    tool_.warn(std::string(all_behind() ? "at every pose the tool is behind the camera"
                                        : "at no pose is the tool in the camera's view") +
               inversion_hint());
    return;
  }
  const double gap = nearest_gap(false);
  if (gap > 1)
    tool_.warn("at no pose is the tool within its size of the surface" + inversion_hint());
}

}  // namespace vpm::tools
