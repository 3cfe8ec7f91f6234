// A kernel that stays on a device after it has answered a query, and takes the next one without a
// launch (orders.h). It fills the device meanwhile, so whatever else is to run there dismisses it.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "libvpm/query/cuda/launch.h"
#include "libvpm/query/cuda/orders.h"

namespace vpm::cuda {

// A kernel(OrdersView, unsigned first), which is launched as a cooperative one.
struct StandbyKernel {
  const void* kernel = nullptr;
  unsigned blocks = 0, threads = 0;
};

// Of one device, for all threads and queries of the process, one pose at a time.
class Standby {
 public:
  Standby();
  ~Standby();
  Standby(const Standby&) = delete;
  Standby& operator=(const Standby&) = delete;

  // One query: the kernel sends its result to `answer` as number `sequence`.
  RawResult ask(const StandbyKernel& kernel, Order order, const Answer& answer, unsigned sequence);
  // The kernel leaves, done with its last query when this returns.
  void dismiss();
  // The same; until the work is done, it leaves after each query.
  void make_way_for(std::shared_ptr<const Event> work);

 private:
  bool stands() const;
  bool has_left_at(unsigned number) const;
  void give(const Order& order);
  void give_leave();
  void launch(const StandbyKernel& kernel, const Order& order);
  bool is_device_busy();

  std::mutex mutex_;
  Stream stream_;
  MappedArray<OrderWords> given_{1};
  MappedArray<unsigned> left_{1};
  DeviceArray<OrderWords> passed_on_{OrdersView::kCopies};
  DeviceArray<unsigned> finished_{1};
  unsigned number_ = 0;  // of the last order
  bool is_there_ = false;
  std::vector<std::shared_ptr<const Event>> work_;
};

// That of the current device.
std::shared_ptr<Standby> standby();

// The same, if any query of the process has one: to be called before anything else is launched.
void dismiss_standby();
void dismiss_standby_for(std::shared_ptr<const Event> work);

}  // namespace vpm::cuda
