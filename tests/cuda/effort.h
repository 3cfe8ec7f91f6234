// Limits what a test of the device tries, since an emulated device takes a thousand times as long.
#pragma once

namespace vpm::testing {

#ifdef VPM_EMULATED_DEVICE
inline constexpr bool kIsEmulated = true;
#else
inline constexpr bool kIsEmulated = false;
#endif

// Returns `count`, or a small part of it, two at least, where the device is emulated.
constexpr int effort(int count) {
  constexpr int kPart = 40;
  return !kIsEmulated ? count : count / kPart < 2 ? 2 : count / kPart;
}
// Returns how many of the tried cases must be of some kind: none if few are tried.
constexpr unsigned expected_of(unsigned count) {
  return kIsEmulated ? 0 : count;
}

}  // namespace vpm::testing
