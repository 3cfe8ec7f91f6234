#include "libvpm/query/measure_refined.h"

#include <algorithm>

#include "libvpm/core/parallel.h"

namespace vpm {

std::vector<BlockMass> block_masses(const Level& level) {
  std::vector<BlockMass> masses(level.blocks.size());
  for (std::size_t b = 0; b < masses.size(); ++b) {
    Vec3 moment;
    for (std::uint32_t s = level.blocks[b].begin; s < level.blocks[b].end; ++s) {
      masses[b].weight += level.samples[s].weight;
      moment += level.samples[s].weight * widen(level.samples[s].center);
    }
    masses[b].centroid =
        masses[b].weight > 0 ? moment / masses[b].weight : widen(level.blocks[b].center);
  }
  return masses;
}

RefinedMeasure::RefinedMeasure(const ToolModel& tool, const Level& level)
    : tool_(tool), level_(level), masses_(block_masses(level)) {
  cells_.resize(level.sphere_count);
  results_.resize(level.sphere_count);
  reached_.resize(level.sphere_count);
  source_.resize(level.sphere_count);
  inside_.reserve(level.sphere_count);
}

CellView RefinedMeasure::cell(std::uint32_t i) const {
  return {level_.blocks.data(),      masses_.data(),
          level_.samples.data(),     level_.block_begin[i],
          level_.block_begin[i + 1], tool_.spheres[i].center - tool_.center_of_mass,
          level_.share_reach[i]};
}

Result RefinedMeasure::run(const PreparedCloud& cloud, const Pose& pose,
                           std::vector<SphereState>& states) {
  const Pose from_center_of_mass{pose.rotation, pose * tool_.center_of_mass};
  if (cloud.is_organised()) {
    const Pose& frame = cloud.camera_to_world();
    return run_on(cloud.depth_surface(), relative_to(frame, from_center_of_mass), frame.rotation,
                  states);
  }
  return run_on(cloud.disk_surface(), relative_to({{}, cloud.origin()}, from_center_of_mass),
                Rotation{}, states);
}

template <class Surface>
Result RefinedMeasure::run_on(const Surface& surface, const Pose& to_surface,
                              const Rotation& to_world, std::vector<SphereState>& states) {
  classify(surface, to_surface);
  flood(surface, to_surface);

  constexpr std::size_t kGrain = 64;
  parallel_for(inside_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const std::uint32_t i = inside_[k];
      if (cells_[i] != Cell::partial) {
        results_[i].sum = CellMeasure(surface, to_surface, tool_.reach, cell(i)).whole();
      }
    }
  });

  ToolSum sum;
  Result result;
  std::fill(states.begin(), states.end(), SphereState::outside);
  for (std::uint32_t i = 0; i < level_.sphere_count; ++i) {
    if (cells_[i] == Cell::cut) {
      states[i] = SphereState::boundary;
      sum.add(results_[i].sum);
      ++result.boundary;
    }
  }
  for (const std::uint32_t i : inside_) {
    states[i] = SphereState::inside;
    sum.add(results_[i].sum);
  }
  result.inside = static_cast<std::uint32_t>(inside_.size());
  sum.write(tool_, to_world, result);
  return result;
}

template <class Surface>
void RefinedMeasure::classify(const Surface& surface, const Pose& to_surface) {
  constexpr std::size_t kGrain = 32;
  parallel_for(level_.sphere_count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const CellView view = cell(static_cast<std::uint32_t>(i));
      const Side side = surface.side_of_ball(to_surface * view.center, view.reach);
      if (side == Side::free) {
        cells_[i] = Cell::free;
      } else if (side == Side::behind) {
        cells_[i] = Cell::whole;
      } else if (side == Side::uncut) {
        cells_[i] = Cell::open;
      } else {
        results_[i] = CellMeasure(surface, to_surface, tool_.reach, view).run();
        const bool counts = results_[i].sum.volume.value > 0;
        cells_[i] = results_[i].plane.count > 0 ? Cell::cut : (counts ? Cell::partial : Cell::free);
      }
    }
  });
}

// The surface enters the tool through cut cells; from there every cell behind it that the graph
// reaches is inside. Front by front, so that each sphere's source does not depend on the traversal.
template <class Surface>
void RefinedMeasure::flood(const Surface& surface, const Pose& to_surface) {
  const SphereGraph& graph = level_.graph;
  std::fill(reached_.begin(), reached_.end(), Reached::no);
  inside_.clear();
  for (std::uint32_t i = 0; i < level_.sphere_count; ++i) {
    if (cells_[i] != Cell::cut) continue;
    for (std::uint32_t k = graph.begin[i]; k < graph.begin[i + 1]; ++k) {
      const std::uint32_t j = graph.neighbors[k];
      if (reached_[j] != Reached::no || !is_candidate(surface, to_surface, j)) continue;
      const double near = kSheetReach * (level_.share_reach[i] + level_.share_reach[j]);
      if (!is_before(surface, to_surface, i, j, near)) {
        reached_[j] = Reached::yes;
        source_[j] = i;
        inside_.push_back(j);
      }
    }
  }
  for (std::size_t front = 0; front < inside_.size();) {
    const std::size_t end = inside_.size();
    for (; front < end; ++front) discover_neighbors(surface, to_surface, inside_[front]);
    std::size_t kept = end;
    for (std::size_t k = end; k < inside_.size(); ++k) {
      const std::uint32_t j = inside_[k];
      const bool before = is_before(surface, to_surface, source_[j], j, tool_.reach);
      reached_[j] = before ? Reached::no : Reached::yes;
      if (!before) inside_[kept++] = j;
    }
    inside_.resize(kept);
  }
}

template <class Surface>
void RefinedMeasure::discover_neighbors(const Surface& surface, const Pose& to_surface,
                                        std::uint32_t i) {
  const SphereGraph& graph = level_.graph;
  for (std::uint32_t k = graph.begin[i]; k < graph.begin[i + 1]; ++k) {
    const std::uint32_t j = graph.neighbors[k];
    if (reached_[j] == Reached::yes || !is_candidate(surface, to_surface, j)) continue;
    if (reached_[j] == Reached::no) inside_.push_back(j);
    source_[j] = reached_[j] == Reached::no ? source_[i] : std::min(source_[j], source_[i]);
    reached_[j] = Reached::in_this_front;
  }
}

template <class Surface>
bool RefinedMeasure::is_candidate(const Surface& surface, const Pose& to_surface, std::uint32_t j) {
  if (cells_[j] == Cell::open) {
    const Reading reading =
        surface.read(to_surface * (tool_.spheres[j].center - tool_.center_of_mass));
    cells_[j] = reading.known && reading.distance < 0 ? Cell::whole : Cell::free;
  }
  return cells_[j] == Cell::whole || cells_[j] == Cell::partial;
}

// A sphere may be behind a surface that is not the tool's business: one further away than `near`
// only hides it. Then the plane of the cut cell from which the flood came decides: before it, the
// sphere is out of sight, not inside.
template <class Surface>
bool RefinedMeasure::is_before(const Surface& surface, const Pose& to_surface, std::uint32_t source,
                               std::uint32_t sphere, double near) const {
  const Vec3 at = to_surface * (tool_.spheres[sphere].center - tool_.center_of_mass);
  const Reading reading = surface.read(at);
  if (reading.known && squared_norm(reading.foot - at) <= near * near) return false;
  const Vec3 from = to_surface * (tool_.spheres[source].center - tool_.center_of_mass);
  return !results_[source].plane.is_behind((at - from) / level_.share_reach[source]);
}

}  // namespace vpm
