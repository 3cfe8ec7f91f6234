// The device that this thread talks to, and its errors as vpm::Error.
#pragma once

#include <cuda_runtime.h>

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

}  // namespace vpm::cuda
