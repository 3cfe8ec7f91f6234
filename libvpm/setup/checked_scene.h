// Declares what the checks of a setup know of a scene: where it lies, and how it came there.
#pragma once

#include <optional>
#include <vector>

#include "libvpm/cloud/camera_axes.h"
#include "libvpm/cloud/cloud.h"

namespace vpm {

// Points and camera that sizes and poses are compared with.
struct CheckedScene {
  Vec3 origin;                   // world
  std::vector<Vec3f> positions;  // about the origin, m
  double spacing = 0;            // m, median distance of neighbouring points; 0 without any
  std::optional<Camera> camera;  // empty for points without one
};

// Return the scene of a cloud; that of a depth image, of which some ten thousand pixels stand for
// all; and that of points about an origin in the world, which a camera has seen or none.
CheckedScene checked_scene(const Cloud& cloud);
CheckedScene checked_scene(const CloudSensor& image);
CheckedScene checked_scene(Vec3 origin, std::vector<Vec3f> positions,
                           const std::optional<Camera>& camera);

// Returns the size of what a scene shows, m: the diagonal of its points' box, or the distance from
// the camera to the farthest point if that is larger. 0 without points.
double size_of(const CheckedScene& scene);

// Tells how the scene came to its place, which decides what else may be tried.
struct SceneSource {
  CameraAxes axes = CameraAxes::opencv;
  // Pose that was given for the frame of points without a camera; images know their camera's.
  std::optional<Pose> points_to_world;
  bool are_frames =
      false;  // scenes are frames of a recording, whose options the caller has himself
};

// Returns the source of a cloud that import_cloud or vpm-normals made, as far as its provenance
// tells it.
SceneSource source_of(const Cloud& cloud);

}  // namespace vpm
