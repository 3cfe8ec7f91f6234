// Runs the first step of a query: classifies cells and lists what is to be measured.
//
// One to four threads classify each task group's cluster, more where groups are few, and sample the
// surface at four places of a planar one. A block task of a cut cluster is classified by one to
// four threads, which read its pixels; others by four, which classify the balls of its cell and
// block. Work is listed as tasks in shared memory (task_measure.h).
#pragma once

#include <climits>

#include "libvpm/backend/cuda/task_measure.h"

namespace vpm::cuda {

// Samples a surface at four places by the lanes of a subwarp, four at most.
struct SampleByLanes : SampleInTurn {
  Subwarp lanes;

  template <class Surface, class Take>
  __device__ bool operator()(const Surface& surface, const Vec3 (&places)[kPlacesAround],
                             const Take& take) const {
    SurfaceSample mine;
#pragma unroll 1
    for (unsigned k = 0; k < kPlacesAround; ++k) {
      const unsigned from = k % lanes.width, at = k + lanes.lane;
      if (from == 0) mine = surface.sample(place_of(places, at));
      SurfaceSample on_surface;
      on_surface.known = lanes.from(static_cast<int>(mine.known), from) != 0;
      on_surface.normal = lanes.from(mine.normal, from);
      on_surface.foot = lanes.from(mine.foot, from);
      if (!take(on_surface)) return false;
    }
    return true;
  }
};

template <class Surface>
class GroupMeasure {
 public:
  using Shared = MeasureShared;  // memory of a block

  // Adds to `found`, this thread's sums, which are 0 before.
  __device__ GroupMeasure(const PoseWork<Surface>& work, MeasureShared& shared, ThreadResult& found)
      : work_(work), shared_(shared), tasks_(work, shared.lists, found) {}

  // Classifies the task groups of the block's part. Call from all threads. kApart keeps the classes
  // of groups in a function of their own, whose registers are not spilled all through the kernel.
  template <bool kApart = false>
  __device__ void run() {
    if (kFloods && work_.part.part == 0 && threadIdx.x == 0) work_.space.parents[0] = 0;
    clear_seen();
    tasks_.clear();
    const Subwarp lanes(lanes_of_group());
    // Deals neighbours to different warps, since they often take long together.
    const unsigned of_warp = 32 / lanes.width, slots = blockDim.x / lanes.width;
    const unsigned slot = threadIdx.x % 32 / lanes.width * (slots / of_warp) + threadIdx.x / 32;
    for (unsigned first = work_.part.part; first < work_.level.task_group_count;
         first += slots * work_.part.parts) {
      const unsigned c = first + slot * work_.part.parts;
      if (c < work_.level.task_group_count) {
        if constexpr (kApart) {
          classify_group_apart(c, slot, lanes);
        } else {
          classify_group(c, slot, lanes);
        }
      }
      __syncthreads();
      note_uniform();
      classify_seen(first + slots * work_.part.parts >= work_.level.task_group_count);
      __syncthreads();
      clear_seen();
      __syncthreads();
    }
    tasks_.finish();
  }

 private:
  using Measure = CellMeasure<Surface>;
  static constexpr bool kFloods = !Surface::kTellsInside;
  static constexpr unsigned kLanes = 4;  // lanes of a block task outside planar clusters
  static constexpr unsigned kSamplesOfBall =
      4;  // classifying a ball takes as long as so many samples
  // A round adds at most one task per thread to a list: one for each block task of a cut cluster,
  // two for each other.
  static_assert(kLanes >= 2 && kMeasureThreads <= TaskLists::kTasks);

  __device__ void clear_seen() {
    if (threadIdx.x == 0) shared_.seen_count = shared_.clipped_count = shared_.uniform_count = 0;
  }
  // Returns the lanes per task group. More finish a group sooner, fewer take more groups at once.
  __device__ unsigned lanes_of_group() const {
    unsigned best = 1, least = UINT_MAX;
    for (unsigned lanes = kPlacesAround; lanes > 0; lanes /= 2) {
      const unsigned at_once = blockDim.x / lanes * work_.part.parts;
      const unsigned rounds = (work_.level.task_group_count + at_once - 1) / at_once;
      const unsigned reads = rounds * (kSamplesOfBall + kPlacesAround / lanes);
      if (reads < least) best = lanes, least = reads;
    }
    return best;
  }
  // Classifies the cluster of one task group with all threads of a slot. Its first thread notes the
  // result.
  __device__ void classify_group(std::uint32_t c, unsigned slot, const Subwarp& lanes) {
    const TaskGroup& group = work_.level.task_groups[c];
    const Vec3 at = work_.to_surface * group.ball.center;
    const auto in_ball = work_.surface.classify_ball(at, group.ball.radius);
    const Sight sight = sight_of<Surface>(in_ball);
    if (in_ball.side == Side::free && sight != Sight::mixed) {
      if (lanes.leads()) work_.add_free(group, sight);
      return;
    }
    ClipPlane plane;
    const ClusterClass seen = classify_cluster(group.ball, in_ball, at, lanes, plane);
    if (!lanes.leads() || (seen == ClusterClass::free && sight != Sight::mixed)) return;
    if (seen == ClusterClass::uniform) {
      shared_.uniform_groups[atomicAdd(&shared_.uniform_count, 1U)] = c;
      return;
    }
    shared_.first_tasks[slot] = group.begin;
    const unsigned count = group.end - group.begin;
    const bool clipped = seen == ClusterClass::cut;
    if (clipped) {  // member by member: nvcc copies a padded struct byte by byte
      PlanarCluster& planar = planar_cluster_of(slot);
      planar.plane = plane;
      planar.least_inverse_depth = least_inverse_depth<Surface>(in_ball);
    }
    const unsigned begin =
        clipped ? MeasureShared::kSeen - count - atomicAdd(&shared_.clipped_count, count)
                : atomicAdd(&shared_.seen_count, count);
    for (unsigned u = 0; u < count; ++u) shared_.seen[begin + u] = PendingTask::of(slot, u, seen);
  }
  __device__ PlanarCluster& planar_cluster_of(unsigned slot) const {
    return work_.space.planar_clusters[work_.part.part * blockDim.x + slot];
  }
  __device__ __noinline__ void classify_group_apart(std::uint32_t c, unsigned slot,
                                                    const Subwarp& lanes) {
    classify_group(c, slot, lanes);
  }
  template <class BallClass>
  __device__ ClusterClass classify_cluster(const TaskBall& ball, const BallClass& in_ball, Vec3 at,
                                           const Subwarp& lanes, ClipPlane& plane) {
    const double tool = work_.level.tool_radius.length;
    const ClusterClass found = class_of_cluster(work_.surface, in_ball, at, ball.radius, tool);
    if (found == ClusterClass::by_middle)
      return class_by_middle(work_.surface, work_.surface.sample(at), at, ball.radius, tool);
    TangentPlane tangent;
    if (found != ClusterClass::ambiguous ||
        !finds_cluster_plane(work_.surface, in_ball, at, ball.radius, tool,
                             SampleByLanes{{}, lanes}, tangent))
      return found;
    plane = {tangent, work_.to_surface};
    return ClusterClass::cut;
  }
  // Notes the cells of uniform clusters, a thread for each block task. Finding the normals takes
  // long, so the last warps do it while the first ones handle cut clusters.
  __device__ void note_uniform() {
    const unsigned thread = blockDim.x - 1 - threadIdx.x, u = thread % TaskGroup::kTasks;
    for (unsigned k = thread / TaskGroup::kTasks; k < shared_.uniform_count;
         k += blockDim.x / TaskGroup::kTasks) {
      const TaskGroup& group = work_.level.task_groups[shared_.uniform_groups[k]];
      const Vec3 at = work_.to_surface * group.ball.center;
      const Vec3 normal = transpose(work_.to_surface.rotation) *
                          work_.surface.closest_normal(at, work_.surface.sample(at));
      if (u >= group.end - group.begin) continue;
      const BlockTask& task = work_.level.block_tasks[group.begin + u];
      if ((task.flags & BlockTask::is_head) != 0) note_uniform(task, normal);
    }
  }
  // Classifies the listed block tasks in rounds, after each of which the lists get room: those of
  // cut clusters by the first warps, others by the rest. Neighbours go to different warps. Empties
  // the lists after the last round of the last groups, so that measuring is compiled in once.
  __device__ void classify_seen(bool is_last) {
    const unsigned clipped_count = shared_.clipped_count, count = shared_.seen_count;
    const unsigned warps = idle_warps(), lanes = lanes_of_clipped(warps);
    const unsigned warp = threadIdx.x / 32, lane = threadIdx.x % 32;
    for (unsigned clipped = 0, others = 0; is_last || clipped < clipped_count || others < count;) {
      const unsigned first =
          warps_for_clipped(warps, warps_of(clipped_count - clipped, lanes), count - others);
      const unsigned rest = warps - first;
      if (warp < first) {
        const unsigned k = clipped + lane / lanes * first + warp;
        if (k < clipped_count)
          classify_clipped(shared_.seen[MeasureShared::kSeen - 1 - k], Subwarp(lanes));
      } else if (warp < warps && others + warp - first < count) {
        const unsigned k = others + lane / kLanes * rest + warp - first;
        const bool active = k < count;
        classify(shared_.seen[active ? k : 0], active);
      }
      clipped = min(clipped_count, clipped + first * (32 / lanes));
      others = min(count, others + rest * (32 / kLanes));
      const bool ends = is_last && clipped == clipped_count && others == count;
      tasks_.make_room(ends ? TaskLists::kTasks + 1 : blockDim.x);
      is_last &= !ends;
    }
  }
  __device__ static unsigned warps_of(unsigned tasks, unsigned lanes) {
    return (tasks * lanes + 31) / 32;
  }
  // Returns the number of warps that do not handle uniform clusters.
  __device__ unsigned idle_warps() const {
    const unsigned warps = blockDim.x / 32;
    return warps - min(warps_of(shared_.uniform_count, TaskGroup::kTasks), warps / 2);
  }
  // Returns the lanes per task of a cut cluster, as many as fit into one round.
  __device__ unsigned lanes_of_clipped(unsigned warps) const {
    const unsigned others = warps_of(shared_.seen_count, kLanes);
    unsigned lanes = kLanes;
    while (lanes > 1 && warps_of(shared_.clipped_count, lanes) + others > warps) lanes /= 2;
    return lanes;
  }
  // Returns the warps for tasks of cut clusters. If there are other tasks too, each kind gets at
  // least one warp and half of the spare ones.
  __device__ static unsigned warps_for_clipped(unsigned warps, unsigned clipped, unsigned others) {
    if (clipped == 0 || others == 0) return clipped == 0 ? 0 : warps;
    const unsigned spare = warps - min(warps, clipped + warps_of(others, kLanes));
    return min(clipped + spare / 2, warps - 1);
  }

  // Classifies one block task per kLanes lanes, with all threads of a warp. Notes `active` ones.
  __device__ void classify(PendingTask seen, bool active) {
    const Subwarp lanes(kLanes);
    const BlockTask& task = work_.level.block_tasks[shared_.first_tasks[seen.slot()] + seen.task()];
    const TaskBall ball = task.balls[min(lanes.lane, BlockTask::kBalls - 1U)];
    const std::uint32_t flags = task.flags;
    const bool head = (flags & BlockTask::is_head) != 0;
    const Vec3 at = work_.to_surface * ball.center;
    decltype(work_.surface.classify_ball(at, ball.radius)) in_ball;
    Side own = in_ball.side;
    Sight sight = Sight::mixed;  // of this lane's ball: that of a free cluster was mixed
    if (seen.side() == Side::ambiguous) {
      if (lanes.lane < BlockTask::kBalls) in_ball = work_.surface.classify_ball(at, ball.radius);
      own = in_ball.side;
      sight = sight_of<Surface>(in_ball);
      if (is_cell_free(lanes, in_ball, at, ball.radius)) own = Side::free;
    }
    const auto of_cell =
        static_cast<Side>(lanes.from(static_cast<unsigned>(own), BlockTask::of_cell));
    const Side side = seen.side() == Side::ambiguous ? of_cell : seen.side();

    const bool samples_cell = kFloods && lanes.lane == BlockTask::of_cell && side != Side::free;
    const bool samples_block = lanes.lane == BlockTask::of_block && side == Side::ambiguous &&
                               (flags & BlockTask::has_block) != 0 &&
                               in_ball.side == Side::ambiguous &&
                               work_.surface.may_be_flat(in_ball);
    SurfaceSample on_surface;
    if (samples_cell || samples_block) on_surface = work_.surface.sample(at, in_ball.point);

    double gap = 0;
    bool hidden = false, whole = side == Side::behind || (!kFloods && side == Side::no_surface);
    if (kFloods) {
      gap = squared_gap(on_surface);
      hidden = lanes.from(seen.seen() != ClusterClass::behind_near &&
                              is_hidden_cell(gap, work_.level.tool_radius.length),
                          BlockTask::of_cell);
      const bool behind = lanes.from(is_behind_surface(on_surface), BlockTask::of_cell);
      whole |= side == Side::no_surface && behind;
    }
    if (!active) return;
    if (lanes.lane == BlockTask::of_cell && head)
      note_cell(task, word_of_cell(side, whole, hidden), gap);
    if (lanes.lane == BlockTask::of_cell && side == Side::free) work_.add_free(task, sight);
    if (lanes.lane != BlockTask::of_block) return;
    if (side == Side::ambiguous)
      add_ambiguous(task, in_ball, at, ball.radius, on_surface);
    else if (whole)
      add_whole(task);
  }

  // Classifies one block task of a cut cluster by all lanes of a subwarp.
  __device__ void classify_clipped(PendingTask seen, const Subwarp& lanes) {
    const BlockTask& task = work_.level.block_tasks[shared_.first_tasks[seen.slot()] + seen.task()];
    const PlanarCluster& planar = planar_cluster_of(seen.slot());
    const ClipPlane plane = planar.plane;
    const TaskBall cell = task.balls[BlockTask::of_cell];
    const bool head = (task.flags & BlockTask::is_head) != 0;
    const double distance = plane.distance(cell.center);
    const Vec3 at = work_.to_surface * cell.center;
    const PlaneSide side = side_in_cut_cluster(distance, cell.radius, [&] {
      return may_be_free(work_.surface, planar.least_inverse_depth, at, cell.radius) &&
             is_free(lanes, at, cell.radius);
    });
    if (!lanes.leads()) return;
    if (head) {
      std::uint32_t word = 0;
      if (side == PlaneSide::behind) {
        tasks_.note_behind(task, plane.normal);
        if (kFloods) word = cell_bit::partial;
      }
      note_cell(task, word, distance * distance);
    }
    if ((task.flags & BlockTask::has_block) != 0 && side == PlaneSide::cut)
      tasks_.add_clipped(task, plane);
  }

  // True in the cell's lane if its ball was seen to be free, though its class does not tell. All
  // lanes read its pixels where they can.
  template <class BallClass>
  __device__ bool is_cell_free(const Subwarp& lanes, const BallClass& in_ball, Vec3 center,
                               double radius) const {
    constexpr unsigned kCell = BlockTask::of_cell;
    if constexpr (SharesPixels<Surface>) {
      const double depth = center.z + radius;
      if (!lanes.from(work_.surface.may_be_seen_past(in_ball, depth), kCell)) return false;
      const PixelRectangle own = Surface::pixels_of(in_ball);
      const PixelRectangle pixels{lanes.from(own.u0, kCell), lanes.from(own.v0, kCell),
                                  lanes.from(own.u1, kCell), lanes.from(own.v1, kCell)};
      const double farthest = lanes.from(depth, kCell);
      return is_seen_past(lanes, pixels, farthest) && lanes.lane == kCell;
    } else {
      return lanes.lane == kCell && side_of(work_.surface, in_ball, center, radius) == Side::free;
    }
  }
  __device__ bool is_seen_past(const Subwarp& lanes, const PixelRectangle& pixels,
                               double depth) const {
    return !lanes.any(!work_.surface.is_seen_past(pixels, depth, lanes.lane, lanes.width));
  }

  // True if a ball was seen to be free; all lanes read its pixels where they can.
  __device__ bool is_free(const Subwarp& lanes, Vec3 center, double radius) const {
    const auto in_ball = work_.surface.classify_ball(center, radius);
    if constexpr (SharesPixels<Surface>) {
      const double farthest = center.z + radius;
      return work_.surface.may_be_seen_past(in_ball, farthest)
                 ? is_seen_past(lanes, Surface::pixels_of(in_ball), farthest)
                 : in_ball.side == Side::free;
    } else {
      return side_of(work_.surface, in_ball, center, radius) == Side::free;
    }
  }

  // Notes a cell of a uniform cluster.
  __device__ void note_uniform(const BlockTask& task, Vec3 normal) {
    tasks_.note_behind(task, normal);
    if (!kFloods) return;
    const Vec3 at = work_.to_surface * task.balls[BlockTask::of_cell].center;
    note_cell(task, cell_bit::whole, squared_gap(work_.surface.sample(at)));
  }

  __device__ void note_cell(const BlockTask& task, std::uint32_t word, double gap) {
    const std::uint32_t i = task.cell;
    if (!kFloods) return;
    if (word != 0) atomicOr(&work_.notes.words[i], word);
    work_.space.gaps[i] = gap;
    work_.space.parents[i + 1] = i + 1;
  }

  // Returns the word to note of a cell that is `whole` behind the surface or ambiguous; counts a
  // hidden one.
  __device__ std::uint32_t word_of_cell(Side side, bool whole, bool hidden) const {
    std::uint32_t word = whole ? cell_bit::whole : 0;
    if ((whole || side == Side::ambiguous) && hidden) {
      word |= cell_bit::hidden;
      atomicAdd(&work_.counters.hidden, 1U);
    }
    return word;
  }

  // Lists the block of an ambiguous cell; its ball was classified and, where that is ambiguous,
  // sampled.
  template <class BallClass>
  __device__ void add_ambiguous(const BlockTask& task, const BallClass& in_ball, Vec3 at,
                                double radius, const SurfaceSample& on_surface) {
    if ((task.flags & BlockTask::has_block) == 0) return;
    TangentPlane tangent;
    const BlockClass found = class_of_block(
        work_.surface, in_ball, at, radius, work_.level.tool_radius, [&] { return on_surface; },
        tangent);
    if (found == BlockClass::cut)
      tasks_.add_clipped(task, {tangent, work_.to_surface});
    else if (found == BlockClass::free)
      work_.add_free(work_.level.block_masses[task.block], sight_of<Surface>(in_ball));
    else
      list_block(task, found);
  }

  // Lists the block of a cell that counts whole, or the cell itself where it is compact.
  __device__ void add_whole(const BlockTask& task) {
    const WholePart part = whole_part_of(task.flags);
    if (part == WholePart::cell)
      tasks_.add(TaskLists::pieces, {task.cell, Task::whole_cell, task.cell, 1});
    else if (part == WholePart::block)
      tasks_.add(TaskLists::pieces, {task.cell, Task::whole_block, task.block, 1});
  }

  // Lists a block of an ambiguous cell, which no plane cuts and which is not free.
  __device__ void list_block(const BlockTask& task, BlockClass found) {
    if (found == BlockClass::uncut) {
      tasks_.add(TaskLists::pieces, {task.cell, Task::block, task.block, 1});
      return;
    }
    const std::uint32_t begin = task.begin, count = task.end - begin;
    if (count <= TaskLists::kNarrow) {
      tasks_.add(TaskLists::samples_narrow, {task.cell, Task::samples, begin, count});
      return;
    }
    // Halves at a whole number of neighbours.
    constexpr std::uint32_t kTwice = 2 * kNeighborSamples;
    const std::uint32_t half =
        count > TaskLists::kWide ? (count + kTwice - 1) / kTwice * kNeighborSamples : count;
    tasks_.add(TaskLists::samples_wide, {task.cell, Task::samples, begin, half});
    if (half < count)
      tasks_.add(TaskLists::samples_wide, {task.cell, Task::samples, begin + half, count - half});
  }

  const PoseWork<Surface>& work_;
  MeasureShared& shared_;
  TaskMeasure<Surface> tasks_;
};

}  // namespace vpm::cuda
