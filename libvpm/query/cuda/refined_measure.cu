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

__device__ RefinedSpace space_of(const RefinedSpace& first, std::size_t count, std::size_t team) {
  const std::size_t at = team * count;
  return {first.kinds + at,          first.gaps + at, first.sums + at, first.planes + at,
          first.parents + at + team, first.work + at, first.cut + at,  first.states + at};
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
                                           *counters, team)
               .run();
  } else {
    part.points = for_points_inside(launch.level, launch.points, frame, team.points(),
                                    [](std::uint32_t, std::uint32_t, Vec3) {});
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
  const RefinedSpace space = space_of(launch.space, level.count, blockIdx.x);
  BlockTeam team;
  for (unsigned p = blockIdx.x; p < count; p += gridDim.x) {
    __syncthreads();
    if (threadIdx.x == 0) {
      frame = frame_of(poses[p], cloud, level.center_of_mass, level.tool_reach);
      counters = RefinedCounters{};
      total = RawResult{};
    }
    __syncthreads();
    RawResult part =
        RefinedQuery<Surface, BlockTeam>(level, launch.surface, frame, space, counters, team).run();
    part.points = for_points_inside(level, launch.points, frame, team.points(),
                                    [](std::uint32_t, std::uint32_t, Vec3) {});
    add_block(part, total);
    __syncthreads();
    if (threadIdx.x == 0) results[p] = total;
  }
}

// Memory of a number of teams.
struct RefinedMemory {
  RefinedMemory(std::size_t spheres, std::size_t teams)
      : kinds(spheres * teams),
        gaps(spheres * teams),
        sums(spheres * teams),
        planes(spheres * teams),
        parents((spheres + 1) * teams),
        work(spheres * teams),
        cut(spheres * teams),
        states(spheres * teams) {}
  RefinedSpace space() const {
    return {kinds.get(),   gaps.get(), sums.get(), planes.get(),
            parents.get(), work.get(), cut.get(),  states.get()};
  }
  static constexpr std::size_t kBytesPerSphere = sizeof(std::uint8_t) + sizeof(double) +
                                                 sizeof(ToolSum) + sizeof(ContactPlane) +
                                                 3 * sizeof(std::uint32_t) + sizeof(SphereState);

  DeviceArray<std::uint8_t> kinds;
  DeviceArray<double> gaps;
  DeviceArray<ToolSum> sums;
  DeviceArray<ContactPlane> planes;
  DeviceArray<std::uint32_t> parents, work, cut;
  DeviceArray<SphereState> states;
};

class RefinedOnDevice : public DeviceMeasure {
 public:
  RefinedOnDevice(const ToolModel& tool, const Level& level, int device)
      : device_(device),
        tool_(tool),
        level_(tool, level),
        memory_(level.sphere_count, 1),
        totals_(1),
        counters_(1),
        answer_(1) {
    totals_.clear();
    counters_.clear();
  }

  Result run(const PreparedCloud& cloud, const Pose& pose) override {
    const CurrentDevice current(device_);
    bring(cloud);
    const PoseFrame frame = frame_of(pose, cloud_->frame(), tool_.center_of_mass, tool_.reach);
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
    if (!batch_) batch_ = std::make_unique<Batch>(level_.view().count);
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
    check(cudaMemcpy(states.data(), memory_.states.get(), states.size() * sizeof(SphereState),
                     cudaMemcpyDeviceToHost));
  }

 private:
  // Poses of one launch, and teams that share the work.
  struct Batch {
    static constexpr std::size_t kPoses = 16384;

    explicit Batch(std::size_t spheres)
        : teams(teams_that_fit(spheres, RefinedMemory::kBytesPerSphere)),
          memory(spheres, teams),
          poses(kPoses),
          results(kPoses),
          answers(kPoses) {}
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
