// Spheres as files that other programs show. A suffix means the same to all programs, as
// formats/spheres.md says.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "libvpm/model/sphere.h"

namespace vpm::view {

// Colours of the spheres' states, in views, exports and plots: they differ in lightness too, so
// that the colour-blind can tell them apart.

struct StateLook {
  const char* name;
  std::array<std::uint8_t, 3> rgb;
};

// Indexed by SphereState.
inline constexpr std::array<StateLook, 3> kStateLooks{
    {{"outside", {160, 160, 160}}, {"boundary", {255, 140, 0}}, {"inside", {200, 0, 0}}}};

// .csv, .ply (balls), .points.ply, .glb
enum class SphereFormat { csv, ply, points, glb };

// Returns the format that the name's suffix asks for; none for other suffixes.
std::optional<SphereFormat> sphere_format(const std::string& path);

// Returns the content of the file. With `states` (SphereState, one per sphere) colours tell the
// state and tables name it; without, colours tell the radius on a logarithmic scale from dark
// violet (smallest) to yellow. Tables have nine digits, with states as many as the numbers need,
// since spheres that were moved may lie far from the origin. Throws Error(refused) for more balls
// than 32-bit indices reach.
std::string spheres_as(SphereFormat format, std::span<const Sphere> spheres,
                       std::span<const std::uint8_t> states = {});

}  // namespace vpm::view
