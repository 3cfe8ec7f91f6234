// Sizes launches, passes results from the threads of a query to the host program, and waits for
// them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>

#include "libvpm/backend/cuda/team.h"
#include "libvpm/backend/cuda/views.h"
#include "libvpm/device/cuda/numbered_word.h"
#include "libvpm/device/cuda/runtime.h"

namespace vpm::cuda {

// Holds the words of a RawResult in host memory.
struct Answer {
  static constexpr unsigned kWords = 18;
  static_assert(sizeof(RawResult) == kWords * sizeof(std::uint32_t));

  NumberedWord words[kWords] = {};
};

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

// Returns this thread's word of a result; 0 beyond the first Answer::kWords threads of a block.
__device__ inline std::uint32_t word_of(const RawResult& result) {
  const unsigned k = threadIdx.x;
  return k < Answer::kWords ? reinterpret_cast<const std::uint32_t*>(&result)[k] : 0;
}

// Sends a result, given as each thread's word, with `flood_ns` put in. All threads of a block call
// it.
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
  unsigned arrived = 0;  // counter of GridTeam
};

// Adds up eight values over a warp. Lane l returns the sum of value l / 4.
__device__ inline std::int64_t add_up_over_warp(std::int64_t (&values)[8]) {
  // Halves the values and the lanes that hold them in each step.
#pragma unroll
  for (unsigned half = 16, kept = 4; kept > 0; half /= 2, kept /= 2) {
    const bool is_upper = (threadIdx.x & half) != 0;
#pragma unroll
    for (unsigned k = 0; k < kept; ++k) {
      const std::int64_t low = values[k], high = values[k + kept];
      values[k] = (is_upper ? high : low) + __shfl_xor_sync(~0U, is_upper ? low : high, half);
    }
  }
  std::int64_t sum = values[0];
  sum += __shfl_xor_sync(~0U, sum, 2);
  return sum + __shfl_xor_sync(~0U, sum, 1);
}

// Adds a block's parts to `total`, which may lie in shared memory.
__device__ inline void add_block(const RawResult& part, RawResult& total) {
  constexpr unsigned kMostWarps = kMostThreads / 32, kCounts = kTerms;
  __shared__ std::int64_t values[kMostWarps][kTerms + 1];
  const ToolSum& s = part.sum;
  const std::int64_t counts = std::int64_t{part.inside} << 32 | part.boundary;
  std::int64_t mine[kTerms + 1] = {
      s.volume.value,    s.force[0].value,  s.force[1].value,  s.force[2].value,
      s.torque[0].value, s.torque[1].value, s.torque[2].value, counts};
  const unsigned warp = threadIdx.x / 32, lane = threadIdx.x % 32;
  const std::int64_t sum_of_warp = add_up_over_warp(mine);
  __syncthreads();
  if (lane % 4 == 0) values[warp][lane / 4] = sum_of_warp;
  if (__any_sync(~0U, part.points != 0) != 0) {  // seldom
    const auto points = static_cast<unsigned>(Subwarp(32).sum(part.points));
    if (lane == 0) atomicAdd(&total.points, points);
  }
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

// Returns the number of multiprocessors of the current device.
inline unsigned processor_count() {
  int count = 0;
  check(cudaDeviceGetAttribute(&count, cudaDevAttrMultiProcessorCount, current_device()));
  return static_cast<unsigned>(count);
}

// Returns how many blocks of a kernel the current device holds at once, at most `wanted` per
// multiprocessor.
template <class Kernel>
unsigned blocks_that_fit(Kernel* kernel, unsigned threads, unsigned wanted) {
  int blocks = 0;
  check(
      cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, kernel, static_cast<int>(threads), 0));
  return std::clamp(static_cast<unsigned>(blocks), 1U, wanted) * processor_count();
}

// Returns the number of blocks that fill the device, as far as their memory takes no more than a
// quarter of it and half of what is free.
inline unsigned teams_that_fit(std::size_t bytes_of_team, unsigned blocks_per_processor) {
  std::size_t free = 0, total = 0;
  check(cudaMemGetInfo(&free, &total));
  const std::size_t fit = std::min(free / 2, total / 4) / std::max<std::size_t>(bytes_of_team, 1);
  const std::size_t wanted = std::size_t{blocks_per_processor} * processor_count();
  return static_cast<unsigned>(std::clamp<std::size_t>(fit, 1, wanted));
}

// Returns Teams(count, arguments...), which takes memory for `most` teams, or half as many again
// and again where other programs have taken what was free.
template <class Teams, class... Arguments>
std::unique_ptr<Teams> make_teams(unsigned most, const Arguments&... arguments) {
  for (unsigned count = most;; count /= 2) {
    try {
      return std::make_unique<Teams>(count, arguments...);
    } catch (const Error&) {
      if (cudaGetLastError() != cudaErrorMemoryAllocation || count == 1) throw;
    }
  }
}

// Returns the answer number `sequence`: polls the host's own memory until the device has written
// all of it there, which is quicker than waiting for the stream.
inline RawResult wait_for(const Answer& answer, unsigned sequence, cudaStream_t stream) {
  std::uint32_t words[Answer::kWords];
  unsigned looks = 0;
  for (unsigned k = 0; k < Answer::kWords;) {
    const NumberedWord word = look_at(answer.words[k]);
    if (number_of(word) == sequence) {
      words[k++] = value_of(word);
      continue;
    }
    if (++looks % kLooksPerCheck == 0) is_done(cudaStreamQuery(stream));
  }
  RawResult result;
  std::memcpy(static_cast<void*>(&result), words, sizeof(words));
  return result;
}

}  // namespace vpm::cuda
