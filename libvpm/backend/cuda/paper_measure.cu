#include <algorithm>

#include "libvpm/backend/cuda/device_level.h"
#include "libvpm/backend/cuda/measure_on_device.h"
#include "libvpm/backend/cuda/paper_flood.h"

namespace vpm::cuda {
namespace {

struct PaperLaunch {
  PaperLevel level;
  PointsView points;
  PaperSpace space;  // memory of the first team; team t's begins t * count spheres later
};

__device__ PaperSpace space_of(const PaperSpace& first, std::size_t spheres) {
  return {first.words + spheres, first.contacts + spheres, first.normals + spheres,
          first.boundary + spheres, first.inside + spheres};
}

// Answers one query by all blocks of a cooperative launch. Two spaces alternate: while one gathers
// points, the other is cleared of the last query, whose states could be read until now.
__global__ void __launch_bounds__(kPaperThreads, kPaperBlocksPerProcessor)
    one_pose(const __grid_constant__ PaperLaunch launch, const __grid_constant__ PoseFrame frame,
             Totals* totals, PaperCounters* counters, Answer* answer, unsigned sequence) {
  __shared__ HubShared shared;
  __shared__ RawResult total;
  const PaperLevel& level = launch.level;
  const unsigned turn = sequence % 2;
  const PaperSpace space = space_of(launch.space, std::size_t{turn} * level.count);
  GridTeam team(&totals->arrived);
  clear(space_of(launch.space, std::size_t{1 - turn} * level.count), counters[1 - turn],
        team.thread(), team.threads());
  gather(level, launch.points, frame, {blockIdx.x, gridDim.x}, space, counters[turn]);
  team.sync();
  const std::uint64_t met = now();
  const RawResult part = PaperFlood<GridTeam>(level, space, counters[turn], team, shared).run();
  add_block(part, totals->result);
  if (!is_last_of(totals->done, gridDim.x)) return;
  if (threadIdx.x == 0) {
    total = totals->result;
    total.points = read(counters[turn].points);
    *totals = Totals{};
    counters[1 - turn] = PaperCounters{};
  }
  __syncthreads();
  send(word_of(total), now() - met, answer, sequence);
}

// Answers one query after another in each block.
__global__ void __launch_bounds__(kPaperThreads, kPaperBlocksPerProcessor)
    many_poses(const __grid_constant__ PaperLaunch launch, const __grid_constant__ CloudFrame cloud,
               const Pose* poses, unsigned count, RawResult* results) {
  __shared__ HubShared shared;
  __shared__ PoseFrame frame;
  __shared__ PaperCounters counters;
  __shared__ RawResult total;
  const PaperLevel& level = launch.level;
  const PaperSpace space = space_of(launch.space, std::size_t{blockIdx.x} * level.count);
  BlockTeam team;
  for (unsigned p = blockIdx.x; p < count; p += gridDim.x) {
    if (threadIdx.x == 0) {
      frame = frame_of(poses[p], cloud, level.tool.center_of_mass, level.tool.reach);
      counters = PaperCounters{};
      total = RawResult{};
    }
    __syncthreads();
    gather(level, launch.points, frame, {}, space, counters);
    team.sync();
    const RawResult part = PaperFlood<BlockTeam>(level, space, counters, team, shared).run();
    add_block(part, total);
    __syncthreads();
    if (threadIdx.x == 0) {
      results[p] = total;
      results[p].points = counters.points;
    }
    clear(space, counters, threadIdx.x, blockDim.x);
    __syncthreads();
  }
}

constexpr std::size_t kBytesOfSphere =
    3 * sizeof(std::uint32_t) + sizeof(PaperContact) + sizeof(Vec3);
// Returns the space of a number of teams.
PaperSpace space_in(DeviceMemory& memory, std::size_t spheres, std::size_t teams) {
  const std::size_t count = spheres * teams;
  return {memory.zeros<std::uint32_t>(count), memory.zeros<PaperContact>(count),
          memory.room<Vec3>(count), memory.room<std::uint32_t>(count),
          memory.room<std::uint32_t>(count)};
}

std::vector<std::uint32_t> hubs_of(const SphereGraph& graph) {
  std::vector<std::uint32_t> hubs;
  for (std::uint32_t i = 0; i + 1 < graph.begin.size(); ++i)
    if (graph.begin[i + 1] - graph.begin[i] > PaperLevel::kMostNeighbors) hubs.push_back(i);
  return hubs;
}

class PaperOnDevice : public MeasureOnDevice {
 public:
  PaperOnDevice(const ToolModel& tool, const Level& level, int device)
      : MeasureOnDevice(tool, device),
        blocks_(blocks_that_fit(one_pose, kPaperThreads, kPaperBlocksPerProcessor)),
        totals_(1),
        counters_(2) {
    const std::vector<std::uint32_t> hubs = hubs_of(level.graph);
    level_ = {level.sphere_count,
              memory_.copy(tool.spheres.data(), level.sphere_count),
              memory_.copy(level.graph.begin),
              memory_.copy(level.graph.neighbors),
              memory_.copy(hubs),
              static_cast<std::uint32_t>(hubs.size()),
              view_of(level.grid),
              measures_of(tool),
              reach_of_spheres(tool, level)};
    level_.grid.begin = memory_.copy(level.grid.begin);
    level_.grid.spheres = memory_.copy(level.grid.spheres);
    space_ = space_in(memory_, level.sphere_count, 2);
    totals_.clear();
    counters_.clear();
  }

 private:
  // Holds the teams that deal with a batch.
  struct Teams {
    Teams(unsigned teams, std::size_t spheres)
        : count(teams), space(space_in(memory, spheres, count)) {}
    unsigned count;
    DeviceMemory memory;
    PaperSpace space;
  };

  void launch(const PoseFrame& frame, Answer* answer, unsigned sequence) override {
    const PaperLaunch arguments{level_, cloud().points(), space_};
    launch_kernel(one_pose, {blocks_, kPaperThreads}, LaunchKind::cooperative, stream(), arguments,
                  frame, totals_.get(), counters_.get(), answer, sequence);
  }
  // Launches once for each tool.
  void launch(std::span<const ToolPart> tools, const Pose* poses, RawResult* results) override {
    unsigned begin = 0;
    for (const ToolPart& part : tools) {
      const unsigned count = part.end - begin;
      auto& of_tool = static_cast<PaperOnDevice&>(*part.measure);
      if (!of_tool.teams_) {
        const std::size_t spheres = of_tool.level_.count;
        of_tool.teams_ = make_teams<Teams>(
            teams_that_fit(spheres * kBytesOfSphere, kPaperBlocksPerProcessor), spheres);
      }
      const Teams& teams = *of_tool.teams_;
      const PaperLaunch arguments{of_tool.level_, cloud().points(), teams.space};
      launch_kernel(many_poses, {std::min(teams.count, count), kPaperThreads},
                    LaunchKind::independent, stream(), arguments, cloud().frame(), poses + begin,
                    count, results + begin);
      begin = part.end;
    }
  }
  // Returns the CPU's radius, so that the same pixels of an image are tested.
  double reach() const override { return level_.tool.reach; }
  const std::uint32_t* state_words(unsigned sequence) const override {
    return space_.words + sequence % 2 * level_.count;
  }
  SphereState state_of(std::uint32_t word) const override {
    return word == 0                       ? SphereState::outside
           : word == PaperSpace::kBoundary ? SphereState::boundary
                                           : SphereState::inside;
  }

  unsigned blocks_;  // blocks that answer one pose
  DeviceMemory memory_;
  PaperLevel level_;
  PaperSpace space_;  // two teams alternate in it
  DeviceArray<Totals> totals_;
  DeviceArray<PaperCounters> counters_;
  std::unique_ptr<Teams> teams_;
};

}  // namespace

std::unique_ptr<DeviceMeasure> make_paper_measure(const ToolModel& tool, const Level& level,
                                                  int device) {
  const CurrentDevice current(device);
  return std::make_unique<PaperOnDevice>(tool, level, device);
}

}  // namespace vpm::cuda
