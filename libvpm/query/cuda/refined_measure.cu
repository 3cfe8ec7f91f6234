#include <algorithm>

#include "libvpm/query/cuda/flood.h"
#include "libvpm/query/cuda/launch.h"
#include "libvpm/query/cuda/on_device.h"
#include "libvpm/query/cuda/points.h"
#include "libvpm/query/cuda/refined_measure.h"
#include "libvpm/query/cuda/share_measure.h"

namespace vpm::cuda {
namespace {

template <class Surface>
struct RefinedLaunch {
  LevelView level;
  Surface surface;
  PointsView points;
  RefinedSpace space;  // of the first team; that of team t begins t * count spheres later
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
  space.hidden = first.hidden + team * level.piece_count;
  space.flats = first.flats + team * 2 * TaskLists::kTasks;
  return space;
}

// Whether one block floods a level in its own memory.
__host__ __device__ bool is_small(const LevelView& level) {
  return level.count <= kFloodShares && level.edge_count <= kFloodEdges;
}

// Memory of a block; the steps of a query follow each other.
union BlockShared {
  MeasureShared measure;
  FloodShared flood;
};

// The first step of one query by all blocks of a launch: `sphere_blocks` deal with spheres, the
// others with points.
template <class Surface>
__device__ void measure_shares(const RefinedLaunch<Surface>& launch, const PoseFrame& frame,
                               unsigned sphere_blocks, unsigned turn, RefinedCounters& counters,
                               BlockShared& shared) {
  if (blockIdx.x < sphere_blocks) {
    ShareMeasure<Surface>(launch.level, launch.surface, frame.to_surface, launch.space, turn,
                          counters, {blockIdx.x, sphere_blocks}, shared.measure)
        .run();
  } else {
    count_points(launch.level, launch.points, frame,
                 {blockIdx.x - sphere_blocks, gridDim.x - sphere_blocks},
                 launch.space.notes[turn % 2].points);
  }
}

// One query; the last block to come finishes it alone. For levels of few shares.
template <class Surface>
__global__ void __launch_bounds__(kThreads, kBlocksPerProcessor)
    one_pose_small(const __grid_constant__ RefinedLaunch<Surface> launch,
                   const __grid_constant__ PoseFrame frame, unsigned sphere_blocks, Totals* totals,
                   RefinedCounters* counters, Answer* answer, unsigned sequence) {
  __shared__ BlockShared shared;
  __shared__ RawResult total;
  measure_shares(launch, frame, sphere_blocks, sequence, *counters, shared);
  if (threadIdx.x == 0) total = RawResult{};
  if (!is_last_block(totals->done)) return;
  BlockTeam team;
  const RawResult part =
      Flood<Surface, BlockTeam>(launch.level, launch.surface, frame.to_surface, launch.space,
                                sequence, *counters, team, shared.flood, true)
          .run();
  add_block(part, total);
  __syncthreads();
  send(total, answer, sequence);
  if (threadIdx.x == 0) {
    totals->done = 0;
    *counters = RefinedCounters{};
  }
}

// One query by all blocks of a cooperative launch.
template <class Surface>
__global__ void __launch_bounds__(kThreads, kBlocksPerProcessor)
    one_pose(const __grid_constant__ RefinedLaunch<Surface> launch,
             const __grid_constant__ PoseFrame frame, unsigned sphere_blocks, Totals* totals,
             RefinedCounters* counters, Answer* answer, unsigned sequence) {
  __shared__ BlockShared shared;
  __shared__ RawResult total;
  measure_shares(launch, frame, sphere_blocks, sequence, *counters, shared);
  GridTeam team(&totals->arrived);
  team.sync();
  const RawResult part =
      Flood<Surface, GridTeam>(launch.level, launch.surface, frame.to_surface, launch.space,
                               sequence, *counters, team, shared.flood, false)
          .run();
  add_block(part, totals->result);
  if (!is_last_block(totals->done)) return;
  if (threadIdx.x == 0) {
    total = totals->result;
    *totals = Totals{};
    *counters = RefinedCounters{};
  }
  __syncthreads();
  send(total, answer, sequence);
}

// Each block a query of its own, one after another.
template <class Surface>
__global__ void __launch_bounds__(kThreads, kBlocksPerProcessor)
    many_poses(const __grid_constant__ RefinedLaunch<Surface> launch,
               const __grid_constant__ CloudFrame cloud, const Pose* poses, unsigned count,
               RawResult* results) {
  __shared__ BlockShared shared;
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
    count_points(level, launch.points, frame, {}, space.notes[turn % 2].points);
    ShareMeasure<Surface>(level, launch.surface, frame.to_surface, space, turn, counters, {},
                          shared.measure)
        .run();
    __syncthreads();
    const RawResult part =
        Flood<Surface, BlockTeam>(level, launch.surface, frame.to_surface, space, turn, counters,
                                  team, shared.flood, is_small(level))
            .run();
    add_block(part, total);
    __syncthreads();
    if (threadIdx.x == 0) results[p] = total;
  }
  // The next launch begins with turn 0 again.
  for (const ShareNotes& notes : space.notes) notes.clear(level, threadIdx.x, blockDim.x);
}

// Memory of a number of teams, of one or more blocks each.
class RefinedMemory {
 public:
  RefinedMemory(const LevelView& level, std::size_t teams, std::size_t blocks)
      : words_(2 * level.count * teams),
        points_(2 * level.count * teams),
        sums_(2 * level.count * teams),
        planes_(2 * level.count * teams),
        gaps_(level.count * teams),
        parents_((std::size_t{level.count} + 1) * teams),
        cut_(level.count * teams),
        hidden_(level.piece_count * teams),
        flats_(2 * TaskLists::kTasks * blocks) {
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
            hidden_.get(),
            flats_.get()};
  }

  // Of a team of one block.
  static std::size_t bytes_of_team(const LevelView& level) {
    constexpr std::size_t kOfShare =
        2 * (2 * sizeof(std::uint32_t) + sizeof(ToolSum) + sizeof(ContactPlane)) + sizeof(double) +
        2 * sizeof(std::uint32_t);
    return level.count * kOfShare + level.piece_count * sizeof(HiddenPiece) +
           2 * TaskLists::kTasks * sizeof(FlatLook);
  }

 private:
  DeviceArray<std::uint32_t> words_, points_;
  DeviceArray<ToolSum> sums_;
  DeviceArray<ContactPlane> planes_;
  DeviceArray<double> gaps_;
  DeviceArray<std::uint32_t> parents_, cut_;
  DeviceArray<HiddenPiece> hidden_;
  DeviceArray<FlatLook> flats_;
};

class RefinedOnDevice : public DeviceMeasure {
 public:
  RefinedOnDevice(const ToolModel& tool, const Level& level, int device)
      : device_(device),
        tool_(tool),
        level_(tool, level),
        memory_(level_.view(), 1, processors_),
        totals_(1),
        counters_(1),
        answer_(1) {
    totals_.clear();
    counters_.clear();
  }

  Result run(const PreparedCloud& cloud, const Pose& pose) override {
    const CurrentDevice current(device_);
    bring(cloud);
    const PoseFrame frame =
        frame_of(pose, cloud_->frame(), tool_.center_of_mass, level_.view().spheres_reach);
    if (cloud_->frame().is_organised)
      launch(cloud_->depth_surface(), frame);
    else
      launch(cloud_->disk_surface(), frame);
    return result_of(wait_for(*answer_.host(), sequence_, stream_.get()));
  }

  void run(const PreparedCloud& cloud, std::span<const Pose> poses,
           std::span<Result> results) override {
    const CurrentDevice current(device_);
    bring(cloud);
    if (!batch_) batch_ = std::make_unique<Batch>(level_.view());
    for (std::size_t begin = 0; begin < poses.size(); begin += Batch::kPoses) {
      const std::size_t count = std::min(Batch::kPoses, poses.size() - begin);
      check(cudaMemcpyAsync(batch_->poses.get(), poses.data() + begin, count * sizeof(Pose),
                            cudaMemcpyHostToDevice, stream_.get()));
      if (cloud_->frame().is_organised)
        launch(cloud_->depth_surface(), static_cast<unsigned>(count));
      else
        launch(cloud_->disk_surface(), static_cast<unsigned>(count));
      check(cudaMemcpyAsync(batch_->answers.data(), batch_->results.get(),
                            count * sizeof(RawResult), cudaMemcpyDeviceToHost, stream_.get()));
      check(cudaStreamSynchronize(stream_.get()));
      for (std::size_t k = 0; k < count; ++k) results[begin + k] = result_of(batch_->answers[k]);
    }
  }

  void read_states(std::vector<SphereState>& states) override {
    const CurrentDevice current(device_);
    check(cudaStreamSynchronize(stream_.get()));
    std::vector<std::uint32_t> words(states.size());
    check(cudaMemcpy(words.data(), memory_.space().notes[sequence_ % 2].words,
                     words.size() * sizeof(std::uint32_t), cudaMemcpyDeviceToHost));
    for (std::size_t i = 0; i < states.size(); ++i) {
      states[i] = (words[i] & kCounted) == 0 ? SphereState::outside
                  : (words[i] & kCut) != 0   ? SphereState::boundary
                                             : SphereState::inside;
    }
  }

 private:
  // Poses of one launch, and teams that share the work.
  struct Batch {
    static constexpr std::size_t kPoses = 16384;

    explicit Batch(const LevelView& level)
        : teams(teams_that_fit(RefinedMemory::bytes_of_team(level))),
          memory(level, teams, teams),
          poses(kPoses),
          results(kPoses),
          answers(kPoses) {
      results.clear();  // results have gaps, which are copied too
    }
    unsigned teams;
    RefinedMemory memory;
    DeviceArray<Pose> poses;
    DeviceArray<RawResult> results;
    std::vector<RawResult> answers;
  };

  void bring(const PreparedCloud& cloud) {
    if (cloud_ && cloud.serial() == serial_) return;
    cloud_ = on_device(cloud);
    serial_ = cloud.serial();
  }

  template <class Surface>
  void launch(const Surface& surface, const PoseFrame& frame) {
    RefinedLaunch<Surface> arguments{level_.view(), surface, cloud_->points(), memory_.space()};
    PoseFrame pose = frame;
    Totals* totals = totals_.get();
    RefinedCounters* counters = counters_.get();
    Answer* answer = answer_.device();
    unsigned sphere_blocks = processors_, sequence = ++sequence_;
    void* values[] = {&arguments, &pose, &sphere_blocks, &totals, &counters, &answer, &sequence};
    const unsigned blocks = kBlocksPerProcessor * processors_;
    if (is_small(level_.view())) {
      check(cudaLaunchKernel(one_pose_small<Surface>, blocks, kThreads, values, 0, stream_.get()));
    } else {
      check(cudaLaunchCooperativeKernel(one_pose<Surface>, blocks, kThreads, values, 0,
                                        stream_.get()));
    }
  }

  template <class Surface>
  void launch(const Surface& surface, unsigned count) {
    const RefinedLaunch<Surface> arguments{level_.view(), surface, cloud_->points(),
                                           batch_->memory.space()};
    many_poses<Surface><<<std::min(batch_->teams, count), kThreads, 0, stream_.get()>>>(
        arguments, cloud_->frame(), batch_->poses.get(), count, batch_->results.get());
    check(cudaGetLastError());
  }

  Result result_of(const RawResult& raw) const {
    Result result;
    raw.sum.write(tool_, cloud_->frame().camera_to_world.rotation, result);
    result.boundary = raw.boundary;
    result.inside = raw.inside;
    result.points = raw.points;
    return result;
  }

  int device_;
  const ToolModel& tool_;
  Stream stream_;
  unsigned processors_ = processor_count();
  DeviceLevel level_;
  RefinedMemory memory_;
  DeviceArray<Totals> totals_;
  DeviceArray<RefinedCounters> counters_;
  MappedArray<Answer> answer_;
  unsigned sequence_ = 0;
  std::shared_ptr<const DeviceCloud> cloud_;
  std::uint64_t serial_ = 0;
  std::unique_ptr<Batch> batch_;
};

}  // namespace

std::unique_ptr<DeviceMeasure> make_refined_measure(const ToolModel& tool, const Level& level,
                                                    int device) {
  const CurrentDevice current(device);
  return std::make_unique<RefinedOnDevice>(tool, level, device);
}

}  // namespace vpm::cuda
