// What kernels see of a tool and a pose: plain pointers and numbers.
#pragma once

#include <cstdint>

#include "libvpm/backend/cell_clusters.h"
#include "libvpm/backend/sphere_location.h"
#include "libvpm/measure/cell_measure.h"
#include "libvpm/scene/cuda/cloud_views.h"
#include "libvpm/scene/depth/depth_surface.h"
#include "libvpm/scene/pixel_rectangle.h"
#include "libvpm/scene/points/disk_surface.h"

namespace vpm::cuda {

struct alignas(32) TaskBall {
  Vec3 center;  // about the centre of mass
  double radius = 0;
};

// One block of a share, or a share that has none: what is classified by itself. All that this needs
// lies together, since it is read once, by lanes that wait for it.
struct alignas(32) BlockTask {
  enum Ball { of_cell, of_block, of_sphere, kBalls };
  enum Flag : std::uint32_t {
    is_head = 1,     // the first of its share
    is_compact = 2,  // its share is (cell_clusters.h)
    has_block = 4,
  };
  TaskBall balls[kBalls];
  std::uint32_t cell = 0, block = 0, begin = 0, end = 0;  // samples of the block
  std::uint32_t flags = 0;
};

// Units of one cluster that are classified together.
struct TaskGroup {
  static constexpr unsigned kTasks = 8;
  TaskBall ball;  // of the cluster
  std::uint32_t begin = 0, end = 0;
};

// A unit, and what of it may be taken whole.
struct WarpTask : BlockTask {
  BlockMass block_mass, cell_mass;
};

// Levels of more spheres have more chunks than any device has warps at once.
inline constexpr std::uint32_t kSpheresOfWarps = 8192;

// The units of a small level, for warps that take one chunk each: of few units that are wide, of
// more samples than kNarrow, or of more others. Where there are fewer, room is left behind them for
// such as are nothing.
struct WarpTaskGroups {
  static constexpr unsigned kWideTasks = 2;
  static constexpr std::uint32_t kNarrow = 8;

  const WarpTask* units = nullptr;
  const TaskGroup* chunks = nullptr;
  std::uint32_t count = 0,
                wide_count = 0;  // wide ones come first; none of a level that is not small
};

// An edge of the graph; the spheres' indices.
struct Edge {
  std::uint32_t larger, smaller;
};

// One level of a tool.
struct LevelView {
  std::uint32_t count = 0, task_group_count = 0, edge_count = 0;  // `count` of spheres
  std::uint32_t piece_count = 0;  // samples, blocks and shares: no query finds more
  const Sphere* spheres = nullptr;
  const Vec3* centers = nullptr;  // of the spheres, about the centre of mass
  const double* reach = nullptr;  // of the shares
  const std::uint32_t* block_begin = nullptr;
  const CellBlock* blocks = nullptr;
  const BlockMass* block_masses = nullptr;
  const BlockMass* cell_masses = nullptr;
  const CellSample* samples = nullptr;
  const BlockTask* units = nullptr;
  const TaskGroup* chunks = nullptr;
  WarpTaskGroups of_warps;
  const Edge* edges = nullptr;                // by their larger index
  const std::uint32_t* edge_begin = nullptr;  // count + 1
  GridView grid;
  Vec3 center_of_mass;
  ToolReach tool_reach;
  double spheres_reach = 0;  // no point of a sphere is further from the centre of mass

  VPM_HD CellView cell(std::uint32_t i) const {
    return {blocks,     block_masses, samples, block_begin[i], block_begin[i + 1],
            centers[i], reach[i]};
  }
};

// A pose, as the parts of a query need it.
struct PoseFrame {
  Pose to_surface;        // from coordinates about the centre of mass
  Pose to_tool;           // from coordinates about the cloud's origin
  Vec3 center;            // of mass, about the cloud's origin
  PixelRectangle pixels;  // that the tool can reach; of organised clouds
};

VPM_HD inline PoseFrame frame_of(const Pose& pose, const CloudFrame& cloud, Vec3 center_of_mass,
                                 double spheres_reach) {
  PoseFrame frame;
  const Pose from_center_of_mass{pose.rotation, pose * center_of_mass};
  const Pose surface = cloud.is_organised ? cloud.camera_to_world : Pose{{}, cloud.origin};
  frame.to_surface = relative_to(surface, from_center_of_mass);
  frame.to_tool = relative_to(pose, {{}, cloud.origin});
  frame.center = pose.rotation * center_of_mass + (pose.translation - cloud.origin);
  if (cloud.is_organised) {
    const Vec3 at = relative_to(cloud.camera_to_world, {{}, cloud.origin}) * frame.center;
    frame.pixels =
        rectangle_of_ball(cloud.intrinsics, cloud.width, cloud.height, at, spheres_reach);
  }
  return frame;
}

// The answer of a kernel, before it is turned into world axes.
struct RawResult {
  ToolSum sum;
  std::uint32_t boundary = 0, inside = 0, points = 0;
  std::uint32_t flood_ns = 0;  // of one pose: what came after the boundary was known
};

inline Result result_of(const RawResult& raw, const ToolModel& tool,
                        const Rotation& tool_to_world) {
  Result result;
  raw.sum.write(tool, tool_to_world, result);
  result.boundary = raw.boundary;
  result.inside = raw.inside;
  result.points = raw.points;
  return result;
}

}  // namespace vpm::cuda
