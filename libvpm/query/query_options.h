// What a query is asked for.
#pragma once

#include <cstdint>

#include "libvpm/device/device.h"
#include "libvpm/query/result.h"
#include "libvpm/query/shadows.h"

namespace vpm {

struct QueryOptions {
  Measure measure = Measure::refined;
  std::uint32_t level = 0;  // number of spheres; 0: the finest level of the model
  Device device = {};       // device_from_text(); the tool's level is copied there
  bool coherent = false;    // poses are those of a motion: a tool that passes wholly behind the
                            // surface stays inside until it comes out; refined measure, on the CPU
  bool counts_points = false;  // true: the refined measure counts Result::points, which takes up to
                               // 2.5 times as long; the measure as printed counts them anyway
  // Of a device, with the refined measure, in images, without counted points: how long it stays
  // ready for the next pose, which then needs no launch, and does nothing else of this process
  // meanwhile; README.md, "Standing by". Microseconds, at most kLongestStandby.
  std::uint32_t standby_us = 0;
  static constexpr std::uint32_t kLongestStandby = 1'000'000;
  Shadows shadows = Shadows::near;  // solid: refined measure, in images
  double stiffness = 1;             // N/m^3: the wrench is in N and N m; 1 leaves it in m^3 and m^4
};

}  // namespace vpm
