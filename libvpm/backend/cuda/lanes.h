// Deals the samples of a cell out to the lanes of a warp, and adds up what lanes and blocks find.
#pragma once

#include "libvpm/backend/cuda/views.h"
#include "libvpm/device/cuda/subwarp.h"
#include "libvpm/device/cuda/team.h"

namespace vpm::cuda {

// Threads of a block: kThreads where all blocks share one pose, kBatchThreads where each block has
// a pose of its own. Registers limit the refined measure: fewer threads finish one pose sooner,
// more threads get through more poses.
inline constexpr unsigned kThreads = 128, kBatchThreads = 192;
inline constexpr unsigned kMostThreads = kBatchThreads;
static_assert(kThreads <= kMostThreads);
inline constexpr unsigned kMostWarps = kMostThreads / 32;

// Returns the first of the neighbouring samples that share a direction with this lane's; `sharing`
// has a bit for each lane.
__device__ inline unsigned direction_leader(unsigned lane, unsigned sharing) {
  const unsigned begin = neighbors_of(lane) * kNeighborSamples;
  return begin + static_cast<unsigned>(__ffs(static_cast<int>(sharing >> begin))) - 1;
}

// Number of places about its middle at which a cluster is sampled (SampleInTurn). place_of()
// chooses one of them by comparisons: an index would put them all in local memory.
inline constexpr unsigned kPlacesAround = 4;
__device__ inline Vec3 place_of(const Vec3 (&places)[kPlacesAround], unsigned k) {
  return k == 0 ? places[0] : k == 1 ? places[1] : k == 2 ? places[2] : places[3];
}

// Number of 64-bit terms of a ToolSum, and of a ContactPlane.
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
  // Shuffles all terms in one step, so that they wait together.
#pragma unroll 1
  for (unsigned other = subwarp.width / 2; other > 0; other /= 2) {
#pragma unroll
    for (int k = 0; k < kTerms; ++k)
      terms[k] += __shfl_xor_sync(subwarp.mask, terms[k], static_cast<int>(other),
                                  static_cast<int>(subwarp.width));
  }
}

// Adds up the rows that the lanes of a subwarp hold; its first lane receives the sum. Lanes without
// a row count as 0.
__device__ inline void add_up(const Subwarp& subwarp, ClippedMoments& row) {
#pragma unroll 1
  for (unsigned half = subwarp.width / 2; half > 0; half /= 2) {
    row.weight += subwarp.from_next(row.weight, half);
    row.moment += subwarp.from_next(row.moment, half);
  }
  row.is_cut = subwarp.any(row.is_cut);
}

// Adds a term to a sum, atomically.
__device__ inline void add_term(std::int64_t& sum, std::int64_t term) {
  atomicAdd(reinterpret_cast<unsigned long long*>(&sum), static_cast<unsigned long long>(term));
}

// Adds what was not seen of a part of the tool to the sum of the pose. For most parts it is
// nothing, which costs no atomic operation.
__device__ inline void add_atomically(const UnseenSum& part, UnseenSum& sum) {
  if (part.unseen.value != 0) add_term(sum.unseen.value, part.unseen.value);
  if (part.out_of_view.value != 0) add_term(sum.out_of_view.value, part.out_of_view.value);
}

// Returns what was not seen of the parts that a warp of this block measures: a sum in shared
// memory.
__device__ inline UnseenSum& unseen_of_warp(unsigned warp) {
  __shared__ UnseenSum of_warps[kMostWarps];
  return of_warps[warp];
}
// Clears that of this thread's warp. Call from all its threads.
__device__ inline void clear_unseen() {
  if (threadIdx.x % 32 == 0) unseen_of_warp(threadIdx.x / 32) = {};
  __syncwarp();
}

template <class Sum>
__device__ void add_atomically(Sum part, Sum& sum) {
  const std::int64_t* const terms = terms_of(part);
  std::int64_t* const totals = terms_of(sum);
#pragma unroll
  for (int k = 0; k < kTerms; ++k)
    if (terms[k] != 0) add_term(totals[k], terms[k]);
}

// Adds a block's parts to `total`, which may lie in shared memory.
__device__ inline void add_block(const ThreadResult& part, RawResult& total) {
  constexpr unsigned kCounts = kTerms;
  __shared__ std::int64_t values[kMostWarps][kTerms + 1];
  const ToolSum& s = part.sum;
  const std::int64_t counts = std::int64_t{part.inside} << 32 | part.boundary;
  std::int64_t mine[kTerms + 1] = {
      s.volume.value,    s.force[0].value,  s.force[1].value,  s.force[2].value,
      s.torque[0].value, s.torque[1].value, s.torque[2].value, counts};
  const unsigned warp = threadIdx.x / 32, lane = threadIdx.x % 32;
  const std::int64_t sum_of_warp = Warp::add_up(mine);
  __syncthreads();
  if (lane % 4 == 0) values[warp][lane / 4] = sum_of_warp;
  __syncthreads();
  if (threadIdx.x > kCounts) return;
  std::int64_t sum = 0;
  for (unsigned w = 0; w < blockDim.x / 32; ++w) sum += values[w][threadIdx.x];
  if (sum == 0) return;
  if (threadIdx.x < kCounts) {
    add_term(terms_of(total.sum)[threadIdx.x], sum);
  } else {
    atomicAdd(&total.boundary, static_cast<unsigned>(sum));
    atomicAdd(&total.inside, static_cast<unsigned>(sum >> 32));
  }
}
// Adds to `total` what the block's warps have not seen. Call after add_block(), which waits for
// them.
__device__ inline void add_unseen_of_warps(UnseenSum& total) {
  if (threadIdx.x != 32) return;  // a thread that add_block() leaves idle
  UnseenSum sum;
  for (unsigned w = 0; w < blockDim.x / 32; ++w) sum.add(unseen_of_warp(w));
  add_atomically(sum, total);
}

}  // namespace vpm::cuda
