// Groups the threads that do one piece of work: all blocks of a launch, or one block alone.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>
#include <cuda/atomic>

namespace vpm::cuda {

// Returns the device's clock, ns, which all blocks share.
__device__ inline std::uint64_t now() {
#ifdef __CUDACC__
  std::uint64_t time;
  asm volatile("mov.u64 %0, %%globaltimer;" : "=l"(time));
  return time;
#else
  return emulator::nanoseconds();
#endif
}

// Counts a block, called by all its threads. True for the last of `all` blocks, which then sees all
// writes that the others made before.
__device__ inline bool is_last_of(unsigned& come, unsigned all) {
  using Count = ::cuda::atomic_ref<unsigned, ::cuda::thread_scope_device>;
  __shared__ bool is_last;
  __syncthreads();
  // Uses no fence, which costs as much as the addition and would be needed on both sides of it.
  if (threadIdx.x == 0) is_last = Count(come).fetch_add(1, ::cuda::memory_order_acq_rel) == all - 1;
  __syncthreads();
  return is_last;
}

// Rows dealt out to blocks: row k goes to part k % parts.
struct BlockRange {
  unsigned part = 0, parts = 1;
};

// Makes one block the team.
class BlockTeam {
 public:
  static constexpr bool kIsBlock = true;
  __device__ unsigned thread() const { return threadIdx.x; }
  __device__ unsigned threads() const { return blockDim.x; }
  __device__ BlockRange block() const { return {}; }
  __device__ void sync() { __syncthreads(); }
};

// Makes all blocks of a cooperative launch the team.
class GridTeam {
 public:
  static constexpr bool kIsBlock = false;
  __device__ explicit GridTeam(unsigned* arrived) : arrived_(arrived) {}
  __device__ unsigned thread() const { return blockIdx.x * blockDim.x + threadIdx.x; }
  __device__ unsigned threads() const { return gridDim.x * blockDim.x; }
  __device__ BlockRange block() const { return {blockIdx.x, gridDim.x}; }
  __device__ void sync() {
    arrive();
    wait();
  }
  // Begins sync(). True for the last block to arrive.
  __device__ bool arrive() {
    target_ += gridDim.x;
    return is_last_of(*arrived_, target_);
  }
  // Ends sync(). Spins with relaxed loads, since each acquire drops the multiprocessor's L1 cache,
  // which other blocks may still need.
  __device__ void wait() {
    if (threadIdx.x == 0) {
      while (count().load(::cuda::memory_order_relaxed) < target_) {
      }
      static_cast<void>(count().load(::cuda::memory_order_acquire));
    }
    __syncthreads();
  }

 private:
  using Count = ::cuda::atomic_ref<unsigned, ::cuda::thread_scope_device>;
  __device__ Count count() const { return Count(*arrived_); }

  unsigned* arrived_;  // 0 at the start of a query
  unsigned target_ = 0;
};

}  // namespace vpm::cuda
