// How much of a tool is inside a cloud's solid, and which wrench pushes it out.
//
//   const ToolModel tool = read_tool_model("tool.vpmg");
//   const PreparedCloud cloud(read_cloud("scene.vpmc"));   // once per frame
//   Query query(tool, {});
//   const Result r = query.run(cloud, pose);               // a thousand times a second
//
// The tool must outlive its queries. A Query belongs to one thread at a time (it may use several
// inside); tools and clouds may be shared. run() of one pose allocates nothing after the first call
// on a cloud with one thread; several take what their scheduler needs for its tasks, and lists of
// what they hand to each other grow with the contact. The same input gives the same bits, whatever
// the device, the number of threads and the order of the points: README.md states the domain of
// that promise.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "libvpm/query/device_measure.h"
#include "libvpm/query/measure_paper.h"
#include "libvpm/query/measure_refined.h"
#include "libvpm/query/query_options.h"
#include "libvpm/surface/depth_frames.h"

namespace vpm {

class Query {
 public:
  // Throws Error(unavailable) where the device is not there or too small, Error(invalid_argument) where the
  // model has no such level, coherence is asked of another measure or device, or solid shadows of
  // another measure, the stiffness is not positive or so large that forces overflow, or a device is
  // to stand by for too long. The model must be one that validate() of tool_model.h accepts.
  Query(const ToolModel& tool, const QueryOptions& options);

  // `pose` maps tool to world coordinates; a rotation that is rounded is taken for the nearest one
  // (exact_rotation). Throws Error(refused) for one that is not finite, not rigid (tolerance
  // kRotationRounding) or further than kLargestLength from the origin, and where shadows are to be
  // solid of points without a camera.
  Result run(const PreparedCloud& cloud, const Pose& pose);

  // The results of many poses, in their order: the bits of one by one, but a device takes thousands
  // at once.
  void run(const PreparedCloud& cloud, std::span<const Pose> poses, std::span<Result> results);

  // The same on a frame of depth_frames.h, which must have been made for the query's device to be
  // used where it lies.
  Result run(const DepthFrame& frame, const Pose& pose);
  void run(const DepthFrame& frame, std::span<const Pose> poses, std::span<Result> results);

  // Many poses of several tools, each with a query of its own; `queries` were made with the same
  // options, but for level and stiffness. The bits of one by one; a device takes thousands of poses
  // of up to 16 tools in one launch, of the measure as printed in one for each tool. Throws
  // Error(invalid_argument) where options differ, or a pose has no such tool.
  static void run_together(std::span<Query* const> queries, const PreparedCloud& cloud,
                           std::span<const ToolPose> poses, std::span<Result> results);
  static void run_together(std::span<Query* const> queries, const DepthFrame& frame,
                           std::span<const ToolPose> poses, std::span<Result> results);

  // Of coherent poses: the next one does not follow from the last.
  void forget();

  const Level& level() const { return level_; }
  // Of the last run of one pose, one per sphere of the level; from a device they are fetched here.
  // A batch leaves them undefined.
  std::span<const SphereState> states() const;

 private:
  void check_cloud(const PreparedCloud& cloud) const;
  static void check_together(std::span<Query* const> queries, std::span<const ToolPose> poses,
                             std::span<Result> results);
  template <class OnDevice>
  void run_batch(const PreparedCloud* cloud, std::span<const Pose> poses, std::span<Result> results,
                 const OnDevice& on_device);
  template <class Scene, class OnDevice>
  static void run_tools(std::span<Query* const> queries, const Scene& scene,
                        std::span<const ToolPose> poses, std::span<Result> results,
                        const OnDevice& on_device);
  void finish(Result& result) const;

  const Level& level_;
  QueryOptions options_;
  std::unique_ptr<PaperMeasure> paper_;
  std::unique_ptr<RefinedMeasure> refined_;
  std::unique_ptr<DeviceMeasure> device_;
  std::vector<Pose> sound_;  // of a batch
  mutable std::vector<SphereState> states_;
};

}  // namespace vpm
