#include <algorithm>
#include <cmath>
#include <limits>

#include "libvpm/core/error.h"
#include "libvpm/core/lengths.h"
#include "libvpm/model/sphere.h"
#include "libvpm/model/tool_model.h"

namespace vpm {
namespace {

using Indices = std::vector<std::uint32_t>;

// Relative tolerance of sums over the cells of a tool: rounding only.
constexpr double kSumTolerance = 1e-6;
// Relative tolerance for spheres that touch the tool's bounding ball.
constexpr double kReachTolerance = 1e-6;
// Largest area vector of a surface that counts as closed, relative to the squared tool radius.
constexpr double kSurfaceGap = 1e-9;
// Largest distance of blocks and samples from the centre of mass, in tool radii. The fixed-point
// sums of a query (ToolSum) allow lever arms of up to 8.
constexpr double kFarthestPart = 2;
// Largest distance of a cell's blocks and samples from its sphere's centre, in bounding radii of
// the cell.
constexpr double kFarthestOfCell = 7;
// Number of samples per cell up to which a query's counts are exact.
constexpr std::size_t kMaxSamplesOfACell = std::size_t{1} << 20;
// Largest extent of a sample at a face, in its radii: that of a flat one across its axis is the
// root of 3/2, of a long one along it the root of 3.
constexpr double kFarthestOfFace = 2;
// Tolerance for what float32 rounds of a unit vector and of extents.
constexpr double kUnitTolerance = 1e-6;
// Least extents along the axis of a sample at a face, in those across it: of thinner ones rounding
// would leave nothing of the density.
constexpr double kThinnestFace = 0x1p-11;
// Limits the depth, since traversals recurse; a hierarchy that halves its spheres at each node
// needs 32.
constexpr std::uint32_t kDeepestHierarchy = 1000;

// Checks one level of a model; `where` is "<name>: level k".
class LevelCheck {
 public:
  LevelCheck(const ToolModel& model, const Level& level, std::string where)
      : model_(model), level_(level), where_(std::move(where)) {}

  void run() const {
    if (!(level_.epsilon >= 0 && std::isfinite(level_.epsilon)))
      fail("its epsilon is not finite and positive");
    graph();
    hierarchy();
    grid();
    cell_sum();
    samples();
    faces();
    sums();
  }

 private:
  [[noreturn]] void fail(const std::string& defect) const { refuse(defect, where_); }

  // Checks compressed rows: `count` + 1 offsets that ascend from 0 to `entries`.
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

  // Checks that every row of `entries` ascends strictly and stays below the sphere count.
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

  // Checks that the nodes are a tree: children follow their parent, and each node but the root and
  // each leaf has one parent. This proves that a traversal ends.
  void hierarchy() const {
    const auto& [nodes, leaves] = level_.hierarchy;
    if (nodes.empty()) fail("its hierarchy has no nodes");
    if (nodes.size() > std::numeric_limits<std::uint32_t>::max())
      fail("its hierarchy has more than 2^32 - 1 nodes");
    std::vector<char> node_met(nodes.size()), leaf_met(leaves.size());
    std::vector<std::uint32_t> depth(nodes.size());
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
        if (!of_leaves) depth[child] = depth[i] + 1;
      }
      if (depth[i] > kDeepestHierarchy)
        fail_node("is deeper than " + std::to_string(kDeepestHierarchy));
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

  void cell_sum() const {
    const std::size_t n = level_.sphere_count;
    if (level_.cell_volume.size() != n || level_.cell_centroid.size() != n ||
        level_.cell_radius.size() != n)
      fail("its cells are not as many as its spheres");
    for (std::size_t i = 0; i < n; ++i) {
      if (!(level_.cell_volume[i] >= 0) || !std::isfinite(level_.cell_volume[i]) ||
          !is_finite(level_.cell_centroid[i]) || !(level_.cell_radius[i] > 0) ||
          !std::isfinite(level_.cell_radius[i]))
        fail("cell " + std::to_string(i) + " is negative or not finite, or has no radius");
    }
  }

  // Checks that blocks cut the samples into consecutive runs, and cells cut the blocks so.
  void samples() const {
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
    for (std::size_t i = 0; i < level_.sphere_count; ++i) {
      const std::uint32_t first = level_.block_begin[i], last = level_.block_begin[i + 1];
      if (first < last &&
          level_.blocks[last - 1].end - level_.blocks[first].begin > kMaxSamplesOfACell)
        fail("the cell of sphere " + std::to_string(i) + " has more than 2^20 samples");
    }
    for (std::size_t i = 0; i < level_.samples.size(); ++i) {
      const CellSample& sample = level_.samples[i];
      if (!is_finite(sample.center) || !(sample.radius >= 0) || !std::isfinite(sample.radius) ||
          !(sample.weight >= 0) || !std::isfinite(sample.weight))
        fail("sample " + std::to_string(i) + " is negative or not finite");
    }
  }

  // Checks that the shapes of samples at faces are shapes: no part of them counts less than
  // nothing, and none reaches much further than the ball.
  void faces() const {
    std::uint64_t next = 0;
    for (const SampleFace& face : level_.faces) {
      const auto fail_face = [&](const std::string& defect) {
        fail("the face of sample " + std::to_string(face.sample) + " " + defect);
      };
      if (face.sample < next || face.sample >= level_.samples.size())
        fail_face("is out of order or range");
      next = std::uint64_t{face.sample} + 1;
      const double toward = face.toward, away = face.away, along = face.along, across = face.across,
                   most = kFarthestOfFace * double{level_.samples[face.sample].radius};
      if (!(std::abs(squared_norm(widen(face.axis)) - 1) <= kUnitTolerance))
        fail_face("has an axis that is no unit vector");
      const auto is_extent = [&](double extent) {
        return extent > 0 && extent >= kThinnestFace * across && extent <= along;
      };
      if (!(across >= 0 && across <= most && along <= most && is_extent(toward) && is_extent(away)))
        fail_face("has extents out of range");
      if (!(along * along <= (1 + kUnitTolerance) * most_variance_at_face(toward, away) * 5))
        fail_face("has a larger variance than its extents allow");
    }
    check_order_of_faces();
    if (level_.faces.size() > kMostFaces) fail("it has more than 2^22 samples at faces");
  }

  // Checks that the samples at faces are the last ones of their blocks: a query asks the last one.
  void check_order_of_faces() const {
    auto face = level_.faces.begin();
    for (const CellBlock& block : level_.blocks) {
      const auto first = face;
      while (face != level_.faces.end() && face->sample < block.end) ++face;
      if (face != first && block.end - first->sample != face - first)
        fail("sample " + std::to_string(first->sample) +
             " is at a face, and a later one of its block is at none");
    }
  }

  // Checks what keeps a query's fixed-point sums from overflowing: no piece lies beyond the tool,
  // and all pieces together are no more than the whole.
  void sums() const {
    const double farthest = kFarthestPart * model_.radius,
                 of_sphere = (1 + kReachTolerance) * model_.radius;
    double balls = 0, cell_sum = 0, weights = 0;
    for (std::size_t i = 0; i < level_.sphere_count; ++i) {
      const Sphere& sphere = model_.spheres[i];
      if (!(norm(sphere.center - model_.center_of_mass) + sphere.radius <= of_sphere) ||
          !(level_.cell_radius[i] <= 2 * farthest))
        fail("sphere " + std::to_string(i) + " or its cell lies beyond the tool radius");
      balls += volume(sphere);
      cell_sum += level_.cell_volume[i];
    }
    for (std::size_t i = 0; i < level_.blocks.size(); ++i) {
      if (!(norm(widen(level_.blocks[i].center)) <= farthest))
        fail("block " + std::to_string(i) + " lies beyond the tool radius");
    }
    for (std::size_t i = 0; i < level_.samples.size(); ++i) {
      const CellSample& sample = level_.samples[i];
      if (!(norm(widen(sample.center)) <= farthest) || !(sample.radius <= farthest))
        fail("sample " + std::to_string(i) + " lies beyond the tool radius");
      weights += sample.weight;
    }
    for (std::uint32_t i = 0; i < level_.sphere_count; ++i) check_cell(i);
    const auto differ = [](double sum, double whole) {
      return !(std::abs(sum - whole) <= kSumTolerance * whole);
    };
    if (!(balls <= (1 + kSumTolerance) * model_.volume))
      fail("its spheres hold " + std::to_string(balls / model_.volume) +
           " times the tool's volume, so they overlap");
    if (differ(cell_sum, model_.volume))
      fail("its cells sum to " + std::to_string(cell_sum / model_.volume) +
           " times the tool's volume");
    if (differ(weights, 1))
      fail("the weights of its samples sum to " + std::to_string(weights) + " instead of 1");
  }

  // Checks that the pieces of a cell lie within its bounding radius, in whose multiples a query
  // sums places.
  void check_cell(std::uint32_t i) const {
    const Vec3 center = model_.spheres[i].center - model_.center_of_mass;
    const double farthest = kFarthestOfCell * level_.cell_radius[i];
    const auto check = [&](Vec3 at, double radius) {
      if (!(norm(at - center) + radius <= farthest))
        fail("the cell of sphere " + std::to_string(i) + " reaches further than it says");
    };
    for (std::uint32_t b = level_.block_begin[i]; b < level_.block_begin[i + 1]; ++b) {
      const CellBlock& block = level_.blocks[b];
      check(widen(block.center), block.radius);
      for (std::uint32_t s = block.begin; s < block.end; ++s)
        check(widen(level_.samples[s].center), level_.samples[s].radius);
      for (auto face = std::ranges::lower_bound(level_.faces, block.begin, {}, &SampleFace::sample);
           face != level_.faces.end() && face->sample < block.end; ++face)
        check(widen(level_.samples[face->sample].center), std::max(face->along, face->across));
    }
  }

  const ToolModel& model_;
  const Level& level_;
  std::string where_;
};

void check_calibration(const ToolModel& model, const std::string& name) {
  if (model.calibration.empty()) return;
  if (model.calibration.size() != model.levels.size())
    refuse("its calibration has " + std::to_string(model.calibration.size()) + " entries for " +
               std::to_string(model.levels.size()) + " levels",
           name);
  for (const LevelError& error : model.calibration) {
    if (!(error.mean >= 0 && error.p95 >= 0 && error.mean <= error.worst &&
          error.p95 <= error.worst && std::isfinite(error.worst)))
      refuse("its calibration is negative, not finite or exceeds its own worst case", name);
  }
}

// Returns the first vertex that is not finite, or beyond the tool radius, or the first triangle of
// vertices that are not there, as a defect; empty if there is none.
std::string defect_of_places(const Solid& surface, const ToolModel& model) {
  const double farthest = (1 + kReachTolerance) * model.radius;
  for (std::size_t i = 0; i < surface.vertices.size(); ++i)
    if (!(norm(surface.vertices[i] - model.center_of_mass) <= farthest))
      return "vertex " + std::to_string(i) + " of its surface lies beyond the tool radius";
  for (std::size_t i = 0; i < surface.triangles.size(); ++i)
    for (const std::uint32_t vertex : surface.triangles[i])
      if (vertex >= surface.vertices.size())
        return "triangle " + std::to_string(i) + " of its surface names vertex " +
               std::to_string(vertex) + ", but there are " +
               std::to_string(surface.vertices.size());
  return {};
}

void check_surface(const ToolModel& model, const std::string& name) {
  if (model.surface.triangles.empty() && model.surface.vertices.empty()) return;
  const std::string defect = defect_of_surface(model.surface, model);
  if (!defect.empty()) refuse(defect, name, "make the tool model again with vpm-graph");
}

}  // namespace

std::string defect_of_surface(const Solid& surface, const ToolModel& model) {
  if (std::string defect = defect_of_places(surface, model); !defect.empty()) return defect;
  Vec3 area;  // twice the integral of the normal, which is 0 for what is closed
  for (const auto& [i, j, k] : surface.triangles) {
    const Vec3 a = surface.vertices[i];
    area += cross(surface.vertices[j] - a, surface.vertices[k] - a);
  }
  if (!(norm(area) <= 2 * kSurfaceGap * model.radius * model.radius))
    return "its surface is not closed";
  const MassProperties mass = mass_properties(surface);
  if (!(std::abs(mass.volume - model.volume) <= kSumTolerance * model.volume))
    return "its surface bounds " + std::to_string(mass.volume / model.volume) +
           " times the tool's volume";
  return {};
}

void validate(const ToolModel& model, const std::string& name) {
  if (!(model.volume > 0) || !std::isnormal(model.volume) || !is_finite(model.center_of_mass) ||
      !std::isfinite(model.radius))
    refuse("volume, centre of mass and tool radius must be finite, and the volume positive", name);
  if (!(model.radius >= kSmallestLength && model.radius <= kLargestLength) ||
      !is_in_range(model.center_of_mass))
    refuse(
        "the tool is smaller than 2^-100 m, larger than 2^100 m or further than that from its "
        "origin",
        name, "scale it");
  check_spheres(model.spheres, name);
  if (model.levels.empty()) refuse("the tool model has no levels", name);
  std::uint32_t previous = 0;
  for (std::size_t k = 0; k < model.levels.size(); ++k) {
    const std::string where = name + ": level " + std::to_string(k);
    const std::uint32_t count = model.levels[k].sphere_count;
    if (count <= previous || count > model.spheres.size()) {
      refuse(
          std::to_string(count) + " spheres", where,
          "levels must ascend and not exceed the model's " + std::to_string(model.spheres.size()));
    }
    LevelCheck(model, model.levels[k], where).run();
    previous = count;
  }
  check_calibration(model, name);
  check_surface(model, name);
}

}  // namespace vpm
