#include <cuda_runtime.h>

#include <stdexcept>

#include "libvpm/core/division.h"
#include "tests/cuda/device_division.h"

namespace vpm::testing {
namespace {

__device__ double reciprocal_of(double b) {
  return quotient(1, b);
}
__device__ float reciprocal_of(float b) {
  return reciprocal(b);
}

template <class Real>
__global__ void divide(const Operands<Real>* operands, std::size_t count, Divided<Real>* divided) {
  const std::size_t i = std::size_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (i >= count) return;
  const auto [a, b] = operands[i];
  divided[i] = {quotient(a, b), square_root(std::fabs(a)), reciprocal_of(b)};
}

void check(cudaError_t status) {
  if (status != cudaSuccess) throw std::runtime_error(cudaGetErrorString(status));
}

}  // namespace

template <class Real>
std::vector<Divided<Real>> divide_on_device(const std::vector<Operands<Real>>& operands) {
  const std::size_t bytes = operands.size() * sizeof(Operands<Real>);
  std::vector<Divided<Real>> divided(operands.size());
  const std::size_t divided_bytes = divided.size() * sizeof(Divided<Real>);
  Operands<Real>* there = nullptr;
  Divided<Real>* divided_there = nullptr;
  check(cudaMalloc(&there, bytes));
  check(cudaMalloc(&divided_there, divided_bytes));
  check(cudaMemcpy(there, operands.data(), bytes, cudaMemcpyHostToDevice));
  constexpr unsigned kThreads = 256;
  divide<<<static_cast<unsigned>((operands.size() + kThreads - 1) / kThreads), kThreads>>>(
      there, operands.size(), divided_there);
  check(cudaGetLastError());
  check(cudaMemcpy(divided.data(), divided_there, divided_bytes, cudaMemcpyDeviceToHost));
  check(cudaFree(there));
  check(cudaFree(divided_there));
  return divided;
}

template std::vector<Divided<float>> divide_on_device(const std::vector<Operands<float>>&);
template std::vector<Divided<double>> divide_on_device(const std::vector<Operands<double>>&);

}  // namespace vpm::testing
