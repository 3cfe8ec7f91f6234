#include <algorithm>
#include <atomic>
#include <cstring>

#include "libvpm/backend/cuda/persistent/standby.h"

namespace vpm::cuda {

Standby::Standby(const StandbyKernel& kernel) : kernel_(kernel) {
  passed_on_.clear();
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
  std::atomic_thread_fence(std::memory_order_release);
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
  const CurrentDevice current(device_);
  is_there_ = false;
  ++number_;
  const OrdersView view{given_.device(), passed_on_.get(), left_.device()};
  const unsigned first = number_ + 1;
  give(order);
  launch_kernel(kernel_.kernel, {kernel_.blocks, kernel_.threads}, LaunchKind::cooperative,
                stream_.get(), view, first);
  is_there_ = true;
}

namespace {

// A display's watchdog ends kernels that stay.
bool may_stay(int device) {
  int has_watchdog = 0;
  check(cudaDeviceGetAttribute(&has_watchdog, cudaDevAttrKernelExecTimeout, device));
  return has_watchdog == 0;
}

}  // namespace

std::shared_ptr<Standby> standby(const StandbyKernel& kernel) {
  const int device = current_device();
  if (!may_stay(device)) return nullptr;
  std::shared_ptr<StandingKernel> there = standing_kernel(device);
  if (!there) there = standing_kernel_or(device, std::make_shared<Standby>(kernel));
  return std::static_pointer_cast<Standby>(there);  // no other kind stands by
}

}  // namespace vpm::cuda
