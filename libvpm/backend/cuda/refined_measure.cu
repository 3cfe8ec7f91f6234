#include <algorithm>
#include <cmath>

#include "libvpm/backend/cuda/answer.h"
#include "libvpm/backend/cuda/device_level.h"
#include "libvpm/backend/cuda/job_order.h"
#include "libvpm/backend/cuda/refined_kernels.h"
#include "libvpm/backend/cuda/resident_batch.h"
#include "libvpm/backend/device_measure.h"
#include "libvpm/core/parallel.h"
#include "libvpm/device/cuda/occupancy.h"
#include "libvpm/scene/cuda/cloud_slot.h"
#include "libvpm/scene/cuda/device_bodies.h"

namespace vpm::cuda {
namespace {

// Names the kernel that answers one pose before a kind of surface.
template <class Surface>
struct PoseKernel {
  using Function = void (*)(RefinedLaunch<Surface>, Pose, unsigned);
  Function function = nullptr;
  unsigned blocks = 0;
  bool meets = true;  // its blocks meet, so all must be resident at once

  // Where a flood decides, small levels have a kernel of their own.
  explicit PoseKernel(const LevelView& level) {
    unsigned per_processor = kManyBlocks;
    if constexpr (Surface::kTellsInside) {
      const bool few = level.count <= kSpheresOfFewBlocks;
      if (few) per_processor = kFewBlocks;
      function = few ? one_pose<Surface, kFewBlocks> : one_pose<Surface, kManyBlocks>;
    } else {
      meets = !is_small(level);
      function = meets ? one_pose<Surface, kManyBlocks> : one_pose_small<Surface>;
    }
    blocks = blocks_that_fit(function, kThreads, per_processor);
  }
};

// Returns how many teams, of an equal number of the device's blocks, answer so many poses soonest.
// A launch takes the fixed time of a pose (meetings and waits, whatever is to be done) once for
// each pose of a team, and at its end as long as the dearest pose takes one team. More teams
// shorten the first and lengthen the second; their sum is least at this root.
unsigned teams_for(unsigned poses, unsigned blocks) {
  // The time of the dearest pose in one block over the fixed time: 12 before a wall, 400 in clutter
  // (H200), and in between here.
  constexpr double kDearest = 66;
  const double teams = std::ceil(std::sqrt(poses * (blocks / kDearest)));
  return std::min(poses, static_cast<unsigned>(teams));
}

// Least blocks of a team: fewer gain nothing in clutter, and take 1.25 of the time before a wall.
constexpr unsigned kLeastBlocks = 4;

// Holds the memory of the blocks that share the work of a batch.
struct Teams {
  Teams(unsigned blocks, const TeamRoom& wanted)
      : count(blocks),
        room(wanted),
        memory(room, count, count, kBatchThreads),
        of_teams(count),
        state(1) {
    of_teams.clear();
    state.clear();
  }
  unsigned count;
  TeamRoom room;
  RefinedMemory memory;
  DeviceArray<TeamState> of_teams;
  DeviceArray<BatchState> state;
};

// Holds the jobs of one launch, and where it takes and leaves them.
struct Batch {
  static constexpr std::size_t kJobs = 16384;

  Batch() : given(kJobs), answers(kJobs), poses(kJobs), sums(kJobs), results(kJobs) {}
  MappedArray<Pose> given;  // of the host, to and from which the device copies at the bus's speed
  MappedArray<RawResult> answers;
  DeviceArray<Pose> poses;
  DeviceArray<SceneSum> sums;  // of poses that lie on the device
  DeviceArray<RawResult> results;
  JobOrder order;
};

class RefinedOnDevice : public DeviceMeasure {
 public:
  // Keeps the tool by reference. The device must be the current one.
  RefinedOnDevice(const ToolModel& tool, const Level& level, const QueryOptions& options,
                  int device)
      : device_(device),
        scale_{tool.center_of_mass, tool.volume, tool.radius},
        level_(tool, level, options.shadows),
        kernels_(BodyKinds::of_surfaces<PoseKernel>(level_.view())),
        memory_(TeamRoom(level_.view()), 1, most_blocks(), kThreads),
        totals_(1),
        counters_(1) {
    totals_.clear();
    counters_.clear();
  }

  void run(const AnyBody& body, std::span<DeviceMeasure* const> measures,
           std::span<const BodyJob> jobs, std::span<BodySum> sums) override {
    const CurrentDevice current(device_);
    body.visit([&](const auto& one) { run_on(one, measures, jobs, sums); });
  }
  std::shared_ptr<const ResidentAnswers> begin(std::span<const AnyBody> scene,
                                               const DevicePoses& poses,
                                               double stiffness) override {
    const CurrentDevice current(device_);
    require_memory_of(device_, poses);
    if (!batch_) batch_ = std::make_unique<Batch>();
    const auto answers = std::make_shared<AnswersOnDevice>(device_, poses.count, scene);
    const Event ready(cudaEventDisableTiming);
    check(cudaEventRecord(ready.get(), static_cast<cudaStream_t>(poses.stream)));
    check(cudaStreamWaitEvent(stream_.get(), ready.get()));
    ToolScale scale = scale_;
    scale.stiffness = stiffness;
    DevicePoses part = poses;
    for (std::size_t begin = 0; begin < poses.count; begin += part.count) {
      part.numbers = poses.numbers + begin * poses.width;
      part.count = std::min(Batch::kJobs, poses.count - begin);
      for (const AnyBody& body : scene)
        body.visit([&](const auto& one) { add_resident(one, part, &body == scene.data()); });
      launch_kernel(tell, size_of(part.count), LaunchKind::independent, stream_.get(), part, scale,
                    batch_->sums.get(), answers->memory() + begin);
    }
    check(cudaEventRecord(answers->told().get(), stream_.get()));
    return answers;
  }
  void keep_only(std::span<const AnyBody> scene) override { copies_.keep_only(scene); }

  void read_states(std::vector<SphereState>& states) override {
    const CurrentDevice current(device_);
    check(cudaStreamSynchronize(stream_.get()));
    std::vector<std::uint32_t> words(states.size());
    check(cudaMemcpy(words.data(), memory_.space().notes[sequence_ % 2].words,
                     words.size() * sizeof(std::uint32_t), cudaMemcpyDeviceToHost));
    std::ranges::transform(words, states.begin(), [](std::uint32_t word) {
      return (word & cell_bit::counted) == 0 ? SphereState::outside
             : (word & cell_bit::cut) != 0   ? SphereState::boundary
                                             : SphereState::inside;
    });
  }
  double flood_microseconds() const override { return flood_microseconds_; }

 private:
  unsigned most_blocks() const {
    return std::apply([](const auto&... kernel) { return std::max({kernel.blocks...}); }, kernels_);
  }

  // Asks the copy of a body.
  template <class Kind>
  void run_on(const Kind& body, std::span<DeviceMeasure* const> measures,
              std::span<const BodyJob> jobs, std::span<BodySum> sums) {
    ask(copies_.of(body).surface(), measures, jobs, sums);
  }
  // Asks a frame that is made on this device, else the copy of what the CPU prepares.
  void run_on(const DepthBody& body, std::span<DeviceMeasure* const> measures,
              std::span<const BodyJob> jobs, std::span<BodySum> sums) {
    if (const CloudSlot* const slot = slot_of(body)) {
      slot->require(stream_.get());
      ask(slot->body().surface(), measures, jobs, sums);
      if (slot->is_sound()) return;
    }
    run_on<DepthBody>(body, measures, jobs, sums);
  }
  // Returns the frame of a body that is made on this device; null if there is none.
  const CloudSlot* slot_of(const DepthBody& body) const {
    const auto* const slot = dynamic_cast<const CloudSlot*>(body.slot());
    const bool is_here = slot != nullptr && slot->options().device.first() == device_;
    return is_here && slot->is_on_device() ? slot : nullptr;
  }

  // Add what a body gives for poses on the device.
  template <class Kind>
  void add_resident(const Kind& body, const DevicePoses& poses, bool is_first) {
    add_resident(copies_.of(body).surface(), body.to_world(), poses, is_first);
  }
  // Waits for a frame that is made on this device, since it may not be sound.
  void add_resident(const DepthBody& body, const DevicePoses& poses, bool is_first) {
    const CloudSlot* const slot = slot_of(body);
    if (slot == nullptr || !slot->is_sound()) return add_resident<DepthBody>(body, poses, is_first);
    slot->require(stream_.get());
    add_resident(slot->body().surface(), body.to_world(), poses, is_first);
  }
  template <class Surface>
  void add_resident(const Surface& surface, const Pose& to_world, const DevicePoses& poses,
                    bool is_first) {
    const auto launch = [&](auto kernel, const auto&... arguments) {
      launch_kernel(kernel, size_of(poses.count), LaunchKind::independent, stream_.get(),
                    arguments...);
    };
    launch(place_poses, poses, to_world, scale_.center_of_mass, batch_->poses.get());
    DeviceMeasure* const self = this;
    const JobOrder::Part all{0, static_cast<unsigned>(poses.count)};
    make_room({&self, 1}, {&all, 1});
    launch_batch(surface, {&self, 1}, {&all, 1});
    launch(add_body<Surface>, batch_->results.get(), poses.count, is_first, batch_->sums.get());
  }

  template <class Surface>
  void ask(const Surface& surface, std::span<DeviceMeasure* const> measures,
           std::span<const BodyJob> jobs, std::span<BodySum> sums) {
    if (measures.size() == 1 && jobs.size() == 1) {
      sums.front() = ask(surface, jobs.front().to_body);
      return;
    }
    if (!batch_) batch_ = std::make_unique<Batch>();
    for (std::size_t begin = 0; begin < jobs.size(); begin += Batch::kJobs) {
      const std::size_t count = std::min(Batch::kJobs, jobs.size() - begin);
      batch_->order.order(jobs.subspan(begin, count), measures.size(), batch_->given.host());
      const std::span<const RawResult> answers = answers_of(surface, measures, count);
      constexpr std::size_t kAnswersPerTask = 1024;
      parallel_for(count, kAnswersPerTask, [&](std::size_t first, std::size_t end) {
        for (std::size_t k = first; k < end; ++k)
          sums[begin + batch_->order.place(k)] = sum_of<Surface>(answers[k]);
      });
    }
  }

  template <class Surface>
  BodySum ask(const Surface& surface, const Pose& to_body) {
    const auto& kernel = std::get<PoseKernel<Surface>>(kernels_);
    const RefinedLaunch<Surface> arguments{level_.view(), surface,         memory_.space(),
                                           totals_.get(), counters_.get(), answer_.device()};
    launch_kernel(kernel.function, {kernel.blocks, kThreads},
                  kernel.meets ? LaunchKind::cooperative : LaunchKind::independent, stream_.get(),
                  arguments, to_body, sequence_ + 1);
    const RawResult raw = wait_for(*answer_.host(), ++sequence_, stream_.get());
    flood_microseconds_ = 1e-3 * raw.flood_ns;
    return sum_of<Surface>(raw);
  }

  // Returns the answers to the ordered jobs of one launch.
  template <class Surface>
  std::span<const RawResult> answers_of(const Surface& surface,
                                        std::span<DeviceMeasure* const> measures,
                                        std::size_t count) {
    check(cudaMemcpyAsync(batch_->poses.get(), batch_->given.host(), count * sizeof(Pose),
                          cudaMemcpyHostToDevice, stream_.get()));
    make_room(measures, batch_->order.parts());
    launch_batch(surface, measures, batch_->order.parts());
    check(cudaMemcpyAsync(batch_->answers.host(), batch_->results.get(), count * sizeof(RawResult),
                          cudaMemcpyDeviceToHost, stream_.get()));
    check(cudaStreamSynchronize(stream_.get()));
    return {batch_->answers.host(), count};
  }

  static const LevelView& level_of(std::span<DeviceMeasure* const> measures,
                                   const JobOrder::Part& part) {
    return dynamic_cast<const RefinedOnDevice&>(*measures[part.tool]).level_.view();
  }
  void make_room(std::span<DeviceMeasure* const> measures, std::span<const JobOrder::Part> parts) {
    TeamRoom wanted = teams_ ? teams_->room : TeamRoom();
    for (const JobOrder::Part& part : parts)
      wanted = wanted.with(TeamRoom(level_of(measures, part)));
    if (teams_ && teams_->room.holds(wanted)) return;
    teams_.reset();  // before more memory is taken
    teams_ = make_teams<Teams>(teams_that_fit(RefinedMemory::bytes_of_team(wanted), kBatchBlocks),
                               wanted);
  }
  // Launches batches of as many tools as a launch has room for.
  template <class Surface>
  void launch_batch(const Surface& surface, std::span<DeviceMeasure* const> measures,
                    std::span<const JobOrder::Part> parts) {
    BatchLaunch<Surface> arguments{{},
                                   {},
                                   surface,
                                   teams_->memory.space(),
                                   teams_->room,
                                   teams_->state.get(),
                                   teams_->of_teams.get()};
    for (unsigned begin = 0; !parts.empty();) {
      const std::size_t count = std::min<std::size_t>(arguments.kTools, parts.size());
      for (std::size_t t = 0; t < count; ++t) {
        arguments.levels[t] = level_of(measures, parts[t]);
        arguments.ends[t] = parts[t].end - begin;
      }
      const unsigned end = parts[count - 1].end;
      launch_poses(arguments, begin, end);
      parts = parts.subspan(count);
      begin = end;
    }
  }

  // Launches the poses from `begin` to `end`: by teams of several blocks, if teams_for() so many
  // leave a team enough of them.
  template <class Surface>
  void launch_poses(BatchLaunch<Surface>& arguments, unsigned begin, unsigned end) {
    const unsigned count = end - begin;
    const auto launch = [&](auto kernel, const LaunchSize& size, LaunchKind kind) {
      launch_kernel(kernel, size, kind, stream_.get(), arguments, batch_->poses.get() + begin,
                    count, batch_->results.get() + begin);
    };
    const unsigned blocks =
        std::min(teams_->count, blocks_that_fit(few_poses<Surface>, kThreads, kFewBlocks));
    const unsigned teams = teams_for(count, blocks);
    arguments.blocks = blocks / teams;
    if (arguments.blocks >= std::min(kLeastBlocks, blocks))
      launch(few_poses<Surface>, {teams * arguments.blocks, kThreads}, LaunchKind::cooperative);
    else
      launch(many_poses<Surface>, {std::min(teams_->count, count), kBatchThreads},
             LaunchKind::independent);
  }

  int device_;
  ToolScale scale_;
  DeviceLevel level_;
  BodyKinds::OfSurfaces<PoseKernel> kernels_;
  Stream stream_;
  MappedArray<Answer> answer_{1};
  unsigned sequence_ = 0;
  double flood_microseconds_ = 0;
  RefinedMemory memory_;
  DeviceArray<Totals> totals_;
  DeviceArray<RefinedCounters> counters_;
  BodyCopies copies_;
  std::unique_ptr<Batch> batch_;
  std::unique_ptr<Teams> teams_;
};

std::unique_ptr<DeviceMeasure> measure_on(int device, const ToolModel& tool, const Level& level,
                                          const QueryOptions& options) {
  const CurrentDevice current(device);
  return std::make_unique<RefinedOnDevice>(tool, level, options, device);
}

}  // namespace
}  // namespace vpm::cuda

namespace vpm {

std::unique_ptr<DeviceMeasure> make_device_measure(const ToolModel& tool, const Level& level,
                                                   const QueryOptions& options) {
  const Device& device = options.device;
  const int count = device.index == Device::kAll ? std::max(1, cuda_device_count()) : 1;
  std::vector<std::unique_ptr<DeviceMeasure>> measures;
  for (int k = 0; k < count; ++k)
    measures.push_back(cuda::measure_on(device.first() + k, tool, level, options));
  if (measures.size() == 1) return std::move(measures.front());
  return std::make_unique<SpreadMeasure>(std::move(measures));
}

}  // namespace vpm
