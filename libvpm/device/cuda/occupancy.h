// Sizes launches by what the current device holds at once.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>

#include "libvpm/device/cuda/runtime.h"

namespace vpm::cuda {

// Returns the number of multiprocessors of the current device.
inline unsigned processor_count() {
  int count = 0;
  check(cudaDeviceGetAttribute(&count, cudaDevAttrMultiProcessorCount, current_device()));
  return static_cast<unsigned>(count);
}

// Returns how many blocks of a kernel the current device holds at once, at most `wanted` per
// multiprocessor.
template <class Kernel>
unsigned blocks_that_fit(Kernel* kernel, unsigned threads, unsigned wanted) {
  int blocks = 0;
  check(
      cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, kernel, static_cast<int>(threads), 0));
  return std::clamp(static_cast<unsigned>(blocks), 1U, wanted) * processor_count();
}

// Returns the number of blocks that fill the device, as far as their memory takes no more than a
// quarter of it and half of what is free.
inline unsigned teams_that_fit(std::size_t bytes_of_team, unsigned blocks_per_processor) {
  std::size_t free = 0, total = 0;
  check(cudaMemGetInfo(&free, &total));
  const std::size_t fit = std::min(free / 2, total / 4) / std::max<std::size_t>(bytes_of_team, 1);
  const std::size_t wanted = std::size_t{blocks_per_processor} * processor_count();
  return static_cast<unsigned>(std::clamp<std::size_t>(fit, 1, wanted));
}

// Returns Teams(count, arguments...), which takes memory for `most` teams, or half as many again
// and again where other programs have taken what was free.
template <class Teams, class... Arguments>
std::unique_ptr<Teams> make_teams(unsigned most, const Arguments&... arguments) {
  for (unsigned count = most;; count /= 2) {
    try {
      return std::make_unique<Teams>(count, arguments...);
    } catch (const Error&) {
      if (cudaGetLastError() != cudaErrorMemoryAllocation || count == 1) throw;
    }
  }
}

}  // namespace vpm::cuda
