// Runs the first step of a query where a camera has seen the surface, for a level with no more task
// groups than a launch has warps: each warp takes one group and waits for no other. It classifies
// the group's cells and sums what is behind the surface by no more than the tool radius.
//
// Each block task has 4 or 16 lanes of the warp. A launch takes as long as its slowest warp, so
// what may be needed is computed side by side, before it is known whether it is. Loading
// instructions takes longest, so each step stands in the code once, and all lanes go through it
// together.
#pragma once

#include <type_traits>

#include "libvpm/backend/cuda/cell_notes.h"
#include "libvpm/scene/depth/depth_surface.h"

namespace vpm::cuda {

// Lays out a warp's shared memory for the task group at hand.
struct alignas(16) ImageShared {
  // What the lanes of a block task tell one another.
  struct OfTask {
    Side cell = Side::free;
    BlockClass block = BlockClass::free;
    Sight sight_of_cell = Sight::seen, sight_of_block = Sight::seen;
    bool asks_pixels = false;  // its pixels may show the cell to be free
    bool may_be_free = false;
    ClipPlane plane;        // set for a cut block
    PixelRectangle pixels;  // the cell's
    double farthest = 0;    // depth of the farthest place of the cell's ball, m
  };
  // The class of the cluster's ball, its middle (surface frame, m), and the surface sampled at the
  // middle and at four places about it.
  DepthSurface::BallClass in_ball;
  Vec3 middle;
  SurfaceSample on_surface, around[kPlacesAround];
  Vec3 normal;  // along which a uniform cluster is pushed
  OfTask tasks[TaskGroup::kTasks];
};

// Samples the surface at the four places about a cluster's middle, each by one lane of a warp. The
// middle has been sampled before.
struct SampleByWarp {
  ImageShared& shared;

  __device__ SurfaceSample middle(const DepthSurface&, const Vec3&) const {
    return shared.on_surface;
  }
  template <class Take>
  __device__ bool operator()(const DepthSurface& surface, const Vec3 (&places)[kPlacesAround],
                             const Take& take) const {
    const unsigned lane = threadIdx.x % 32;
    if (lane < kPlacesAround) shared.around[lane] = surface.sample(place_of(places, lane));
    __syncwarp();
    for (const SurfaceSample& around : shared.around)
      if (!take(around)) return false;
    return true;
  }
};

// Measures one task group by all lanes of a warp. `Found` is what is computed per block task:
// TaskSums or, in a second pass that few queries need, ContactPlane.
template <class Found>
class ImageTaskGroup {
 public:
  // Takes the number of `lanes` per block task.
  __device__ ImageTaskGroup(const PoseWork<DepthSurface>& work, const TaskGroup& group,
                            const WarpTask* tasks, unsigned lanes, ImageShared& shared,
                            ImageSums& sums)
      : work_(work),
        group_(group),
        cluster_(group.ball),
        lanes_(lanes),
        lane_(threadIdx.x % lanes),
        task_(tasks[threadIdx.x % 32 / lanes]),
        flags_(task_.flags),
        begin_(task_.begin),
        end_(task_.end),
        shared_(shared),
        seen_(shared.tasks[threadIdx.x % 32 / lanes]),
        sums_(sums) {}

  __device__ void measure() {
    classify_balls();
    measure_tasks();
  }

 private:
  static constexpr bool kFindsPlanes = std::is_same_v<Found, ContactPlane>;
  using Measure = CellMeasure<DepthSurface>;
  using PieceSample = Measure::PieceSample;

  // Lanes of a task that classify its balls, and the lane of the warp that classifies the
  // cluster's.
  static constexpr unsigned kOfCell = BlockTask::of_cell, kOfBlock = BlockTask::of_block,
                            kOfCluster = BlockTask::kBalls;

  // How a block task counts.
  enum class Counts {
    not_at_all,
    uniform,     // its cell is behind the surface of a planar cluster
    by_plane,    // a plane cuts its block
    whole_cell,  // its cell is behind the surface
    whole_block,
    by_samples,  // sample by sample
  };

  __device__ void measure_tasks() {
    if (shared_.in_ball.side == Side::free) return add_free_group();
    Found found;
    const Counts counts = classify();
    measure_pieces(counts, found);
    measure_by_plane(counts, found);
    if (counts != Counts::not_at_all && lane_ == 0) sums_.note(task_, found);
  }
  // Adds what was not seen of a part that is free. The pass that finds planes adds nothing.
  template <class Part>
  __device__ void add_free(const Part& part, Sight sight) const {
    if constexpr (!kFindsPlanes) work_.add_free(part, sight);
  }
  // Adds what was not seen of a group that is wholly free.
  __device__ void add_free_group() {
    const Sight sight = DepthSurface::sight_of(shared_.in_ball);
    if (sight == Sight::mixed)
      add_free_task(sight);
    else if (threadIdx.x % 32 == 0)
      add_free(group_, sight);
  }
  // Adds what was not seen of a task whose cell is free, by the sight of that or of the group.
  __device__ void add_free_task(Sight sight) {
    if (lane_ == 0) add_free(task_, sight);
  }

  __device__ bool is_of_cluster() const { return threadIdx.x % 32 == kOfCluster; }
  __device__ bool is(BlockTask::Flag flag) const { return (flags_ & flag) != 0; }
  __device__ Measure measure_of_cell() const {
    const TaskBall& cell = task_.balls[kOfCell];
    return work_.measure_of(
        {.center = cell.center, .radius = cell.radius, .faces = work_.level.faces});
  }
  // True for all lanes of a task if `value` is true for any of them.
  __device__ bool any(bool value) const {
    const unsigned mask = (1U << lanes_) - 1;
    return (__ballot_sync(~0U, value) >> (threadIdx.x % 32 - lane_) & mask) != 0;
  }

  // Adds up over the lanes of a task; all of them receive the sum.
  template <class Sum>
  __device__ void add_up(Sum& sum) const {
    std::int64_t* const terms = terms_of(sum);
#pragma unroll 1
    for (unsigned half = lanes_ / 2; half > 0; half /= 2) {
#pragma unroll
      for (int k = 0; k < kTerms; ++k) terms[k] += __shfl_xor_sync(~0U, terms[k], half);
    }
  }

  // Classifies the balls of cell, block and cluster, one by each of three lanes, and shares what
  // the other lanes need of them.
  __device__ void classify_balls() {
    const bool is_of_task = lane_ < BlockTask::kBalls;
    const TaskBall ball = is_of_task ? task_.balls[lane_] : cluster_;
    radius_ = ball.radius;
    middle_ = work_.to_surface * ball.center;
    in_ball_ = work_.surface.classify_ball(middle_, radius_);
    __syncwarp();  // all lanes are done with the last group
    if (is_of_cluster()) {
      shared_.in_ball = in_ball_;
      shared_.middle = middle_;
    }
    if (lane_ == kOfCell) {
      seen_.cell = in_ball_.side;
      seen_.sight_of_cell = DepthSurface::sight_of(in_ball_);
      seen_.farthest = middle_.z + radius_;
      seen_.asks_pixels = work_.surface.may_be_seen_past(in_ball_, seen_.farthest);
      seen_.pixels = in_ball_.pixels;
    }
    __syncwarp();
  }

  __device__ Counts classify() {
    const ClusterClass found = class_of_cluster(work_.surface, shared_.in_ball, shared_.middle,
                                                cluster_.radius, work_.level.tool_radius.length);
    switch (found) {
      case ClusterClass::ambiguous:
        return sees_plane() ? classify_clipped() : classify_alone(Side::ambiguous);
      case ClusterClass::uniform:
        return is(BlockTask::is_head) ? Counts::uniform : Counts::not_at_all;
      case ClusterClass::free:
        return Counts::not_at_all;
      default:
        return classify_alone(side_of_cells(found));
    }
  }

  // True if the surface passes through the cluster as one plane, plane_. Samples it in the middles
  // of the cluster and of the blocks together, then at four places about the cluster's middle.
  __device__ bool sees_plane() {
    const double tool_radius = work_.level.tool_radius.length;
    const bool may_be =
        may_have_plane(work_.surface, shared_.in_ball, cluster_.radius, tool_radius);
    if (is_of_cluster() ? may_be : lane_ == kOfBlock && is(BlockTask::has_block))
      on_surface_ = work_.surface.sample(middle_);
    if (is_of_cluster()) shared_.on_surface = on_surface_;
    __syncwarp();
    TangentPlane tangent;
    if (!finds_cluster_plane(work_.surface, shared_.in_ball, shared_.middle, cluster_.radius,
                             tool_radius, SampleByWarp{shared_}, tangent))
      return false;
    plane_ = {tangent, work_.to_surface};
    return true;
  }

  // Classifies a task of a cluster that is cut by plane_.
  __device__ Counts classify_clipped() {
    const TaskBall& cell = task_.balls[kOfCell];
    const double distance = plane_.distance(cell.center);
    const bool may_be_free = side_of_plane(distance, cell.radius) != PlaneSide::before &&
                             (seen_.cell == Side::free || seen_.asks_pixels);
    const bool is_free = __any_sync(~0U, may_be_free) != 0 && is_free_in_cluster(may_be_free);
    switch (side_in_cut_cluster(distance, cell.radius, [&] { return is_free; })) {
      case PlaneSide::before:
        break;
      case PlaneSide::behind:
        return is(BlockTask::is_head) ? Counts::uniform : Counts::not_at_all;
      case PlaneSide::cut:
        return is(BlockTask::has_block) ? Counts::by_plane : Counts::not_at_all;
    }
    return Counts::not_at_all;
  }

  // True if the cell's own pixels show it free though it is behind the plane. Call from all lanes.
  __device__ bool is_free_in_cluster(bool may_be_free) {
    if (lane_ == kOfCell)
      seen_.may_be_free =
          may_be_free && work_.surface.may_be_free(
                             DepthSurface::least_inverse_depth(shared_.in_ball), middle_, radius_);
    __syncwarp();
    return side_of_cell(seen_.may_be_free) == Side::free && seen_.may_be_free;
  }

  // Classifies a task of a cluster that is not planar.
  __device__ Counts classify_alone(Side side) {
    if (side == Side::ambiguous) {
      side = side_of_cell(true);
      const bool asks_block = side == Side::ambiguous && is(BlockTask::has_block);
      if (lane_ == kOfBlock && asks_block) classify_block();
      __syncwarp();
      if (asks_block) {
        plane_ = seen_.plane;
        switch (seen_.block) {
          case BlockClass::free:
            if (lane_ == 0) add_free(task_.block_mass, seen_.sight_of_block);
            return Counts::not_at_all;
          case BlockClass::uncut:
            return Counts::whole_block;
          case BlockClass::cut:
            return Counts::by_plane;
          case BlockClass::ambiguous:
            return Counts::by_samples;
        }
      }
      if (side == Side::ambiguous) return Counts::not_at_all;
    }
    if (side == Side::free) {
      add_free_task(seen_.sight_of_cell);
      return Counts::not_at_all;
    }
    const WholePart part = whole_part_of(flags_);
    return part == WholePart::cell    ? Counts::whole_cell
           : part == WholePart::block ? Counts::whole_block
                                      : Counts::not_at_all;
  }

  // Returns the side of the cell; if `asks`, its pixels may show it to be free.
  __device__ Side side_of_cell(bool asks) {
    asks = asks && seen_.asks_pixels;
    if (__any_sync(~0U, asks) == 0) return seen_.cell;
    const bool is_past =
        asks && work_.surface.is_seen_past(seen_.pixels, seen_.farthest, lane_, lanes_);
    const bool is_near = any(asks && !is_past);
    return asks && !is_near ? Side::free : seen_.cell;
  }

  // Classifies the block in its lane: the surface may pass through it as one plane.
  __device__ void classify_block() {
    TangentPlane tangent;
    seen_.block = class_of_block(
        work_.surface, in_ball_, middle_, radius_, work_.level.tool_radius,
        [&] { return on_surface_; }, tangent);
    seen_.sight_of_block = DepthSurface::sight_of(in_ball_);
    if (seen_.block == BlockClass::cut) seen_.plane = {tangent, work_.to_surface};
  }

  // Returns false if this lane has no piece in this turn. Otherwise gives a sample, or a block or
  // cell taken whole, and its place x in the surface's frame.
  __device__ bool take_piece(Counts counts, unsigned turn, ToolPiece& piece, Vec3& x) const {
    if (counts == Counts::by_samples) {
      const std::uint32_t k = begin_ + turn * lanes_ + lane_;
      if (k >= end_) return false;
      piece = piece_of(work_.level.samples[k], work_.level.faces);
    } else {
      if (counts != Counts::whole_cell && counts != Counts::whole_block) return false;
      if (turn > 0 || lane_ != 0) return false;
      const BlockMass& mass = counts == Counts::whole_cell ? task_.cell_mass : task_.block_mass;
      piece = {mass.centroid, {}, mass.weight};
    }
    x = work_.to_surface * piece.at;
    return true;
  }

  // Measures pieces one by one, and finds the way out of the middle of a uniform cluster.
  __device__ void measure_pieces(Counts counts, Found& found) {
    const bool finds_way =
        __any_sync(~0U, counts == Counts::uniform) != 0 && shared_.in_ball.side == Side::behind;
    const bool adds_up = __any_sync(~0U, counts == Counts::by_samples) != 0;
    for (unsigned turn = 0;; ++turn) {
      ToolPiece piece;
      Vec3 x = shared_.middle;
      const bool exists =
          finds_way ? turn == 0 && is_of_cluster() : take_piece(counts, turn, piece, x);
      if (__any_sync(~0U, exists) == 0) break;
      const Vec3 way = measure_piece(piece, x, exists, counts == Counts::by_samples, found);
      if (finds_way && exists) shared_.normal = transpose(work_.to_surface.rotation) * way;
    }
    if (finds_way) {
      __syncwarp();
      plane_.normal = shared_.normal;
    }
    if (!adds_up) return;
    if constexpr (kFindsPlanes) {
      add_up(found);
    } else {
      add_up(found.sum);
      found.is_cut = any(found.is_cut);
    }
  }

  // Measures a piece; lanes without one take part with weight 0. Neighbouring samples are pushed in
  // one direction. Returns the way out of a piece that is wholly inside.
  __device__ Vec3 measure_piece(const ToolPiece& piece, Vec3 x, bool exists, bool is_sample,
                                Found& found) {
    const Measure measure = measure_of_cell();
    const unsigned lane = threadIdx.x % 32;
    unsigned leader = lane;
    bool is_inside = false, searches = false, wants = exists;
    Vec3 place = x;
    PieceSample sampled;
    FootSearch<double> search;
#pragma unroll 1
    for (bool is_first = true;; is_first = false) {
      SurfaceSample on_surface;
      FootSearch<double>::Neighbors beside;
      if (wants) {
        on_surface = work_.surface.sample_and(place, [&](std::int32_t u, std::int32_t v) {
          beside = FootSearch<double>::neighbors_of(work_.surface, u, v);
        });
      }
      if (is_first) {
        sampled = measure.sample_of(piece, x, on_surface);
        is_inside = exists && sampled.is_inside;
        const WayOut way = exists ? Measure::way_out(sampled, is_sample) : WayOut::none;
        const unsigned sharing = __ballot_sync(~0U, way == WayOut::shared);
        if (way == WayOut::shared) leader = direction_leader(lane, sharing);
        searches = wants = is_searched(way) && leader == lane;
        if (wants) search = FootSearch<double>(work_.surface, x, on_surface, beside);
      } else if (wants) {
        search.take(work_.surface, on_surface, beside);
      }
      wants = wants && search.goes_on();
      if (__any_sync(~0U, wants) == 0) break;
      place = search.target();
    }
    Vec3 normal;
    if (searches) normal = search.normal();
    normal = Warp::from(normal, leader);
    if (!kFindsPlanes && exists && piece.weight > 0) work_.add_unseen(measure, piece, sampled);
    if (is_inside && piece.weight > 0) add_piece(measure, piece, sampled, normal, found);
    return normal;
  }

  // Adds a piece that is inside.
  __device__ void add_piece(const Measure& measure, const ToolPiece& piece,
                            const PieceSample& sampled, Vec3 normal, Found& found) {
    const bool is_cut = sampled.side == PlaneSide::cut;
    if constexpr (kFindsPlanes) {
      if (is_cut) measure.add_to_plane(sampled, found);
    } else {
      found.is_cut |= is_cut;
      work_.add_inside(measure, piece, sampled, normal, task_.cell, found.sum);
    }
  }

  // Adds the part of a task behind a plane, in its first lane.
  __device__ void measure_by_plane(Counts counts, Found& found) {
    const TaskBall& block = task_.balls[kOfBlock];
    const PlaneSide side = counts == Counts::uniform ? PlaneSide::behind
                           : counts != Counts::by_plane
                               ? PlaneSide::before
                               : side_of_plane(plane_.distance(block.center), block.radius);
    const bool is_crossed = side == PlaneSide::cut;
    ClippedMoments sums;
    if (__any_sync(~0U, is_crossed) != 0) sums = clipped_moments(is_crossed ? end_ - begin_ : 0);
    if (lane_ != 0 || side == PlaneSide::before) return;
    if constexpr (kFindsPlanes) {
      if (sums.is_cut) measure_of_cell().add_to_plane(block.center, plane_, found);
    } else {
      found.is_cut |= sums.is_cut;
      add_by_plane(side, counts == Counts::uniform ? task_.cell_mass : task_.block_mass, sums,
                   plane_.normal, work_.level.tool_radius, found.sum);
    }
  }

  // Returns, in the first lane, the clipped moments of the block's first `count` samples, with the
  // bits of clipped_in_turn(): a row per lane, added by halves. (With fewer lanes than rows, no
  // lane has more than two samples, and the rows left out are 0.)
  __device__ ClippedMoments clipped_moments(std::uint32_t count) const {
    static_assert(WarpTaskGroups::kNarrow == 2 * (32 / TaskGroup::kTasks) &&
                  kSumRows == 32 / WarpTaskGroups::kWideTasks);
    ClippedMoments row;
    bool is_at_face = false;
#pragma unroll 4
    for (std::uint32_t k = lane_; k < count; k += lanes_)
      is_at_face |= !add_ball_to_row(work_.level.samples[begin_ + k], plane_, row);
    if (__any_sync(~0U, is_at_face) != 0) {
#pragma unroll 1
      for (std::uint32_t k = lane_; k < count; k += lanes_)
        add_face_to_row(work_.level.samples[begin_ + k], work_.level.faces, plane_, row);
    }
    __syncwarp();
#pragma unroll 1
    for (unsigned half = lanes_ / 2; half > 0; half /= 2) {
      row.weight += Warp::from_next(row.weight, half);
      row.moment += Warp::from_next(row.moment, half);
    }
    row.is_cut = any(row.is_cut);
    return row;
  }

  const PoseWork<DepthSurface>& work_;
  const TaskGroup& group_;
  const TaskBall& cluster_;
  unsigned lanes_, lane_;
  const WarpTask& task_;
  std::uint32_t flags_, begin_, end_;  // loaded together with the task's balls
  ImageShared& shared_;
  ImageShared::OfTask& seen_;
  ImageSums& sums_;

  Vec3 middle_;  // centre of the ball that this lane classified, surface frame, m
  double radius_ = 0;
  DepthSurface::BallClass in_ball_;
  SurfaceSample on_surface_;  // sample at the block's middle
  ClipPlane plane_;           // set for a task that is cut by a plane or pushed
};

// Measures a small level by all warps of a launch, one task group each.
class ImageMeasure {
 public:
  static constexpr unsigned kMostWarps = kMostThreads / 32;
  struct Shared {  // memory of a block
    alignas(ImageShared) unsigned char warps[kMostWarps][sizeof(ImageShared)];
  };

  __device__ ImageMeasure(const PoseWork<DepthSurface>& work, Shared& shared)
      : work_(work),
        shared_(*reinterpret_cast<ImageShared*>(shared.warps[threadIdx.x / 32])),
        sums_(work.notes) {}

  // True if the launch has enough warps for the level.
  __device__ static bool is_for(const LevelView& level, BlockRange part) {
    return level.of_warps.count > 0 && level.of_warps.count <= part.parts * (blockDim.x / 32);
  }
  // Returns the sums of this thread.
  __device__ ThreadResult run() {
    measure_group<TaskSums>();
    return sums_.found();
  }
  // Notes the planes of cut cells, which run() leaves out since few queries need them.
  __device__ void note_planes() { measure_group<ContactPlane>(); }

 private:
  // Deals neighbours to different blocks, since they often take long together.
  template <class Found>
  __device__ void measure_group() {
    const WarpTaskGroups& all = work_.level.of_warps;
    const unsigned c = threadIdx.x / 32 * work_.part.parts + work_.part.part;
    if (c >= all.count) return;
    const bool is_wide = c < all.wide_count;
    const unsigned at_once = is_wide ? WarpTaskGroups::kWideTasks : TaskGroup::kTasks;
    const WarpTask* const tasks = all.tasks +
                                  (is_wide ? 0 : all.wide_count * WarpTaskGroups::kWideTasks) +
                                  (is_wide ? c : c - all.wide_count) * at_once;
    ImageTaskGroup<Found>(work_, all.groups[c], tasks, 32 / at_once, shared_, sums_).measure();
  }

  const PoseWork<DepthSurface>& work_;
  ImageShared& shared_;
  ImageSums sums_;
};

}  // namespace vpm::cuda
