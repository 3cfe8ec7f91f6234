// Passes results from the threads of a query to the host program, which waits for them.
#pragma once

#include <cstddef>
#include <cstring>

#include "libvpm/backend/cuda/views.h"
#include "libvpm/device/cuda/numbered_word.h"
#include "libvpm/device/cuda/runtime.h"

namespace vpm::cuda {

// Holds the words of a RawResult in host memory.
struct Answer {
  static constexpr unsigned kWords = offsetof(RawResult, flood_ns) / sizeof(std::uint32_t) + 1;

  NumberedWord words[kWords] = {};
};

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

// Returns the answer number `sequence`: polls the host's own memory until the device has written
// all of it there, which is quicker than waiting for the stream.
inline RawResult wait_for(const Answer& answer, unsigned sequence, cudaStream_t stream) {
  std::uint32_t words[Answer::kWords];
  unsigned looks = 0;
  for (unsigned k = 0; k < Answer::kWords;) {
    const NumberedWord word = poll(answer.words[k]);
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
