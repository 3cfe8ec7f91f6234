// Defines what a query notes of cells on a device (a word of bits each, sums, and what later steps
// need), visits the noted cells, and finds those that the surface cuts.
#pragma once

#include <algorithm>

#include "libvpm/backend/cuda/lanes.h"
#include "libvpm/backend/cuda/views.h"
#include "libvpm/measure/flood_rules.h"

namespace vpm::cuda {

// Adds the part of a sample behind a plane to the sums of one lane, `row`, if the sample is a ball;
// returns false if its shape is in a FaceRow. Those come last in their blocks, and
// add_face_to_row() adds them once all balls are added, so that no ball waits for their longer way.
__device__ inline bool add_ball_to_row(const CellSample& sample, const ClipPlane& plane,
                                       ClippedMoments& row) {
  if (sample.radius < 0) return false;
  add_to_row(BallShape<double>{sample.radius}, sample, plane, row, row.is_cut);
  return true;
}
__device__ inline void add_face_to_row(const CellSample& sample, const SampleFaces& faces,
                                       const ClipPlane& plane, ClippedMoments& row) {
  if (sample.radius < 0) add_to_row(shape_of(faces.of(sample)), sample, plane, row, row.is_cut);
}

// Holds one entry per cell. All are 0 at the start of a query: many threads add to them.
struct CellNotes {
  std::uint32_t* words = nullptr;
  ToolSum* sums = nullptr;
  ContactPlane* planes = nullptr;  // mean planes in cut cells

  // Clears the part of the entries that a block range owns. Call from all its threads.
  __device__ void clear(const LevelView& level, BlockRange part) const {
    constexpr unsigned kTogether = 4;  // words whose reads wait together
    const std::uint32_t step = part.parts * blockDim.x;
    for (std::uint32_t first = part.part * blockDim.x + threadIdx.x; first < level.count;
         first += kTogether * step) {
      std::uint32_t noted[kTogether];
#pragma unroll
      for (unsigned k = 0; k < kTogether; ++k)
        noted[k] = first + k * step < level.count ? words[first + k * step] : 0;
#pragma unroll
      for (unsigned k = 0; k < kTogether; ++k) {
        const std::uint32_t i = first + k * step;
        if (noted[k] == 0) continue;
        words[i] = 0;
        if ((noted[k] & (cell_bit::partial | cell_bit::whole | cell_bit::summed)) != 0)
          sums[i] = ToolSum{};
        if ((noted[k] & cell_bit::cut) != 0) planes[i] = ContactPlane{};
      }
    }
  }
};

// The plane that cuts a block and clips all its samples.
struct ClippedBlock {
  ClipPlane plane;
  Vec3 center;
};

// A piece further behind the surface than the tool radius, and what it adds if the plane of a cut
// cell supports it.
struct FarPiece {
  Vec3 at, foot;  // the piece and the foot of its surface sample, surface frame, m
  ToolSum sum;
  ToolSum::Sum weight;  // volume of the piece, which is unseen unless a plane supports it
  std::uint32_t cell = 0;
};

// Holds the sizes of one query's memory, in entries: those of the largest level that uses it.
struct TeamRoom {
  std::size_t cells = 0, pieces = 0;

  TeamRoom() = default;
  explicit TeamRoom(const LevelView& level) : cells(level.count), pieces(level.piece_count) {}
  bool holds(const TeamRoom& other) const { return cells >= other.cells && pieces >= other.pieces; }
  TeamRoom with(const TeamRoom& other) const {
    TeamRoom both;
    both.cells = std::max(cells, other.cells);
    both.pieces = std::max(pieces, other.pieces);
    return both;
  }
};

// Holds a planar cluster that the surface cuts.
struct PlanarCluster {
  ClipPlane plane;
  float least_inverse_depth;  // least in the cluster, 1/m
};

// Points into the memory of one query.
struct RefinedSpace {
  CellNotes notes[2];                // this query's and, cleared by it, the next one's, alternating
  double* gaps = nullptr;            // squared_gap() of cells that may be inside, m^2
  std::uint32_t* parents = nullptr;  // count + 1: the entry, then cells
  std::uint32_t* cut = nullptr;      // rows of the cut cells, where they are needed
  FarPiece* far = nullptr;
  ClippedBlock* clipped_blocks =
      nullptr;  // planes of each thread block's lists of tasks of clipped blocks
  PlanarCluster* planar_clusters = nullptr;  // those that a thread block classifies
};

// Holds the lengths of a query's lists; all are 0 at its start.
struct RefinedCounters {
  unsigned hidden = 0;  // cells that another surface may hide
  unsigned far = 0;     // FarPieces
  unsigned cut = 0;     // cut cells; 0 until CutCells::list()
};

// Counts a cell as boundary or inside if the bits just added to its word say so.
__device__ inline void count_cell(std::uint32_t before, std::uint32_t bits, ThreadResult& result) {
  const auto is_inside = [](std::uint32_t word) {
    return (word & cell_bit::counted) != 0 && (word & cell_bit::cut) == 0 ? 1U : 0U;
  };
  result.boundary += (bits & ~before & cell_bit::cut) != 0 ? 1 : 0;
  result.inside += is_inside(before | bits) - is_inside(before);
}

// Reads a counter anew from memory, since other blocks add to it.
__device__ inline unsigned read(const unsigned& counter) {
  return *const_cast<const volatile unsigned*>(&counter);
}
// Reads the counters by one thread for all of its block: many readers of one place would wait for
// each other.
__device__ inline RefinedCounters read_for_block(const RefinedCounters& counters) {
  __shared__ RefinedCounters found;
  __syncthreads();
  if (threadIdx.x == 0) found = {read(counters.hidden), read(counters.far), 0};
  __syncthreads();
  return found;
}

// Bundles what the threads that measure cells know of their pose.
template <class Surface>
struct PoseWork {
  const LevelView& level;
  const Surface& surface;
  const Pose& to_surface;
  const RefinedSpace& space;
  const CellNotes& notes;  // the pose's notes in `space`
  RefinedCounters& counters;
  BlockRange part;

  __device__ CellMeasure<Surface> measure_of(const CellView& view) const {
    return {surface, to_surface, level.tool_radius, view};
  }

  // Adds to what was not seen.
  __device__ void add_unseen(const UnseenSum& found) const {
    if constexpr (TellsSight<Surface>) add_atomically(found, unseen_of_warp(threadIdx.x / 32));
  }
  // Adds a piece that was sampled, if it does not count.
  __device__ void add_unseen(const CellMeasure<Surface>& measure, const ToolPiece& piece,
                             const typename CellMeasure<Surface>::PieceSample& sampled) const {
    UnseenSum found;
    measure.add_unseen(piece, sampled, found);
    add_unseen(found);
  }
  // Adds what stands for a task on the free side of the surface, by the sight of its cell's ball,
  // or a block.
  __device__ void add_free(const BlockTask& task, Sight of_ball) const {
    if (of_ball == Sight::seen) return;  // mostly: nothing is read then
    const WholePart whole = whole_part_of(task.flags);
    if (whole == WholePart::cell) add_free(level.cell_masses[task.cell], of_ball);
    if (whole == WholePart::block) add_free(level.block_masses[task.block], of_ball);
  }
  __device__ void add_free(const WarpTask& task, Sight of_ball) const {  // holds its masses
    const WholePart whole = whole_part_of(task.flags);
    if (whole == WholePart::cell) add_free(task.cell_mass, of_ball);
    if (whole == WholePart::block) add_free(task.block_mass, of_ball);
  }
  __device__ void add_free(const BlockMass& mass, Sight of_ball) const {
    if (of_ball == Sight::seen) return;
    UnseenSum found;
    measure_of({}).add_free(mass, of_ball, found);
    add_unseen(found);
  }
  // Adds the tasks of a group that is wholly free.
  __device__ void add_free(const TaskGroup& group, Sight of_ball) const {
    if (of_ball == Sight::seen) return;
    UnseenSum found;
    found.add(group.weight, of_ball);
    add_unseen(found);
  }

  // Adds a piece that is inside or cut; lists a far one. `normal` is the way out of an uncut one.
  __device__ void add_inside(const CellMeasure<Surface>& measure, const ToolPiece& piece,
                             const typename CellMeasure<Surface>::PieceSample& sampled, Vec3 normal,
                             std::uint32_t cell, ToolSum& total) const {
    ToolSum sum;
    measure.push(piece, sampled, normal, surface, sum);
    if (!sampled.is_far) {
      total.add(sum);
      return;
    }
    // Assigns member by member, since nvcc would store the whole byte by byte.
    FarPiece& far = space.far[atomicAdd(&counters.far, 1U)];
    far.at = sampled.x;
    far.foot = sampled.on_surface.foot;
    far.sum = sum;
    far.weight = UnseenSum::rounded(piece.weight);
    far.cell = cell;
  }
};

// Lists noted cells in a block's shared memory, with their words.
struct NotedList {
  static constexpr unsigned kRoom = 4096;

  std::uint32_t cells[kRoom], words[kRoom];
  unsigned count;
};

// Visits the cells that the first step has noted, which are few in a large level.
template <class Team>
class NotedCells {
 public:
  __device__ NotedCells(const LevelView& level, const CellNotes& notes, const Team& team,
                        NotedList& list)
      : level_(level), notes_(notes), team_(team), list_(list) {}

  // Calls visit(i, word) for the cells whose word is not 0, spread over the threads of the team.
  // Each block lists its noted cells first, as many as its list holds, and visits them, until it
  // has gone over all cells. If one list holds them all, later calls visit it without listing
  // again.
  template <class Visit>
  __device__ void for_each(const Visit& visit) {
    constexpr unsigned kTogether = 8;  // loads in flight
    const BlockRange part = team_.block();
    const unsigned step = part.parts * blockDim.x, begin = part.part * blockDim.x;
    const Subwarp warp(32);
    const auto visit_all = [&] {
      for (unsigned k = threadIdx.x; k < list_.count; k += blockDim.x)
        visit(list_.cells[k], list_.words[k]);
    };
    if (lists_all_) {
      visit_all();
      return;
    }
    lists_all_ = true;
    __syncthreads();
    if (threadIdx.x == 0) list_.count = 0;
    for (std::uint32_t first = begin; first < level_.count;) {
      lists_all_ &= first == begin;
      __syncthreads();
      if (threadIdx.x == 0) list_.count = 0;
      __syncthreads();
      bool has_room = true;
      for (; has_room && first < level_.count; first += kTogether * step) {
        std::uint32_t words[kTogether];
#pragma unroll
        for (unsigned k = 0; k < kTogether; ++k) {
          const std::uint32_t i = first + k * step + threadIdx.x;
          words[k] = i < level_.count ? notes_.words[i] : 0;
        }
#pragma unroll
        for (unsigned k = 0; k < kTogether; ++k) {
          const unsigned found = __ballot_sync(~0U, words[k] != 0);
          const unsigned slot = warp.take_slots(list_.count, found);
          if (words[k] == 0) continue;
          list_.cells[slot] = first + k * step + threadIdx.x;
          list_.words[slot] = words[k];
        }
        __syncthreads();
        has_room = list_.count + kTogether * blockDim.x <= NotedList::kRoom;
        __syncthreads();
      }
      visit_all();
    }
  }

 private:
  const LevelView& level_;
  const CellNotes& notes_;
  const Team& team_;
  NotedList& list_;
  bool lists_all_ = false;  // list_ holds all noted cells of this block
};

// Lists the cells that the surface cuts, whose planes support pieces far behind it.
template <class Team>
class CutCells {
 public:
  __device__ CutCells(const LevelView& level, const Pose& to_surface, const RefinedSpace& space,
                      const CellNotes& notes, RefinedCounters& counters, const Team& team)
      : level_(level),
        to_surface_(to_surface),
        space_(space),
        notes_(notes),
        counters_(counters),
        team_(team) {}

  // Lists the cut cells. Synchronise the team before calling other members.
  __device__ __noinline__ void list() {
    for (std::uint32_t i = team_.thread(); i < level_.count; i += team_.threads()) {
      if ((notes_.words[i] & cell_bit::cut) != 0) space_.cut[atomicAdd(&counters_.cut, 1U)] = i;
    }
  }
  __device__ CutCell at(std::uint32_t cut) const {
    return {notes_.planes[cut], to_surface_ * level_.centers[cut], level_.cell_radius[cut]};
  }
  // Returns the nearest cut cell, or level.count if there is none; ties go to the smaller index.
  // Call from all lanes of a subwarp.
  __device__ std::uint32_t nearest_to(const Subwarp& subwarp, std::uint32_t i) const {
    const Vec3 from = level_.spheres[i].center;
    double best_squared = HUGE_VAL;
    std::uint32_t best = level_.count;
    const auto take = [&](double squared, std::uint32_t j) {
      if (!is_nearer_cut(squared, j, best_squared, best)) return;
      best_squared = squared;
      best = j;
    };
    const unsigned count = read(counters_.cut);
    for (unsigned k = subwarp.lane; k < count; k += subwarp.width) {
      const std::uint32_t j = space_.cut[k];
      take(squared_norm(level_.spheres[j].center - from), j);
    }
    for (unsigned other = subwarp.width / 2; other > 0; other /= 2) {
      const double squared = __shfl_xor_sync(subwarp.mask, best_squared, other, subwarp.width);
      take(squared, __shfl_xor_sync(subwarp.mask, best, other, subwarp.width));
    }
    return best;
  }

  // Adds the far pieces that count. Asks may_count(cell) for uncut cells, and whether the body
  // encloses them, for which no plane is needed; one thread calls add(piece).
  template <class MayCount, class IsEnclosed, class Add>
  __device__ __noinline__ void add_far(unsigned count, const MayCount& may_count,
                                       const IsEnclosed& is_enclosed, const Add& add) const {
    const Subwarp warp(32);
    const bool any_cut = read(counters_.cut) > 0;
    for (unsigned k = team_.thread() / 32; k < count; k += team_.threads() / 32) {
      const FarPiece& far = space_.far[k];
      const std::uint32_t i = far.cell, word = notes_.words[i];
      const bool cut = (word & cell_bit::cut) != 0;
      if (!cut && is_enclosed(i)) {
        if (warp.leads()) add(far);
        continue;
      }
      if (!any_cut || (!cut && !may_count(i))) continue;
      const std::uint32_t by = cut ? i : nearest_to(warp, i);
      if (by < level_.count && warp.leads() &&
          at(by).supports(far.at, far.foot, level_.tool_radius.length))
        add(far);
    }
  }

 private:
  const LevelView& level_;
  const Pose& to_surface_;
  const RefinedSpace& space_;
  const CellNotes& notes_;
  RefinedCounters& counters_;
  const Team& team_;
};

// Holds the result of a block task.
struct TaskSums {
  ToolSum sum;
  bool is_cut = false;
};

// Adds up what one thread finds in an image's query, and notes which cells it found.
class ImageSums {
 public:
  __device__ explicit ImageSums(const CellNotes& notes) : notes_(notes) {}

  // Notes the result of a task's cell, once per thread; others may note the same cell.
  __device__ void note(const BlockTask& task, const TaskSums& found) {
    found_.sum.add(found.sum);
    if (!found.is_cut && !counts(found.sum)) return;
    bits_added_ = cell_bit::counted | (found.is_cut ? cell_bit::cut : 0);
    word_before_ = atomicOr(&notes_.words[task.cell], bits_added_);
  }
  // Notes the plane of a cut cell.
  __device__ void note(const BlockTask& task, const ContactPlane& found) const {
    if (found.count > 0) add_atomically(found, notes_.planes[task.cell]);
  }
  __device__ ThreadResult found() {
    count_cell(word_before_, bits_added_, found_);
    return found_;
  }

 private:
  const CellNotes& notes_;
  ThreadResult found_;
  std::uint32_t word_before_ = 0, bits_added_ = 0;  // word of the noted cell
};

}  // namespace vpm::cuda
