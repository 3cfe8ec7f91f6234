// Streams and events.
#pragma once

#include "libvpm/device/cuda/current_device.h"

namespace vpm::cuda {

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

// At the host's own memory, before the device is asked whether the launch has failed.
inline constexpr unsigned kLooksPerCheck = 1U << 16;

}  // namespace vpm::cuda
