#include <algorithm>

#include "libvpm/query/cuda/answer.h"
#include "libvpm/query/cuda/launch.h"
#include "libvpm/query/cuda/on_device.h"
#include "libvpm/query/cuda/refined.h"
#include "libvpm/query/cuda/refined_measure.h"

namespace vpm::cuda {
namespace {

template <class Surface>
struct RefinedLaunch {
  LevelView level;
  Surface surface;
  PointsView points;
  RefinedSpace space;  // of the first team; that of team t begins t * count spheres later
};

// The memory of one of several teams.
__device__ RefinedSpace space_of(const RefinedSpace& first, const LevelView& level,
                                 std::size_t team) {
  const std::size_t shares = team * level.count, units = team * level.unit_count;
  RefinedSpace space;
  space.kinds = first.kinds + shares;
  space.gaps = first.gaps + shares;
  for (int turn = 0; turn < 2; ++turn) {
    const MeasuredShares& from = first.measured[turn];
    space.measured[turn] = {from.sums + shares, from.planes + shares, from.marks + shares};
  }
  space.parents = first.parents + shares + team;
  space.states = first.states + shares;
  space.cut = first.cut + shares;
  space.flats = first.flats + units;
  space.many = first.many + units;
  space.few = first.few + units;
  space.pieces = first.pieces + units;
  space.shares = first.shares + units;
  return space;
}

template <class Surface, class Team>
__device__ RawResult points_of(const RefinedLaunch<Surface>& launch, const PoseFrame& frame,
                               Team& team) {
  RawResult part;
  for_points_inside(launch.level, launch.points, frame, team.points(),
                    [&](std::uint32_t sphere, std::uint32_t, Vec3) {
                      part.points += RefinedQuery<Surface, Team>::counts_points(
                          launch.level, launch.surface, frame, sphere);
                    });
  return part;
}

template <class Surface>
__global__ void __launch_bounds__(kThreads, kBlocksPerProcessor)
    one_pose(const __grid_constant__ RefinedLaunch<Surface> launch,
             const __grid_constant__ PoseFrame frame, unsigned sphere_blocks, Totals* totals,
             RefinedCounters* counters, Answer* answer, unsigned sequence) {
  GridTeam team(&totals->arrived, sphere_blocks);
  RawResult part;
  if (team.spheres().parts > 0) {
    part = RefinedQuery<Surface, GridTeam>(launch.level, launch.surface, frame, launch.space,
                                           sequence, *counters, team)
               .run();
  } else {
    part = points_of(launch, frame, team);
  }
  if (finish(part, *totals, answer, sequence)) *counters = RefinedCounters{};
}

template <class Surface>
__global__ void __launch_bounds__(kThreads, kBlocksPerProcessor)
    many_poses(const __grid_constant__ RefinedLaunch<Surface> launch,
               const __grid_constant__ CloudFrame cloud, const Pose* poses, unsigned count,
               RawResult* results) {
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
    RawResult part =
        RefinedQuery<Surface, BlockTeam>(level, launch.surface, frame, space, turn, counters, team)
            .run();
    part.points = points_of(launch, frame, team).points;
    add_block(part, total);
    __syncthreads();
    if (threadIdx.x == 0) results[p] = total;
  }
  // The next launch begins with turn 0 again.
  for (std::uint32_t i = threadIdx.x; i < level.count; i += blockDim.x) {
    space.measured[0].clear(i);
    space.measured[1].clear(i);
  }
}

// Memory of a number of teams.
class RefinedMemory {
 public:
  RefinedMemory(const LevelView& level, std::size_t teams)
      : kinds_(level.count * teams),
        gaps_(level.count * teams),
        sums_(2 * level.count * teams),
        planes_(2 * level.count * teams),
        marks_(2 * level.count * teams),
        parents_((std::size_t{level.count} + 1) * teams),
        states_(level.count * teams),
        cut_(level.count * teams),
        flats_(level.unit_count * teams),
        many_(level.unit_count * teams),
        few_(level.unit_count * teams),
        pieces_(level.unit_count * teams),
        shares_(level.unit_count * teams) {
    sums_.clear();
    planes_.clear();
    marks_.clear();
    states_.clear();
  }

  RefinedSpace space() const {
    const std::size_t half = marks_.size() / 2;
    return {kinds_.get(),
            gaps_.get(),
            {{sums_.get(), planes_.get(), marks_.get()},
             {sums_.get() + half, planes_.get() + half, marks_.get() + half}},
            parents_.get(),
            states_.get(),
            cut_.get(),
            flats_.get(),
            many_.get(),
            few_.get(),
            pieces_.get(),
            shares_.get()};
  }

  static std::size_t bytes_of_team(const LevelView& level) {
    constexpr std::size_t kOfShare = 2 * sizeof(std::uint8_t) + sizeof(double) +
                                     2 * (sizeof(ToolSum) + sizeof(ContactPlane)) +
                                     4 * sizeof(std::uint32_t);
    constexpr std::size_t kOfUnit = 4 * sizeof(std::uint32_t) + sizeof(FlatLook);
    return level.count * kOfShare + level.unit_count * kOfUnit;
  }

 private:
  DeviceArray<std::uint8_t> kinds_;
  DeviceArray<double> gaps_;
  DeviceArray<ToolSum> sums_;
  DeviceArray<ContactPlane> planes_;
  DeviceArray<unsigned> marks_;
  DeviceArray<std::uint32_t> parents_;
  DeviceArray<SphereState> states_;
  DeviceArray<FlatLook> flats_;
  DeviceArray<std::uint32_t> cut_, many_, few_, pieces_, shares_;
};

class RefinedOnDevice : public DeviceMeasure {
 public:
  RefinedOnDevice(const ToolModel& tool, const Level& level, int device)
      : device_(device),
        tool_(tool),
        level_(tool, level),
        memory_(level_.view(), 1),
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
    wait_for(answer_.host()->sequence, sequence_, stream_.get());
    return result_of(answer_.host()->result);
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
    check(cudaMemcpy(states.data(), memory_.space().states, states.size() * sizeof(SphereState),
                     cudaMemcpyDeviceToHost));
  }

 private:
  // Poses of one launch, and teams that share the work.
  struct Batch {
    static constexpr std::size_t kPoses = 16384;

    explicit Batch(const LevelView& level)
        : teams(teams_that_fit(RefinedMemory::bytes_of_team(level))),
          memory(level, teams),
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
    check(cudaLaunchCooperativeKernel(one_pose<Surface>, kBlocksPerProcessor * processors_,
                                      kThreads, values, 0, stream_.get()));
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
