// Defines a tool and a pose as kernels take them: plain pointers and numbers.
#pragma once

#include <cstdint>
#include <type_traits>

#include "libvpm/backend/cell_clusters.h"
#include "libvpm/measure/body_sum.h"
#include "libvpm/measure/cell_measure.h"
#include "libvpm/scene/depth/depth_sampler.h"
#include "libvpm/scene/depth/depth_surface.h"
#include "libvpm/scene/points/disk_surface.h"

namespace vpm::cuda {

// A ball about a cell, a block or a cluster of the tool.
struct alignas(32) TaskBall {
  Vec3 center;  // about the tool's centre of mass, m
  double radius = 0;
};

// Describes one block of a cell, or a cell without blocks, to be classified. Its data lie together,
// since waiting lanes read them once.
struct alignas(32) BlockTask {
  enum Ball { of_cell, of_block, kBalls };
  enum Flag : std::uint32_t {
    is_head = 1,     // the first of its cell
    is_compact = 2,  // is_compact() is true of its cell
    has_block = 4,
  };
  TaskBall balls[kBalls];
  std::uint32_t cell = 0, block = 0, begin = 0, end = 0;  // begin, end: samples of the block
  std::uint32_t flags = 0;
};

// Returns what a block task of a cell wholly behind the surface stands for.
VPM_HD constexpr WholePart whole_part_of(std::uint32_t flags) {
  return whole_part((flags & BlockTask::is_compact) != 0, (flags & BlockTask::is_head) != 0,
                    (flags & BlockTask::has_block) != 0);
}

// Groups block tasks of one cluster that are classified together.
struct TaskGroup {
  static constexpr unsigned kTasks = 8;
  TaskBall ball;  // the cluster's, about the tool's centre of mass
  std::uint32_t begin = 0, end = 0;
  ToolSum::Sum weight;  // volume that the tasks stand for (WholePart), in parts of the tool's
};

// A block task with the masses of its block and cell, which a warp loads with it.
struct WarpTask : BlockTask {
  BlockMass block_mass, cell_mass;
};

// Most spheres of a level whose task groups get a warp each. Larger levels have more groups than
// any device has warps at once.
inline constexpr std::uint32_t kSpheresOfWarps = 8192;

// Lists the block tasks of a small level for warps that take one group each: kWideTasks tasks with
// more than kNarrow samples, or TaskGroup::kTasks others. Tasks without flags fill groups up.
struct WarpTaskGroups {
  static constexpr unsigned kWideTasks = 2;
  static constexpr std::uint32_t kNarrow = 8;

  const WarpTask* tasks = nullptr;
  const TaskGroup* groups = nullptr;
  std::uint32_t count = 0,
                wide_count = 0;  // groups of wide tasks, which come first; 0 for a large level
};

// An edge of the sphere graph, by the indices of its two spheres.
struct Edge {
  std::uint32_t larger, smaller;
};

// Lists the clusters of a level and the tree of their groups.
struct ClustersView {
  const CellCluster* all = nullptr;
  std::uint32_t count = 0;
  const std::uint32_t* cells = nullptr;  // of their rows
  const GroupTreeNode* tree = nullptr;
};

// Points to one level of a tool.
struct LevelView {
  std::uint32_t count = 0, task_group_count = 0, edge_count = 0;  // count: spheres
  std::uint32_t piece_count = 0;  // samples, blocks and cells: bounds what a query finds
  const Sphere* spheres = nullptr;
  const Vec3* centers = nullptr;        // the spheres' centres, about the tool's centre of mass, m
  const double* cell_radius = nullptr;  // bounding radii of the cells, m
  const std::uint32_t* block_begin = nullptr;
  const CellBlock* blocks = nullptr;
  const BlockMass* block_masses = nullptr;
  const BlockMass* cell_masses = nullptr;
  const CellSample* samples = nullptr;  // numbered_samples()
  SampleFaces faces;
  const BlockTask* block_tasks = nullptr;
  const TaskGroup* task_groups = nullptr;
  WarpTaskGroups of_warps;
  const Edge* edges = nullptr;                // ordered by their larger index
  const std::uint32_t* edge_begin = nullptr;  // edges by larger index; count + 1 entries
  const TaskBall* cluster_balls = nullptr;    // of each cell's cluster
  ClustersView clusters;
  ToolRadius tool_radius;

  VPM_HD CellView cell(std::uint32_t i) const {
    return {blocks,     block_masses,   samples, block_begin[i], block_begin[i + 1],
            centers[i], cell_radius[i], faces};
  }
};

// Holds what one thread finds, in the tool's axes.
struct ThreadResult {
  ToolSum sum;
  std::uint32_t boundary = 0, inside = 0;
};

// Holds the result of a kernel.
struct RawResult {
  ToolSum sum;
  std::uint32_t boundary = 0, inside = 0;
  UnseenSum unseen;
  std::uint32_t flood_ns = 0;  // time of one pose after the boundary was known, ns
  std::uint32_t unused = 0;    // takes the place of padding, which would be copied uninitialised
};
static_assert(std::has_unique_object_representations_v<RawResult>);

// Returns what a body with this surface gives.
template <class Surface>
BodySum sum_of(const RawResult& raw) {
  BodySum sum{raw.sum, raw.boundary, raw.inside, std::nullopt, std::nullopt};
  if (TellsSight<Surface>) sum.unseen = raw.unseen;
  if (TellsUnknown<Surface>) sum.unknown = raw.unseen.unseen;
  return sum;
}

}  // namespace vpm::cuda
