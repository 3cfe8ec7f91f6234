// frame-stages CLOUD.vpmc [JSON]: times the stages of a depth frame on the device's clock:
// launching nothing and copying the image, which are the floors of the other times; taking the
// image; making its cloud. Eight copies of everything take turns, so that caches do not help.
#include <algorithm>
#include <cstring>
#include <fstream>
#include <iostream>
#include <memory>

#include "libvpm/cloud/cloud.h"
#include "libvpm/scene/cuda/cloud_slot.h"

namespace {

using namespace vpm;
namespace device = vpm::cuda;

constexpr int kCopies = 8, kLaunches = 40, kRounds = 50, kWarmUp = 10;

// Launches in a row as one graph, so that the host's time for launching is not counted.
class Graph {
 public:
  template <class Launch>
  Graph(cudaStream_t stream, const Launch& launch) {
    cudaGraph_t graph = nullptr;
    device::check(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal));
    for (int k = 0; k < kLaunches; ++k) launch(static_cast<std::size_t>(k % kCopies));
    device::check(cudaStreamEndCapture(stream, &graph));
    device::check(cudaGraphInstantiate(&executable_, graph, 0));
    device::check(cudaGraphDestroy(graph));
  }
  Graph(const Graph&) = delete;
  Graph& operator=(const Graph&) = delete;
  ~Graph() { cudaGraphExecDestroy(executable_); }
  void launch(cudaStream_t stream) const { device::check(cudaGraphLaunch(executable_, stream)); }

 private:
  cudaGraphExec_t executable_ = nullptr;
};

// Returns the microseconds of one of many launches in a row, the median over rounds.
template <class Launch>
double time_of(cudaStream_t stream, const Launch& launch) {
  const Graph graph(stream, launch);
  const device::Event begin, end;
  std::vector<double> times;
  for (int round = -kWarmUp; round < kRounds; ++round) {
    device::check(cudaEventRecord(begin.get(), stream));
    graph.launch(stream);
    device::check(cudaEventRecord(end.get(), stream));
    device::check(cudaEventSynchronize(end.get()));
    if (round >= 0) times.push_back(microseconds_between(begin, end) / kLaunches);
  }
  std::nth_element(times.begin(), times.begin() + kRounds / 2, times.end());
  return times[kRounds / 2];
}

__global__ void do_nothing() {}

DepthFrameOptions options_of(const Camera& camera, NormalMethod method, bool in_counts) {
  constexpr double kCountsPerMetre = 5000;
  return {camera.intrinsics, camera.width,
          camera.height,     in_counts ? std::optional(kCountsPerMetre) : std::nullopt,
          {method},          {Device::Kind::cuda, 0}};
}

void fill(device::CloudSlot& slot, const std::vector<float>& depth) {
  const auto& counts_per_metre = slot.options().counts_per_metre;
  if (!counts_per_metre) {
    std::memcpy(slot.image(), depth.data(), slot.image_bytes());
    return;
  }
  auto* const counts = reinterpret_cast<std::uint16_t*>(slot.image());
  for (std::size_t i = 0; i < depth.size(); ++i)
    counts[i] = static_cast<std::uint16_t>(std::min(depth[i] * *counts_per_metre + 0.5, 65535.0));
}

nlohmann::json stages(const CloudSensor& sensor, NormalMethod method, bool in_counts) {
  const DepthFrameOptions options = options_of(sensor.camera, method, in_counts);
  device::Stream stream;
  std::vector<std::unique_ptr<device::CloudSlot>> slots;
  for (int k = 0; k < kCopies; ++k) {
    slots.push_back(std::make_unique<device::CloudSlot>(options));
    fill(*slots.back(), sensor.depth.depth);
  }
  const std::size_t bytes = slots[0]->image_bytes();
  const device::DeviceArray<std::byte> copy(bytes * kCopies);
  const double copying = time_of(stream.get(), [&](std::size_t k) {
    device::check(cudaMemcpyAsync(copy.get() + k * bytes, slots[k]->image(), bytes,
                                  cudaMemcpyHostToDevice, stream.get()));
  });
  const double launching = time_of(stream.get(), [&](std::size_t) {
    do_nothing<<<1, 1, 0, stream.get()>>>();
    device::check(cudaGetLastError());
  });
  const double taking = time_of(stream.get(), [&](std::size_t k) { slots[k]->take(stream.get()); });
  const double making = time_of(stream.get(), [&](std::size_t k) { slots[k]->make(stream.get()); });
  const double both = time_of(stream.get(), [&](std::size_t k) {
    slots[k]->take(stream.get());
    slots[k]->make(stream.get());
  });
  return {{"method", to_text(method)},
          {"image", in_counts ? "counts" : "metres"},
          {"bytes", bytes},
          {"launch_us", launching},
          {"copy_us", copying},
          {"take_us", taking},
          {"make_us", making},
          {"take_and_make_us", both}};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    std::cerr << "usage: frame-stages CLOUD.vpmc [JSON]\n";
    return 2;
  }
  try {
    const Cloud cloud = read_cloud(argv[1]);
    if (!cloud.sensor) refuse(std::string(argv[1]) + ": the cloud has no camera");
    device_from_text("cuda");
    nlohmann::json results;
    for (const NormalMethod method : {NormalMethod::inverse_depth, NormalMethod::pca}) {
      for (const bool in_counts : {true, false}) {
        results.push_back(stages(*cloud.sensor, method, in_counts));
        std::cout << results.back().dump() << '\n';
      }
    }
    if (argc == 3) std::ofstream(argv[2]) << results.dump(2) << '\n';
    return 0;
  } catch (const Error& fault) {
    std::cerr << "frame-stages: " << fault.what() << '\n';
    return 1;
  }
}
