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

// Names all blocks of a launch.
struct AllBlocks {
  __device__ BlockRange range() const { return {blockIdx.x, gridDim.x}; }
};
// Names some blocks of a launch, of which this one is a part.
struct SomeBlocks {
  BlockRange blocks;
  __device__ BlockRange range() const { return blocks; }
};

// Makes blocks of a cooperative launch the team: all of them, or as many as Blocks names.
template <class Blocks>
class MeetingTeam {
 public:
  static constexpr bool kIsBlock = false;
  // Meets by a counter of the team's own, which is 0 before.
  __device__ explicit MeetingTeam(unsigned* arrived, Blocks blocks = {})
      : arrived_(arrived), blocks_(blocks) {}
  __device__ unsigned thread() const { return block().part * blockDim.x + threadIdx.x; }
  __device__ unsigned threads() const { return block().parts * blockDim.x; }
  __device__ BlockRange block() const { return blocks_.range(); }
  __device__ void sync() {
    arrive();
    wait();
  }
  // Begins sync(). True for the last block to arrive.
  __device__ bool arrive() {
    target_ += block().parts;
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

  unsigned* arrived_;
  [[no_unique_address]] Blocks blocks_;
  unsigned target_ = 0;
};
using GridTeam = MeetingTeam<AllBlocks>;

}  // namespace vpm::cuda
