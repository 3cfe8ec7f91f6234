#include <cuda_runtime.h>

#include <stdexcept>

#include "libvpm/core/division.h"
#include "tests/cuda/device_division.h"

namespace vpm::testing {
namespace {

__global__ void divide(const Operands* operands, std::size_t count, Divided* divided) {
  const std::size_t i = std::size_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (i >= count) return;
  const auto [a, b] = operands[i];
  divided[i] = {quotient(a, b), square_root(std::fabs(a))};
}

void check(cudaError_t status) {
  if (status != cudaSuccess) throw std::runtime_error(cudaGetErrorString(status));
}

}  // namespace

std::vector<Divided> divide_on_device(const std::vector<Operands>& operands) {
  std::vector<Divided> divided(operands.size());
  Operands* there = nullptr;
  Divided* divided_there = nullptr;
  check(cudaMalloc(&there, operands.size() * sizeof(Operands)));
  check(cudaMalloc(&divided_there, operands.size() * sizeof(Divided)));
  check(cudaMemcpy(there, operands.data(), operands.size() * sizeof(Operands),
                   cudaMemcpyHostToDevice));
  constexpr unsigned kThreads = 256;
  divide<<<static_cast<unsigned>((operands.size() + kThreads - 1) / kThreads), kThreads>>>(
      there, operands.size(), divided_there);
  check(cudaGetLastError());
  check(cudaMemcpy(divided.data(), divided_there, divided.size() * sizeof(Divided),
                   cudaMemcpyDeviceToHost));
  check(cudaFree(there));
  check(cudaFree(divided_there));
  return divided;
}

}  // namespace vpm::testing
