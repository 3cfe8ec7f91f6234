// Measures the tasks listed during classification by the warps of a block: a lane for each sample,
// each row of clipped samples, or each piece taken whole. Without a flood, each thread sums what it
// finds.
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
  enum List { samples_wide, samples_narrow, clipped_wide, pieces, clipped_narrow, kLists };
  static constexpr unsigned kTasks = 352;                                  // room in a list
  static constexpr unsigned kNarrow = 8, kWide = 32, kClipped = kSumRows;  // lanes

  Task tasks[kLists][kTasks];
  unsigned counts[kLists];
  unsigned next_bundle;

  __device__ static unsigned width(unsigned list) {
    return list == pieces         ? 1
           : list == samples_wide ? kWide
           : list == clipped_wide ? kClipped
                                  : kNarrow;
  }
  __device__ static bool is_clipped(unsigned list) {
    return list == clipped_wide || list == clipped_narrow;
  }
  __device__ unsigned add(unsigned list, const Task& task) {
    const unsigned slot = atomicAdd(&counts[list], 1U);
    tasks[list][slot] = task;
    return slot;
  }
};

// Packs a block task to be classified: its index in its task group, the slot of the threads that
// classified the group's cluster, and the class of that.
struct PendingTask {
  std::uint16_t bits;

  __device__ static PendingTask of(unsigned slot, unsigned task, ClusterClass seen) {
    return {static_cast<std::uint16_t>(static_cast<unsigned>(seen) << 11 | slot << 3 | task)};
  }
  __device__ ClusterClass seen() const { return static_cast<ClusterClass>(bits >> 11); }
  __device__ unsigned slot() const { return bits >> 3 & 255U; }
  __device__ unsigned task() const { return bits & 7U; }
  __device__ Side side() const { return side_of_cells(seen()); }
};
inline constexpr unsigned kMeasureThreads = kThreads > kBatchThreads ? kThreads : kBatchThreads;
static_assert(kMeasureThreads <= kMostThreads && kMostThreads <= 256 && TaskGroup::kTasks <= 8);

// Lays out a block's shared memory.
struct MeasureShared {
  static constexpr unsigned kSeen = kMeasureThreads * TaskGroup::kTasks;
  PendingTask seen[kSeen];  // from the front those of clusters that are not planar, from the end
                            // those of cut ones
  unsigned seen_count, clipped_count;
  std::uint32_t uniform_groups[kMeasureThreads];  // task groups of uniform clusters
  unsigned uniform_count;
  std::uint32_t first_tasks[kMeasureThreads];  // first block task of each slot's group
  TaskLists lists;
};

template <class Surface>
class TaskMeasure {
 public:
  using Measure = CellMeasure<Surface>;

  // Adds to `found`, this thread's sums.
  __device__ TaskMeasure(const PoseWork<Surface>& work, TaskLists& lists, ThreadResult& found)
      : work_(work), lists_(lists), found_(found) {}

  // Empties the lists. Call from all threads of the block.
  __device__ void clear() {
    if (threadIdx.x < TaskLists::kLists) lists_.counts[threadIdx.x] = 0;
    if (threadIdx.x == TaskLists::kLists) lists_.next_bundle = 0;
    __syncthreads();
  }
  // Makes room for this many tasks in each list. Call from all threads of the block.
  __device__ void make_room(unsigned tasks) {
    __syncthreads();
    bool room = true;
    for (unsigned k = 0; k < TaskLists::kLists; ++k)
      room &= lists_.counts[k] + tasks <= TaskLists::kTasks;
    if (__syncthreads_and(room) != 0) return;
    measure();
    __syncthreads();
    clear();
  }
  // Measures all listed tasks, by all threads of the block: warps take bundles of tasks of one
  // list, as many as fit into a warp; the slowest lists come first.
  __device__ void measure() {
    for (;;) {
      unsigned bundle = 0;
      if (threadIdx.x % 32 == 0) bundle = atomicAdd(&lists_.next_bundle, 1U);
      bundle = __shfl_sync(~0U, bundle, 0);
      unsigned list = 0;
      for (; list < TaskLists::kLists; ++list) {
        const unsigned tasks = 32 / TaskLists::width(list);
        const unsigned bundles = (lists_.counts[list] + tasks - 1) / tasks;
        if (bundle < bundles) break;
        bundle -= bundles;
      }
      if (list == TaskLists::kLists) return;
      const Subwarp subwarp(TaskLists::width(list));
      const unsigned slot = bundle * (32 / subwarp.width) + threadIdx.x % 32 / subwarp.width;
      if (slot < lists_.counts[list]) measure(subwarp, list, slot, lists_.tasks[list][slot]);
      __syncwarp();
    }
  }
  // Counts the cell noted last. Call it once, after all else.
  __device__ void finish() { count_cell(words_before_, bits_added_, found_); }

  __device__ void add(unsigned list, const Task& task) { lists_.add(list, task); }

  // Adds a block in a cluster that is cut by one plane. Lists it if the plane cuts the block too.
  __device__ void add_clipped(const BlockTask& block_task, const ClipPlane& plane) {
    const TaskBall& ball = block_task.balls[BlockTask::of_block];
    const PlaneSide side = side_of_plane(plane.distance(ball.center), ball.radius);
    const Task task{block_task.cell, Task::samples, block_task.begin,
                    block_task.end - block_task.begin};
    if (side == PlaneSide::cut) {
      const unsigned list =
          task.count <= TaskLists::kNarrow ? TaskLists::clipped_narrow : TaskLists::clipped_wide;
      // Assigns member by member, since nvcc would store the whole byte by byte.
      ClippedBlock& block = clipped_block(list, lists_.add(list, task));
      block.plane = plane;
      block.center = ball.center;
      return;
    }
    CellResult result;
    if (side == PlaneSide::behind)
      add_whole(work_.level.tool_radius, work_.level.block_masses[block_task.block], plane.normal,
                result.sum);
    note_task(task, result);
  }

  // Adds a cell wholly behind its cluster's surface, pushed along `normal`.
  __device__ void note_behind(const BlockTask& block_task, Vec3 normal) {
    ToolSum sum;
    add_whole(work_.level.tool_radius, work_.level.cell_masses[block_task.cell], normal, sum);
    if (kFloods) {
      work_.notes.sums[block_task.cell] = sum;
    } else {
      found_.sum.add(sum);
      if (counts(sum)) count(block_task.cell, cell_bit::counted);
    }
  }

 private:
  static constexpr bool kFloods = !Surface::kTellsInside;
  // Lanes of one subwarp measure neighbours.
  static_assert(TaskLists::kNarrow % kNeighborSamples == 0 &&
                TaskLists::kWide % kNeighborSamples == 0);

  __device__ ClippedBlock& clipped_block(unsigned list, unsigned slot) const {
    const unsigned row = 2 * work_.part.part + (list == TaskLists::clipped_wide);
    return work_.space.clipped_blocks[row * TaskLists::kTasks + slot];
  }

  __device__ void measure(const Subwarp& subwarp, unsigned list, unsigned slot, const Task& task) {
    const CellResult result = TaskLists::is_clipped(list)
                                  ? measure_clipped(subwarp, clipped_block(list, slot), task)
                                  : measure_pieces(subwarp, task);
    if (subwarp.leads()) note_task(task, result);
  }
  __device__ ToolPiece piece(Task::Form form, std::uint32_t k) const {
    switch (form) {
      case Task::samples:
        return piece_of(work_.level.samples[k], work_.level.faces);
      case Task::whole_cell:
        return piece_of(work_.level.cell_masses[k], work_.level.cell(k));
      default:
        return piece_of(work_.level.block_masses[k], work_.level.blocks[k]);
    }
  }

  // Adds piece `k` of a task, if it exists, as CellMeasure::run() does, or whole() for a whole
  // cell. Lists far pieces. Call from all lanes of the subwarp.
  __device__ void add_piece(const Subwarp& subwarp, const Measure& measure, const Task& task,
                            std::uint32_t k, CellResult& result) {
    const bool exists = k < task.count;
    const ToolPiece piece = this->piece(task.form, task.begin + (exists ? k : 0));
    const typename Measure::PieceSample sampled = measure.sample_piece(piece);
    const WayOut way =
        exists ? Measure::way_out(sampled, task.form == Task::samples) : WayOut::none;
    const unsigned first =
        Surface::kSearchesFoot ? first_neighbor(subwarp, way == WayOut::shared) : subwarp.lane;
    Vec3 normal;
    if (is_searched(way) && first == subwarp.lane) normal = measure.closest_normal(sampled);
    if (Surface::kSearchesFoot) normal = subwarp.from(normal, first);
    if (exists) work_.add_unseen(measure, piece, sampled);
    if (way == WayOut::none) return;
    measure.note(sampled, result);
    work_.add_inside(measure, piece, sampled, normal, task.cell, result.sum);
  }

  // Returns the first lane that shares a direction with this one; itself if it shares none.
  __device__ static unsigned first_neighbor(const Subwarp& subwarp, bool shares) {
    const unsigned sharing = subwarp.which(shares);
    return shares ? direction_leader(subwarp.lane, sharing) : subwarp.lane;
  }

  // Measures a block that is cut by one plane, a row of samples per lane. Loads each sample before
  // the last one is added. Returns the result to the first lane.
  __device__ CellResult measure_clipped(const Subwarp& subwarp, const ClippedBlock& clipped,
                                        const Task& task) {
    const ClipPlane plane = clipped.plane;
    const Vec3 center = clipped.center, cell = work_.level.centers[task.cell];
    const double radius = work_.level.cell_radius[task.cell];
    const CellSample* const samples = work_.level.samples + task.begin;
    CellSample next = samples[subwarp.lane < task.count ? subwarp.lane : 0];
    ClippedMoments row;
    bool is_at_face = false;
#pragma unroll 1
    for (std::uint32_t k = subwarp.lane; k < task.count;) {
      const CellSample sample = next;
      k += subwarp.width;
      if (k < task.count) next = samples[k];
      is_at_face |= !add_ball_to_row(sample, plane, row);
    }
    if (is_at_face) {
#pragma unroll 1
      for (std::uint32_t k = subwarp.lane; k < task.count; k += subwarp.width)
        add_face_to_row(samples[k], work_.level.faces, plane, row);
    }
    __syncwarp(subwarp.mask);
    add_up(subwarp, row);
    CellResult result;
    if (subwarp.leads()) {
      if (row.is_cut)
        work_.measure_of({.center = cell, .radius = radius, .faces = work_.level.faces})
            .add_to_plane(center, plane, result.plane);
      add_by_plane(PlaneSide::cut, {}, row, plane.normal, work_.level.tool_radius, result.sum);
    }
    return result;
  }

  // Measures the pieces of a task. Returns the result to all lanes of the subwarp.
  __device__ CellResult measure_pieces(const Subwarp& subwarp, const Task& task) {
    const std::uint32_t i = task.cell;
    const Measure measure = work_.measure_of({.samples = work_.level.samples,
                                              .center = work_.level.centers[i],
                                              .radius = work_.level.cell_radius[i],
                                              .faces = work_.level.faces});
    CellResult result;
    for (std::uint32_t begin = 0; begin < task.count; begin += subwarp.width)
      add_piece(subwarp, measure, task, begin + subwarp.lane, result);
    __syncwarp(subwarp.mask);
    add_up(subwarp, result.sum);
    if (subwarp.any(result.plane.count > 0)) add_up(subwarp, result.plane);
    result.is_far = subwarp.any(result.is_far);
    return result;
  }

  // Notes the result of a task. One thread of its subwarp calls this.
  __device__ void note_task(const Task& task, const CellResult& result) {
    const std::uint32_t i = task.cell;
    const CellClass found = class_of_result(result);
    const bool cut = found == CellClass::cut;
    if (kFloods) {
      const bool partial = !task.is_whole() && found == CellClass::partial;
      const std::uint32_t bits =
          (cut ? cell_bit::cut | cell_bit::summed : 0) | (partial ? cell_bit::partial : 0);
      if (bits != 0) atomicOr(&work_.notes.words[i], bits);
      add_atomically(result.sum, work_.notes.sums[i]);
    } else {
      found_.sum.add(result.sum);
      if (cut || counts(result.sum)) count(i, cell_bit::counted | (cut ? cell_bit::cut : 0));
    }
    if (cut) add_atomically(result.plane, work_.notes.planes[i]);
  }

  // Notes that a cell counts; other threads may note the same cell. The word that it had before is
  // used only in the next call, so that nobody waits for it.
  __device__ void count(std::uint32_t cell, std::uint32_t bits) {
    count_cell(words_before_, bits_added_, found_);
    words_before_ = atomicOr(&work_.notes.words[cell], bits);
    bits_added_ = bits;
  }

  const PoseWork<Surface>& work_;
  TaskLists& lists_;
  ThreadResult& found_;
  std::uint32_t words_before_ = 0, bits_added_ = 0;  // word of the cell noted last
};

}  // namespace vpm::cuda
