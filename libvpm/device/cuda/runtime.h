// CUDA's runtime as the library uses it: the device that this thread talks to, its errors as
// vpm::Error, streams and events, and launches of kernels, all in one way: by typed functions, so
// that what is passed is checked.
#pragma once

#include <cuda_runtime.h>

#include <cstddef>
#include <string>

#include "libvpm/core/error.h"

namespace vpm::cuda {

inline void check(cudaError_t status) {
  if (status == cudaSuccess) return;
  throw Error(ErrorKind::unavailable, cudaGetErrorString(status), "CUDA device",
              "use `device` cpu if this persists");
}

inline int current_device() {
  int device = 0;
  check(cudaGetDevice(&device));
  return device;
}

// Makes a device the current one of this thread for a scope.
class CurrentDevice {
 public:
  explicit CurrentDevice(int index) : before_(current_device()), is_changed_(index != before_) {
    if (is_changed_) check(cudaSetDevice(index));
  }
  ~CurrentDevice() {
    if (is_changed_) cudaSetDevice(before_);
  }
  CurrentDevice(const CurrentDevice&) = delete;
  CurrentDevice& operator=(const CurrentDevice&) = delete;

 private:
  int before_ = 0;
  bool is_changed_ = false;
};

class Stream {
 public:
  Stream() { check(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking)); }
  ~Stream() { cudaStreamDestroy(stream_); }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  cudaStream_t get() const { return stream_; }

 private:
  cudaStream_t stream_ = nullptr;
};

class Event {
 public:
  explicit Event(unsigned flags = cudaEventDefault) {
    check(cudaEventCreateWithFlags(&event_, flags));
  }
  ~Event() { cudaEventDestroy(event_); }
  Event(const Event&) = delete;
  Event& operator=(const Event&) = delete;
  cudaEvent_t get() const { return event_; }

 private:
  cudaEvent_t event_ = nullptr;
};

// True if the status of cudaEventQuery or the like says that the work is done. Throws on errors.
inline bool is_done(cudaError_t status) {
  if (status == cudaErrorNotReady) return false;
  check(status);
  return true;
}
inline bool has_happened(const Event& event) {
  return is_done(cudaEventQuery(event.get()));
}

// Returns the time between two events that have happened, by the device's clock.
inline double microseconds_between(const Event& begin, const Event& end) {
  float milliseconds = 0;
  check(cudaEventElapsedTime(&milliseconds, begin.get(), end.get()));
  return 1e3 * static_cast<double>(milliseconds);
}

// How often the host looks into its own memory for an answer before it asks the device whether the
// launch has failed.
inline constexpr unsigned kLooksPerCheck = 1U << 16;

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
