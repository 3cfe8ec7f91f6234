#include <map>
#include <mutex>
#include <utility>

#include "libvpm/device/cuda/current_device.h"
#include "libvpm/device/cuda/other_work.h"

namespace vpm::cuda {
namespace {

struct Registry {
  std::mutex mutex;
  std::map<int, std::weak_ptr<StandingKernel>> of_devices;
};

// Not destroyed: memory of the device may be given back after it.
Registry& registry() {
  static Registry* const all = new Registry;
  return *all;
}

}  // namespace

std::shared_ptr<StandingKernel> standing_kernel(int device) {
  const std::lock_guard lock(registry().mutex);
  const auto found = registry().of_devices.find(device);
  return found == registry().of_devices.end() ? nullptr : found->second.lock();
}

std::shared_ptr<StandingKernel> standing_kernel_or(int device,
                                                   std::shared_ptr<StandingKernel> made) {
  const std::lock_guard lock(registry().mutex);
  std::weak_ptr<StandingKernel>& one = registry().of_devices[device];
  if (std::shared_ptr<StandingKernel> there = one.lock()) return there;
  one = made;
  return made;
}

OtherWork::OtherWork() : OtherWork(current_device()) {}

OtherWork::OtherWork(int device) : standing_(standing_kernel(device)) {
  if (standing_) standing_->begin_other_work();
}

OtherWork::~OtherWork() {
  if (standing_) standing_->end_other_work();
}

void OtherWork::goes_on_until(std::shared_ptr<const Event> end) const {
  if (standing_) standing_->make_way_until(std::move(end));
}

}  // namespace vpm::cuda
