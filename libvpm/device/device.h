// Where queries are computed. Plain C++: programs need no CUDA to be compiled against it.
#pragma once

#include <string>

namespace vpm {

struct Device {
  enum class Kind { cpu, cuda };
  static constexpr int kAll = -1;
  Kind kind = Kind::cpu;
  int index = 0;  // of the CUDA device; kAll: batches are spread over all that there are

  bool is_cuda() const { return kind == Kind::cuda; }
  int first() const { return index == kAll ? 0 : index; }
  friend bool operator==(const Device&, const Device&) = default;
};

// CUDA devices that queries can run on; 0 where libvpm was built without CUDA, and on a machine
// without driver or device.
int cuda_device_count();
bool is_built_with_cuda();

// "NVIDIA H100 80GB HBM3, driver 13.0"; the CUDA version that the driver supports.
std::string cuda_device_name(int index);

// The same, of all that a Device stands for; "cpu" of the CPU.
std::string device_name(const Device& device);

// The device of "cpu", "cuda", "cuda:1", "cuda:all" or "auto" (the first CUDA device, or the CPU
// where there is none). Throws Error(usage) for other texts, Error(unavailable) for a device that
// is not there.
Device device_from_text(const std::string& text);

}  // namespace vpm
