#include <algorithm>
#include <type_traits>

#include "libvpm/query/cuda/flood.h"
#include "libvpm/query/cuda/measure_on_device.h"
#include "libvpm/query/cuda/points.h"
#include "libvpm/query/cuda/refined_measure.h"
#include "libvpm/query/cuda/seen_shares.h"
#include "libvpm/query/cuda/share_measure.h"

namespace vpm::cuda {
namespace {

// Blocks of one multiprocessor. Two spill no registers where an image is read, and are sooner done
// with a pose of up to some 50 000 spheres; three are, with more spheres, or among points.
constexpr unsigned kFewBlocks = 2, kManyBlocks = 3, kBatchBlocks = 2;
constexpr std::uint32_t kSpheresOfFewBlocks = 50'000;

template <class Surface>
struct RefinedLaunch {
  LevelView level;
  Surface surface;
  PointsView points;
  RefinedSpace space;  // of the first team; that of team t begins t * count spheres later
  bool counts_points = false;
  // Of one pose: the blocks that deal with spheres, the others do with points; and what these add
  // up.
  unsigned sphere_blocks = 0;
  Totals* totals = nullptr;
  RefinedCounters* counters = nullptr;
  Answer* answer = nullptr;
};

// The memory of one of several teams, each of one block.
__device__ RefinedSpace space_of(const RefinedSpace& first, const LevelView& level,
                                 std::size_t team) {
  const std::size_t shares = team * level.count;
  RefinedSpace space;
  for (int turn = 0; turn < 2; ++turn) {
    const ShareNotes& from = first.notes[turn];
    space.notes[turn] = {from.words + shares, from.points + shares, from.sums + shares,
                         from.planes + shares};
  }
  space.gaps = first.gaps + shares;
  space.parents = first.parents + shares + team;
  space.cut = first.cut + shares;
  space.far = first.far + team * level.piece_count;
  space.flats = first.flats + team * 2 * TaskLists::kTasks;
  space.planes = first.planes + team * kBatchThreads;
  return space;
}

// What decides which shares behind a surface are inside.
template <class Surface, class Team>
using Inside = std::conditional_t<Surface::kTellsInside, SeenShares<Team>, Flood<Team>>;

// Memory of a block; the steps of a query follow each other.
template <class Surface>
union BlockShared {
  MeasureShared measure;
  typename Inside<Surface, BlockTeam>::Shared inside;
};

// The first step of one query by all blocks of a launch. Returns what this thread has added up.
template <class Surface>
__device__ RawResult measure_shares(const RefinedLaunch<Surface>& launch, const PoseFrame& frame,
                                    unsigned turn, BlockShared<Surface>& shared) {
  const Part of_spheres{blockIdx.x, launch.sphere_blocks};
  const Part of_points{blockIdx.x - launch.sphere_blocks, gridDim.x - launch.sphere_blocks};
  if (blockIdx.x >= launch.sphere_blocks) {
    count_points(launch.level, launch.points, frame, of_points,
                 launch.space.notes[turn % 2].points);
    return {};
  }
  return ShareMeasure<Surface>(launch.level, launch.surface, frame.to_surface, launch.space, turn,
                               *launch.counters, of_spheres, launch.counts_points, shared.measure)
      .run();
}

// What the next query begins with, when nobody waits for this one any more.
template <class Surface>
__device__ void clear_next(const RefinedLaunch<Surface>& launch, unsigned turn) {
  launch.space.notes[(turn + 1) % 2].clear(launch.level, {blockIdx.x, gridDim.x});
}

// One query; the last block to come floods alone. For levels of few shares.
__global__ void __launch_bounds__(kThreads, kManyBlocks)
    one_pose_small(const __grid_constant__ RefinedLaunch<DiskSurface> launch,
                   const __grid_constant__ PoseFrame frame, unsigned sequence) {
  __shared__ BlockShared<DiskSurface> shared;
  __shared__ RawResult total;
  measure_shares(launch, frame, sequence, shared);
  if (!is_last_block(launch.totals->done)) {
    clear_next(launch, sequence);
    return;
  }
  const std::uint64_t met = now();
  if (threadIdx.x == 0) total = RawResult{};
  BlockTeam team;
  add_block(Flood<BlockTeam>(launch.level, frame.to_surface, launch.space, sequence,
                             *launch.counters, team, shared.inside, launch.counts_points)
                .run(),
            total);
  __syncthreads();
  send(word_of(total), now() - met, launch.answer, sequence);
  if (threadIdx.x == 0) {
    launch.totals->done = 0;
    *launch.counters = RefinedCounters{};
  }
  clear_next(launch, sequence);
}

// One query by all blocks of a cooperative launch. Where the first step has found all (no far
// pieces, and nobody asks for points), the last block to come sends the answer. Whether this block
// is the last to be done.
template <class Surface>
__device__ bool answer_pose(const RefinedLaunch<Surface>& launch, const PoseFrame& frame,
                            unsigned sequence, BlockShared<Surface>& shared) {
  Totals* const totals = launch.totals;
  const RawResult found = measure_shares(launch, frame, sequence, shared);
  if (Surface::kTellsInside) add_block(found, totals->result);
  GridTeam team(&totals->arrived);
  Inside<Surface, GridTeam> inside(launch.level, frame.to_surface, launch.space, sequence,
                                   *launch.counters, team, shared.inside, launch.counts_points);
  const bool is_last = team.arrive();
  std::uint64_t met = now();
  if (is_last) {
    const std::uint32_t word = word_of(totals->result);  // read while it is seen that this is all
    if (!inside.has_more()) send(word, now() - met, launch.answer, sequence);
  }
  team.wait();
  met = now();
  const bool has_more = inside.has_more();
  if (has_more) add_block(inside.run(), totals->result);
  clear_next(launch, sequence);
  if (!is_last_block(totals->done)) return false;
  if (has_more) send(word_of(totals->result), now() - met, launch.answer, sequence);
  __syncthreads();
  if (threadIdx.x == 0) {
    *totals = Totals{};
    *launch.counters = RefinedCounters{};
  }
  return true;
}

template <class Surface, unsigned kBlocks>
__global__ void __launch_bounds__(kThreads, kBlocks)
    one_pose(const __grid_constant__ RefinedLaunch<Surface> launch,
             const __grid_constant__ PoseFrame frame, unsigned sequence) {
  __shared__ BlockShared<Surface> shared;
  answer_pose(launch, frame, sequence, shared);
}

// One query after another (orders.h), until none comes.
__global__ void __launch_bounds__(kThreads, kFewBlocks)
    stand_by_kernel(const __grid_constant__ OrdersView view, unsigned first) {
  using Launch = RefinedLaunch<DepthSurface>;
  __shared__ BlockShared<DepthSurface> shared;
  __shared__ Launch launch;
  __shared__ Order order;
  __shared__ PoseFrame frame;
  Orders orders(view, first, order);
  for (unsigned number = first;; ++number) {
    orders.receive(number);
    if (order.leaves != 0) return;
    if (threadIdx.x == 0) frame.to_surface = order.to_surface;
    copy_words(*static_cast<const Launch*>(order.launch), launch);
    if (answer_pose(launch, frame, order.turn, shared)) orders.finish(number);
  }
}

// Each block a query of its own, one after another.
template <class Surface>
__global__ void __launch_bounds__(kBatchThreads, kBatchBlocks)
    many_poses(const __grid_constant__ RefinedLaunch<Surface> launch,
               const __grid_constant__ CloudFrame cloud, const Pose* poses, unsigned count,
               RawResult* results) {
  __shared__ BlockShared<Surface> shared;
  __shared__ PoseFrame frame;
  __shared__ RefinedCounters counters;
  __shared__ RawResult total;
  const LevelView& level = launch.level;
  const RefinedSpace space = space_of(launch.space, level, blockIdx.x);
  BlockTeam team;
  unsigned turn = 0;
  for (unsigned p = blockIdx.x; p < count; p += gridDim.x, ++turn) {
    __syncthreads();
    if (threadIdx.x == 0) {
      frame = frame_of(poses[p], cloud, level.center_of_mass, level.spheres_reach);
      counters = RefinedCounters{};
      total = RawResult{};
    }
    __syncthreads();
    if (launch.counts_points)
      count_points(level, launch.points, frame, {}, space.notes[turn % 2].points);
    const RawResult found =
        ShareMeasure<Surface>(level, launch.surface, frame.to_surface, space, turn, counters, {},
                              launch.counts_points, shared.measure)
            .run();
    if (Surface::kTellsInside) add_block(found, total);
    space.notes[(turn + 1) % 2].clear(level, {});
    __syncthreads();
    Inside<Surface, BlockTeam> inside(level, frame.to_surface, space, turn, counters, team,
                                      shared.inside, launch.counts_points);
    if (inside.has_more()) add_block(inside.run(), total);
    __syncthreads();
    if (threadIdx.x == 0) results[p] = total;
  }
  // The next launch begins with turn 0 again.
  for (const ShareNotes& notes : space.notes) notes.clear(level, {});
}

// Memory of a number of teams, of one or more blocks each.
class RefinedMemory {
 public:
  RefinedMemory(const LevelView& level, std::size_t teams, std::size_t blocks, unsigned threads)
      : words_(2 * level.count * teams),
        points_(2 * level.count * teams),
        sums_(2 * level.count * teams),
        planes_(2 * level.count * teams),
        gaps_(level.count * teams),
        parents_((std::size_t{level.count} + 1) * teams),
        cut_(level.count * teams),
        far_(level.piece_count * teams),
        flats_(2 * TaskLists::kTasks * blocks),
        patches_(threads * blocks) {
    words_.clear();
    points_.clear();
    sums_.clear();
    planes_.clear();
  }

  RefinedSpace space() const {
    const std::size_t half = words_.size() / 2;
    return {{{words_.get(), points_.get(), sums_.get(), planes_.get()},
             {words_.get() + half, points_.get() + half, sums_.get() + half, planes_.get() + half}},
            gaps_.get(),
            parents_.get(),
            cut_.get(),
            far_.get(),
            flats_.get(),
            patches_.get()};
  }

  // Of a team of one block.
  static std::size_t bytes_of_team(const LevelView& level) {
    constexpr std::size_t kOfShare =
        2 * (2 * sizeof(std::uint32_t) + sizeof(ToolSum) + sizeof(ContactPlane)) + sizeof(double) +
        2 * sizeof(std::uint32_t);
    return level.count * kOfShare + level.piece_count * sizeof(FarPiece) +
           2 * TaskLists::kTasks * sizeof(FlatBlock) + kBatchThreads * sizeof(CrossingPlane);
  }

 private:
  DeviceArray<std::uint32_t> words_, points_;
  DeviceArray<ToolSum> sums_;
  DeviceArray<ContactPlane> planes_;
  DeviceArray<double> gaps_;
  DeviceArray<std::uint32_t> parents_, cut_;
  DeviceArray<FarPiece> far_;
  DeviceArray<FlatBlock> flats_;
  DeviceArray<CrossingPlane> patches_;
};

class RefinedOnDevice : public MeasureOnDevice {
 public:
  RefinedOnDevice(const ToolModel& tool, const Level& level, const QueryOptions& options,
                  int device)
      : MeasureOnDevice(tool, device),
        level_(tool, level),
        counts_points_(options.counts_points),
        of_images_(kernel_of_images(level_.view())),
        of_points_(kernel_of_points(level_.view())),
        standing_by_(kernel_of(stand_by_kernel, kFewBlocks)),
        memory_(level_.view(), 1,
                std::max({of_images_.blocks, of_points_.blocks, standing_by_.blocks}), kThreads),
        totals_(1),
        counters_(1) {
    totals_.clear();
    counters_.clear();
    if (options.standby_us > 0 && !counts_points_)  // orders say nothing of points
      stand_by(standby({standing_by_.function, standing_by_.blocks, kThreads}), options.standby_us);
  }

 private:
  // How one pose is answered.
  struct PoseKernel {
    const void* function = nullptr;
    unsigned blocks = 0;
    bool meets = true;  // its blocks do, so all of them must be there at once
  };
  template <class Kernel>
  static PoseKernel kernel_of(Kernel* kernel, unsigned blocks, bool meets = true) {
    return {reinterpret_cast<const void*>(kernel),
            blocks_that_fit(kernel, kThreads, blocks) * processor_count(), meets};
  }
  static PoseKernel kernel_of_images(const LevelView& level) {
    return level.count <= kSpheresOfFewBlocks
               ? kernel_of(one_pose<DepthSurface, kFewBlocks>, kFewBlocks)
               : kernel_of(one_pose<DepthSurface, kManyBlocks>, kManyBlocks);
  }
  // Points alone are flooded, for which small levels have a kernel of their own.
  static PoseKernel kernel_of_points(const LevelView& level) {
    return is_small(level) ? kernel_of(one_pose_small, kManyBlocks, false)
                           : kernel_of(one_pose<DiskSurface, kManyBlocks>, kManyBlocks);
  }

  // Teams that share the work of a batch.
  struct Teams {
    explicit Teams(const LevelView& level)
        : count(teams_that_fit(RefinedMemory::bytes_of_team(level), kBatchBlocks)),
          memory(level, count, count, kBatchThreads) {}
    unsigned count;
    RefinedMemory memory;
  };

  void launch(const PoseFrame& frame, Answer* answer, unsigned sequence) override {
    if (cloud().frame().is_organised)
      launch_on(surface_there(), of_images_, frame, answer, sequence);
    else
      launch_on(cloud().disk_surface(), of_points_, frame, answer, sequence);
  }
  void launch(const Pose* poses, unsigned count, RawResult* results) override {
    if (!teams_) teams_ = std::make_unique<Teams>(level_.view());
    if (cloud().frame().is_organised)
      launch_on(cloud().depth_surface(), poses, count, results);
    else
      launch_on(cloud().disk_surface(), poses, count, results);
  }
  double reach() const override { return level_.view().spheres_reach; }
  PixelRectangle pixels_read(const PoseFrame& frame) const override {
    if (counts_points_) return MeasureOnDevice::pixels_read(frame);
    return part_read(cloud().depth_surface(), frame.to_surface.translation, reach(),
                     level_.looks().all());
  }
  const std::uint32_t* state_words(unsigned sequence) const override {
    return memory_.space().notes[sequence % 2].words;
  }
  SphereState state_of(std::uint32_t word) const override {
    return (word & kCounted) == 0 ? SphereState::outside
           : (word & kCut) != 0   ? SphereState::boundary
                                  : SphereState::inside;
  }

  // Of clouds that a camera has seen. The arguments of the last clouds are kept: frames come by
  // turns.
  const void* standing_launch(Answer* answer) override {
    if (!cloud().frame().is_organised) return nullptr;
    const DepthSurface surface = surface_there();
    const Known known{cloud().serial(), surface.made};
    for (std::size_t k = 0; k < kClouds; ++k)
      if (clouds_on_device_[k] == known) return arguments_.get() + k;
    if (arguments_.size() == 0) arguments_ = DeviceArray<RefinedLaunch<DepthSurface>>(kClouds);
    const std::size_t k = next_cloud_++ % kClouds;
    const RefinedLaunch<DepthSurface> arguments =
        arguments_of(surface, standing_by_.blocks, answer);
    clouds_on_device_[k] = {};
    check(cudaMemcpy(arguments_.get() + k, &arguments, sizeof(arguments), cudaMemcpyHostToDevice));
    finish_transfers();
    clouds_on_device_[k] = known;
    return arguments_.get() + k;
  }

  DepthSurface surface_there() const {
    DepthSurface surface = cloud().depth_surface();
    if (!part().is_whole) surface.restrict_to(part().made, &totals_.get()->result.beyond);
    return surface;
  }
  template <class Surface>
  RefinedLaunch<Surface> arguments_of(const Surface& surface, unsigned blocks,
                                      Answer* answer) const {
    // Few points lie in reach: they take less than a large level's spheres.
    unsigned sphere_blocks = blocks;
    if (counts_points_) sphere_blocks -= sphere_blocks / (is_small(level_.view()) ? 2 : 8);
    return {level_.view(), surface,       cloud().points(), memory_.space(), counts_points_,
            sphere_blocks, totals_.get(), counters_.get(),  answer};
  }
  template <class Surface>
  void launch_on(const Surface& surface, const PoseKernel& kernel, const PoseFrame& frame,
                 Answer* answer, unsigned sequence) {
    RefinedLaunch<Surface> arguments = arguments_of(surface, kernel.blocks, answer);
    PoseFrame pose = frame;
    void* values[] = {&arguments, &pose, &sequence};
    check(kernel.meets
              ? cudaLaunchCooperativeKernel(kernel.function, kernel.blocks, kThreads, values, 0,
                                            stream())
              : cudaLaunchKernel(kernel.function, kernel.blocks, kThreads, values, 0, stream()));
  }

  template <class Surface>
  void launch_on(const Surface& surface, const Pose* poses, unsigned count, RawResult* results) {
    const RefinedLaunch<Surface> arguments{level_.view(), surface, cloud().points(),
                                           teams_->memory.space(), counts_points_};
    many_poses<Surface><<<std::min(teams_->count, count), kBatchThreads, 0, stream()>>>(
        arguments, cloud().frame(), poses, count, results);
    check(cudaGetLastError());
  }

  DeviceLevel level_;
  bool counts_points_;
  PoseKernel of_images_, of_points_, standing_by_;
  RefinedMemory memory_;
  DeviceArray<Totals> totals_;
  DeviceArray<RefinedCounters> counters_;
  std::unique_ptr<Teams> teams_;
  // A cloud whose arguments for standing_launch() are kept, and what was there of it.
  struct Known {
    std::uint64_t serial = 0;
    PixelRectangle made;
    bool operator==(const Known&) const = default;
  };
  static constexpr std::size_t kClouds = 4;
  DeviceArray<RefinedLaunch<DepthSurface>> arguments_;
  Known clouds_on_device_[kClouds];
  std::size_t next_cloud_ = 0;
};

}  // namespace

std::unique_ptr<DeviceMeasure> make_refined_measure(const ToolModel& tool, const Level& level,
                                                    const QueryOptions& options, int device) {
  const CurrentDevice current(device);
  return std::make_unique<RefinedOnDevice>(tool, level, options, device);
}

}  // namespace vpm::cuda
