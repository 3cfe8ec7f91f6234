// Colours of the spheres' states, in views, exports and plots: they differ in lightness too, so
// that the colour-blind can tell them apart.
#pragma once

#include <array>
#include <cstdint>

namespace vpm::view {

struct StateLook {
  const char* name;
  std::array<std::uint8_t, 3> rgb;
};

// Indexed by SphereState.
inline constexpr std::array<StateLook, 3> kStateLooks{
    {{"outside", {160, 160, 160}}, {"boundary", {255, 140, 0}}, {"inside", {200, 0, 0}}}};

}  // namespace vpm::view
