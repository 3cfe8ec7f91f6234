// The first step of a query: what each share is to the surface, and its sums.
//
// What a cluster of shares is to the surface is decided first, by a thread for each chunk of its
// units, or by four where chunks are few: they read the surface at four places of a patch at once.
// A unit (block of a share) of a patch is classified by one thread, others by four lanes, which
// look at the balls of its share, the block and the sphere. What is to be measured is listed as
// tasks in shared memory, and warps take these: a lane for each sample, or for each piece that is
// taken whole. Where no flood decides what is inside, each thread adds up what it finds.
#pragma once

#include "libvpm/query/cuda/share_tasks.h"
#include "libvpm/query/cuda/shares.h"
#include "libvpm/query/patch.h"

namespace vpm::cuda {

// Reads a surface at four places by four lanes.
struct ReadByLanes {
  static constexpr unsigned kLanes = 4;
  Tile lanes;

  template <class Surface>
  __device__ void operator()(const Surface& surface, const Vec3 (&places)[kLanes],
                             Reading (&readings)[kLanes]) const {
    const unsigned k = lanes.lane;
    const Reading mine =
        surface.read(k == 0 ? places[0] : (k == 1 ? places[1] : (k == 2 ? places[2] : places[3])));
#pragma unroll
    for (unsigned from = 0; from < kLanes; ++from) {
      readings[from].known = lanes.from(static_cast<int>(mine.known), from) != 0;
      readings[from].normal = lanes.from(mine.normal, from);
      readings[from].foot = lanes.from(mine.foot, from);
    }
  }
};

template <class Surface>
class ShareMeasure {
 public:
  __device__ ShareMeasure(const LevelView& level, const Surface& surface, const Pose& to_surface,
                          const RefinedSpace& space, unsigned turn, RefinedCounters& counters,
                          Part part, bool counts_points, MeasureShared& shared)
      : level_(level),
        surface_(surface),
        to_surface_(to_surface),
        space_(space),
        notes_(space.notes[turn % 2]),
        counters_(counters),
        part_(part),
        counts_points_(counts_points),
        shared_(shared),
        lists_(shared.lists) {}

  // By all threads of the block, for its part of the chunks. Returns what this thread has added up.
  __device__ RawResult run() {
    if (kFloods && part_.part == 0 && threadIdx.x == 0) space_.parents[0] = 0;
    clear_lists();
    const bool are_few =
        level_.chunk_count <= kFewRounds * (blockDim.x / ReadByLanes::kLanes) * part_.parts;
    const Tile lanes(are_few ? ReadByLanes::kLanes : 1);
    const unsigned slot = threadIdx.x / lanes.width, slots = blockDim.x / lanes.width;
    for (unsigned first = part_.part; first < level_.chunk_count; first += slots * part_.parts) {
      const unsigned c = first + slot * part_.parts;
      if (c < level_.chunk_count) {
        if (are_few)
          look_at(c, slot, lanes.leads(), ReadByLanes{lanes});
        else
          look_at(c, slot, true, ReadInTurn{});
      }
      __syncthreads();
      note_pushed();
      classify_seen();
      __syncthreads();
      clear_seen();
      __syncthreads();
    }
    measure_tasks();
    count_share(words_before_, bits_added_, found_);
    return found_;
  }

 private:
  using Measure = CellMeasure<Surface>;
  static constexpr bool kFloods = !Surface::kTellsInside;
  static constexpr unsigned kLanes = 4;      // of a unit in no patch
  static constexpr unsigned kFewRounds = 2;  // of more, each lane looks at a chunk of its own
  // What a round adds to a list: a task of each unit in a patch, two of each other.
  static constexpr unsigned kTasksOfRound = kThreads;
  static_assert(2 * kThreads / kLanes <= kTasksOfRound && kTasksOfRound <= TaskLists::kTasks);
  // Neighbours are measured by lanes of one tile.
  static_assert(TaskLists::kNarrow % kNeighborSamples == 0 &&
                TaskLists::kWide % kNeighborSamples == 0);

  __device__ void clear_lists() {
    clear_seen();
    clear_task_lists();
  }
  __device__ void clear_seen() {
    if (threadIdx.x == 0) shared_.seen_count = shared_.crossed_count = shared_.pushed_count = 0;
  }
  // By all threads of a slot; one notes what they have seen.
  template <class ReadAll>
  __device__ void look_at(std::uint32_t c, unsigned slot, bool notes, const ReadAll& read_all) {
    const Chunk& chunk = level_.chunks[c];
    const Vec3 at = to_surface_ * chunk.ball.center;
    const auto look = surface_.look_at_ball(at, chunk.ball.radius);
    if (look.side == Side::free) return;
    CrossingPlane plane;
    const Seen seen = what_is_seen(chunk.ball, look, at, read_all, plane);
    if (!notes || seen == Seen::free) return;
    if (seen == Seen::pushed) {
      shared_.pushed[atomicAdd(&shared_.pushed_count, 1U)] = c;
      return;
    }
    shared_.first_units[slot] = chunk.begin;
    const unsigned count = chunk.end - chunk.begin;
    const bool crossed = seen == Seen::crossed;
    if (crossed) plane_of(slot) = plane;
    const unsigned begin =
        crossed ? MeasureShared::kSeen - count - atomicAdd(&shared_.crossed_count, count)
                : atomicAdd(&shared_.seen_count, count);
    for (unsigned u = 0; u < count; ++u) shared_.seen[begin + u] = SeenUnit::of(slot, u, seen);
  }
  __device__ CrossingPlane& plane_of(unsigned slot) const {
    return space_.planes[part_.part * blockDim.x + slot];
  }
  template <class Look, class ReadAll>
  __device__ Seen what_is_seen(const UnitBall& ball, const Look& look, Vec3 at,
                               const ReadAll& read_all, CrossingPlane& plane) {
    const bool patch = is_patch(ball.radius, level_.tool_reach.length);
    if (look.side == Side::uncut) {
      if (!patch) return Seen::uncut;
      switch (open_patch(surface_, surface_.read(at), at, ball.radius, level_.tool_reach.length)) {
        case OpenPatch::free:
          return Seen::free;
        case OpenPatch::behind:
          return Seen::behind;
        case OpenPatch::near:
          return Seen::behind_near;
        case OpenPatch::pushed:
          return Seen::pushed;
      }
    }
    if (look.side == Side::mixed) {
      TangentPlane tangent;
      if (!patch || !sees_patch(surface_, look, at, ball.radius, read_all, tangent))
        return Seen::mixed;
      plane = {tangent, to_surface_};
      return Seen::crossed;
    }
    if (!(surface_.largest_gap(look, at, ball.radius) < level_.tool_reach.length))
      return Seen::behind;
    return patch ? Seen::pushed : Seen::behind_near;
  }
  // A thread for each unit; those of a patch find its normal together. It takes long, so the last
  // warps begin with it while the first ones deal with crossed patches.
  __device__ void note_pushed() {
    const unsigned thread = blockDim.x - 1 - threadIdx.x, u = thread % Chunk::kUnits;
    for (unsigned k = thread / Chunk::kUnits; k < shared_.pushed_count;
         k += blockDim.x / Chunk::kUnits) {
      const Chunk& chunk = level_.chunks[shared_.pushed[k]];
      const Vec3 at = to_surface_ * chunk.ball.center;
      const Vec3 normal =
          transpose(to_surface_.rotation) * surface_.closest_normal(at, surface_.read(at));
      if (u >= chunk.end - chunk.begin) continue;
      const Unit& unit = level_.units[chunk.begin + u];
      if ((unit.flags & Unit::is_head) != 0) note_pushed(unit, normal);
    }
  }
  // By rounds, before each of which the lists have room for its tasks: units of crossed patches by
  // the first warps, a thread each, others by the next, kLanes each.
  __device__ void classify_seen() {
    const unsigned crossed = shared_.crossed_count, lanes = kLanes * shared_.seen_count;
    const unsigned others = (crossed + 31) / 32 * 32;  // the first of their threads
    for (unsigned first = 0; first < others + lanes; first += blockDim.x) {
      const unsigned thread = first + threadIdx.x;
      if (thread < crossed) {
        classify_crossed(shared_.seen[MeasureShared::kSeen - 1 - thread]);
      } else if (thread >= others && thread - thread % 32 < others + lanes) {
        const unsigned k = (thread - others) / kLanes;
        const bool active = k < shared_.seen_count;
        classify(shared_.seen[active ? k : 0], active);
      }
      make_room();
    }
  }
  __device__ void make_room() {
    __syncthreads();
    bool room = true;
    for (unsigned k = 0; k < TaskLists::kLists; ++k)
      room &= lists_.counts[k] + kTasksOfRound <= TaskLists::kTasks;
    if (__syncthreads_and(room) != 0) return;
    measure_tasks();
    __syncthreads();
    clear_task_lists();
  }
  __device__ void clear_task_lists() {
    if (threadIdx.x < TaskLists::kLists) lists_.counts[threadIdx.x] = 0;
    if (threadIdx.x == TaskLists::kLists) lists_.next_bundle = 0;
    __syncthreads();
  }
  __device__ Measure measure_of(const CellView& view) const {
    return {surface_, to_surface_, level_.tool_reach, view};
  }
  __device__ FlatBlock& flat(unsigned list, unsigned slot) const {
    const unsigned row = 2 * part_.part + (list == TaskLists::flat_wide);
    return space_.flats[row * TaskLists::kTasks + slot];
  }

  __device__ void classify(SeenUnit seen, bool active);
  __device__ void classify_crossed(SeenUnit seen);
  template <class Look>
  __device__ bool is_seen_past(const Tile& lanes, Side side, const Look& look, double depth) const;
  __device__ void note_pushed(const Unit& unit, Vec3 normal);
  __device__ void note_share(const Unit& unit, std::uint32_t word, double gap);
  __device__ void note_behind(const Unit& unit, Vec3 normal);
  __device__ void list_block(const Unit& unit, Side side);
  __device__ void list_crossed(const Unit& unit, const CrossingPlane& plane);
  __device__ void measure_tasks();
  __device__ void measure(const Tile& tile, unsigned list, unsigned slot, const Task& task);
  __device__ SharePiece piece(Task::Form form, std::uint32_t k) const {
    switch (form) {
      case Task::samples:
        return piece_of(level_.samples[k]);
      case Task::whole_share:
        return piece_of(level_.share_masses[k], level_.cell(k));
      default:
        return piece_of(level_.block_masses[k], level_.blocks[k]);
    }
  }
  __device__ void add_piece(const Tile& tile, const Measure& measure, const Task& task,
                            std::uint32_t k, CellResult& result);
  __device__ static unsigned first_neighbor(const Tile& tile, bool shares);
  __device__ void add_flat(const Tile& tile, const Measure& measure, const FlatBlock& flat,
                           const Task& task, CellResult& result);
  __device__ void note_task(const Task& task, const CellResult& result);
  __device__ void count(std::uint32_t share, std::uint32_t bits);

  const LevelView& level_;
  const Surface& surface_;
  const Pose& to_surface_;
  const RefinedSpace& space_;
  const ShareNotes& notes_;
  RefinedCounters& counters_;
  Part part_;
  bool counts_points_;
  MeasureShared& shared_;
  TaskLists& lists_;
  RawResult found_;
  std::uint32_t words_before_ = 0, bits_added_ = 0;  // of the share that was noted last
};

// By the lanes of each unit, all threads of a warp together; `active`: it is to be noted.
template <class Surface>
__device__ void ShareMeasure<Surface>::classify(SeenUnit seen, bool active) {
  const Tile lanes(kLanes);
  const Unit& unit = level_.units[shared_.first_units[seen.slot()] + seen.unit()];
  const UnitBall ball = unit.balls[min(lanes.lane, Unit::kBalls - 1U)];
  const std::uint32_t flags = unit.flags;
  const bool head = (flags & Unit::is_head) != 0;
  const Vec3 at = to_surface_ * ball.center;
  decltype(surface_.look_at_ball(at, ball.radius)) look;
  Side own = look.side;
  if (seen.side() == Side::mixed) {
    look = surface_.look_at_ball(at, ball.radius);
    own = look.side;
    if (is_seen_past(lanes, own, look, at.z + ball.radius)) own = Side::free;
  }
  const auto side_of = [&](unsigned lane) {
    return static_cast<Side>(lanes.from(static_cast<unsigned>(own), lane));
  };
  const Side of_share = side_of(Unit::of_share), of_sphere = side_of(Unit::of_sphere);
  const Side side = seen.side() == Side::mixed ? of_share : seen.side();

  const bool reads_share = kFloods && lanes.lane == Unit::of_share && side != Side::free;
  const bool reads_block = lanes.lane == Unit::of_block && side == Side::mixed &&
                           (flags & Unit::has_block) != 0 && look.side == Side::mixed &&
                           surface_.may_be_flat(look);
  Reading reading;
  if (reads_share || reads_block) reading = surface_.read(at, look.point);

  double gap = 0;
  bool hidden = false, whole = side == Side::behind;
  if (kFloods) {
    gap = squared_gap(reading);
    hidden = lanes.from(
        seen.seen() != Seen::behind_near && is_hidden_share(gap, level_.tool_reach.length),
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
      atomicAdd(&counters_.hidden, 1U);
    }
    note_share(unit, word, gap);
  }
  if (lanes.lane != Unit::of_block) return;
  if (side == Side::mixed && (flags & Unit::has_block) != 0) {
    TangentPlane tangent;
    const Measure measure = measure_of(
        {.center = unit.balls[Unit::of_share].center, .reach = unit.balls[Unit::of_share].radius});
    const bool is_flat =
        reads_block &&
        surface_.is_flat(look, reading, measure.flat_tolerance(ball.radius), tangent) &&
        measure.is_of_one_wall(at, ball.radius, tangent, look.point);
    if (is_flat)
      list_crossed(unit, {tangent, to_surface_});
    else
      list_block(unit, look.side);
  } else if (whole && (flags & Unit::is_compact) != 0) {
    if (head) lists_.add(TaskLists::pieces, {unit.share, Task::whole_share, unit.share, 1});
  } else if (whole && (flags & Unit::has_block) != 0) {
    lists_.add(TaskLists::pieces, {unit.share, Task::whole_block, unit.block, 1});
  }
}

// Whether the share's lane has looked at a ball that is free, its pixels read by all lanes. (Of a
// surface without pixels, what the look says stands.)
template <class Surface>
template <class Look>
__device__ bool ShareMeasure<Surface>::is_seen_past(const Tile& lanes, Side side, const Look& look,
                                                    double depth) const {
  constexpr unsigned kShare = Unit::of_share;
  if (static_cast<Side>(lanes.from(static_cast<unsigned>(side), kShare)) != Side::mixed)
    return false;
  const PixelRectangle of_share = lanes.from(Surface::pixels_of(look), kShare);
  const double farthest = lanes.from(depth, kShare);
  const bool past = surface_.is_seen_past(of_share, farthest, lanes.lane, lanes.width);
  return !lanes.any(!past) && lanes.lane == kShare;
}

template <class Surface>
__device__ void ShareMeasure<Surface>::note_share(const Unit& unit, std::uint32_t word,
                                                  double gap) {
  const std::uint32_t i = unit.share;
  if (!kFloods) word &= kCountsPoints;
  if (word != 0) atomicOr(&notes_.words[i], word);
  if (!kFloods) return;
  space_.gaps[i] = gap;
  space_.parents[i + 1] = i + 1;
}

// A share wholly behind the surface of its patch.
template <class Surface>
__device__ void ShareMeasure<Surface>::note_behind(const Unit& unit, Vec3 normal) {
  ToolSum sum;
  add_whole(level_.tool_reach, level_.share_masses[unit.share], normal, sum);
  if (kFloods) {
    notes_.sums[unit.share] = sum;
  } else {
    found_.sum.add(sum);
    if (sum.volume.value != 0) count(unit.share, kCounted);
  }
}

// One unit of a patch that a plane crosses.
template <class Surface>
__device__ void ShareMeasure<Surface>::classify_crossed(SeenUnit seen) {
  const Unit& unit = level_.units[shared_.first_units[seen.slot()] + seen.unit()];
  const CrossingPlane plane = plane_of(seen.slot());
  const UnitBall share = unit.balls[Unit::of_share];
  const bool head = (unit.flags & Unit::is_head) != 0;
  const double distance = plane.distance(share.center);
  const Vec3 at = to_surface_ * share.center;
  const bool free =
      !(distance < share.radius) || (surface_.may_be_free(at, share.radius) &&
                                     surface_.side_of_ball(at, share.radius) == Side::free);
  const bool behind = !free && distance <= -share.radius;
  if (head) {
    std::uint32_t word = 0;
    if (behind) {
      note_behind(unit, plane.normal);
      if (kFloods) word = kPartial;
    }
    if (counts_points_) {
      const UnitBall& sphere = unit.balls[Unit::of_sphere];
      if (surface_.look_at_ball(to_surface_ * sphere.center, sphere.radius).side == Side::mixed)
        word |= kCountsPoints;
    }
    note_share(unit, word, distance * distance);
  }
  if ((unit.flags & Unit::has_block) != 0 && !free && !behind) list_crossed(unit, plane);
}

// A share of a patch behind the surface.
template <class Surface>
__device__ void ShareMeasure<Surface>::note_pushed(const Unit& unit, Vec3 normal) {
  note_behind(unit, normal);
  if (!kFloods) return;
  const Vec3 at = to_surface_ * unit.balls[Unit::of_share].center;
  note_share(unit, kWhole, squared_gap(surface_.read(at)));
}

// Lists a block of a mixed share.
template <class Surface>
__device__ void ShareMeasure<Surface>::list_block(const Unit& unit, Side side) {
  if (side == Side::free) return;
  if (side != Side::mixed) {
    lists_.add(TaskLists::pieces, {unit.share, Task::block, unit.block, 1});
    return;
  }
  const std::uint32_t begin = unit.begin, count = unit.end - begin;
  if (count <= TaskLists::kNarrow) {
    lists_.add(TaskLists::samples_narrow, {unit.share, Task::samples, begin, count});
    return;
  }
  // Neighbours stay together.
  constexpr std::uint32_t kTwice = 2 * kNeighborSamples;
  const std::uint32_t half =
      count > TaskLists::kWide ? (count + kTwice - 1) / kTwice * kNeighborSamples : count;
  lists_.add(TaskLists::samples_wide, {unit.share, Task::samples, begin, half});
  if (half < count)
    lists_.add(TaskLists::samples_wide, {unit.share, Task::samples, begin + half, count - half});
}

// Lists a block where the surface is one plane, if the plane crosses it.
template <class Surface>
__device__ void ShareMeasure<Surface>::list_crossed(const Unit& unit, const CrossingPlane& plane) {
  const UnitBall& ball = unit.balls[Unit::of_block];
  const double distance = plane.distance(ball.center);
  const Task task{unit.share, Task::samples, unit.begin, unit.end - unit.begin};
  if (distance > -ball.radius && distance < ball.radius) {
    const unsigned list =
        task.count <= TaskLists::kNarrow ? TaskLists::flat_narrow : TaskLists::flat_wide;
    // Member by member: the whole would be stored byte by byte.
    FlatBlock& block = flat(list, lists_.add(list, task));
    block.plane = plane;
    block.block = unit.block;
    return;
  }
  CellResult result;
  if (distance <= -ball.radius)
    add_whole(level_.tool_reach, level_.block_masses[unit.block], plane.normal, result.sum);
  note_task(task, result);
}

// Warps take bundles of tasks of one list, as many as have room in a warp; those that take longest
// first.
template <class Surface>
__device__ void ShareMeasure<Surface>::measure_tasks() {
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
__device__ void ShareMeasure<Surface>::measure(const Tile& tile, unsigned list, unsigned slot,
                                               const Task& task) {
  const std::uint32_t i = task.share;
  const Measure measure = measure_of(
      {.samples = level_.samples, .center = level_.centers[i], .reach = level_.reach[i]});
  CellResult result;
  if (TaskLists::is_flat(list)) {
    add_flat(tile, measure, flat(list, slot), task, result);
  } else {
    for (std::uint32_t begin = 0; begin < task.count; begin += tile.width)
      add_piece(tile, measure, task, begin + tile.lane, result);
    __syncwarp(tile.mask);
    add_up(tile, result.sum);
    if (tile.any(result.plane.count > 0)) add_up(tile, result.plane);
    result.is_far = tile.any(result.is_far);
  }
  if (tile.leads()) note_task(task, result);
}

// What piece `k` of a task, if there is one, adds to CellMeasure::run() or, where its share is
// whole, to whole(). Far pieces are listed. By all threads of a tile.
template <class Surface>
__device__ void ShareMeasure<Surface>::add_piece(const Tile& tile, const Measure& measure,
                                                 const Task& task, std::uint32_t k,
                                                 CellResult& result) {
  const bool exists = k < task.count;
  const SharePiece piece = this->piece(task.form, task.begin + (exists ? k : 0));
  const typename Measure::PieceLook look = measure.look_at(piece);
  const bool inside = exists && look.is_inside, cut = Measure::is_cut(piece, look);
  const bool shares =
      exists && task.form == Task::samples && Measure::shares_direction(piece, look);
  const unsigned first = Surface::kSearchesFoot ? first_neighbor(tile, shares) : tile.lane;
  Vec3 normal;
  if (inside && !cut && first == tile.lane) normal = measure.closest_normal(look);
  if (Surface::kSearchesFoot) normal = tile.from(normal, first);
  if (!inside) return;
  result.is_far |= look.is_far;
  if (!task.is_whole() && cut) measure.add_to_plane(look, result.plane);
  ToolSum sum;
  if (cut)
    measure.add_cut(piece, look, sum);
  else
    measure.add_behind(piece, look, normal, surface_, sum);
  if (look.is_far) {
    // Member by member: the whole would be stored byte by byte.
    FarPiece& far = space_.far[atomicAdd(&counters_.far, 1U)];
    far.at = look.x;
    far.foot = look.reading.foot;
    far.sum = sum;
    far.share = task.share;
    return;
  }
  result.sum.add(sum);
}

// The first lane of those that share a direction with this one; itself where it has its own.
template <class Surface>
__device__ unsigned ShareMeasure<Surface>::first_neighbor(const Tile& tile, bool shares) {
  const unsigned begin = tile.lane / kNeighborSamples * kNeighborSamples;
  const unsigned sharing = tile.which(shares) >> begin;
  return shares ? begin + static_cast<unsigned>(__ffs(static_cast<int>(sharing))) - 1 : tile.lane;
}

// The weights of the samples by all threads, their sums in the samples' order by four. The result
// is there for the first thread of the tile.
template <class Surface>
__device__ void ShareMeasure<Surface>::add_flat(const Tile& tile, const Measure& measure,
                                                const FlatBlock& flat, const Task& task,
                                                CellResult& result) {
  const unsigned slot = threadIdx.x - tile.lane;
  bool is_cut = false;
  double sum = 0;  // of this thread's row of terms
#pragma unroll 1
  for (std::uint32_t begin = 0; begin < task.count; begin += tile.width) {
    const std::uint32_t k = begin + tile.lane;
    const CellSample sample = level_.samples[task.begin + (k < task.count ? k : 0)];
    const double inside = k < task.count ? weight_behind(sample, flat.plane, is_cut) : 0;
    const Vec3 moment = inside != 0 ? inside * widen(sample.center) : Vec3{};
    shared_.terms[0][slot + tile.lane] = inside;
    shared_.terms[1][slot + tile.lane] = moment.x;
    shared_.terms[2][slot + tile.lane] = moment.y;
    shared_.terms[3][slot + tile.lane] = moment.z;
    __syncwarp(tile.mask);
    const unsigned count = min(tile.width, task.count - begin);
    if (tile.lane < 4) {
#pragma unroll 4
      for (unsigned t = 0; t < count; ++t) sum += shared_.terms[tile.lane][slot + t];
    }
    __syncwarp(tile.mask);
  }
  is_cut = tile.any(is_cut);
  const double sums[4] = {tile.from(sum, 0), tile.from(sum, 1), tile.from(sum, 2),
                          tile.from(sum, 3)};
  if (!tile.leads()) return;
  measure.add_crossed(level_.blocks[flat.block], flat.plane,
                      {sums[0], {sums[1], sums[2], sums[3]}, is_cut}, result);
}

// By one thread, what all threads of its tile have found.
template <class Surface>
__device__ void ShareMeasure<Surface>::note_task(const Task& task, const CellResult& result) {
  const std::uint32_t i = task.share;
  const bool cut = result.plane.count > 0;
  if (kFloods) {
    const bool partial = !task.is_whole() && (result.sum.volume.value > 0 || result.is_far);
    const std::uint32_t bits = (cut ? kCut | kSummed : 0) | (partial ? kPartial : 0);
    if (bits != 0) atomicOr(&notes_.words[i], bits);
    add_atomically(result.sum, notes_.sums[i]);
  } else {
    found_.sum.add(result.sum);
    if (cut || result.sum.volume.value != 0) count(i, kCounted | (cut ? kCut : 0));
  }
  if (cut) add_atomically(result.plane, notes_.planes[i]);
}

// Notes that a share counts; others may do so too. What its word was is needed only when the next
// one comes, so that nobody waits for it.
template <class Surface>
__device__ void ShareMeasure<Surface>::count(std::uint32_t share, std::uint32_t bits) {
  count_share(words_before_, bits_added_, found_);
  words_before_ = atomicOr(&notes_.words[share], bits);
  bits_added_ = bits;
}

}  // namespace vpm::cuda
