// Device on which queries are computed. Plain C++: programs that include this need no CUDA.
#pragma once

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
int cuda_device_count();
bool is_built_with_cuda();

// Returns name and CUDA version of the driver, e.g. "NVIDIA H100 80GB HBM3, driver 13.0".
std::string cuda_device_name(int index);

// Returns the names of all devices that `device` stands for; "cpu" for the CPU.
std::string device_name(const Device& device);

// Parses "cpu", "cuda", "cuda:1", "cuda:all" or "auto" (the first CUDA device, else the CPU).
// Throws Error(invalid_argument) for other texts and Error(unavailable) if the device does not
// exist.
Device device_from_text(const std::string& text);

}  // namespace vpm
