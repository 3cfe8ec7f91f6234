// A kernel that stands by (standby.h) fills the device: what else is done there says so.
#pragma once

#include <cuda_runtime.h>

#include <memory>

namespace vpm::cuda {

class Event;
class Standby;

int current_device();

// While one is held, no kernel stands by on the device: those that are launched for queries leave
// with the answer. To be held by whoever launches something else there, or calls what waits for all
// kernels, until that is done. Costs next to nothing where no query stands by.
class OtherWork {
 public:
  OtherWork();  // on the current device
  explicit OtherWork(int device);
  ~OtherWork();
  OtherWork(const OtherWork&) = delete;
  OtherWork& operator=(const OtherWork&) = delete;

  // It goes on without this one until that, which has been recorded, happens.
  void goes_on_until(std::shared_ptr<const Event> end) const;

 private:
  std::shared_ptr<Standby> standby_;
};

}  // namespace vpm::cuda
