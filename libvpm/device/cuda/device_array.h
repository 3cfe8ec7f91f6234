// Memory of a device, and of the host where a device can write.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "libvpm/device/cuda/runtime.h"

namespace vpm::cuda {

// Waits for what copies and clears have only begun: they belong to the default stream, for which
// other streams (runtime.h) do not wait.
inline void finish_transfers() {
  check(cudaStreamSynchronize(cudaStreamLegacy));
}

// Values on the device, there when a constructor, fill() or clear() returns. Owns them. The
// destructor waits for the work that the device has in hand, as cudaFree() does: a kernel may still
// clear its memory after it has sent its answer.
template <class T>
class DeviceArray {
 public:
  DeviceArray() = default;
  explicit DeviceArray(std::size_t count) : count_(count) {
    if (count == 0) return;
    check(cudaMalloc(&data_, count * sizeof(T)));
  }
  DeviceArray(const T* values, std::size_t count) : DeviceArray(count) { fill(values); }
  explicit DeviceArray(const std::vector<T>& values) : DeviceArray(values.data(), values.size()) {}
  ~DeviceArray() {
    if (data_ != nullptr) cudaFree(data_);
  }
  DeviceArray(DeviceArray&& other) noexcept { swap(other); }
  DeviceArray& operator=(DeviceArray&& other) noexcept {
    swap(other);
    return *this;
  }

  T* get() const { return data_; }
  std::size_t size() const { return count_; }
  void fill(const T* values) {
    if (count_ == 0) return;
    check(cudaMemcpy(data_, values, count_ * sizeof(T), cudaMemcpyHostToDevice));
    finish_transfers();
  }
  void clear() {
    if (count_ == 0) return;
    check(cudaMemset(data_, 0, count_ * sizeof(T)));
    finish_transfers();
  }

 private:
  void swap(DeviceArray& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(count_, other.count_);
  }
  T* data_ = nullptr;
  std::size_t count_ = 0;
};

// Owns arrays of several types on the device. Pointers to them stay valid as long as it lives.
class DeviceMemory {
 public:
  // Returns a copy of these values; null for none.
  template <class T>
  T* copy(const T* values, std::size_t count) {
    return keep(DeviceArray<T>(values, count));
  }
  template <class T>
  T* copy(const std::vector<T>& values) {
    return copy(values.data(), values.size());
  }
  // Return room for this many values: as it comes, and all bytes 0.
  template <class T>
  T* room(std::size_t count) {
    return keep(DeviceArray<T>(count));
  }
  template <class T>
  T* zeros(std::size_t count) {
    DeviceArray<T> array(count);
    array.clear();
    return keep(std::move(array));
  }

 private:
  template <class T>
  T* keep(DeviceArray<T> array) {
    T* const values = array.get();
    kept_.push_back(std::make_shared<DeviceArray<T>>(std::move(array)));
    return values;
  }
  std::vector<std::shared_ptr<void>> kept_;
};

// Values in the host's memory that the device reads and writes over the bus. Owns them. The
// destructor waits for the device's work, as cudaFreeHost() does.
template <class T>
class MappedArray {
 public:
  explicit MappedArray(std::size_t count) : count_(count) {
    check(cudaHostAlloc(&host_, count * sizeof(T), cudaHostAllocMapped | cudaHostAllocPortable));
    check(cudaHostGetDevicePointer(&device_, host_, 0));
    for (std::size_t i = 0; i < count; ++i) host_[i] = T{};
  }
  ~MappedArray() { cudaFreeHost(host_); }
  MappedArray(const MappedArray&) = delete;
  MappedArray& operator=(const MappedArray&) = delete;

  T* host() const { return host_; }
  T* device() const { return device_; }
  std::size_t size() const { return count_; }

 private:
  T* host_ = nullptr;
  T* device_ = nullptr;
  std::size_t count_ = 0;
};

}  // namespace vpm::cuda
