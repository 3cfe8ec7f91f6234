#include <algorithm>
#include <cstring>
#include <map>

#include "libvpm/query/cuda/standby.h"

namespace vpm::cuda {

Standby::Standby() {
  passed_on_.clear();
  finished_.clear();
}

Standby::~Standby() {
  try {
    give_leave();
  } catch (const Error&) {  // of the device, which whoever asks it next is told
  }
  cudaStreamSynchronize(stream_.get());
}

RawResult Standby::ask(const StandbyKernel& kernel, Order order, const Answer& answer,
                       unsigned sequence) {
  const std::lock_guard lock(mutex_);
  if (is_device_busy()) order.waits_us = 0;
  if (stands())
    give(order);
  else
    launch(kernel, order);
  return wait_for(answer, sequence, stream_.get(), [&] {
    if (has_left_at(number_)) launch(kernel, order);  // it was too late
  });
}

void Standby::dismiss() {
  const std::lock_guard lock(mutex_);
  give_leave();
}

void Standby::make_way_for(std::shared_ptr<const Event> work) {
  const std::lock_guard lock(mutex_);
  give_leave();
  if (std::find(work_.begin(), work_.end(), work) == work_.end()) work_.push_back(std::move(work));
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
    *static_cast<volatile std::uint64_t*>(&given_.host()->words[k]) =
        std::uint64_t{number_} << 32 | words[k];
}

// Waits until it has left: then all that the last query has noted is cleared.
void Standby::give_leave() {
  if (!stands()) return;
  Order order;
  order.leaves = 1;
  give(order);
  is_there_ = false;
  constexpr unsigned kLooksPerCheck = 1U << 16;
  for (unsigned looks = 1; !has_left_at(number_); ++looks)
    if (looks % kLooksPerCheck == 0 && is_done(cudaStreamQuery(stream_.get()))) return;
}

// The last kernel may have left at the next number: that is passed over, since its blocks would
// find the order to leave again.
void Standby::launch(const StandbyKernel& kernel, const Order& order) {
  ++number_;
  OrdersView view{given_.device(), passed_on_.get(), finished_.get(), left_.device()};
  unsigned first = number_ + 1;
  give(order);
  void* values[] = {&view, &first};
  check(cudaLaunchCooperativeKernel(kernel.kernel, kernel.blocks, kernel.threads, values, 0,
                                    stream_.get()));
  is_there_ = true;
}

bool Standby::is_device_busy() {
  std::erase_if(work_, [](const auto& work) { return has_happened(*work); });
  return !work_.empty();
}

namespace {

struct Registry {
  std::mutex mutex;
  std::map<int, std::weak_ptr<Standby>> of_devices;
};

Registry& registry() {
  static Registry all;
  return all;
}

int current_device() {
  int device = 0;
  check(cudaGetDevice(&device));
  return device;
}

std::shared_ptr<Standby> known_standby() {
  Registry& all = registry();
  const std::lock_guard lock(all.mutex);
  if (all.of_devices.empty()) return nullptr;
  const auto found = all.of_devices.find(current_device());
  return found == all.of_devices.end() ? nullptr : found->second.lock();
}

}  // namespace

std::shared_ptr<Standby> standby() {
  Registry& all = registry();
  const std::lock_guard lock(all.mutex);
  std::weak_ptr<Standby>& known = all.of_devices[current_device()];
  std::shared_ptr<Standby> one = known.lock();
  if (!one) known = one = std::make_shared<Standby>();
  return one;
}

void dismiss_standby() {
  if (const auto one = known_standby()) one->dismiss();
}

void dismiss_standby_for(std::shared_ptr<const Event> work) {
  if (const auto one = known_standby()) one->make_way_for(std::move(work));
}

}  // namespace vpm::cuda
