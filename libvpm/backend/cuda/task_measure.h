// What is listed while shares are classified, measured by the warps of a block: a lane for each
// sample, for a row of samples that a plane crosses, or for each piece that is taken whole. Where
// no flood decides what is inside, each thread adds up what it finds.
#pragma once

#include "libvpm/backend/cuda/pose_work.h"
#include "libvpm/backend/cuda/share_tasks.h"

namespace vpm::cuda {

template <class Surface>
class TaskMeasure {
 public:
  using Measure = CellMeasure<Surface>;

  __device__ TaskMeasure(const PoseWork<Surface>& work, TaskLists& lists)
      : work_(work), lists_(lists) {}

  // By all threads of the block.
  __device__ void clear() {
    if (threadIdx.x < TaskLists::kLists) lists_.counts[threadIdx.x] = 0;
    if (threadIdx.x == TaskLists::kLists) lists_.next_bundle = 0;
    __syncthreads();
  }
  // By all threads of the block: for so many tasks in each list.
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
  // By all threads of the block.
  __device__ void measure();
  // What this thread has added up.
  __device__ RawResult found() {
    count_share(words_before_, bits_added_, found_);
    return found_;
  }

  __device__ void add(unsigned list, const Task& task) { lists_.add(list, task); }
  __device__ void add_crossed(const Unit& unit, const CrossingPlane& plane);
  __device__ void note_behind(const Unit& unit, Vec3 normal);
  __device__ Measure measure_of(const CellView& view) const {
    return {work_.surface, work_.to_surface, work_.level.tool_reach, view};
  }

 private:
  static constexpr bool kFloods = !Surface::kTellsInside;
  // Neighbours are measured by lanes of one tile.
  static_assert(TaskLists::kNarrow % kNeighborSamples == 0 &&
                TaskLists::kWide % kNeighborSamples == 0);

  __device__ FlatBlock& flat(unsigned list, unsigned slot) const {
    const unsigned row = 2 * work_.part.part + (list == TaskLists::flat_wide);
    return work_.space.flats[row * TaskLists::kTasks + slot];
  }
  __device__ void measure(const Tile& tile, unsigned list, unsigned slot, const Task& task);
  __device__ SharePiece piece(Task::Form form, std::uint32_t k) const {
    switch (form) {
      case Task::samples:
        return piece_of(work_.level.samples[k]);
      case Task::whole_share:
        return piece_of(work_.level.share_masses[k], work_.level.cell(k));
      default:
        return piece_of(work_.level.block_masses[k], work_.level.blocks[k]);
    }
  }
  __device__ void add_piece(const Tile& tile, const Measure& measure, const Task& task,
                            std::uint32_t k, CellResult& result);
  __device__ static unsigned first_neighbor(const Tile& tile, bool shares);
  __device__ CellResult measure_flat(const Tile& tile, const FlatBlock& flat, const Task& task);
  __device__ CellResult measure_pieces(const Tile& tile, const Task& task);
  __device__ void note_task(const Task& task, const CellResult& result);
  __device__ void count(std::uint32_t share, std::uint32_t bits);

  const PoseWork<Surface>& work_;
  TaskLists& lists_;
  RawResult found_;
  std::uint32_t words_before_ = 0, bits_added_ = 0;  // of the share that was noted last
};

// Lists a block where the surface is one plane, if the plane crosses it.
template <class Surface>
__device__ void TaskMeasure<Surface>::add_crossed(const Unit& unit, const CrossingPlane& plane) {
  const UnitBall& ball = unit.balls[Unit::of_block];
  const PlaneSide side = side_of_plane(plane.distance(ball.center), ball.radius);
  const Task task{unit.share, Task::samples, unit.begin, unit.end - unit.begin};
  if (side == PlaneSide::cut) {
    const unsigned list =
        task.count <= TaskLists::kNarrow ? TaskLists::flat_narrow : TaskLists::flat_wide;
    // Member by member: the whole would be stored byte by byte.
    FlatBlock& block = flat(list, lists_.add(list, task));
    block.plane = plane;
    block.center = ball.center;
    return;
  }
  CellResult result;
  if (side == PlaneSide::behind)
    add_whole(work_.level.tool_reach, work_.level.block_masses[unit.block], plane.normal,
              result.sum);
  note_task(task, result);
}

// A share wholly behind the surface of its patch.
template <class Surface>
__device__ void TaskMeasure<Surface>::note_behind(const Unit& unit, Vec3 normal) {
  ToolSum sum;
  add_whole(work_.level.tool_reach, work_.level.share_masses[unit.share], normal, sum);
  if (kFloods) {
    work_.notes.sums[unit.share] = sum;
  } else {
    found_.sum.add(sum);
    if (sum.volume.value != 0) count(unit.share, kCounted);
  }
}

// Warps take bundles of tasks of one list, as many as have room in a warp; those that take longest
// first.
template <class Surface>
__device__ void TaskMeasure<Surface>::measure() {
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
    const Tile tile(TaskLists::width(list));
    const unsigned slot = bundle * (32 / tile.width) + threadIdx.x % 32 / tile.width;
    if (slot < lists_.counts[list]) measure(tile, list, slot, lists_.tasks[list][slot]);
    __syncwarp();
  }
}

template <class Surface>
__device__ void TaskMeasure<Surface>::measure(const Tile& tile, unsigned list, unsigned slot,
                                              const Task& task) {
  const CellResult result = TaskLists::is_flat(list) ? measure_flat(tile, flat(list, slot), task)
                                                     : measure_pieces(tile, task);
  if (tile.leads()) note_task(task, result);
}

// The result is there for all threads of the tile.
template <class Surface>
__device__ CellResult TaskMeasure<Surface>::measure_pieces(const Tile& tile, const Task& task) {
  const std::uint32_t i = task.share;
  const Measure measure = measure_of({.samples = work_.level.samples,
                                      .center = work_.level.centers[i],
                                      .reach = work_.level.reach[i]});
  CellResult result;
  for (std::uint32_t begin = 0; begin < task.count; begin += tile.width)
    add_piece(tile, measure, task, begin + tile.lane, result);
  __syncwarp(tile.mask);
  add_up(tile, result.sum);
  if (tile.any(result.plane.count > 0)) add_up(tile, result.plane);
  result.is_far = tile.any(result.is_far);
  return result;
}

// What piece `k` of a task, if there is one, adds to CellMeasure::run() or, where its share is
// whole, to whole(). Far pieces are listed. By all threads of a tile.
template <class Surface>
__device__ void TaskMeasure<Surface>::add_piece(const Tile& tile, const Measure& measure,
                                                const Task& task, std::uint32_t k,
                                                CellResult& result) {
  const bool exists = k < task.count;
  const SharePiece piece = this->piece(task.form, task.begin + (exists ? k : 0));
  const typename Measure::PieceLook look = measure.look_at(piece);
  const bool inside = exists && look.is_inside;
  const bool shares =
      exists && task.form == Task::samples && Measure::shares_direction(piece, look);
  const unsigned first = Surface::kSearchesFoot ? first_neighbor(tile, shares) : tile.lane;
  Vec3 normal;
  if (inside && !Measure::is_cut(piece, look) && first == tile.lane)
    normal = measure.closest_normal(look);
  if (Surface::kSearchesFoot) normal = tile.from(normal, first);
  if (!inside) return;
  measure.note(piece, look, result);
  work_.add_inside(measure, piece, look, normal, task.share, result.sum);
}

// The first lane of those that share a direction with this one; itself where it has its own.
template <class Surface>
__device__ unsigned TaskMeasure<Surface>::first_neighbor(const Tile& tile, bool shares) {
  const unsigned sharing = tile.which(shares);
  return shares ? direction_leader(tile.lane, sharing) : tile.lane;
}

// A row of samples by each thread; what the block needs is read before the first wait, a sample
// before the one before it is added. The result is there for the first thread of the tile.
template <class Surface>
__device__ CellResult TaskMeasure<Surface>::measure_flat(const Tile& tile, const FlatBlock& flat,
                                                         const Task& task) {
  const CrossingPlane plane = flat.plane;
  const Vec3 center = flat.center, share = work_.level.centers[task.share];
  const double reach = work_.level.reach[task.share];
  const CellSample* const samples = work_.level.samples + task.begin;
  CellSample next = samples[tile.lane < task.count ? tile.lane : 0];
  CrossedSums row;
#pragma unroll 1
  for (std::uint32_t k = tile.lane; k < task.count;) {
    const CellSample sample = next;
    k += tile.width;
    if (k < task.count) next = samples[k];
    add_to_row(sample, plane, row, row.is_cut);
  }
  __syncwarp(tile.mask);
  add_up(tile, row);
  CellResult result;
  if (tile.leads()) {
    if (row.is_cut)
      measure_of({.center = share, .reach = reach}).add_to_plane(center, plane, result.plane);
    add_by_plane(PlaneSide::cut, {}, row, plane.normal, work_.level.tool_reach, result.sum);
  }
  return result;
}

// By one thread, what all threads of its tile have found.
template <class Surface>
__device__ void TaskMeasure<Surface>::note_task(const Task& task, const CellResult& result) {
  const std::uint32_t i = task.share;
  const bool cut = result.plane.count > 0;
  if (kFloods) {
    const bool partial = !task.is_whole() && (result.sum.volume.value > 0 || result.is_far);
    const std::uint32_t bits = (cut ? kCut | kSummed : 0) | (partial ? kPartial : 0);
    if (bits != 0) atomicOr(&work_.notes.words[i], bits);
    add_atomically(result.sum, work_.notes.sums[i]);
  } else {
    found_.sum.add(result.sum);
    if (cut || result.sum.volume.value != 0) count(i, kCounted | (cut ? kCut : 0));
  }
  if (cut) add_atomically(result.plane, work_.notes.planes[i]);
}

// Notes that a share counts; others may do so too. What its word was is needed only when the next
// one comes, so that nobody waits for it.
template <class Surface>
__device__ void TaskMeasure<Surface>::count(std::uint32_t share, std::uint32_t bits) {
  count_share(words_before_, bits_added_, found_);
  words_before_ = atomicOr(&work_.notes.words[share], bits);
  bits_added_ = bits;
}

}  // namespace vpm::cuda
