// Finds tools that no pose brings to the scene, which mistakes of units and poses cause.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libvpm/cloud/cloud.h"
#include "libvpm/import/import_cloud.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/query/tool_query.h"
#include "tools/common/tool.h"
#include "tools/query/even_sample.h"

namespace vpm::tools {

// Ball about a tool, in world coordinates.
struct ToolBall {
  Vec3 center;
  double radius = 0;  // m
};

// Points and camera that a pose is compared with.
struct CheckedScene {
  Vec3 origin;                   // world
  std::vector<Vec3f> positions;  // about the origin
  std::optional<Camera> camera;  // empty for points without one
};

// Return the scene of a cloud, and that of a scan: of an image some ten thousand pixels.
CheckedScene checked_scene(const Cloud& cloud);
CheckedScene checked_scene(const ImportedScan& scan);

// Tells how the scene came to its place, which decides what else may be tried.
struct SceneSource {
  CameraAxes axes = CameraAxes::opencv;
  // Pose that was given for the frame of points without a camera; images know their camera's.
  std::optional<Pose> points_to_world;
  bool are_frames = false;  // scenes are recorded frames, which this run reads itself
};

// Returns the source of a cloud that vpm-normals wrote, as far as its provenance tells it.
SceneSource source_of(const Cloud& cloud);

struct PlacedScene;
struct PoseFit;
struct Suspicion;

class SetupCheck {
 public:
  // Returns the scene of this number. Called at the end, and only where no tool touched any.
  using SceneOf = std::function<CheckedScene(std::size_t)>;

  // Warns if a tool and the scene, whose points are `positions`, differ 100 times in size.
  SetupCheck(const Tool& tool, std::span<const ToolModel> models, std::span<const Vec3f> positions,
             SceneSource source, SceneOf scene_of);

  // Notes the answer at a pose of the k-th tool in a scene.
  void see(const Pose& pose, std::size_t k, const Result& result, std::size_t scene = 0);
  // Warns if at no pose a tool was in the camera's view, or none came near the surface, and says
  // what else would bring it there.
  void warn_at_end() const;
  // True if a tool and the scene differ so much in size that this was warned of.
  bool doubts_sizes() const { return doubts_sizes_; }

 private:
  // Pose that is kept, of a tool in a scene.
  struct Kept {
    Pose pose;
    std::size_t tool = 0, scene = 0;
  };

  // Returns the scenes of the kept poses that have points, by number; of many every n-th.
  std::map<std::size_t, PlacedScene> places() const;
  // Counts the poses that are at the scene, as it is or if a mistake were put right.
  PoseFit fit_of(const std::map<std::size_t, PlacedScene>& places,
                 const std::optional<Suspicion>& suspicion) const;
  std::string hint(const std::map<std::size_t, PlacedScene>& places) const;

  const Tool& tool_;
  SceneSource source_;
  SceneOf scene_of_;
  std::vector<ToolBall> tools_;  // in their own coordinates
  EvenSample<Kept> kept_;
  bool has_touched_ = false, doubts_sizes_ = false;
};

}  // namespace vpm::tools
