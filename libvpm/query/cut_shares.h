// The shares that the surface cuts, and what their planes say of places far behind it.
#pragma once

#include <algorithm>
#include <utility>

#include "libvpm/query/share_states.h"

namespace vpm {

class CutShares {
 public:
  CutShares(const ToolModel& tool, const SpatialLevel& level, const Pose& to_surface,
            ShareStates& states)
      : tool_(tool), level_(level), to_surface_(to_surface), states_(states) {}

  // When the surface has met all shares.
  void list() {
    states_.cut.clear();
    for_rows_in(Cell::cut, states_.cells, 0, level_.size(),
                [&](std::uint32_t i) { states_.cut.push_back(i); });
  }
  bool are_none() const { return states_.cut.empty(); }

  CutShare at(std::uint32_t cut) const {
    return {states_.results[cut].plane, to_surface_ * level_.cell(cut).center, level_.reach(cut)};
  }
  // Equal distances go to the sphere with the smaller index. There must be some.
  CutShare nearest_to(std::uint32_t row) const {
    const Vec3 center = tool_.spheres[level_.sphere(row)].center;
    const auto rank = [&](std::uint32_t cut) {
      const std::uint32_t sphere = level_.sphere(cut);
      return std::pair(squared_norm(tool_.spheres[sphere].center - center), sphere);
    };
    return at(
        *std::min_element(states_.cut.begin(), states_.cut.end(),
                          [&](std::uint32_t a, std::uint32_t b) { return rank(a) < rank(b); }));
  }

 private:
  const ToolModel& tool_;
  const SpatialLevel& level_;
  const Pose& to_surface_;
  ShareStates& states_;
};

}  // namespace vpm
