#include "libvpm/device/cuda/device_array.h"
#include "tests/cuda/resident_poses.h"

namespace vpm::testing {

std::vector<DeviceResult> ask_on_device(ToolQuery& query, std::span<const AnyBody> scene,
                                        const std::vector<double>& numbers, std::uint32_t width) {
  const cuda::Stream stream;
  const cuda::DeviceArray<double> poses(numbers);
  const auto answers = query.run(scene, {poses.get(), numbers.size() / width, width, stream.get()});
  answers->wait_in(stream.get());
  std::vector<DeviceResult> rows(answers->size());
  cuda::check(cudaMemcpyAsync(rows.data(), answers->rows(), rows.size() * sizeof(DeviceResult),
                              cudaMemcpyDeviceToHost, stream.get()));
  cuda::check(cudaStreamSynchronize(stream.get()));
  return rows;
}

}  // namespace vpm::testing
