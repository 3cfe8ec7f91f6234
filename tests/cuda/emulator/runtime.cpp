// Implements memory, streams and events of the emulated device. A stream is a thread of the host
// that does its work in order.
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <memory>
#include <mutex>
#include <set>
#include <thread>

#include "tests/cuda/emulator/cuda_runtime.h"

namespace emulator {

// cudaStreamQuery() and cudaEventQuery() of the emulated device wait up to this long for the work
// to end, and only then answer that it has not. Callers ask again at once: without the wait they
// would take the processor from the emulated device, whose threads are those of the host.
constexpr std::chrono::milliseconds kPatience{1};

class Stream {
 public:
  Stream() : thread_([this] { work(); }) {}
  ~Stream() {
    enqueue(nullptr);
    thread_.join();
  }
  // Queues work; null ends the stream when it gets there.
  void enqueue(std::function<void()> work) {
    const std::lock_guard lock(mutex_);
    queue_.push_back(std::move(work));
    changed_.notify_all();
  }
  void synchronize() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return queue_.empty(); });
  }
  bool is_idle_soon() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kPatience, [&] { return queue_.empty(); });
  }

 private:
  void work() {
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait(lock, [&] { return !queue_.empty(); });
      const std::function<void()> next = queue_.front();
      if (!next) return;
      lock.unlock();
      next();
      lock.lock();
      queue_.pop_front();
      changed_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> queue_;
  std::thread thread_;
};

struct Streams {
  std::mutex mutex;
  std::set<Stream*> all;
};
Streams& streams() {
  static Streams all;
  return all;
}

// Holds what a handle of an event stands for. A stream that still has to wait for it shares it, so
// that the handle may be destroyed first.
struct EventState {
  std::mutex mutex;
  std::condition_variable changed;
  unsigned recorded = 0, happened = 0;
  std::chrono::steady_clock::time_point time;

  bool has_happened_soon() {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, kPatience, [&] { return happened == recorded; });
  }
  void wait_for(unsigned record) {
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return happened >= record; });
  }
  unsigned last_record() {
    const std::lock_guard lock(mutex);
    return recorded;
  }
};

struct Event {
  const std::shared_ptr<EventState> state = std::make_shared<EventState>();
};

void enqueue(Stream* stream, std::function<void()> work) {
  if (stream == nullptr)
    work();
  else
    stream->enqueue(std::move(work));
}

// Allocates memory filled with a pattern, so that reads before any write show.
cudaError_t allocate(void** place, std::size_t bytes) {
  *place = std::aligned_alloc(256, (bytes + 255) / 256 * 256);
  if (*place == nullptr) return cudaErrorMemoryAllocation;
  std::memset(*place, 0xA5, bytes);
  return cudaSuccess;
}

}  // namespace emulator

// Waits for all that the streams have been given, as a device does before it takes memory back.
cudaError_t cudaFree(void* memory) {
  cudaDeviceSynchronize();
  std::free(memory);
  return cudaSuccess;
}
cudaError_t cudaFreeHost(void* memory) {
  return cudaFree(memory);
}
cudaError_t cudaMemcpy(void* to, const void* from, std::size_t bytes, cudaMemcpyKind) {
  std::memcpy(to, from, bytes);
  return cudaSuccess;
}
cudaError_t cudaMemcpyAsync(void* to, const void* from, std::size_t bytes, cudaMemcpyKind,
                            cudaStream_t stream) {
  // Of no bytes, places may be null.
  if (bytes > 0) emulator::enqueue(stream, [=] { std::memcpy(to, from, bytes); });
  return cudaSuccess;
}
cudaError_t cudaMemset(void* place, int value, std::size_t bytes) {
  std::memset(place, value, bytes);
  return cudaSuccess;
}
cudaError_t cudaMemGetInfo(std::size_t* free, std::size_t* total) {
  *free = *total = std::size_t{1} << 28;
  return cudaSuccess;
}

cudaError_t cudaStreamCreateWithFlags(cudaStream_t* stream, unsigned) {
  *stream = new emulator::Stream;
  emulator::Streams& streams = emulator::streams();
  const std::lock_guard lock(streams.mutex);
  streams.all.insert(*stream);
  return cudaSuccess;
}
cudaError_t cudaStreamDestroy(cudaStream_t stream) {
  {
    emulator::Streams& streams = emulator::streams();
    const std::lock_guard lock(streams.mutex);
    streams.all.erase(stream);
  }
  delete stream;
  return cudaSuccess;
}
cudaError_t cudaStreamSynchronize(cudaStream_t stream) {
  if (stream != nullptr) stream->synchronize();
  return cudaSuccess;
}
cudaError_t cudaStreamQuery(cudaStream_t stream) {
  return stream == nullptr || stream->is_idle_soon() ? cudaSuccess : cudaErrorNotReady;
}
cudaError_t cudaStreamWaitEvent(cudaStream_t stream, cudaEvent_t event) {
  emulator::enqueue(stream, [state = event->state, record = event->state->last_record()] {
    state->wait_for(record);
  });
  return cudaSuccess;
}
cudaError_t cudaDeviceSynchronize() {
  emulator::Streams& streams = emulator::streams();
  const std::lock_guard lock(streams.mutex);
  for (emulator::Stream* stream : streams.all) stream->synchronize();
  return cudaSuccess;
}
cudaError_t cudaEventCreateWithFlags(cudaEvent_t* event, unsigned) {
  *event = new emulator::Event;
  return cudaSuccess;
}
cudaError_t cudaEventDestroy(cudaEvent_t event) {
  delete event;
  return cudaSuccess;
}
cudaError_t cudaEventRecord(cudaEvent_t event, cudaStream_t stream) {
  unsigned record = 0;
  {
    const std::lock_guard lock(event->state->mutex);
    record = ++event->state->recorded;
  }
  emulator::enqueue(stream, [state = event->state, record] {
    const std::lock_guard lock(state->mutex);
    state->happened = record;
    state->time = std::chrono::steady_clock::now();
    state->changed.notify_all();
  });
  return cudaSuccess;
}
cudaError_t cudaEventQuery(cudaEvent_t event) {
  return event->state->has_happened_soon() ? cudaSuccess : cudaErrorNotReady;
}
cudaError_t cudaEventSynchronize(cudaEvent_t event) {
  event->state->wait_for(event->state->last_record());
  return cudaSuccess;
}
cudaError_t cudaEventElapsedTime(float* milliseconds, cudaEvent_t begin, cudaEvent_t end) {
  const auto time = end->state->time - begin->state->time;
  *milliseconds = std::chrono::duration<float, std::milli>(time).count();
  return cudaSuccess;
}

cudaError_t cudaGetDevice(int* device) {
  *device = 0;
  return cudaSuccess;
}
cudaError_t cudaSetDevice(int) {
  return cudaSuccess;
}
cudaError_t cudaGetDeviceCount(int* count) {
  *count = 1;
  return cudaSuccess;
}
cudaError_t cudaGetDeviceProperties(cudaDeviceProp* properties, int) {
  std::snprintf(properties->name, sizeof properties->name, "emulated device");
  return cudaSuccess;
}
cudaError_t cudaDriverGetVersion(int* version) {
  *version = 0;
  return cudaSuccess;
}
cudaError_t cudaDeviceGetAttribute(int* value, cudaDeviceAttr attribute, int) {
  *value = attribute == cudaDevAttrMultiProcessorCount            ? 2
           : attribute == cudaDevAttrMaxSharedMemoryPerBlockOptin ? 1 << 17
                                                                  : 0;
  return cudaSuccess;
}
cudaError_t cudaGetLastError() {
  return cudaSuccess;
}
const char* cudaGetErrorString(cudaError_t error) {
  return error == cudaSuccess ? "no error" : "out of memory, or not ready";
}
