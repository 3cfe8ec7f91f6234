#include <algorithm>
#include <cstring>
#include <map>

#include "libvpm/query/cuda/other_work.h"
#include "libvpm/query/cuda/standby.h"

namespace vpm::cuda {

Standby::Standby(const StandbyKernel& kernel) : kernel_(kernel) {
  passed_on_.clear();
  finished_.clear();
}

Standby::~Standby() {
  give_leave();
  cudaStreamSynchronize(stream_.get());
}

RawResult Standby::ask(Order order, const Answer& answer, unsigned sequence) {
  const std::lock_guard lock(mutex_);
  if (has_other_work()) order.waits_us = 0;
  if (stands())
    give(order);
  else
    launch(order);
  return wait_for(answer, sequence, stream_.get(), [&] {
    if (has_left_at(number_)) launch(order);  // it was too late
  });
}

void Standby::begin_other_work() {
  const std::lock_guard lock(mutex_);
  ++others_;
  give_leave();
}

void Standby::end_other_work() {
  const std::lock_guard lock(mutex_);
  --others_;
}

void Standby::make_way_until(std::shared_ptr<const Event> end) {
  const std::lock_guard lock(mutex_);
  if (std::find(ends_.begin(), ends_.end(), end) == ends_.end()) ends_.push_back(std::move(end));
}

bool Standby::has_other_work() {
  std::erase_if(ends_, [](const auto& end) { return has_happened(*end); });
  return others_ > 0 || !ends_.empty();
}

bool Standby::stands() const {
  return is_there_ && !has_left_at(number_ + 1);
}

bool Standby::has_left_at(unsigned number) const {
  return *static_cast<const volatile unsigned*>(left_.host()) == number;
}

void Standby::give(const Order& order) {
  ++number_;
  std::uint32_t words[OrderWords::kWords];
  std::memcpy(words, &order, sizeof(words));
  for (unsigned k = 0; k < OrderWords::kWords; ++k)
    put(numbered(number_, words[k]), given_.host()->words[k]);
}

// Waits until it has left: then all that the last query has noted is cleared. What fails, whoever
// asks the device next is told.
void Standby::give_leave() {
  if (!stands()) return;
  is_there_ = false;
  Order order;
  order.leaves = 1;
  give(order);
  for (unsigned looks = 1; !has_left_at(number_); ++looks)
    if (looks % kLooksPerCheck == 0 && cudaStreamQuery(stream_.get()) != cudaErrorNotReady) return;
}

// The last kernel may have left at the next number: that is passed over, since its blocks would
// find the order to leave again.
void Standby::launch(const Order& order) {
  is_there_ = false;
  ++number_;
  OrdersView view{given_.device(), passed_on_.get(), finished_.get(), left_.device()};
  unsigned first = number_ + 1;
  give(order);
  void* values[] = {&view, &first};
  check(cudaLaunchCooperativeKernel(kernel_.kernel, kernel_.blocks, kernel_.threads, values, 0,
                                    stream_.get()));
  is_there_ = true;
}

namespace {

struct Registry {
  std::mutex mutex;
  std::map<int, std::weak_ptr<Standby>> of_devices;

  // Null where there is none.
  std::shared_ptr<Standby> known(int device) {
    const std::lock_guard lock(mutex);
    const auto found = of_devices.find(device);
    return found == of_devices.end() ? nullptr : found->second.lock();
  }
  // The same, or this one from now on.
  std::shared_ptr<Standby> known_or(int device, std::shared_ptr<Standby> made) {
    const std::lock_guard lock(mutex);
    std::weak_ptr<Standby>& one = of_devices[device];
    if (std::shared_ptr<Standby> there = one.lock()) return there;
    one = made;
    return made;
  }
};

// Not destroyed: memory of the device may be given back after it.
Registry& registry() {
  static Registry* const all = new Registry;
  return *all;
}

// A display's watchdog ends kernels that stay.
bool may_stay(int device) {
  int has_watchdog = 0;
  check(cudaDeviceGetAttribute(&has_watchdog, cudaDevAttrKernelExecTimeout, device));
  return has_watchdog == 0;
}

}  // namespace

int current_device() {
  int device = 0;
  check(cudaGetDevice(&device));
  return device;
}

std::shared_ptr<Standby> standby(const StandbyKernel& kernel) {
  const int device = current_device();
  if (!may_stay(device)) return nullptr;
  if (std::shared_ptr<Standby> there = registry().known(device)) return there;
  return registry().known_or(device, std::make_shared<Standby>(kernel));
}

OtherWork::OtherWork() : OtherWork(current_device()) {}

OtherWork::OtherWork(int device) : standby_(registry().known(device)) {
  if (standby_) standby_->begin_other_work();
}

OtherWork::~OtherWork() {
  if (standby_) standby_->end_other_work();
}

void OtherWork::goes_on_until(std::shared_ptr<const Event> end) const {
  if (standby_) standby_->make_way_until(std::move(end));
}

}  // namespace vpm::cuda
