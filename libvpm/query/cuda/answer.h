// From the threads of a query to the program that waits for it.
#pragma once

#include <cstddef>

#include "libvpm/device/cuda/numbered_word.h"
#include "libvpm/query/cuda/team.h"
#include "libvpm/query/cuda/views.h"

namespace vpm::cuda {

// Where the host looks for a result, in its own memory: the words of a RawResult.
struct Answer {
  static constexpr unsigned kWords = 20;
  static_assert(sizeof(RawResult) == kWords * sizeof(std::uint32_t));

  NumberedWord words[kWords] = {};
};

// Nanoseconds of the device's clock, which all blocks share.
__device__ inline std::uint64_t now() {
  std::uint64_t time;
  asm volatile("mov.u64 %0, %%globaltimer;" : "=l"(time));
  return time;
}

// This thread's word of a result; of the first ones of a block.
__device__ inline std::uint32_t word_of(const RawResult& result) {
  const unsigned k = threadIdx.x;
  return k < Answer::kWords ? reinterpret_cast<const std::uint32_t*>(&result)[k] : 0;
}

// By the threads of a block, with their words. `flood_ns` goes with the result.
__device__ inline void send(std::uint32_t word, std::uint64_t flood_ns, Answer* answer,
                            unsigned sequence) {
  constexpr unsigned kFlood = offsetof(RawResult, flood_ns) / sizeof(std::uint32_t);
  const unsigned k = threadIdx.x;
  if (k < Answer::kWords)
    put(numbered(sequence, k == kFlood ? static_cast<std::uint32_t>(flood_ns) : word),
        answer->words[k]);
}

// Sums of one query over its blocks. All 0 between queries: the last block clears them.
struct Totals {
  RawResult result;
  unsigned done = 0;     // blocks that have added their part
  unsigned arrived = 0;  // of GridTeam
};

// Adds up a block's parts into `total`, which may lie in shared memory.
__device__ inline void add_block(const RawResult& part, RawResult& total) {
  constexpr int kMostWarps = kMostThreads / 32, kValues = 10;
  __shared__ std::int64_t values[kValues][kMostWarps];
  const ToolSum& s = part.sum;
  const std::int64_t mine[kValues] = {
      s.volume.value,    s.force[0].value,  s.force[1].value, s.force[2].value, s.torque[0].value,
      s.torque[1].value, s.torque[2].value, part.boundary,    part.inside,      part.points};
  const Tile warp(32);
  __syncthreads();
#pragma unroll
  for (int k = 0; k < kValues; ++k) {
    const std::int64_t sum = warp.sum(mine[k]);
    if (warp.leads()) values[k][threadIdx.x / 32] = sum;
  }
  __syncthreads();
  if (threadIdx.x >= kValues) return;
  std::int64_t sum = 0;
  for (unsigned w = 0; w < blockDim.x / 32; ++w) sum += values[threadIdx.x][w];
  if (sum == 0) return;
  ToolSum& t = total.sum;
  std::int64_t* const sums[] = {&t.volume.value,   &t.force[0].value,  &t.force[1].value,
                                &t.force[2].value, &t.torque[0].value, &t.torque[1].value,
                                &t.torque[2].value};
  unsigned* const counts[] = {&total.boundary, &total.inside, &total.points};
  if (threadIdx.x < 7) {
    add_term(*sums[threadIdx.x], sum);
  } else {
    atomicAdd(counts[threadIdx.x - 7], static_cast<unsigned>(sum));
  }
}

// By all threads of a block: whether it is the last one of the launch to come here; what the others
// did before is seen then.
__device__ inline bool is_last_block(unsigned& done) {
  __shared__ bool last;
  __syncthreads();
  if (threadIdx.x == 0) {
    fence();
    last = atomicAdd(&done, 1U) == gridDim.x - 1;
    if (last) fence();
  }
  __syncthreads();
  return last;
}

}  // namespace vpm::cuda
