#include "libvpm/query/measure_refined.h"

#include <algorithm>

#include "libvpm/core/parallel.h"
#include "libvpm/query/passage.h"

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
  passages_.resize(level.sphere_count);
  squared_gaps_.resize(level.sphere_count);
  cut_.reserve(level.sphere_count);
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
  count_inside(surface, to_surface);

  ToolSum sum;
  Result result;
  std::fill(states.begin(), states.end(), SphereState::outside);
  for (const std::uint32_t i : cut_) {
    states[i] = SphereState::boundary;
    sum.add(results_[i].sum);
  }
  result.boundary = static_cast<std::uint32_t>(cut_.size());
  for (const std::uint32_t i : inside_) {
    if (results_[i].sum.volume.value == 0) continue;  // the flood passed through the hidden
    states[i] = SphereState::inside;
    sum.add(results_[i].sum);
    ++result.inside;
  }
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

// The surface enters the tool through cut shares; from there every share behind it that the graph
// reaches is inside. Which ones does not depend on the order of the traversal.
template <class Surface>
void RefinedMeasure::flood(const Surface& surface, const Pose& to_surface) {
  const SphereGraph& graph = level_.graph;
  std::fill(passages_.begin(), passages_.end(), Passage::unknown);
  cut_.clear();
  inside_.clear();
  for (std::uint32_t i = 0; i < level_.sphere_count; ++i) {
    if (cells_[i] == Cell::cut) cut_.push_back(i);
  }
  const auto take = [&](std::uint32_t j) {
    passages_[j] = Passage::taken;
    inside_.push_back(j);
  };
  for (const std::uint32_t i : cut_) {
    for (std::uint32_t k = graph.begin[i]; k < graph.begin[i + 1]; ++k) {
      const std::uint32_t j = graph.neighbors[k];
      if (is_passable(surface, to_surface, j) && enters(to_surface, i, j)) take(j);
    }
  }
  for (std::size_t next = 0; next < inside_.size(); ++next) {
    const std::uint32_t i = inside_[next];
    for (std::uint32_t k = graph.begin[i]; k < graph.begin[i + 1]; ++k) {
      const std::uint32_t j = graph.neighbors[k];
      if (is_passable(surface, to_surface, j)) take(j);
    }
  }
}

template <class Surface>
void RefinedMeasure::count_inside(const Surface& surface, const Pose& to_surface) {
  constexpr std::size_t kGrain = 64;
  parallel_for(inside_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const std::uint32_t i = inside_[k];
      const auto nearest = [&] { return cut_share(to_surface, nearest_cut(i)); };
      results_[i].sum = CellMeasure(surface, to_surface, tool_.reach, cell(i))
                            .reached(cells_[i] == Cell::whole, nearest);
    }
  });
}

template <class Surface>
bool RefinedMeasure::is_passable(const Surface& surface, const Pose& to_surface, std::uint32_t j) {
  if (cells_[j] == Cell::free || cells_[j] == Cell::cut) return false;
  if (passages_[j] == Passage::unknown) passages_[j] = find_passage(surface, to_surface, j);
  return passages_[j] == Passage::open;
}

template <class Surface>
RefinedMeasure::Passage RefinedMeasure::find_passage(const Surface& surface, const Pose& to_surface,
                                                     std::uint32_t j) {
  const Vec3 at = to_surface * cell(j).center;
  const Reading reading = surface.read(at);
  if (cells_[j] == Cell::open) {
    if (!(reading.known && reading.distance < 0)) return Passage::closed;
    cells_[j] = Cell::whole;
  }
  squared_gaps_[j] = squared_gap(at, reading);
  if (!is_hidden_share(squared_gaps_[j], tool_.reach)) return Passage::open;
  return cut_share(to_surface, nearest_cut(j)).height(at) < 0 ? Passage::open : Passage::closed;
}

bool RefinedMeasure::enters(const Pose& to_surface, std::uint32_t cut, std::uint32_t sphere) const {
  return lies_near_sheet(squared_gaps_[sphere], level_.share_reach[cut],
                         level_.share_reach[sphere]) ||
         cut_share(to_surface, cut).height(to_surface * cell(sphere).center) < 0;
}

// Equal distances go to the smaller index.
std::uint32_t RefinedMeasure::nearest_cut(std::uint32_t sphere) const {
  const Vec3 center = tool_.spheres[sphere].center;
  return *std::min_element(cut_.begin(), cut_.end(), [&](std::uint32_t a, std::uint32_t b) {
    return squared_norm(tool_.spheres[a].center - center) <
           squared_norm(tool_.spheres[b].center - center);
  });
}

CutShare RefinedMeasure::cut_share(const Pose& to_surface, std::uint32_t cut) const {
  return {results_[cut].plane, to_surface * cell(cut).center, level_.share_reach[cut]};
}

}  // namespace vpm
