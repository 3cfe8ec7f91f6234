// Defines the kernels of the refined measure, for refined_measure.cu: one pose by all blocks, a few
// poses by teams of some blocks, and many poses by a block each.
#pragma once

#include <type_traits>

#include "libvpm/backend/cuda/answer.h"
#include "libvpm/backend/cuda/cell_notes.h"
#include "libvpm/backend/cuda/group_measure.h"
#include "libvpm/backend/cuda/image_measure.h"
#include "libvpm/backend/cuda/inside_flood.h"
#include "libvpm/backend/cuda/task_measure.h"
#include "libvpm/device/cuda/device_array.h"
#include "libvpm/device/cuda/occupancy.h"

namespace vpm::cuda {
namespace {

// Blocks per multiprocessor. With two, a query of an image spills no registers and a pose of up to
// kSpheresOfFewBlocks spheres is answered sooner; with three, one of more spheres is, and one among
// points.
constexpr unsigned kFewBlocks = 2, kManyBlocks = 3, kBatchBlocks = 2;
constexpr std::uint32_t kSpheresOfFewBlocks = 50'000;

template <class Surface>
struct RefinedLaunch {
  LevelView level;
  Surface surface;
  RefinedSpace space;
  Totals* totals = nullptr;
  RefinedCounters* counters = nullptr;
  Answer* answer = nullptr;
};

// Counts what the blocks of a batch have done; all 0 between launches.
struct BatchState {
  unsigned taken = 0;  // poses that blocks or teams have taken after their first
  unsigned done = 0;   // blocks that are done
};

// Holds what the blocks of one team share, twice, for poses by turns: the last block to finish a
// pose clears what it used while others already add to that of the next pose. All 0 between
// launches.
struct TeamState {
  RawResult results[2];
  RefinedCounters counters[2];
  unsigned next[2] = {};  // the pose after this
  unsigned arrived = 0;   // counter of MeetingTeam
};

// Holds the arguments of a launch for many poses of several tools.
template <class Surface>
struct BatchLaunch {
  static constexpr unsigned kTools = 16;

  LevelView levels[kTools];
  unsigned ends[kTools];  // end of each tool's poses, which follow those of the tool before
  Surface surface;
  RefinedSpace space;   // memory of the first team
  TeamRoom room;        // size of one team's memory
  BatchState* state;    // of the whole launch
  TeamState* of_teams;  // of teams of several blocks, of `blocks` each
  unsigned blocks = 1;
};

// Returns the memory of one of several teams, the first of whose blocks is given.
__device__ RefinedSpace space_of(const RefinedSpace& first, const TeamRoom& room, std::size_t team,
                                 std::size_t block) {
  const std::size_t cells = team * room.cells;
  RefinedSpace space;
  for (int turn = 0; turn < 2; ++turn) {
    const CellNotes& from = first.notes[turn];
    space.notes[turn] = {from.words + cells, from.sums + cells, from.planes + cells};
  }
  space.gaps = first.gaps + cells;
  space.parents = first.parents + cells + team;
  space.cut = first.cut + cells;
  space.far = first.far + team * room.pieces;
  space.clipped_blocks = first.clipped_blocks + block * 2 * TaskLists::kTasks;
  space.planar_clusters = first.planar_clusters + block * kBatchThreads;
  return space;
}

// Decides which cells behind a surface are inside.
template <class Surface, class Team>
using Inside = std::conditional_t<Surface::kTellsInside, CameraVisibility<Surface, Team>,
                                  Flood<Surface, Team>>;

// True for a surface that small levels are measured before by a schedule of its own.
template <class Surface>
inline constexpr bool kHasImageSchedule = std::is_same_v<Surface, DepthSurface>;
template <class Surface>
using ImageSchedule =
    std::conditional_t<kHasImageSchedule<Surface>, ImageMeasure, GroupMeasure<Surface>>;

// Lays out a block's shared memory, which the steps of a query use one after another.
template <class Surface>
union BlockShared {
  MeasureShared measure;
  typename ImageSchedule<Surface>::Shared image;
  typename Inside<Surface, BlockTeam>::Shared inside;
};

// Returns what the blocks of a launch that share one pose know of it.
template <class Surface>
__device__ PoseWork<Surface> work_of(const RefinedLaunch<Surface>& launch, const Pose& to_surface,
                                     unsigned turn) {
  return {launch.level,
          launch.surface,
          to_surface,
          launch.space,
          launch.space.notes[turn % 2],
          *launch.counters,
          {blockIdx.x, gridDim.x}};
}

// Runs the first step of one query by the blocks that share it. Returns the sums of this thread.
template <class Surface>
__device__ ThreadResult measure_cells(const PoseWork<Surface>& work, BlockShared<Surface>& shared) {
  if constexpr (TellsSight<Surface>) clear_unseen();
  if constexpr (kHasImageSchedule<Surface>) {
    if (ImageMeasure::is_for(work.level, work.part)) return ImageMeasure(work, shared.image).run();
  }
  ThreadResult found;
  GroupMeasure<Surface>(work, shared.measure, found).run();
  return found;
}

// Adds what a block has found in the first step, before a surface that tells the inside.
template <class Surface>
__device__ void add_first_step(const ThreadResult& found, RawResult& total) {
  static_assert(Surface::kTellsInside || !TellsSight<Surface>, "a flood adds no unseen parts");
  if constexpr (Surface::kTellsInside) add_block(found, total);
  if constexpr (TellsSight<Surface>) add_unseen_of_warps(total.unseen);
}

// Notes the planes of cut cells if the first step has not; few queries need them. Takes a copy of
// the work: a reference would keep the caller's in memory all along.
__device__ __noinline__ void note_planes(PoseWork<DepthSurface> work,
                                         BlockShared<DepthSurface>& shared) {
  if (ImageMeasure::is_for(work.level, work.part)) ImageMeasure(work, shared.image).note_planes();
}

// Clears the notes for the next query, while nobody waits.
template <class Surface>
__device__ void clear_next(const RefinedLaunch<Surface>& launch, unsigned turn) {
  launch.space.notes[(turn + 1) % 2].clear(launch.level, {blockIdx.x, gridDim.x});
}

// Answers one query of a level of few cells: all blocks classify and measure, and the last to
// finish floods alone.
template <class Surface>
__global__ void __launch_bounds__(kThreads, kManyBlocks)
    one_pose_small(const __grid_constant__ RefinedLaunch<Surface> launch,
                   const __grid_constant__ Pose to_surface, unsigned sequence) {
  __shared__ BlockShared<Surface> shared;
  __shared__ RawResult total;
  measure_cells(work_of(launch, to_surface, sequence), shared);
  if (!is_last_of(launch.totals->done, gridDim.x)) {
    clear_next(launch, sequence);
    return;
  }
  const std::uint64_t met = now();
  if (threadIdx.x == 0) total = RawResult{};
  BlockTeam team;
  add_block(Flood<Surface, BlockTeam>(launch.level, launch.surface, to_surface, launch.space,
                                      sequence, *launch.counters, team, shared.inside)
                .run(total.unseen),
            total);
  __syncthreads();
  send(word_of(total), now() - met, launch.answer, sequence);
  if (threadIdx.x == 0) {
    launch.totals->done = 0;
    *launch.counters = RefinedCounters{};
  }
  clear_next(launch, sequence);
}

// Answers one query by all blocks of a cooperative launch. If the first step has found all (no far
// pieces), the last block to arrive sends the answer.
template <class Surface>
__device__ void answer_pose(const RefinedLaunch<Surface>& launch, const Pose& to_surface,
                            unsigned sequence, GridTeam& team, BlockShared<Surface>& shared) {
  using Rest = Inside<Surface, GridTeam>;
  Totals* const totals = launch.totals;
  const ThreadResult found = measure_cells(work_of(launch, to_surface, sequence), shared);
  add_first_step<Surface>(found, totals->result);
  const bool is_last = team.arrive();
  std::uint64_t met = now();
  unsigned far = 0;
  const auto has_more = [&] { return Rest::has_more(far); };
  if (is_last) {
    // Read together with `far`.
    const std::uint32_t word = word_of(totals->result);
    far = read(launch.counters->far);
    if (!has_more()) send(word, now() - met, launch.answer, sequence);
  }
  clear_next(launch, sequence);  // while others arrive
  if (!is_last) {
    team.wait();
    met = now();
    far = read_for_block(*launch.counters).far;
  }
  if (has_more()) {
    if constexpr (kHasImageSchedule<Surface>)
      if (far > 0) note_planes(work_of(launch, to_surface, sequence), shared);
    GridTeam meeting = team;  // a copy, since a function's argument lies in memory
    Rest rest(launch.level, launch.surface, to_surface, launch.space, sequence, *launch.counters,
              meeting, shared.inside);
    add_block(rest.run(totals->result.unseen), totals->result);
  }
  if (!is_last_of(totals->done, gridDim.x)) return;
  if (has_more()) send(word_of(totals->result), now() - met, launch.answer, sequence);
  __syncthreads();
  if (threadIdx.x == 0) {
    *totals = Totals{};
    *launch.counters = RefinedCounters{};
  }
}

template <class Surface, unsigned kBlocks>
__global__ void __launch_bounds__(kThreads, kBlocks)
    one_pose(const __grid_constant__ RefinedLaunch<Surface> launch,
             const __grid_constant__ Pose to_surface, unsigned sequence) {
  __shared__ BlockShared<Surface> shared;
  GridTeam team(&launch.totals->arrived);
  answer_pose(launch, to_surface, sequence, team, shared);
}

// Answers the poses of a batch by teams of several blocks. A team that has answered a pose takes
// the next one that no team has: poses in clutter take very different times.
template <class Surface>
__global__ void __launch_bounds__(kThreads, kFewBlocks)
    few_poses(const __grid_constant__ BatchLaunch<Surface> launch, const Pose* to_surfaces,
              unsigned count, RawResult* results) {
  using Team = MeetingTeam<SomeBlocks>;
  using Rest = Inside<Surface, Team>;
  __shared__ BlockShared<Surface> shared;
  __shared__ Pose to_surface;
  __shared__ RefinedSpace space;
  __shared__ unsigned next;
  const unsigned number = blockIdx.x / launch.blocks, teams = gridDim.x / launch.blocks;
  const BlockRange part{blockIdx.x % launch.blocks, launch.blocks};
  if (threadIdx.x == 0)
    space = space_of(launch.space, launch.room, number, std::size_t{number} * launch.blocks);
  TeamState& state = launch.of_teams[number];
  Team team(&state.arrived, {part});
  const auto clear_notes = [&](const LevelView& level) {
    for (const CellNotes& notes : space.notes) notes.clear(level, part);
  };
  unsigned turn = 0, tool = 0;
  for (unsigned p = number; p < count; p = next, ++turn) {
    __syncthreads();
    if (p >= launch.ends[tool]) {
      clear_notes(launch.levels[tool]);
      while (p >= launch.ends[tool]) ++tool;
      team.sync();
    }
    if (threadIdx.x == 0) to_surface = to_surfaces[p];
    __syncthreads();
    const LevelView& level = launch.levels[tool];
    RawResult& result = state.results[turn % 2];
    RefinedCounters& counters = state.counters[turn % 2];
    const auto work = [&]() -> PoseWork<Surface> {
      return {level, launch.surface, to_surface, space, space.notes[turn % 2], counters, part};
    };
    add_first_step<Surface>(measure_cells(work(), shared), result);
    team.arrive();
    space.notes[(turn + 1) % 2].clear(level, part);  // while others arrive
    team.wait();
    const unsigned far = read_for_block(counters).far;
    if (Rest::has_more(far)) {
      if constexpr (kHasImageSchedule<Surface>) note_planes(work(), shared);
      Team meeting = team;  // a copy, since a function's argument lies in memory
      Rest rest(level, launch.surface, to_surface, space, turn, counters, meeting, shared.inside);
      add_block(rest.run(result.unseen), result);
      team = meeting;
    }
    if (part.part == 0 && threadIdx.x == 0)
      state.next[turn % 2] = teams + atomicAdd(&launch.state->taken, 1U);
    if (team.arrive() && threadIdx.x == 0) {
      results[p] = result;
      result = RawResult{};
      counters = RefinedCounters{};
    }
    team.wait();
    if (threadIdx.x == 0) next = read(state.next[turn % 2]);
    __syncthreads();
  }
  clear_notes(launch.levels[tool]);  // the next launch begins with turn 0
  if (!is_last_of(launch.state->done, gridDim.x)) return;
  for (unsigned k = threadIdx.x; k < teams; k += blockDim.x) launch.of_teams[k].arrived = 0;
  if (threadIdx.x == 0) *launch.state = BatchState{};
}

// Answers the poses of a batch, each by one block. A block that has finished a pose goes on with
// the first pose of the batch that no block has begun.
template <class Surface>
__global__ void __launch_bounds__(kBatchThreads, kBatchBlocks)
    many_poses(const __grid_constant__ BatchLaunch<Surface> launch, const Pose* to_surfaces,
               unsigned count, RawResult* results) {
  __shared__ BlockShared<Surface> shared;
  __shared__ Pose to_surface;
  __shared__ RefinedCounters counters;
  __shared__ RawResult total;
  // Each thread's sums, which are seldom used, lie here and not in its registers. A query with a
  // flood has none.
  __shared__ ThreadResult of_threads[Surface::kTellsInside ? kBatchThreads : 1];
  ThreadResult of_flood, &found = Surface::kTellsInside ? of_threads[threadIdx.x] : of_flood;
  __shared__ RefinedSpace space;  // in registers it would be indexed, thus in local memory
  __shared__ unsigned next;
  if (threadIdx.x == 0) space = space_of(launch.space, launch.room, blockIdx.x, blockIdx.x);
  const auto clear_notes = [&](const LevelView& level) {
    for (const CellNotes& notes : space.notes) notes.clear(level, {});
  };
  BlockTeam team;
  unsigned turn = 0, tool = 0;
  for (unsigned p = blockIdx.x; p < count; p = next, ++turn) {
    __syncthreads();
    if (p >= launch.ends[tool]) {
      clear_notes(launch.levels[tool]);
      while (p >= launch.ends[tool]) ++tool;
      __syncthreads();
    }
    const LevelView& level = launch.levels[tool];
    if (threadIdx.x == 0) {
      to_surface = to_surfaces[p];
      counters = RefinedCounters{};
      total = RawResult{};
      next = gridDim.x + atomicAdd(&launch.state->taken, 1U);
    }
    __syncthreads();
    const PoseWork<Surface> work{
        level, launch.surface, to_surface, space, space.notes[turn % 2], counters, {}};
    found = ThreadResult{};
    if constexpr (TellsSight<Surface>) clear_unseen();
    // Among points groups are classified apart: so batches take 5 % less time, single poses 15 %
    // more.
    constexpr bool kApart = !Surface::kTellsInside;
    GroupMeasure<Surface>(work, shared.measure, found).template run<kApart>();
    add_first_step<Surface>(found, total);
    space.notes[(turn + 1) % 2].clear(level, {});
    __syncthreads();
    Inside<Surface, BlockTeam> inside(level, launch.surface, to_surface, space, turn, counters,
                                      team, shared.inside);
    if (inside.has_more(counters.far)) add_block(inside.run(total.unseen), total);
    __syncthreads();
    if (threadIdx.x == 0) results[p] = total;
  }
  clear_notes(launch.levels[tool]);  // the next launch begins with turn 0
  if (is_last_of(launch.state->done, gridDim.x) && threadIdx.x == 0) *launch.state = BatchState{};
}

}  // namespace

// Holds the device memory of a number of teams, of one or more blocks each.
class RefinedMemory {
 public:
  RefinedMemory(const TeamRoom& room, std::size_t teams, std::size_t blocks, unsigned threads)
      : space_{{notes(room.cells * teams), notes(room.cells * teams)},
               memory_.room<double>(room.cells * teams),
               memory_.room<std::uint32_t>((room.cells + 1) * teams),
               memory_.room<std::uint32_t>(room.cells * teams),
               memory_.room<FarPiece>(room.pieces * teams),
               memory_.room<ClippedBlock>(2 * TaskLists::kTasks * blocks),
               memory_.room<PlanarCluster>(threads * blocks)} {}

  const RefinedSpace& space() const { return space_; }

  // Returns the size of the memory of a team of one block, in bytes.
  static std::size_t bytes_of_team(const TeamRoom& room) {
    constexpr std::size_t kOfCell =
        2 * (sizeof(std::uint32_t) + sizeof(ToolSum) + sizeof(ContactPlane)) + sizeof(double) +
        2 * sizeof(std::uint32_t);
    return sizeof(TeamState) + room.cells * kOfCell + room.pieces * sizeof(FarPiece) +
           2 * TaskLists::kTasks * sizeof(ClippedBlock) + kBatchThreads * sizeof(PlanarCluster);
  }

 private:
  CellNotes notes(std::size_t cells) {
    return {memory_.zeros<std::uint32_t>(cells), memory_.zeros<ToolSum>(cells),
            memory_.zeros<ContactPlane>(cells)};
  }

  DeviceMemory memory_;
  RefinedSpace space_;
};

}  // namespace vpm::cuda
