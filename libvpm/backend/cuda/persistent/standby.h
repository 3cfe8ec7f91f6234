// A kernel that stays on a device after it has answered a query, and takes the next one without a
// launch (orders.h). It makes way for what else is to be done there (device/cuda/other_work.h).
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "libvpm/backend/cuda/launch.h"
#include "libvpm/backend/cuda/persistent/orders.h"
#include "libvpm/device/cuda/device_array.h"
#include "libvpm/device/cuda/other_work.h"

namespace vpm::cuda {

// A kernel(OrdersView, unsigned first), which is launched as a cooperative one.
struct StandbyKernel {
  void (*kernel)(OrdersView, unsigned) = nullptr;
  unsigned blocks = 0, threads = 0;
};

// Of one device, for all threads and queries of the process, one pose at a time.
class Standby : public StandingKernel {
 public:
  explicit Standby(const StandbyKernel& kernel);
  ~Standby() override;
  Standby(const Standby&) = delete;
  Standby& operator=(const Standby&) = delete;

  // One query: the kernel sends its result to `answer` as number `sequence`. What the query needs
  // must be there, and what was launched for it before must have ended.
  RawResult ask(Order order, const Answer& answer, unsigned sequence);

  void begin_other_work() override;
  void end_other_work() override;
  void make_way_until(std::shared_ptr<const Event> end) override;

 private:
  bool stands() const;
  bool has_left_at(unsigned number) const;
  void give(const Order& order);
  void give_leave();
  void launch(const Order& order);
  bool has_other_work();

  std::mutex mutex_;
  StandbyKernel kernel_;
  int device_ = current_device();
  Stream stream_;
  MappedArray<OrderWords> given_{1};
  MappedArray<unsigned> left_{1};
  DeviceArray<OrderWords> passed_on_{OrdersView::kCopies};
  unsigned number_ = 0;  // of the last order
  bool is_there_ = false;
  unsigned others_ = 0;  // that hold an OtherWork
  std::vector<std::shared_ptr<const Event>> ends_;
};

// That of the current device, where the system lets a kernel stay as long as it likes; otherwise
// null. All callers give the same kernel.
std::shared_ptr<Standby> standby(const StandbyKernel& kernel);

}  // namespace vpm::cuda
