// Runs CUDA kernels on the host: the very functions that a device runs, under a debugger, ctest and
// the sanitizers.
//
// Each thread of a block is a fiber; the fibers of a block share one thread of the host, so
// variables marked __shared__ are thread-local. Threads that exchange values or meet at a barrier
// wait until all that are named by the mask have come. A meeting that can never happen ends the
// program with a message, where a device would hang or go on with garbage.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

struct dim3 {
  unsigned x = 1, y = 1, z = 1;
  constexpr dim3() = default;
  constexpr dim3(unsigned blocks) : x(blocks) {}
};

// Number of the thread in its block, of the block in its grid, and the sizes of both. Set for each
// fiber before it goes on.
extern thread_local constinit dim3 threadIdx, blockIdx, blockDim, gridDim;

namespace emulator {

inline constexpr unsigned kLanes = 32;

// Size of a launch. The blocks of a cooperative one run side by side, others one after another.
struct Launch {
  unsigned blocks = 1, threads = 1;
  std::size_t shared_bytes = 0;
  bool is_cooperative = false;
};

// Runs kernel() by all threads of all blocks and returns when they are done.
void run(const Launch& launch, const std::function<void()>& kernel);

// Returns the value that lane `source` of this warp gives, once all lanes of the mask have come.
std::uint64_t exchange(unsigned mask, std::uint64_t value, unsigned source);
// Returns a bit for each lane of the mask whose predicate holds.
unsigned vote(unsigned mask, bool predicate);
// Waits for all threads of the block; returns for how many of them the predicate holds.
unsigned meet_block(bool predicate);
// Lets other threads of the block and the host's other threads go on. Called where a thread waits
// for what another one writes.
void yield();
// Returns the time by a clock that all blocks share.
std::uint64_t nanoseconds();
// Returns the block's memory whose size the launch gives.
void* dynamic_shared_memory();

}  // namespace emulator
