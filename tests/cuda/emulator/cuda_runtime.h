// Replaces the toolkit's header of this name by the part of CUDA that vpm uses: kernels run in the
// emulator, and the device's memory is the host's.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <type_traits>

#include "tests/cuda/emulator/emulator.h"

#define __global__
#define __device__
#define __host__
#define __shared__ static thread_local
#define __forceinline__ inline
#define __noinline__
#define __launch_bounds__(...)
#define __grid_constant__

struct double2 {
  double x, y;
};
struct alignas(16) float4 {
  float x, y, z, w;
};
struct alignas(16) uint4 {
  unsigned x, y, z, w;
};
struct alignas(8) uint2 {
  unsigned x, y;
};

using std::max;
using std::min;

// --- Threads of a block and of a warp --------------------------------------------------------

inline void __syncthreads() {
  emulator::meet_block(false);
}
inline int __syncthreads_or(int predicate) {
  return emulator::meet_block(predicate != 0) != 0 ? 1 : 0;
}
inline int __syncthreads_and(int predicate) {
  return emulator::meet_block(predicate == 0) == 0 ? 1 : 0;
}
inline void __syncwarp(unsigned mask = ~0U) {
  emulator::vote(mask, false);
}
inline unsigned __ballot_sync(unsigned mask, int predicate) {
  return emulator::vote(mask, predicate != 0);
}
inline int __any_sync(unsigned mask, int predicate) {
  return __ballot_sync(mask, predicate) != 0 ? 1 : 0;
}
inline int __all_sync(unsigned mask, int predicate) {
  return __ballot_sync(mask, predicate == 0 ? 1 : 0) == 0 ? 1 : 0;
}
inline void __threadfence() {
  std::atomic_thread_fence(std::memory_order_seq_cst);
}

namespace emulator {
template <class T>
T shuffle(unsigned mask, T value, unsigned source) {
  static_assert(sizeof(T) <= 8 && std::is_trivially_copyable_v<T>);
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof value);
  bits = exchange(mask, bits, source);
  std::memcpy(&value, &bits, sizeof value);
  return value;
}
inline unsigned lane() {
  return threadIdx.x % kLanes;
}
}  // namespace emulator

template <class T>
T __shfl_sync(unsigned mask, T value, int source, int width = 32) {
  const unsigned first = emulator::lane() / width * width;
  return emulator::shuffle(mask, value, first + static_cast<unsigned>(source) % width);
}
template <class T>
T __shfl_xor_sync(unsigned mask, T value, int bits, int width = 32) {
  const unsigned lane = emulator::lane(), source = lane ^ static_cast<unsigned>(bits);
  return emulator::shuffle(mask, value, source / width == lane / width ? source : lane);
}
template <class T>
T __shfl_down_sync(unsigned mask, T value, unsigned lanes, int width = 32) {
  const unsigned lane = emulator::lane(), source = lane + lanes;
  return emulator::shuffle(mask, value, source / width == lane / width ? source : lane);
}
template <class T>
T __shfl_up_sync(unsigned mask, T value, unsigned lanes, int width = 32) {
  const unsigned lane = emulator::lane();
  return emulator::shuffle(mask, value, lane % width >= lanes ? lane - lanes : lane);
}

// --- Atomics ---------------------------------------------------------------------------------

template <class T>
T atomicAdd(T* place, std::type_identity_t<T> term) {
  return std::atomic_ref<T>(*place).fetch_add(term);
}
template <class T>
T atomicOr(T* place, std::type_identity_t<T> bits) {
  return std::atomic_ref<T>(*place).fetch_or(bits);
}
template <class T>
T atomicExch(T* place, std::type_identity_t<T> value) {
  return std::atomic_ref<T>(*place).exchange(value);
}
template <class T>
T atomicCAS(T* place, std::type_identity_t<T> expected, std::type_identity_t<T> value) {
  std::atomic_ref<T>(*place).compare_exchange_strong(expected, value);
  return expected;
}
template <class T, class Better>
T atomic_choose(T* place, T value, const Better& better) {
  std::atomic_ref<T> at(*place);
  T before = at.load();
  while (better(value, before) && !at.compare_exchange_weak(before, value)) {
  }
  return before;
}
template <class T>
T atomicMin(T* place, std::type_identity_t<T> value) {
  return atomic_choose(place, value, std::less<T>());
}
template <class T>
T atomicMax(T* place, std::type_identity_t<T> value) {
  return atomic_choose(place, value, std::greater<T>());
}

// --- Bits ------------------------------------------------------------------------------------

inline int __popc(unsigned bits) {
  return std::popcount(bits);
}
inline int __ffs(int bits) {
  return bits == 0 ? 0 : std::countr_zero(static_cast<unsigned>(bits)) + 1;
}
inline int __clz(int bits) {
  return std::countl_zero(static_cast<unsigned>(bits));
}
inline int __float_as_int(float value) {
  return std::bit_cast<int>(value);
}
inline float __int_as_float(int bits) {
  return std::bit_cast<float>(bits);
}
inline unsigned __float_as_uint(float value) {
  return std::bit_cast<unsigned>(value);
}
inline float __uint_as_float(unsigned bits) {
  return std::bit_cast<float>(bits);
}
// Return the least and the greatest of three.
inline int __vimax3_s32(int a, int b, int c) {
  return std::max({a, b, c});
}
inline unsigned __vimin3_u32(unsigned a, unsigned b, unsigned c) {
  return std::min({a, b, c});
}
template <class T>
T __ldcv(const T* place) {
  return *place;
}

// --- Memory, streams, events, properties -----------------------------------------------------

enum cudaError_t { cudaSuccess = 0, cudaErrorMemoryAllocation = 2, cudaErrorNotReady = 600 };
enum cudaMemcpyKind { cudaMemcpyHostToDevice, cudaMemcpyDeviceToHost };
enum cudaDeviceAttr {
  cudaDevAttrMultiProcessorCount,
  cudaDevAttrMaxSharedMemoryPerBlockOptin,
  cudaDevAttrKernelExecTimeout
};
enum cudaFuncAttribute { cudaFuncAttributeMaxDynamicSharedMemorySize };
enum : unsigned {
  cudaStreamNonBlocking = 1,
  cudaHostAllocPortable = 1,
  cudaHostAllocMapped = 2,
  cudaEventDefault = 0,
  cudaEventDisableTiming = 2
};
enum cudaLaunchAttributeID {
  cudaLaunchAttributeCooperative,
  cudaLaunchAttributeProgrammaticStreamSerialization
};

namespace emulator {
class Stream;
struct Event;
void enqueue(Stream* stream, std::function<void()> work);
cudaError_t allocate(void** place, std::size_t bytes);
}  // namespace emulator
using cudaStream_t = emulator::Stream*;
using cudaEvent_t = emulator::Event*;
inline const cudaStream_t cudaStreamLegacy = nullptr;

struct cudaDeviceProp {
  char name[256];
};
struct cudaFuncAttributes {
  int ptxVersion, binaryVersion;
};
struct cudaLaunchAttribute {
  cudaLaunchAttributeID id;
  struct {
    int cooperative, programmaticStreamSerializationAllowed;
  } val;
};
struct cudaLaunchConfig_t {
  dim3 gridDim, blockDim;
  std::size_t dynamicSmemBytes;
  cudaStream_t stream;
  cudaLaunchAttribute* attrs;
  unsigned numAttrs;
};

template <class T>
cudaError_t cudaMalloc(T** place, std::size_t bytes) {
  return emulator::allocate(reinterpret_cast<void**>(place), bytes);
}
template <class T>
cudaError_t cudaHostAlloc(T** place, std::size_t bytes, unsigned) {
  return emulator::allocate(reinterpret_cast<void**>(place), bytes);
}
template <class T>
cudaError_t cudaHostGetDevicePointer(T** place, void* host, unsigned) {
  *place = static_cast<T*>(host);
  return cudaSuccess;
}
enum cudaMemoryType { cudaMemoryTypeDevice = 2, cudaMemoryTypeManaged = 3 };
struct cudaPointerAttributes {
  cudaMemoryType type;
  int device;
};
// Memory of the emulated device is the host's, so all of it is its own.
inline cudaError_t cudaPointerGetAttributes(cudaPointerAttributes* attributes, const void*) {
  *attributes = {cudaMemoryTypeDevice, 0};
  return cudaSuccess;
}
cudaError_t cudaFree(void* memory);
cudaError_t cudaFreeHost(void* memory);
cudaError_t cudaMemcpy(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind);
cudaError_t cudaMemcpyAsync(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind,
                            cudaStream_t stream);
cudaError_t cudaMemset(void* place, int value, std::size_t bytes);
cudaError_t cudaMemGetInfo(std::size_t* free, std::size_t* total);

cudaError_t cudaStreamCreateWithFlags(cudaStream_t* stream, unsigned flags);
cudaError_t cudaStreamDestroy(cudaStream_t stream);
cudaError_t cudaStreamSynchronize(cudaStream_t stream);
cudaError_t cudaStreamQuery(cudaStream_t stream);
cudaError_t cudaStreamWaitEvent(cudaStream_t stream, cudaEvent_t event);
cudaError_t cudaDeviceSynchronize();
cudaError_t cudaEventCreateWithFlags(cudaEvent_t* event, unsigned flags);
cudaError_t cudaEventDestroy(cudaEvent_t event);
cudaError_t cudaEventRecord(cudaEvent_t event, cudaStream_t stream = nullptr);
cudaError_t cudaEventQuery(cudaEvent_t event);
cudaError_t cudaEventSynchronize(cudaEvent_t event);
cudaError_t cudaEventElapsedTime(float* milliseconds, cudaEvent_t begin, cudaEvent_t end);

cudaError_t cudaGetDevice(int* device);
cudaError_t cudaSetDevice(int device);
cudaError_t cudaGetDeviceCount(int* count);
cudaError_t cudaGetDeviceProperties(cudaDeviceProp* properties, int device);
cudaError_t cudaDriverGetVersion(int* version);
cudaError_t cudaDeviceGetAttribute(int* value, cudaDeviceAttr attribute, int device);
cudaError_t cudaGetLastError();
const char* cudaGetErrorString(cudaError_t error);

template <class Kernel>
cudaError_t cudaOccupancyMaxActiveBlocksPerMultiprocessor(int* blocks, Kernel*, int, std::size_t) {
  *blocks = 1;
  return cudaSuccess;
}
inline cudaError_t cudaFuncGetAttributes(cudaFuncAttributes* attributes, const void*) {
  *attributes = {90, 90};
  return cudaSuccess;
}
inline cudaError_t cudaFuncSetAttribute(const void*, cudaFuncAttribute, int) {
  return cudaSuccess;
}
inline void cudaGridDependencySynchronize() {}
inline void cudaTriggerProgrammaticLaunchCompletion() {}

// Begins a kernel in a stream; its arguments are copied now.
template <class... Parameters, class... Arguments>
cudaError_t cudaLaunchKernelEx(const cudaLaunchConfig_t* config, void (*kernel)(Parameters...),
                               Arguments&&... arguments) {
  emulator::Launch launch{config->gridDim.x, config->blockDim.x, config->dynamicSmemBytes};
  for (unsigned a = 0; a < config->numAttrs; ++a)
    launch.is_cooperative |= config->attrs[a].id == cudaLaunchAttributeCooperative;
  emulator::enqueue(config->stream,
                    [launch, kernel, ... copies = std::remove_cvref_t<Parameters>(arguments)] {
                      emulator::run(launch, [&] { kernel(copies...); });
                    });
  return cudaSuccess;
}
