// A kernel that stays on a device fills it: what else is done there says so.
#pragma once

#include <memory>

namespace vpm::cuda {

class Event;

// A kernel that stays on its device when its work is done, and waits for more.
class StandingKernel {
 public:
  virtual ~StandingKernel() = default;
  // When the first returns, the kernel is done with its last work.
  virtual void begin_other_work() = 0;
  virtual void end_other_work() = 0;
  virtual void make_way_until(std::shared_ptr<const Event> end) = 0;
};

// That of a device; null where there is none.
std::shared_ptr<StandingKernel> standing_kernel(int device);
// The same; where there is none, this one from now on, as long as somebody holds it.
std::shared_ptr<StandingKernel> standing_kernel_or(int device,
                                                   std::shared_ptr<StandingKernel> made);

// While one is held, no kernel stands by on the device: those that are launched for queries leave
// with the answer. To be held by whoever launches something else there, or calls what waits for all
// kernels, until that is done. Costs next to nothing where no kernel stands by.
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
  std::shared_ptr<StandingKernel> standing_;
};

}  // namespace vpm::cuda
