// What a query is asked for, and what it answers.
#pragma once

#include <cstdint>
#include <optional>

#include "vpm/device.h"
#include "vpm/pose.h"

namespace vpm {

// refined: each part of the tool belongs to its nearest sphere, surfaces are planes within it, and
// noise is taken out. paper: the algorithm as printed in 2017.
enum class Measure { refined, paper };

// State of a sphere of the tool at the pose last asked: free, cut by the surface, or behind it.
enum class SphereState : std::uint8_t { outside = 0, boundary = 1, inside = 2 };

// Force and torque in world axes, the torque about the tool's centre of mass; both push the tool
// into free space. Units are N and N m, or m^3 and m^4 if QueryOptions::stiffness is 1.
struct Wrench {
  Vec3 force, torque;
  friend constexpr bool operator==(const Wrench&, const Wrench&) = default;
};

struct Result {
  double volume = 0;           // m^3 of the tool inside the scene's solid
  double volume_fraction = 0;  // volume / volume of the tool
  Wrench wrench;
  std::uint32_t boundary = 0;  // spheres that the surface cuts
  std::uint32_t inside = 0;    // spheres behind the surface that count
  // Distinct points of the scene strictly inside a sphere of the tool; empty if not counted.
  std::optional<std::uint32_t> points;

  friend constexpr bool operator==(const Result&, const Result&) = default;
};

}  // namespace vpm
