// Takes arrays of other programs that lie in the memory of a CUDA device, and gives them such
// arrays, by DLPack: nothing is copied, and streams wait for each other.
#pragma once

#include <dlpack/dlpack.h>
#include <vpm/device_batch.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "libvpm/python/arrays.h"

namespace vpm::python {

// Array of Python that says that it lies on a CUDA device. Others are no such argument, so that the
// next overload takes them.
struct OnDevice {
  py::object array;
};

// Holds poses that an array of Python has, until the array may go.
class TakenPoses {
 public:
  // The default stream waits for what made the array. Throws Error(invalid_argument) for other
  // numbers or shapes than DevicePoses takes.
  explicit TakenPoses(const OnDevice& given);
  ~TakenPoses();
  TakenPoses(const TakenPoses&) = delete;
  TakenPoses& operator=(const TakenPoses&) = delete;

  const DevicePoses& poses() const { return poses_; }

 private:
  DLManagedTensor* tensor_ = nullptr;
  DevicePoses poses_;
};

// Answers on the device of the query, and the poses that they are made of, which go after them.
struct DeviceAnswers {
  std::shared_ptr<const TakenPoses> poses;
  DeviceResults results;
};

// One member of all answers, as an array of shape (N,) or (N, 3) on the device.
struct DeviceColumn {
  std::shared_ptr<const DeviceAnswers> answers;
  std::size_t offset = 0;  // bytes from the beginning of a DeviceResult
  std::int64_t width = 0;  // 3, or 0 for single values
  DLDataType type{kDLFloat, 64, 1};

  py::tuple shape() const;
  // Returns the capsule that __dlpack__ is to return. `stream` is that which the array will be used
  // in: None or 1 for the default one, -1 for one that need not wait.
  py::capsule dlpack(const py::object& stream) const;
};

}  // namespace vpm::python

namespace pybind11::detail {

template <>
struct type_caster<vpm::python::OnDevice> {
  PYBIND11_TYPE_CASTER(vpm::python::OnDevice, const_name("object"));

  bool load(handle source, bool) {
    if (!hasattr(source, "__dlpack_device__")) return false;
    const auto device = source.attr("__dlpack_device__")().cast<std::pair<int, int>>();
    value.array = reinterpret_borrow<object>(source);
    return device.first == kDLCUDA;
  }
};

}  // namespace pybind11::detail
