#include <algorithm>
#include <cmath>
#include <limits>

#include "libvpm/core/error.h"
#include "libvpm/model/sphere_check.h"
#include "libvpm/model/tool_model.h"

namespace vpm {
namespace {

using Indices = std::vector<std::uint32_t>;

// Checks one level; `where` is "<name>: level k".
class LevelCheck {
 public:
  LevelCheck(const Level& level, std::string where) : level_(level), where_(std::move(where)) {}

  void run() const {
    if (!(level_.epsilon >= 0 && std::isfinite(level_.epsilon)))
      fail("its epsilon is not finite and positive");
    graph();
    hierarchy();
    grid();
    shares();
    cells();
  }

 private:
  [[noreturn]] void fail(const std::string& defect) const { refuse(where_ + ": " + defect); }

  // Compressed rows: `rows` + 1 offsets that ascend from 0 to `entries`.
  void rows(const Indices& begin, std::uint64_t count, std::size_t entries,
            const std::string& what) const {
    if (begin.size() != count + 1) {
      fail(what + " have " + std::to_string(begin.size()) + " row offsets instead of " +
           std::to_string(count + 1));
    }
    if (begin.front() != 0 || begin.back() != entries ||
        !std::is_sorted(begin.begin(), begin.end()))
      fail("the row offsets of " + what + " do not ascend from 0 to their number");
  }

  // Every row of `entries` ascends strictly and stays below the sphere count.
  void ascending(const Indices& begin, const Indices& entries, const std::string& what) const {
    for (std::size_t row = 0; row + 1 < begin.size(); ++row) {
      for (std::uint32_t k = begin[row]; k < begin[row + 1]; ++k) {
        if (entries[k] >= level_.sphere_count || (k > begin[row] && entries[k] <= entries[k - 1]))
          fail(what + " of row " + std::to_string(row) + " do not ascend within the spheres");
      }
    }
  }

  void graph() const {
    const Indices& begin = level_.graph.begin;
    const Indices& neighbors = level_.graph.neighbors;
    rows(begin, level_.sphere_count, neighbors.size(), "neighbours");
    ascending(begin, neighbors, "neighbours");
    for (std::uint32_t i = 0; i < level_.sphere_count; ++i) {
      for (std::uint32_t k = begin[i]; k < begin[i + 1]; ++k) {
        const std::uint32_t j = neighbors[k];
        const auto row = neighbors.begin();
        if (j == i || !std::binary_search(row + begin[j], row + begin[j + 1], i))
          fail("the edge from sphere " + std::to_string(i) + " to " + std::to_string(j) +
               " has no way back, or is a loop");
      }
    }
  }

  // A tree: children follow their parent, and every node but the root and every leaf is met once,
  // so that a traversal ends.
  void hierarchy() const {
    const auto& [nodes, leaves] = level_.hierarchy;
    if (nodes.empty()) fail("its hierarchy has no nodes");
    if (nodes.size() > std::numeric_limits<std::uint32_t>::max())
      fail("its hierarchy has more than 2^32 - 1 nodes");
    std::vector<char> node_met(nodes.size()), leaf_met(leaves.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const HierarchyNode& node = nodes[i];
      const auto fail_node = [&](const std::string& defect) {
        fail("node " + std::to_string(i) + " of its hierarchy " + defect);
      };
      if (!is_finite(node.bound.center) || !(node.bound.radius >= 0) ||
          !std::isfinite(node.bound.radius))
        fail_node("has a bound that is no sphere");
      if (node.children_are_leaves > 1 || node.reserved != 0) fail_node("has unknown flags");
      const bool of_leaves = node.children_are_leaves == 1;
      std::vector<char>& met = of_leaves ? leaf_met : node_met;
      if (node.begin >= node.end || node.end > met.size() || (!of_leaves && node.begin <= i))
        fail_node("has children out of range");
      for (std::uint32_t child = node.begin; child < node.end; ++child) {
        if (met[child] != 0) fail_node("shares a child with another");
        met[child] = 1;
      }
    }
    if (std::count(node_met.begin(), node_met.end(), 1) + 1 != std::ssize(nodes) ||
        std::count(leaf_met.begin(), leaf_met.end(), 1) != std::ssize(leaves))
      fail("parts of its hierarchy cannot be reached");
    Indices sorted = leaves;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t i = 0; i < std::max<std::size_t>(sorted.size(), level_.sphere_count); ++i) {
      if (i >= sorted.size() || sorted[i] != i || i >= level_.sphere_count)
        fail("the leaves of its hierarchy are not its spheres, each once");
    }
  }

  void grid() const {
    const PointLocationGrid& grid = level_.grid;
    if (!is_finite(grid.low) || !(grid.cell > 0) || !std::isfinite(grid.cell))
      fail("its grid has no finite corner and positive cell size");
    const std::uint64_t layer = std::uint64_t{grid.nx} * grid.ny;
    if (layer == 0 || grid.nz == 0 || layer > std::numeric_limits<std::uint32_t>::max() / grid.nz)
      fail("its grid of " + std::to_string(grid.nx) + " x " + std::to_string(grid.ny) + " x " +
           std::to_string(grid.nz) + " cells is empty or exceeds 2^32 - 1");
    rows(grid.begin, layer * grid.nz, grid.spheres.size(), "grid cells");
    ascending(grid.begin, grid.spheres, "spheres");
  }

  void shares() const {
    const std::size_t n = level_.sphere_count;
    if (level_.share_volume.size() != n || level_.share_centroid.size() != n ||
        level_.share_reach.size() != n)
      fail("its shares are not as many as its spheres");
    for (std::size_t i = 0; i < n; ++i) {
      if (!(level_.share_volume[i] >= 0) || !std::isfinite(level_.share_volume[i]) ||
          !is_finite(level_.share_centroid[i]) || !(level_.share_reach[i] >= 0) ||
          !std::isfinite(level_.share_reach[i]))
        fail("share " + std::to_string(i) + " is negative or not finite");
    }
  }

  // Blocks cut the samples into consecutive runs.
  void cells() const {
    rows(level_.block_begin, level_.sphere_count, level_.blocks.size(), "blocks");
    std::uint32_t end = 0;
    for (std::size_t i = 0; i < level_.blocks.size(); ++i) {
      const CellBlock& block = level_.blocks[i];
      if (block.begin != end || block.end < block.begin || block.end > level_.samples.size())
        fail("block " + std::to_string(i) + " has samples out of order or range");
      if (!is_finite(block.center) || !(block.radius >= 0) || !std::isfinite(block.radius))
        fail("block " + std::to_string(i) + " is no ball");
      end = block.end;
    }
    if (end != level_.samples.size()) fail("samples belong to no block");
    for (std::size_t i = 0; i < level_.samples.size(); ++i) {
      const CellSample& sample = level_.samples[i];
      if (!is_finite(sample.center) || !(sample.radius >= 0) || !std::isfinite(sample.radius) ||
          !(sample.weight >= 0) || !std::isfinite(sample.weight))
        fail("sample " + std::to_string(i) + " is negative or not finite");
    }
  }

  const Level& level_;
  std::string where_;
};

}  // namespace

void validate(const ToolModel& model, const std::string& name) {
  if (!(model.volume > 0) || !std::isfinite(model.volume) || !is_finite(model.center_of_mass) ||
      !(model.reach >= 0) || !std::isfinite(model.reach))
    refuse(name + ": volume, centre of mass and reach must be finite, and the volume positive");
  check_spheres(model.spheres, name);
  if (model.levels.empty()) refuse(name + ": the tool model has no levels");
  std::uint32_t previous = 0;
  for (std::size_t k = 0; k < model.levels.size(); ++k) {
    const std::string where = name + ": level " + std::to_string(k);
    const std::uint32_t count = model.levels[k].sphere_count;
    if (count <= previous || count > model.spheres.size()) {
      refuse(where + ": " + std::to_string(count) +
             " spheres; levels must ascend and not exceed the model's " +
             std::to_string(model.spheres.size()));
    }
    LevelCheck(model.levels[k], where).run();
    previous = count;
  }
}

}  // namespace vpm
