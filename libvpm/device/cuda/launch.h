// Launching kernels, all in one way: by typed functions, so that what is passed is checked.
#pragma once

#include <cstddef>

#include "libvpm/device/cuda/current_device.h"

namespace vpm::cuda {

// How blocks of a launch depend on each other and on what comes before it in the stream.
enum class LaunchKind {
  independent,  // blocks run in any order
  cooperative,  // all blocks are there at once, since they meet
  overlapping,  // begins early: the kernel itself waits for what comes before it in the stream
};

struct LaunchSize {
  unsigned blocks = 1, threads = 1;
  std::size_t shared_bytes = 0;  // dynamic shared memory of a block
};

// Begins a kernel in a stream. Throws Error(unavailable) where the device refuses it.
template <class... Parameters, class... Arguments>
void launch_kernel(void (*kernel)(Parameters...), const LaunchSize& size, LaunchKind kind,
                   cudaStream_t stream, const Arguments&... arguments) {
  cudaLaunchAttribute attribute{};
  if (kind == LaunchKind::cooperative) {
    attribute.id = cudaLaunchAttributeCooperative;
    attribute.val.cooperative = 1;
  } else {
    attribute.id = cudaLaunchAttributeProgrammaticStreamSerialization;
    attribute.val.programmaticStreamSerializationAllowed = 1;
  }
  cudaLaunchConfig_t config{};
  config.gridDim = dim3(size.blocks);
  config.blockDim = dim3(size.threads);
  config.dynamicSmemBytes = size.shared_bytes;
  config.stream = stream;
  config.attrs = &attribute;
  config.numAttrs = kind == LaunchKind::independent ? 0 : 1;
  check(cudaLaunchKernelEx(&config, kernel, arguments...));
}

// Returns the block's dynamic shared memory, whose size the launch gives; aligned to 16 bytes.
__device__ inline void* dynamic_shared_memory() {
#ifdef __CUDACC__
  extern __shared__ double2 memory[];
  return memory;
#else
  return emulator::dynamic_shared_memory();
#endif
}

}  // namespace vpm::cuda
