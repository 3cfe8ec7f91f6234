// Tests the search for the nearest of the cells that a surface cuts.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>

#include "libvpm/backend/cpu/cell_states.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

// Returns the nearest one by comparing all.
std::uint32_t nearest_of_all(const ToolModel& tool, const SpatialLevel& level,
                             const std::vector<std::uint32_t>& cut, std::uint32_t row) {
  const auto rank = [&](std::uint32_t k) {
    const std::uint32_t sphere = level.sphere(k);
    return std::pair(
        squared_norm(tool.spheres[sphere].center - tool.spheres[level.sphere(row)].center), sphere);
  };
  return *std::min_element(cut.begin(), cut.end(),
                           [&](auto a, auto b) { return rank(a) < rank(b); });
}

TEST(CutCells, FindTheNearest) {
  std::mt19937 random(1);
  for (const std::uint32_t edge : {3U, 12U}) {  // on a lattice many are equally near
    const ToolModel tool = testing::lattice_cube(0.2, edge, 1);
    const SpatialLevel level(tool, tool.levels[0]);
    const Pose to_surface;
    for (const std::uint32_t one_of : {2U, 20U, 300U}) {
      CellStates states(level);
      for (std::uint32_t row = 0; row < level.size(); ++row)
        states.set(row, random() % one_of == 0 ? CellClass::cut : CellClass::free,
                   FloodState::closed);
      states.set(level.size() / 2, CellClass::cut, FloodState::closed);
      CutCells cut(tool, level, to_surface, states);
      cut.list();
      for (std::uint32_t row = 0; row < level.size(); ++row) {
        const std::uint32_t expected = nearest_of_all(tool, level, states.cut, row);
        for (std::uint32_t last : {kNoRow, states.cut[random() % states.cut.size()]}) {
          const CutCell nearest = cut.nearest_to(row, last);
          EXPECT_EQ(last, expected);
          EXPECT_EQ(nearest.center, cut.at(expected).center);
        }
      }
    }
  }
}

}  // namespace
}  // namespace vpm
