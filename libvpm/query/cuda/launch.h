// Streams, sizes of launches, and waiting for answers.
#pragma once

#include <algorithm>

#include "libvpm/query/cuda/device_array.h"
#include "libvpm/query/cuda/team.h"

namespace vpm::cuda {

class Stream {
 public:
  Stream() { check(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking)); }
  ~Stream() { cudaStreamDestroy(stream_); }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  cudaStream_t get() const { return stream_; }

 private:
  cudaStream_t stream_ = nullptr;
};

// Of the current device.
inline unsigned processor_count() {
  int device = 0, count = 0;
  check(cudaGetDevice(&device));
  check(cudaDeviceGetAttribute(&count, cudaDevAttrMultiProcessorCount, device));
  return static_cast<unsigned>(count);
}

// Blocks that fill the device, as far as their memory takes no more than a quarter of it.
inline unsigned teams_that_fit(std::size_t bytes_of_team) {
  std::size_t free = 0, total = 0;
  check(cudaMemGetInfo(&free, &total));
  const std::size_t fit = std::min(free, total / 4) / std::max<std::size_t>(bytes_of_team, 1);
  const std::size_t wanted = std::size_t{kBlocksPerProcessor} * processor_count();
  return static_cast<unsigned>(std::clamp<std::size_t>(fit, 1, wanted));
}

// Looks at the host's own memory until the device has written `sequence` there; that is quicker
// than waiting for the stream.
inline void wait_for(const unsigned& written, unsigned sequence, cudaStream_t stream) {
  constexpr unsigned kLooksPerCheck = 1U << 16;  // whether the launch has failed
  const volatile unsigned& seen = written;
  for (unsigned looks = 1; seen != sequence; ++looks) {
    if (looks % kLooksPerCheck != 0) continue;
    const cudaError_t status = cudaStreamQuery(stream);
    if (status != cudaErrorNotReady) check(status);
  }
  __atomic_thread_fence(__ATOMIC_ACQUIRE);
}

}  // namespace vpm::cuda
