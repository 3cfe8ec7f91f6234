// Defines the shared lists of a block's threads that classify and measure cells: block tasks to be
// classified, and pieces to be measured.
#pragma once

#include "libvpm/backend/cuda/cell_notes.h"
#include "libvpm/measure/classify.h"

namespace vpm::cuda {

// Lists pieces of a cell to be measured together.
struct Task {
  enum Form : std::uint32_t { samples, block, whole_block, whole_cell };

  std::uint32_t cell;
  Form form;
  std::uint32_t begin, count;  // samples; otherwise `begin` is the block or cell

  __device__ bool is_whole() const { return form == whole_block || form == whole_cell; }
};

// Lists of tasks by how warps measure them. Wide tasks have more than kNarrow samples.
struct TaskLists {
  enum List { samples_wide, samples_narrow, flat_wide, pieces, flat_narrow, kLists };
  static constexpr unsigned kTasks = 352;                               // room in a list
  static constexpr unsigned kNarrow = 8, kWide = 32, kFlat = kSumRows;  // lanes

  Task tasks[kLists][kTasks];
  unsigned counts[kLists];
  unsigned next_bundle;

  __device__ static unsigned width(unsigned list) {
    return list == pieces ? 1 : list == samples_wide ? kWide : list == flat_wide ? kFlat : kNarrow;
  }
  __device__ static bool is_flat(unsigned list) { return list == flat_wide || list == flat_narrow; }
  __device__ unsigned add(unsigned list, const Task& task) {
    const unsigned slot = atomicAdd(&counts[list], 1U);
    tasks[list][slot] = task;
    return slot;
  }
};

// Packs a block task to be classified: its index in a task group, the slot of the threads that
// classified that, and the cluster's class.
struct SeenTask {
  std::uint16_t bits;

  __device__ static SeenTask of(unsigned slot, unsigned task, ClusterClass seen) {
    return {static_cast<std::uint16_t>(static_cast<unsigned>(seen) << 11 | slot << 3 | task)};
  }
  __device__ ClusterClass seen() const { return static_cast<ClusterClass>(bits >> 11); }
  __device__ unsigned slot() const { return bits >> 3 & 255U; }
  __device__ unsigned task() const { return bits & 7U; }
  __device__ Side side() const {
    return seen() == ClusterClass::ambiguous    ? Side::ambiguous
           : seen() == ClusterClass::no_surface ? Side::no_surface
                                                : Side::behind;
  }
};
inline constexpr unsigned kMeasureThreads = kThreads > kBatchThreads ? kThreads : kBatchThreads;
static_assert(kMeasureThreads <= kMostThreads && kMostThreads <= 256 && TaskGroup::kTasks <= 8);

// Lays out a block's shared memory.
struct MeasureShared {
  static constexpr unsigned kSeen = kMeasureThreads * TaskGroup::kTasks;
  SeenTask seen[kSeen];  // not planar from the front, of cut clusters from the end
  unsigned seen_count, clipped_count;
  std::uint32_t pushed[kMeasureThreads];  // task groups of uniform clusters
  unsigned pushed_count;
  std::uint32_t first_units[kMeasureThreads];  // first block task of each slot's group
  TaskLists lists;
};

}  // namespace vpm::cuda
