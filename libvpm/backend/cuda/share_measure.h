// The first step of a query: what each share is to the surface, and its sums.
//
// What a cluster of shares is to the surface is decided first, by one to four threads for each
// chunk of its units, more where chunks are few: they read the surface at four places of a patch. A
// unit (block of a share) of a patch is classified by one to four threads, which read its pixels,
// others by four, which look at the balls of its share, the block and the sphere. What is to be
// measured is listed as tasks in shared memory (task_measure.h).
#pragma once

#include <climits>

#include "libvpm/backend/cuda/task_measure.h"

namespace vpm::cuda {

// Reads a surface at four places by the lanes of a tile, up to four.
struct ReadByLanes {
  static constexpr unsigned kPlaces = 4;
  Tile lanes;

  template <class Surface, class Take>
  __device__ bool operator()(const Surface& surface, const Vec3 (&places)[kPlaces],
                             const Take& take) const {
    Reading mine;
#pragma unroll 1
    for (unsigned k = 0; k < kPlaces; ++k) {
      const unsigned from = k % lanes.width, at = k + lanes.lane;
      if (from == 0)
        mine = surface.read(at == 0   ? places[0]
                            : at == 1 ? places[1]
                            : at == 2 ? places[2]
                                      : places[3]);
      Reading reading;
      reading.known = lanes.from(static_cast<int>(mine.known), from) != 0;
      reading.normal = lanes.from(mine.normal, from);
      reading.foot = lanes.from(mine.foot, from);
      if (!take(reading)) return false;
    }
    return true;
  }
};

template <class Surface>
class ShareMeasure {
 public:
  __device__ ShareMeasure(const PoseWork<Surface>& work, bool counts_points, MeasureShared& shared)
      : work_(work), counts_points_(counts_points), shared_(shared), tasks_(work, shared.lists) {}

  // By all threads of the block, for its part of the chunks. Returns what this thread has added up.
  __device__ RawResult run() { return run_inlined(); }
  __device__ __forceinline__ RawResult run_inlined() {
    if (kFloods && work_.part.part == 0 && threadIdx.x == 0) work_.space.parents[0] = 0;
    clear_seen();
    tasks_.clear();
    const Tile lanes(lanes_of_chunk());
    // Neighbours go to different warps: they often differ in what takes long.
    const unsigned of_warp = 32 / lanes.width, slots = blockDim.x / lanes.width;
    const unsigned slot = threadIdx.x % 32 / lanes.width * (slots / of_warp) + threadIdx.x / 32;
    for (unsigned first = work_.part.part; first < work_.level.chunk_count;
         first += slots * work_.part.parts) {
      const unsigned c = first + slot * work_.part.parts;
      if (c < work_.level.chunk_count) look_at(c, slot, lanes);
      __syncthreads();
      note_pushed();
      classify_seen();
      __syncthreads();
      clear_seen();
      __syncthreads();
    }
    tasks_.measure();
    return tasks_.found();
  }

 private:
  using Measure = CellMeasure<Surface>;
  static constexpr bool kFloods = !Surface::kTellsInside;
  static constexpr unsigned kLanes = 4;        // of a unit in no patch
  static constexpr unsigned kReadsOfLook = 4;  // of the surface take as long as the rest of a look
  // What a round adds to a list is at most a task of each thread: one of each unit in a patch, two
  // of each other.
  static_assert(kLanes >= 2 && kMeasureThreads <= TaskLists::kTasks);

  __device__ void clear_seen() {
    if (threadIdx.x == 0) shared_.seen_count = shared_.crossed_count = shared_.pushed_count = 0;
  }
  // More lanes have looked at a chunk sooner, fewer leave room for more chunks in a round.
  __device__ unsigned lanes_of_chunk() const {
    unsigned best = 1, least = UINT_MAX;
    for (unsigned lanes = ReadByLanes::kPlaces; lanes > 0; lanes /= 2) {
      const unsigned at_once = blockDim.x / lanes * work_.part.parts;
      const unsigned rounds = (work_.level.chunk_count + at_once - 1) / at_once;
      const unsigned reads = rounds * (kReadsOfLook + ReadByLanes::kPlaces / lanes);
      if (reads < least) best = lanes, least = reads;
    }
    return best;
  }
  // By all threads of a slot; one notes what they have seen.
  __device__ void look_at(std::uint32_t c, unsigned slot, const Tile& lanes) {
    const Chunk& chunk = work_.level.chunks[c];
    const Vec3 at = work_.to_surface * chunk.ball.center;
    const auto look = work_.surface.look_at_ball(at, chunk.ball.radius);
    if (look.side == Side::free) return;
    CrossingPlane plane;
    const ClusterClass seen = classify_cluster(chunk.ball, look, at, lanes, plane);
    if (!lanes.leads() || seen == ClusterClass::free) return;
    if (seen == ClusterClass::uniform) {
      shared_.pushed[atomicAdd(&shared_.pushed_count, 1U)] = c;
      return;
    }
    shared_.first_units[slot] = chunk.begin;
    const unsigned count = chunk.end - chunk.begin;
    const bool crossed = seen == ClusterClass::cut;
    if (crossed) {  // one by one: nvcc copies a whole that ends in padding byte by byte
      CrossedPatch& patch = patch_of(slot);
      patch.plane = plane;
      patch.least_inverse_depth = least_inverse_depth<Surface>(look);
    }
    const unsigned begin =
        crossed ? MeasureShared::kSeen - count - atomicAdd(&shared_.crossed_count, count)
                : atomicAdd(&shared_.seen_count, count);
    for (unsigned u = 0; u < count; ++u) shared_.seen[begin + u] = SeenUnit::of(slot, u, seen);
  }
  __device__ CrossedPatch& patch_of(unsigned slot) const {
    return work_.space.patches[work_.part.part * blockDim.x + slot];
  }
  template <class Look>
  __device__ ClusterClass classify_cluster(const UnitBall& ball, const Look& look, Vec3 at,
                                           const Tile& lanes, CrossingPlane& plane) {
    const double tool = work_.level.tool_reach.length;
    const ClusterClass found = class_of_cluster(work_.surface, look, at, ball.radius, tool);
    if (found == ClusterClass::no_surface && may_be_planar(ball.radius, tool))
      return class_by_middle(work_.surface, work_.surface.read(at), at, ball.radius, tool);
    TangentPlane tangent;
    if (found != ClusterClass::ambiguous ||
        !finds_cluster_plane(work_.surface, look, at, ball.radius, tool, ReadByLanes{lanes},
                             tangent))
      return found;
    plane = {tangent, work_.to_surface};
    return ClusterClass::cut;
  }
  // A thread for each unit; those of a patch find its normal together. It takes long, so the last
  // warps begin with it while the first ones deal with crossed patches.
  __device__ void note_pushed() {
    const unsigned thread = blockDim.x - 1 - threadIdx.x, u = thread % Chunk::kUnits;
    for (unsigned k = thread / Chunk::kUnits; k < shared_.pushed_count;
         k += blockDim.x / Chunk::kUnits) {
      const Chunk& chunk = work_.level.chunks[shared_.pushed[k]];
      const Vec3 at = work_.to_surface * chunk.ball.center;
      const Vec3 normal = transpose(work_.to_surface.rotation) *
                          work_.surface.closest_normal(at, work_.surface.read(at));
      if (u >= chunk.end - chunk.begin) continue;
      const Unit& unit = work_.level.units[chunk.begin + u];
      if ((unit.flags & Unit::is_head) != 0) note_pushed(unit, normal);
    }
  }
  // By rounds, before each of which the lists have room for its tasks: units of crossed patches by
  // the first warps, others by the rest. Neighbours go to different warps.
  __device__ void classify_seen() {
    const unsigned crossed_count = shared_.crossed_count, count = shared_.seen_count;
    const unsigned warps = idle_warps(), lanes = lanes_of_crossed(warps);
    const unsigned warp = threadIdx.x / 32, lane = threadIdx.x % 32;
    for (unsigned crossed = 0, others = 0; crossed < crossed_count || others < count;) {
      const unsigned first =
          warps_for_crossed(warps, warps_of(crossed_count - crossed, lanes), count - others);
      const unsigned rest = warps - first;
      if (warp < first) {
        const unsigned k = crossed + lane / lanes * first + warp;
        if (k < crossed_count)
          classify_crossed(shared_.seen[MeasureShared::kSeen - 1 - k], Tile(lanes));
      } else if (warp < warps && others + warp - first < count) {
        const unsigned k = others + lane / kLanes * rest + warp - first;
        const bool active = k < count;
        classify(shared_.seen[active ? k : 0], active);
      }
      crossed = min(crossed_count, crossed + first * (32 / lanes));
      others = min(count, others + rest * (32 / kLanes));
      tasks_.make_room(blockDim.x);
    }
  }
  __device__ static unsigned warps_of(unsigned units, unsigned lanes) {
    return (units * lanes + 31) / 32;
  }
  // But for those that still deal with pushed patches.
  __device__ unsigned idle_warps() const {
    const unsigned warps = blockDim.x / 32;
    return warps - min(warps_of(shared_.pushed_count, Chunk::kUnits), warps / 2);
  }
  // Of each unit in a crossed patch: as many as one round has.
  __device__ unsigned lanes_of_crossed(unsigned warps) const {
    const unsigned others = warps_of(shared_.seen_count, kLanes);
    unsigned lanes = kLanes;
    while (lanes > 1 && warps_of(shared_.crossed_count, lanes) + others > warps) lanes /= 2;
    return lanes;
  }
  // Where these and other units are left, each has a warp at least, and half of those to spare.
  __device__ static unsigned warps_for_crossed(unsigned warps, unsigned crossed, unsigned others) {
    if (crossed == 0 || others == 0) return crossed == 0 ? 0 : warps;
    const unsigned spare = warps - min(warps, crossed + warps_of(others, kLanes));
    return min(crossed + spare / 2, warps - 1);
  }
  __device__ void classify(SeenUnit seen, bool active);
  __device__ void classify_crossed(SeenUnit seen, const Tile& lanes);
  template <class Look>
  __device__ bool is_share_seen_past(const Tile& lanes, const Look& look, double depth) const;
  __device__ bool is_seen_past(const Tile& lanes, const PixelRectangle& pixels,
                               double depth) const {
    return !lanes.any(!work_.surface.is_seen_past(pixels, depth, lanes.lane, lanes.width));
  }
  __device__ bool is_free(const Tile& lanes, Vec3 center, double radius) const;
  __device__ void note_pushed(const Unit& unit, Vec3 normal);
  __device__ void note_share(const Unit& unit, std::uint32_t word, double gap);
  __device__ void list_block(const Unit& unit, BlockClass found);

  const PoseWork<Surface>& work_;
  bool counts_points_;
  MeasureShared& shared_;
  TaskMeasure<Surface> tasks_;
};

// By the lanes of each unit, all threads of a warp together; `active`: it is to be noted.
template <class Surface>
__device__ void ShareMeasure<Surface>::classify(SeenUnit seen, bool active) {
  const Tile lanes(kLanes);
  const Unit& unit = work_.level.units[shared_.first_units[seen.slot()] + seen.unit()];
  const UnitBall ball = unit.balls[min(lanes.lane, Unit::kBalls - 1U)];
  const std::uint32_t flags = unit.flags;
  const bool head = (flags & Unit::is_head) != 0;
  const Vec3 at = work_.to_surface * ball.center;
  decltype(work_.surface.look_at_ball(at, ball.radius)) look;
  Side own = look.side;
  if (seen.side() == Side::mixed) {
    if (lanes.lane < Unit::of_sphere || counts_points_)  // spheres hold points
      look = work_.surface.look_at_ball(at, ball.radius);
    own = look.side;
    if (is_share_seen_past(lanes, look, at.z + ball.radius)) own = Side::free;
  }
  const auto side_of = [&](unsigned lane) {
    return static_cast<Side>(lanes.from(static_cast<unsigned>(own), lane));
  };
  const Side of_share = side_of(Unit::of_share), of_sphere = side_of(Unit::of_sphere);
  const Side side = seen.side() == Side::mixed ? of_share : seen.side();

  const bool reads_share = kFloods && lanes.lane == Unit::of_share && side != Side::free;
  const bool reads_block = lanes.lane == Unit::of_block && side == Side::mixed &&
                           (flags & Unit::has_block) != 0 && look.side == Side::mixed &&
                           work_.surface.may_be_flat(look);
  Reading reading;
  if (reads_share || reads_block) reading = work_.surface.read(at, look.point);

  double gap = 0;
  bool hidden = false, whole = side == Side::behind;
  if (kFloods) {
    gap = squared_gap(reading);
    hidden = lanes.from(seen.seen() != ClusterClass::behind_near &&
                            is_hidden_share(gap, work_.level.tool_reach.length),
                        Unit::of_share);
    const bool behind = lanes.from(reading.known && reading.distance < 0, Unit::of_share);
    whole |= side == Side::uncut && behind;
  }
  if (!active) return;
  if (lanes.lane == Unit::of_share && head) {
    std::uint32_t word = whole ? kWhole : 0;
    if (side == Side::mixed && of_sphere == Side::mixed) word |= kCountsPoints;
    if ((whole || side == Side::mixed) && hidden) {
      word |= kHidden;
      atomicAdd(&work_.counters.hidden, 1U);
    }
    note_share(unit, word, gap);
  }
  if (lanes.lane != Unit::of_block) return;
  if (side == Side::mixed && (flags & Unit::has_block) != 0) {
    TangentPlane tangent;
    const BlockClass found = class_of_block(
        work_.surface, look, at, ball.radius, work_.level.tool_reach, [&] { return reading; },
        tangent);
    if (found == BlockClass::cut)
      tasks_.add_crossed(unit, {tangent, work_.to_surface});
    else
      list_block(unit, found);
  } else if (whole && (flags & Unit::is_compact) != 0) {
    if (head) tasks_.add(TaskLists::pieces, {unit.share, Task::whole_share, unit.share, 1});
  } else if (whole && (flags & Unit::has_block) != 0) {
    tasks_.add(TaskLists::pieces, {unit.share, Task::whole_block, unit.block, 1});
  }
}

// True for the share's lane if its ball, whose pixels all lanes read, was seen to be free.
template <class Surface>
template <class Look>
__device__ bool ShareMeasure<Surface>::is_share_seen_past(const Tile& lanes, const Look& look,
                                                          double depth) const {
  if constexpr (SeesFreeSpace<Surface>) {
    constexpr unsigned kShare = Unit::of_share;
    if (!lanes.from(work_.surface.may_be_seen_past(look, depth), kShare)) return false;
    const PixelRectangle pixels = lanes.from(Surface::pixels_of(look), kShare);
    const double farthest = lanes.from(depth, kShare);
    return is_seen_past(lanes, pixels, farthest) && lanes.lane == kShare;
  } else {
    return false;
  }
}

template <class Surface>
__device__ void ShareMeasure<Surface>::note_share(const Unit& unit, std::uint32_t word,
                                                  double gap) {
  const std::uint32_t i = unit.share;
  if (!kFloods) word &= kCountsPoints;
  if (word != 0) atomicOr(&work_.notes.words[i], word);
  if (!kFloods) return;
  work_.space.gaps[i] = gap;
  work_.space.parents[i + 1] = i + 1;
}

// Whether a ball is, its pixels read by all lanes.
template <class Surface>
__device__ bool ShareMeasure<Surface>::is_free(const Tile& lanes, Vec3 center,
                                               double radius) const {
  const auto look = work_.surface.look_at_ball(center, radius);
  const double farthest = center.z + radius;
  if constexpr (SeesFreeSpace<Surface>) {
    if (work_.surface.may_be_seen_past(look, farthest))
      return is_seen_past(lanes, Surface::pixels_of(look), farthest);
  }
  return look.side == Side::free;
}

// One unit of a patch that a plane crosses, by all lanes of a tile.
template <class Surface>
__device__ void ShareMeasure<Surface>::classify_crossed(SeenUnit seen, const Tile& lanes) {
  const Unit& unit = work_.level.units[shared_.first_units[seen.slot()] + seen.unit()];
  const CrossedPatch& patch = patch_of(seen.slot());
  const CrossingPlane plane = patch.plane;
  const UnitBall share = unit.balls[Unit::of_share];
  const bool head = (unit.flags & Unit::is_head) != 0;
  const double distance = plane.distance(share.center);
  const Vec3 at = work_.to_surface * share.center;
  const PlaneSide side = side_in_cut_cluster(distance, share.radius, [&] {
    return may_be_free(work_.surface, patch.least_inverse_depth, at, share.radius) &&
           is_free(lanes, at, share.radius);
  });
  if (!lanes.leads()) return;
  if (head) {
    std::uint32_t word = 0;
    if (side == PlaneSide::behind) {
      tasks_.note_behind(unit, plane.normal);
      if (kFloods) word = kPartial;
    }
    if (counts_points_) {
      const UnitBall& sphere = unit.balls[Unit::of_sphere];
      if (work_.surface.look_at_ball(work_.to_surface * sphere.center, sphere.radius).side ==
          Side::mixed)
        word |= kCountsPoints;
    }
    note_share(unit, word, distance * distance);
  }
  if ((unit.flags & Unit::has_block) != 0 && side == PlaneSide::cut)
    tasks_.add_crossed(unit, plane);
}

// A share of a patch behind the surface.
template <class Surface>
__device__ void ShareMeasure<Surface>::note_pushed(const Unit& unit, Vec3 normal) {
  tasks_.note_behind(unit, normal);
  if (!kFloods) return;
  const Vec3 at = work_.to_surface * unit.balls[Unit::of_share].center;
  note_share(unit, kWhole, squared_gap(work_.surface.read(at)));
}

// Lists a block of a mixed share.
template <class Surface>
__device__ void ShareMeasure<Surface>::list_block(const Unit& unit, BlockClass found) {
  if (found == BlockClass::free) return;
  if (found == BlockClass::uncut) {
    tasks_.add(TaskLists::pieces, {unit.share, Task::block, unit.block, 1});
    return;
  }
  const std::uint32_t begin = unit.begin, count = unit.end - begin;
  if (count <= TaskLists::kNarrow) {
    tasks_.add(TaskLists::samples_narrow, {unit.share, Task::samples, begin, count});
    return;
  }
  // Neighbours stay together.
  constexpr std::uint32_t kTwice = 2 * kNeighborSamples;
  const std::uint32_t half =
      count > TaskLists::kWide ? (count + kTwice - 1) / kTwice * kNeighborSamples : count;
  tasks_.add(TaskLists::samples_wide, {unit.share, Task::samples, begin, half});
  if (half < count)
    tasks_.add(TaskLists::samples_wide, {unit.share, Task::samples, begin + half, count - half});
}

}  // namespace vpm::cuda
