// Device on which queries are computed. Programs need no CUDA to be compiled against this.
#pragma once

#include <vpm/error.h>
#include <vpm/export.h>

#include <string>

namespace vpm {

struct Device {
  enum class Kind { cpu, cuda };
  static constexpr int kAll = -1;
  Kind kind = Kind::cpu;
  int index = 0;  // CUDA device; kAll spreads batches over all devices

  bool is_cuda() const { return kind == Kind::cuda; }
  int first() const { return index == kAll ? 0 : index; }
  friend bool operator==(const Device&, const Device&) = default;
};

// Returns the number of CUDA devices that queries can run on; 0 without CUDA in the build, driver
// or device.
VPM_API int cuda_device_count();

// Returns the names of all devices that `device` stands for, e.g. "NVIDIA H100 80GB HBM3, driver
// 13.0"; "cpu" for the CPU.
VPM_API std::string device_name(const Device& device);

// Parses "cpu", "cuda", "cuda:1", "cuda:all" or "auto" (the first CUDA device, else the CPU).
// Throws Error(invalid_argument) for other texts and Error(unavailable) if the device does not
// exist.
VPM_API Device device_from_text(const std::string& text);

// Caps the threads of all later work of the process; 0 means one per core. Changes no result. Not
// thread-safe: to be called once, before other work.
VPM_API void set_thread_count(int threads);
// Returns that cap, or the number of cores. Thread-safe.
VPM_API int thread_count();

}  // namespace vpm
