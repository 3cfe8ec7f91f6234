// How often the truth lies in the interval that a query tells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tools/bench/penetration_case.h"
#include "tools/bench/report.h"

namespace vpm::bench {

// Number of places of a tool that tell what no camera can know.
inline constexpr std::size_t kPlacesOfIntervals = 65536;

// Asks random poses of the tools, at which the surface cuts them, in six scenes, of an image and of
// points, clean and with noise: `poses` in each, those with noise of so many `images`. Adds a
// result of each, the bounds that coverage must keep, and a summary. A truth that no camera can
// know counts as inside where the interval meets the bounds of what it can be; of the plate only
// points are asked.
void add_intervals(const std::vector<const PackedSolid*>& tools, std::uint32_t level, int poses,
                   int images, Report& report);

}  // namespace vpm::bench
