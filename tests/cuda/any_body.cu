#include "libvpm/backend/cuda/answer.h"
#include "libvpm/backend/cuda/device_level.h"
#include "libvpm/backend/cuda/refined_kernels.h"
#include "tests/cuda/any_body.h"

namespace vpm::testing {
namespace {

template <class Body>
BodySum run(const ToolModel& tool, const Body& body, const Pose& pose) {
  using namespace vpm::cuda;
  constexpr auto kKernel = one_pose<Body, kManyBlocks>;
  const DeviceLevel level(tool, tool.levels.back(), Shadows::near);
  const unsigned blocks = blocks_that_fit(kKernel, kThreads, kManyBlocks);
  const RefinedMemory memory(TeamRoom(level.view()), 1, blocks, kThreads);
  DeviceArray<Totals> totals(1);
  DeviceArray<RefinedCounters> counters(1);
  totals.clear();
  counters.clear();
  const MappedArray<Answer> answer(1);
  const Stream stream;
  const Pose to_surface{pose.rotation, pose * tool.center_of_mass};
  const RefinedLaunch<Body> launch{level.view(), body,           memory.space(),
                                   totals.get(), counters.get(), answer.device()};
  launch_kernel(kKernel, {blocks, kThreads}, LaunchKind::cooperative, stream.get(), launch,
                to_surface, 1U);
  const RawResult raw = wait_for(*answer.host(), 1, stream.get());
  check(cudaStreamSynchronize(stream.get()));
  return sum_of<Body>(raw);
}

}  // namespace

BodySum run_on_device(const ToolModel& tool, const HalfSpace& body, const Pose& pose) {
  return run(tool, body, pose);
}
BodySum run_on_device(const ToolModel& tool, const SeenHalfSpace& body, const Pose& pose) {
  return run(tool, body, pose);
}
BodySum run_on_device(const ToolModel& tool, const Step& body, const Pose& pose) {
  return run(tool, body, pose);
}
BodySum run_on_device(const ToolModel& tool, const Both<HalfSpace, HalfSpace>& body,
                      const Pose& pose) {
  return run(tool, body, pose);
}

}  // namespace vpm::testing
