// Groups the threads that answer one query: all blocks of a launch, or one block alone.
#pragma once

#include <cuda_runtime.h>

#include <cuda/atomic>

#include "libvpm/measure/cell_measure.h"
#include "libvpm/scene/depth/depth_sampler.h"

namespace vpm::cuda {

// Sets the threads of a block: for one pose with other blocks, and for many poses alone. Registers
// limit the refined measure: fewer finish a pose sooner, more get through more poses.
inline constexpr unsigned kThreads = 128, kBatchThreads = 192;
inline constexpr unsigned kPaperThreads = 256, kPaperBlocksPerProcessor = 2;
inline constexpr unsigned kMostThreads = 256;

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

// Groups lanes of a warp that work together; `width` is a power of two.
struct Subwarp {
  unsigned width, lane, mask;

  __device__ explicit Subwarp(unsigned tile_width)
      : width(tile_width), lane(threadIdx.x % tile_width) {
    const unsigned first = threadIdx.x % 32 - lane;
    mask = (width == 32 ? ~0U : (1U << width) - 1) << first;
  }
  __device__ bool leads() const { return lane == 0; }
  // Uses shuffles: ballots with a mask for each subwarp would serialise.
  __device__ bool any(bool value) const {
    unsigned found = value ? 1 : 0;
#pragma unroll 1
    for (unsigned other = width / 2; other > 0; other /= 2)
      found |= __shfl_xor_sync(mask, found, static_cast<int>(other), static_cast<int>(width));
    return found != 0;
  }
  // Returns a bit for each lane.
  __device__ unsigned which(bool value) const {
    return __ballot_sync(mask, value) >> (threadIdx.x % 32 - lane);
  }
  // Returns the number of lanes before this one that which() has found.
  __device__ unsigned before(unsigned found) const {
    return __popc(found & ((1U << lane) - 1));
  }
  // Counts the lanes that which() has found. Returns the slot of each of them.
  __device__ unsigned take_slots(unsigned& counter, unsigned found) const {
    unsigned slot = 0;
    if (leads() && found != 0) slot = atomicAdd(&counter, __popc(found));
    return from(slot, 0) + before(found);
  }
  template <class T>
  __device__ T from(T value, unsigned source) const {
    return __shfl_sync(mask, value, static_cast<int>(source), static_cast<int>(width));
  }
  __device__ Vec3 from(Vec3 v, unsigned source) const {
    return {from(v.x, source), from(v.y, source), from(v.z, source)};
  }
  __device__ PixelRectangle from(const PixelRectangle& r, unsigned source) const {
    return {from(r.u0, source), from(r.v0, source), from(r.u1, source), from(r.v1, source)};
  }
  // Returns the value of the lane `lanes` further on.
  __device__ double from_next(double value, unsigned lanes) const {
    return __shfl_down_sync(mask, value, lanes, static_cast<int>(width));
  }
  __device__ std::int64_t sum(std::int64_t value) const {
    for (unsigned other = width / 2; other > 0; other /= 2)
      value += __shfl_xor_sync(mask, value, static_cast<int>(other), static_cast<int>(width));
    return value;
  }
};

// Returns the first of the neighbouring samples that share a direction with this lane's; `sharing`
// has a bit for each lane.
__device__ inline unsigned direction_leader(unsigned lane, unsigned sharing) {
  const unsigned begin = neighbors_of(lane) * kNeighborSamples;
  return begin + static_cast<unsigned>(__ffs(static_cast<int>(sharing >> begin))) - 1;
}

// Counts the places about its middle at which a cluster is sampled (SampleInTurn). Returns one of
// them; an index would put them all in local memory.
inline constexpr unsigned kPlacesAround = 4;
__device__ inline Vec3 place_of(const Vec3 (&places)[kPlacesAround], unsigned k) {
  return k == 0 ? places[0] : k == 1 ? places[1] : k == 2 ? places[2] : places[3];
}

// Counts the 64-bit terms of a ToolSum or ContactPlane.
inline constexpr int kTerms = 7;
template <class Sum>
__device__ std::int64_t* terms_of(Sum& sum) {
  static_assert(sizeof(Sum) == kTerms * sizeof(std::int64_t));
  return reinterpret_cast<std::int64_t*>(&sum);
}

// Adds up over a subwarp; all its lanes receive the sum.
template <class Sum>
__device__ void add_up(const Subwarp& subwarp, Sum& sum) {
  std::int64_t* const terms = terms_of(sum);
  // Shuffles all terms in each step, so that they overlap.
#pragma unroll 1
  for (unsigned other = subwarp.width / 2; other > 0; other /= 2) {
#pragma unroll
    for (int k = 0; k < kTerms; ++k)
      terms[k] += __shfl_xor_sync(subwarp.mask, terms[k], static_cast<int>(other),
                                  static_cast<int>(subwarp.width));
  }
}

// Adds up the rows of a subwarp's lanes for its first lane. Missing rows count as 0.
__device__ inline void add_up(const Subwarp& subwarp, ClippedMoments& row) {
#pragma unroll 1
  for (unsigned half = subwarp.width / 2; half > 0; half /= 2) {
    row.weight += subwarp.from_next(row.weight, half);
    row.moment += Vec3{subwarp.from_next(row.moment.x, half), subwarp.from_next(row.moment.y, half),
                       subwarp.from_next(row.moment.z, half)};
  }
  row.is_cut = subwarp.any(row.is_cut);
}

// Adds a term to a sum, atomically.
__device__ inline void add_term(std::int64_t& sum, std::int64_t term) {
  atomicAdd(reinterpret_cast<unsigned long long*>(&sum), static_cast<unsigned long long>(term));
}

template <class Sum>
__device__ void add_atomically(Sum part, Sum& sum) {
  const std::int64_t* const terms = terms_of(part);
  std::int64_t* const totals = terms_of(sum);
#pragma unroll
  for (int k = 0; k < kTerms; ++k)
    if (terms[k] != 0) add_term(totals[k], terms[k]);
}

}  // namespace vpm::cuda
