// The threads that answer one query: all blocks of a launch together, or one block alone.
//
// Spheres and points are dealt out to parts of the team. A part is one block, so what a block notes
// for itself needs no more than __syncthreads().
#pragma once

#include <cuda/atomic>

#include "libvpm/query/cell.h"

namespace vpm::cuda {

// Most threads of a block, and blocks of one multiprocessor that they leave room for.
inline constexpr unsigned kThreads = 256, kBlocksPerProcessor = 2;

struct Share {
  unsigned part = 0, parts = 0;  // parts == 0: this block has none of that work
};

// A block alone.
class BlockTeam {
 public:
  __device__ Share spheres() const { return {0, 1}; }
  __device__ Share points() const { return {0, 1}; }
  __device__ void sync() { __syncthreads(); }
};

// All blocks of a cooperative launch: the first `sphere_blocks` deal with spheres and meet in
// sync(), the others with points.
class GridTeam {
 public:
  __device__ GridTeam(unsigned* arrived, unsigned sphere_blocks)
      : arrived_(arrived), sphere_blocks_(sphere_blocks) {}
  __device__ Share spheres() const {
    return blockIdx.x < sphere_blocks_ ? Share{blockIdx.x, sphere_blocks_} : Share{};
  }
  __device__ Share points() const {
    return blockIdx.x < sphere_blocks_
               ? Share{}
               : Share{blockIdx.x - sphere_blocks_, gridDim.x - sphere_blocks_};
  }
  __device__ void sync() {
    __syncthreads();
    target_ += sphere_blocks_;
    if (threadIdx.x == 0) {
      ::cuda::atomic_ref<unsigned, ::cuda::thread_scope_device> arrived(*arrived_);
      __threadfence();
      arrived.fetch_add(1, ::cuda::memory_order_relaxed);
      while (arrived.load(::cuda::memory_order_acquire) < target_) {
      }
      __threadfence();
    }
    __syncthreads();
  }

 private:
  unsigned* arrived_;  // 0 at the start of a launch
  unsigned sphere_blocks_, target_ = 0;
};

// Threads of a warp that work on one share together; `width` is a power of two.
struct Tile {
  unsigned width, lane, mask;

  __device__ explicit Tile(unsigned tile_width)
      : width(tile_width), lane(threadIdx.x % tile_width) {
    const unsigned first = threadIdx.x % 32 - lane;
    mask = (width == 32 ? ~0U : (1U << width) - 1) << first;
  }
  __device__ unsigned index() const { return threadIdx.x / width; }
  __device__ unsigned count() const { return blockDim.x / width; }
  __device__ bool leads() const { return lane == 0; }
  __device__ bool any(bool value) const { return __any_sync(mask, value) != 0; }
  template <class T>
  __device__ T from(T value, unsigned source) const {
    return __shfl_sync(mask, value, static_cast<int>(source), static_cast<int>(width));
  }
  __device__ std::int64_t sum(std::int64_t value) const {
    for (unsigned other = width / 2; other > 0; other /= 2)
      value += __shfl_xor_sync(mask, value, static_cast<int>(other), static_cast<int>(width));
    return value;
  }
  template <int Bits>
  __device__ void add_up(FixedSum<Bits>& value) const {
    value.value = sum(value.value);
  }
  __device__ void add_up(ToolSum& s) const {
    add_up(s.volume);
    for (int k = 0; k < 3; ++k) add_up(s.force[k]), add_up(s.torque[k]);
  }
  __device__ void add_up(ContactPlane& p) const {
    for (int k = 0; k < 3; ++k) add_up(p.normal[k]), add_up(p.foot[k]);
    p.count = sum(p.count);
  }
};

// Adds up over a block; the sum is there for thread 0.
__device__ inline std::int64_t sum_of_block(std::int64_t value) {
  __shared__ std::int64_t warps[kThreads / 32];
  const Tile warp(32);
  value = warp.sum(value);
  __syncthreads();
  if (warp.leads()) warps[warp.index()] = value;
  __syncthreads();
  std::int64_t total = 0;
  if (threadIdx.x == 0)
    for (unsigned w = 0; w < blockDim.x / 32; ++w) total += warps[w];
  return total;
}

}  // namespace vpm::cuda
