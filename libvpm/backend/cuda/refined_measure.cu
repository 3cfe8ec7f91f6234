#include <algorithm>

#include "libvpm/backend/cuda/device_level.h"
#include "libvpm/backend/cuda/measure_on_device.h"
#include "libvpm/backend/cuda/refined_kernels.h"

namespace vpm::cuda {
namespace {

class RefinedOnDevice : public MeasureOnDevice {
 public:
  RefinedOnDevice(const ToolModel& tool, const Level& level, const QueryOptions& options,
                  int device)
      : MeasureOnDevice(tool, device),
        level_(tool, level, options.occluded),
        of_images_(kernel_of_images(level_.view())),
        of_points_(kernel_of_points(level_.view())),
        memory_(TeamRoom(level_.view()), 1, std::max(of_images_.blocks, of_points_.blocks),
                kThreads),
        totals_(1),
        counters_(1) {
    totals_.clear();
    counters_.clear();
  }

 private:
  // Names the kernel that answers one pose.
  template <class Surface>
  struct PoseKernel {
    using Function = void (*)(RefinedLaunch<Surface>, Pose, unsigned);
    Function function = nullptr;
    unsigned blocks = 0;
    bool meets = true;  // its blocks meet, so all must be resident at once
  };
  template <class Surface>
  static PoseKernel<Surface> kernel_of(typename PoseKernel<Surface>::Function function,
                                       unsigned blocks, bool meets = true) {
    return {function, blocks_that_fit(function, kThreads, blocks), meets};
  }
  static PoseKernel<DepthSurface> kernel_of_images(const LevelView& level) {
    return level.count <= kSpheresOfFewBlocks
               ? kernel_of<DepthSurface>(one_pose<DepthSurface, kFewBlocks>, kFewBlocks)
               : kernel_of<DepthSurface>(one_pose<DepthSurface, kManyBlocks>, kManyBlocks);
  }
  // Returns the kernel for points without a camera: they are flooded, for which small levels have
  // one of their own.
  static PoseKernel<DiskSurface> kernel_of_points(const LevelView& level) {
    return is_small(level)
               ? kernel_of<DiskSurface>(one_pose_small, kManyBlocks, false)
               : kernel_of<DiskSurface>(one_pose<DiskSurface, kManyBlocks>, kManyBlocks);
  }

  // Holds the teams that share the work of a batch.
  struct Teams {
    Teams(unsigned teams, const TeamRoom& wanted)
        : count(teams), room(wanted), memory(room, count, count, kBatchThreads) {}
    unsigned count;
    TeamRoom room;
    RefinedMemory memory;
  };

  void launch(const Pose& to_surface, Answer* answer, unsigned sequence) override {
    if (cloud().is_organised())
      launch_on(cloud().depth_surface(), of_images_, to_surface, answer, sequence);
    else
      launch_on(cloud().disk_surface(), of_points_, to_surface, answer, sequence);
  }
  void launch(std::span<const ToolPart> tools, const Pose* to_surfaces,
              RawResult* results) override {
    make_room(tools);
    if (cloud().is_organised())
      launch_on(cloud().depth_surface(), tools, to_surfaces, results);
    else
      launch_on(cloud().disk_surface(), tools, to_surfaces, results);
  }
  const std::uint32_t* state_words(unsigned sequence) const override {
    return memory_.space().notes[sequence % 2].words;
  }
  SphereState state_of(std::uint32_t word) const override {
    return (word & cell_bit::counted) == 0 ? SphereState::outside
           : (word & cell_bit::cut) != 0   ? SphereState::boundary
                                           : SphereState::inside;
  }

  template <class Surface>
  void launch_on(const Surface& surface, const PoseKernel<Surface>& kernel, const Pose& to_surface,
                 Answer* answer, unsigned sequence) {
    const RefinedLaunch<Surface> arguments{level_.view(), surface,         memory_.space(),
                                           totals_.get(), counters_.get(), answer};
    launch_kernel(kernel.function, {kernel.blocks, kThreads},
                  kernel.meets ? LaunchKind::cooperative : LaunchKind::independent, stream(),
                  arguments, to_surface, sequence);
  }

  static const LevelView& level_of(const ToolPart& part) {
    return static_cast<const RefinedOnDevice&>(*part.measure).level_.view();
  }
  void make_room(std::span<const ToolPart> tools) {
    TeamRoom wanted = teams_ ? teams_->room : TeamRoom();
    for (const ToolPart& part : tools) wanted = wanted.with(TeamRoom(level_of(part)));
    if (teams_ && teams_->room.holds(wanted)) return;
    teams_.reset();  // before more memory is taken
    teams_ = make_teams<Teams>(teams_that_fit(RefinedMemory::bytes_of_team(wanted), kBatchBlocks),
                               wanted);
  }
  // Launches batches of as many tools as a launch has room for.
  template <class Surface>
  void launch_on(const Surface& surface, std::span<const ToolPart> tools, const Pose* to_surfaces,
                 RawResult* results) {
    BatchLaunch<Surface> arguments{{}, {}, surface, teams_->memory.space(), teams_->room};
    for (unsigned begin = 0; !tools.empty();) {
      const std::size_t count = std::min<std::size_t>(arguments.kTools, tools.size());
      for (std::size_t t = 0; t < count; ++t) {
        arguments.levels[t] = level_of(tools[t]);
        arguments.ends[t] = tools[t].end - begin;
      }
      const unsigned end = tools[count - 1].end;
      launch_kernel(many_poses<Surface>, {std::min(teams_->count, end - begin), kBatchThreads},
                    LaunchKind::independent, stream(), arguments, to_surfaces + begin, end - begin,
                    results + begin);
      tools = tools.subspan(count);
      begin = end;
    }
  }

  DeviceLevel level_;
  PoseKernel<DepthSurface> of_images_;
  PoseKernel<DiskSurface> of_points_;
  RefinedMemory memory_;
  DeviceArray<Totals> totals_;
  DeviceArray<RefinedCounters> counters_;
  std::unique_ptr<Teams> teams_;
};

}  // namespace

std::unique_ptr<DeviceMeasure> make_refined_measure(const ToolModel& tool, const Level& level,
                                                    const QueryOptions& options, int device) {
  const CurrentDevice current(device);
  return std::make_unique<RefinedOnDevice>(tool, level, options, device);
}

}  // namespace vpm::cuda
