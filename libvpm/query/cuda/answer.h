// From the threads of a query to the program that waits for it.
#pragma once

#include "libvpm/query/cuda/team.h"
#include "libvpm/query/cuda/views.h"

namespace vpm::cuda {

// Where the host looks for a result, in its own memory: it is there once `sequence` is the query's.
struct Answer {
  RawResult result;
  unsigned sequence = 0;
};

// Sums of one query over its blocks. All 0 between launches: the last block clears them.
struct Totals {
  RawResult result;
  unsigned done = 0;     // blocks that have added their part
  unsigned arrived = 0;  // of GridTeam
};

// Adds up a block's parts into `total`, which may lie in shared memory.
__device__ inline void add_block(const RawResult& part, RawResult& total) {
  constexpr int kWarps = kThreads / 32, kValues = 10;
  __shared__ std::int64_t values[kValues][kWarps];
  const ToolSum& s = part.sum;
  const std::int64_t mine[kValues] = {
      s.volume.value,    s.force[0].value,  s.force[1].value, s.force[2].value, s.torque[0].value,
      s.torque[1].value, s.torque[2].value, part.boundary,    part.inside,      part.points};
  const Tile warp(32);
  __syncthreads();
#pragma unroll
  for (int k = 0; k < kValues; ++k) {
    const std::int64_t sum = warp.sum(mine[k]);
    if (warp.leads()) values[k][warp.index()] = sum;
  }
  __syncthreads();
  if (threadIdx.x >= kValues) return;
  std::int64_t sum = 0;
  for (int w = 0; w < kWarps; ++w) sum += values[threadIdx.x][w];
  if (sum == 0) return;
  ToolSum& t = total.sum;
  std::int64_t* const sums[] = {&t.volume.value,   &t.force[0].value,  &t.force[1].value,
                                &t.force[2].value, &t.torque[0].value, &t.torque[1].value,
                                &t.torque[2].value};
  unsigned* const counts[] = {&total.boundary, &total.inside, &total.points};
  if (threadIdx.x < 7) {
    atomicAdd(reinterpret_cast<unsigned long long*>(sums[threadIdx.x]),
              static_cast<unsigned long long>(sum));
  } else {
    atomicAdd(counts[threadIdx.x - 7], static_cast<unsigned>(sum));
  }
}

// Called by all threads of each block of a launch with the block's part. The last block sends the
// answer and clears `totals`; it returns true there, for thread 0.
__device__ inline bool finish(const RawResult& part, Totals& totals, Answer* answer,
                              unsigned sequence) {
  add_block(part, totals.result);
  __threadfence();
  __syncthreads();
  if (threadIdx.x != 0 || atomicAdd(&totals.done, 1U) != gridDim.x - 1) return false;
  __threadfence();
  answer->result = *const_cast<const RawResult*>(&totals.result);
  __threadfence_system();
  *static_cast<volatile unsigned*>(&answer->sequence) = sequence;
  totals = Totals{};
  return true;
}

}  // namespace vpm::cuda
