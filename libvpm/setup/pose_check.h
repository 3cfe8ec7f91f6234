// Finds tools that no pose brings to the scene, which mistakes in poses and frames cause.
#pragma once

#include <vpm/query_types.h>
#include <vpm/remark.h>

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libvpm/model/tool_model.h"
#include "libvpm/setup/checked_scene.h"
#include "libvpm/setup/even_sample.h"

namespace vpm {

// Ball that holds a tool: in the tool's own coordinates, or at a pose in the world's.
struct ToolBall {
  Vec3 center;
  double radius = 0;  // m
};

struct PlacedScene;
struct PoseFit;
struct Suspicion;

class PoseCheck {
 public:
  // Returns the scene of this number. Called by remark(), and only where no tool touched any.
  using SceneOf = std::function<CheckedScene(std::size_t)>;

  PoseCheck(std::span<const ToolModel* const> tools, SceneSource source, SceneOf scene_of);

  // Notes the answer at a pose of the k-th tool in a scene.
  void see(const Pose& pose, std::size_t k, const Result& result, std::size_t scene = 0);
  // Returns a warning if at no pose a tool was in the camera's view, or none came near the surface.
  // It names the mistakes whose correction would bring it there.
  std::optional<Remark> remark() const;

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
  // Returns the mistakes that would explain it, with their cures; "" if none does.
  std::string hint(const std::map<std::size_t, PlacedScene>& places) const;
  bool are_all_behind(const std::map<std::size_t, PlacedScene>& places) const;

  SceneSource source_;
  SceneOf scene_of_;
  std::vector<ToolBall> tools_;  // in their own coordinates
  EvenSample<Kept> kept_;
  bool has_touched_ = false;
  bool has_buried_ = false;  // a tool that the surface does not cut was inside, such as in shadows
};

}  // namespace vpm
