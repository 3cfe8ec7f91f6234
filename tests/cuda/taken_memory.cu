#include "libvpm/device/cuda/device_array.h"
#include "libvpm/device/cuda/occupancy.h"
#include "tests/cuda/taken_memory.h"

namespace vpm::testing {
namespace {

std::size_t free_memory() {
  std::size_t free = 0, total = 0;
  cuda::check(cudaMemGetInfo(&free, &total));
  return free;
}

struct Teams {
  Teams(unsigned teams, std::size_t bytes) : count(teams), memory(teams * bytes) {}
  unsigned count;
  cuda::DeviceArray<std::byte> memory;
};

}  // namespace

TakenMemory::TakenMemory(std::size_t left) {
  const std::size_t free = free_memory();
  if (free > left) cuda::check(cudaMalloc(&taken_, free - left));
}

TakenMemory::~TakenMemory() {
  cudaFree(taken_);
}

unsigned teams_made(unsigned wanted, double part_of_free) {
  const auto bytes = static_cast<std::size_t>(part_of_free * static_cast<double>(free_memory()));
  const unsigned count = cuda::make_teams<Teams>(wanted, bytes)->count;
  cuda::check(cudaGetLastError());  // clears the error of what did not fit
  return count;
}

}  // namespace vpm::testing
