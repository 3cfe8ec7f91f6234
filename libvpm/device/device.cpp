#include "libvpm/device/device.h"

#include <charconv>

#include "libvpm/core/error.h"

namespace vpm {
namespace {

[[noreturn]] void unavailable(const std::string& text, const std::string& why) {
  throw Error(ErrorKind::unavailable, why, "`device` " + text,
              "use `device` cpu, or leave the option out");
}

int index_from_text(const std::string& text) {
  constexpr std::string_view kPrefix = "cuda:";
  constexpr int kNone = -1;
  if (text == "cuda") return 0;
  if (text == "cuda:all") return Device::kAll;
  int index = kNone;
  const char* end = text.data() + text.size();
  if (text.rfind(kPrefix, 0) == 0) {
    const auto [stop, fault] = std::from_chars(text.data() + kPrefix.size(), end, index);
    if (fault != std::errc() || stop != end) index = kNone;
  }
  if (index < 0) {
    throw Error(ErrorKind::invalid_argument,
                text + " not in {auto,cpu,cuda,cuda:N,cuda:all} with N a device's number",
                "`device`");
  }
  return index;
}

}  // namespace

std::string device_name(const Device& device) {
  if (!device.is_cuda()) return "cpu";
  if (device.index != Device::kAll) return cuda_device_name(device.index);
  std::string names;
  for (int k = 0; k < cuda_device_count(); ++k) names += (k == 0 ? "" : "; ") + cuda_device_name(k);
  return names;
}

Device device_from_text(const std::string& text) {
  if (text == "cpu") return {};
  if (text == "auto") return cuda_device_count() > 0 ? Device{Device::Kind::cuda, 0} : Device{};
  const int index = index_from_text(text);
  if (!is_built_with_cuda()) unavailable(text, "this build has no CUDA");
  const int count = cuda_device_count();
  if (count == 0) unavailable(text, "this machine has no CUDA device, or no driver for it");
  if (index >= count)
    unavailable(text, "the devices here are numbered 0 to " + std::to_string(count - 1));
  return {Device::Kind::cuda, index};
}

}  // namespace vpm
