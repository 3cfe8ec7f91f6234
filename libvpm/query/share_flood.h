// The second step of the refined measure: which shares behind the surface are inside. The surface
// enters the tool through cut shares; from there every share behind it that the graph reaches is.
// Which ones does not depend on the order of the traversal.
#pragma once

#include <algorithm>
#include <cstring>
#include <utility>

#include "libvpm/query/flood_memory.h"
#include "libvpm/query/passage.h"
#include "libvpm/query/share_states.h"

namespace vpm {

template <class Surface>
class ShareFlood {
 public:
  ShareFlood(const ToolModel& tool, ToolReach reach, const SpatialLevel& level,
             const Surface& surface, const Pose& to_surface, ShareStates& states)
      : tool_(tool),
        reach_(reach),
        level_(level),
        surface_(surface),
        to_surface_(to_surface),
        states_(states) {}

  void run() {
    list_cut();
    states_.inside.clear();
    for (const std::uint32_t i : states_.cut) {
      for (const std::uint32_t j : level_.neighbors(i)) {
        if (is_passable(j) && enters(i, j)) take(j);
      }
    }
    for (std::size_t next = 0; next < states_.inside.size(); ++next) {
      for (const std::uint32_t j : level_.neighbors(states_.inside[next])) {
        if (is_passable(j)) take(j);
      }
    }
  }

  // Where the surface passes through no share: those stay inside that were, or were cut, as long as
  // they are behind the same surface; so does what the graph reaches from them near it.
  void run_from(const FloodMemory& memory, const Pose& to_world) {
    const auto take_open = [&](std::uint32_t i) {
      if (states_.cells[i] == Cell::open) states_.cells[i] = Cell::whole;
      take(i);
    };
    for (std::uint32_t i = 0; i < level_.size(); ++i) {
      if (memory.was_inside(i) && is_behind(i, [&](Vec3, Vec3 foot) {
            return memory.is_near(level_.root(i), to_world * foot, reach_.length);
          }))
        take_open(i);
    }
    const auto is_near = [&](Vec3 at, Vec3 foot) {
      return squared_norm(foot - at) <= reach_.length * reach_.length;
    };
    for (std::size_t next = 0; next < states_.inside.size(); ++next) {
      for (const std::uint32_t j : level_.neighbors(states_.inside[next])) {
        if (is_behind(j, is_near)) take_open(j);
      }
    }
  }

  // What is cut and inside now.
  void remember(const Pose& to_world, FloodMemory& memory) const {
    memory.forget();
    const auto keep = [&](std::uint32_t i) {
      memory.remember(i, level_.root(i), [&](Vec3& foot) {
        const Reading reading = surface_.read(center(i));
        foot = to_world * reading.foot;
        return reading.known;
      });
    };
    for (const std::uint32_t i : states_.cut) keep(i);
    for (const std::uint32_t i : states_.inside) keep(i);
  }

  // The cut share nearest to one that the flood has taken; without plane where nothing is cut.
  CutShare nearest_cut_share(std::uint32_t row) const {
    return states_.cut.empty() ? CutShare{} : cut_share(nearest_cut(row));
  }

 private:
  Vec3 center(std::uint32_t row) const { return to_surface_ * level_.cell(row).center; }

  void list_cut() {
    static_assert(sizeof(Cell) == 1);  // memchr looks at many at once
    states_.cut.clear();
    const Cell *const begin = states_.cells.data(), *const end = begin + level_.size();
    for (const Cell* at = begin; at < end; ++at) {
      at = static_cast<const Cell*>(
          std::memchr(at, static_cast<int>(Cell::cut), static_cast<std::size_t>(end - at)));
      if (at == nullptr) return;
      states_.cut.push_back(static_cast<std::uint32_t>(at - begin));
    }
  }

  void take(std::uint32_t j) {
    states_.passages[j] = Passage::taken;
    states_.inside.push_back(j);
  }

  bool is_passable(std::uint32_t j) {
    Passage& passage = states_.passages[j];
    if (passage == Passage::closed || passage == Passage::taken) return false;
    if (passage == Passage::unknown) passage = find_passage(j);
    return passage != Passage::closed;
  }

  Passage find_passage(std::uint32_t j) {
    const Vec3 at = center(j);
    const Reading reading = surface_.read(at);
    if (states_.cells[j] == Cell::open) {
      if (!(reading.known && reading.distance < 0)) return Passage::closed;
      states_.cells[j] = Cell::whole;
    }
    states_.squared_gaps[j] = squared_gap(reading);
    if (!is_hidden_share(states_.squared_gaps[j], reach_.length)) return Passage::open;
    return cut_share(nearest_cut(j)).height(at) < 0 ? Passage::open : Passage::closed;
  }

  bool enters(std::uint32_t cut, std::uint32_t row) {
    return lies_near_sheet(squared_gap_of(row), level_.reach(cut), level_.reach(row)) ||
           cut_share(cut).height(center(row)) < 0;
  }
  double squared_gap_of(std::uint32_t row) {
    if (states_.passages[row] == Passage::patch) {
      const double distance = states_.planes[level_.root(row)].distance(level_.cell(row).center);
      return distance * distance;
    }
    if (states_.passages[row] == Passage::near) {
      const Vec3 at = center(row);
      states_.squared_gaps[row] = squared_gap(surface_.read(at));
      states_.passages[row] = Passage::open;
    }
    return states_.squared_gaps[row];
  }

  template <class Holds>
  bool is_behind(std::uint32_t i, const Holds& holds) const {
    if (states_.cells[i] == Cell::free || states_.passages[i] == Passage::taken) return false;
    const Vec3 at = center(i);
    const Reading reading = surface_.read(at);
    if (!reading.known || (states_.cells[i] == Cell::open && !(reading.distance < 0))) return false;
    return holds(at, reading.foot);
  }

  // Equal distances go to the sphere with the smaller index.
  std::uint32_t nearest_cut(std::uint32_t row) const {
    const Vec3 center = tool_.spheres[level_.sphere(row)].center;
    const auto rank = [&](std::uint32_t cut) {
      const std::uint32_t sphere = level_.sphere(cut);
      return std::pair(squared_norm(tool_.spheres[sphere].center - center), sphere);
    };
    return *std::min_element(states_.cut.begin(), states_.cut.end(),
                             [&](std::uint32_t a, std::uint32_t b) { return rank(a) < rank(b); });
  }

  CutShare cut_share(std::uint32_t cut) const {
    return {states_.results[cut].plane, center(cut), level_.reach(cut)};
  }

  const ToolModel& tool_;
  ToolReach reach_;
  const SpatialLevel& level_;
  const Surface& surface_;
  const Pose& to_surface_;
  ShareStates& states_;
};

}  // namespace vpm
