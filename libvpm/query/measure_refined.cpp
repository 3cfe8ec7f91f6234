#include "libvpm/query/measure_refined.h"

#include <algorithm>
#include <atomic>

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

RefinedMeasure::RefinedMeasure(const ToolModel& tool, const Level& level, bool coherent)
    : tool_(tool),
      level_(level),
      masses_(block_masses(level)),
      clusters_(cluster_shares(tool, level)) {
  if (coherent) memory_.emplace(level.sphere_count);
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
  const PointsOfSphere points(cloud, pose);
  if (cloud.is_organised()) {
    const Pose& frame = cloud.camera_to_world();
    return run_on(cloud.depth_surface(), relative_to(frame, from_center_of_mass), frame, points,
                  states);
  }
  return run_on(cloud.disk_surface(), relative_to({{}, cloud.origin()}, from_center_of_mass),
                Pose{{}, cloud.origin()}, points, states);
}

template <class Surface>
Result RefinedMeasure::run_on(const Surface& surface, const Pose& to_surface, const Pose& to_world,
                              const PointsOfSphere& points, std::vector<SphereState>& states) {
  std::fill(states.begin(), states.end(), SphereState::outside);
  Result result;
  result.points = classify(surface, to_surface, points);
  flood(surface, to_surface);
  if (memory_) {
    if (cut_.empty()) flood_from_memory(surface, to_surface, to_world);
    remember(surface, to_surface, to_world);
  }
  count_inside(surface, to_surface);

  ToolSum sum;
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
  sum.write(tool_, to_world.rotation, result);
  return result;
}

// Of clusters first: what holds for a ball holds for the balls in it.
template <class Surface>
std::uint32_t RefinedMeasure::classify(const Surface& surface, const Pose& to_surface,
                                       const PointsOfSphere& points) {
  std::atomic<std::uint32_t> found{0};
  constexpr std::size_t kGrain = 4;
  parallel_for(clusters_.clusters.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::uint32_t found_here = 0;
    for (std::size_t c = begin; c < end; ++c) {
      const ShareCluster& cluster = clusters_.clusters[c];
      const Vec3 center = to_surface * cluster.center;
      const auto look = surface.look_at_ball(center, cluster.reach);
      if (look.side == Side::mixed) {
        for (std::uint32_t k = cluster.begin; k < cluster.end; ++k)
          found_here += classify_share(surface, to_surface, points, clusters_.shares[k]);
      } else if (look.side == Side::behind) {
        const bool near = surface.largest_gap(look, center, cluster.reach) < tool_.reach;
        set_cells(cluster, Cell::whole, near ? Passage::near : Passage::unknown);
      } else {
        set_cells(cluster, look.side == Side::free ? Cell::free : Cell::open, Passage::unknown);
      }
    }
    if (found_here > 0) found.fetch_add(found_here, std::memory_order_relaxed);
  });
  return found;
}

void RefinedMeasure::set_cells(const ShareCluster& cluster, Cell cell, Passage passage) {
  for (std::uint32_t k = cluster.begin; k < cluster.end; ++k) {
    cells_[clusters_.shares[k]] = cell;
    passages_[clusters_.shares[k]] = passage;
  }
}

template <class Surface>
std::uint32_t RefinedMeasure::classify_share(const Surface& surface, const Pose& to_surface,
                                             const PointsOfSphere& points, std::uint32_t i) {
  passages_[i] = Passage::unknown;
  const CellView view = cell(i);
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
    const Sphere& sphere = tool_.spheres[i];
    const auto look = surface.look_at_ball(to_surface * view.center, sphere.radius);
    if (look.side == Side::mixed) return points.count(sphere, look);
  }
  return 0;
}

// The surface enters the tool through cut shares; from there every share behind it that the graph
// reaches is inside. Which ones does not depend on the order of the traversal.
template <class Surface>
void RefinedMeasure::flood(const Surface& surface, const Pose& to_surface) {
  const SphereGraph& graph = level_.graph;
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
      if (is_passable(surface, to_surface, j) && enters(surface, to_surface, i, j)) take(j);
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

// The surface passes through no share: those stay inside that were, or were cut, as long as they
// are behind the same surface; so does what the graph reaches from them near it.
template <class Surface>
void RefinedMeasure::flood_from_memory(const Surface& surface, const Pose& to_surface,
                                       const Pose& to_world) {
  const SphereGraph& graph = level_.graph;
  const auto take = [&](std::uint32_t i) {
    if (cells_[i] == Cell::open) cells_[i] = Cell::whole;
    passages_[i] = Passage::taken;
    inside_.push_back(i);
  };
  const auto is_behind = [&](std::uint32_t i, const auto& holds) {
    if (cells_[i] == Cell::free || passages_[i] == Passage::taken) return false;
    const Vec3 at = to_surface * cell(i).center;
    const Reading reading = surface.read(at);
    if (!reading.known || (cells_[i] == Cell::open && !(reading.distance < 0))) return false;
    return holds(at, reading.foot);
  };
  for (std::uint32_t i = 0; i < level_.sphere_count; ++i) {
    if (is_behind(i, [&](Vec3, Vec3 foot) {
          return memory_->was_behind(i, to_world * foot, tool_.reach);
        }))
      take(i);
  }
  const auto is_near = [&](Vec3 at, Vec3 foot) {
    return squared_norm(foot - at) <= tool_.reach * tool_.reach;
  };
  for (std::size_t next = 0; next < inside_.size(); ++next) {
    const std::uint32_t i = inside_[next];
    for (std::uint32_t k = graph.begin[i]; k < graph.begin[i + 1]; ++k) {
      const std::uint32_t j = graph.neighbors[k];
      if (is_behind(j, is_near)) take(j);
    }
  }
}

template <class Surface>
void RefinedMeasure::remember(const Surface& surface, const Pose& to_surface,
                              const Pose& to_world) {
  memory_->forget();
  const auto keep = [&](std::uint32_t i) {
    const Reading reading = surface.read(to_surface * cell(i).center);
    if (reading.known) memory_->remember(i, to_world * reading.foot);
  };
  for (const std::uint32_t i : cut_) keep(i);
  for (const std::uint32_t i : inside_) keep(i);
}

template <class Surface>
void RefinedMeasure::count_inside(const Surface& surface, const Pose& to_surface) {
  constexpr std::size_t kGrain = 64;
  parallel_for(inside_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const std::uint32_t i = inside_[k];
      const bool whole = cells_[i] == Cell::whole;
      if (!whole && !results_[i].is_far) continue;
      const auto nearest = [&] {
        return cut_.empty() ? CutShare{} : cut_share(to_surface, nearest_cut(i));
      };
      const CellMeasure measure(surface, to_surface, tool_.reach, cell(i));
      if (whole && is_compact(level_.share_reach[i], tool_.reach)) {
        results_[i].sum = ToolSum{};
        measure.add_reached(nearest, piece_of(clusters_.masses[i]), results_[i].sum);
      } else {
        results_[i].sum = measure.reached(whole, nearest);
      }
    }
  });
}

template <class Surface>
bool RefinedMeasure::is_passable(const Surface& surface, const Pose& to_surface, std::uint32_t j) {
  if (cells_[j] == Cell::free || cells_[j] == Cell::cut) return false;
  if (passages_[j] == Passage::unknown) passages_[j] = find_passage(surface, to_surface, j);
  return passages_[j] == Passage::near || passages_[j] == Passage::open;
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

template <class Surface>
bool RefinedMeasure::enters(const Surface& surface, const Pose& to_surface, std::uint32_t cut,
                            std::uint32_t sphere) {
  if (passages_[sphere] == Passage::near) {
    const Vec3 at = to_surface * cell(sphere).center;
    squared_gaps_[sphere] = squared_gap(at, surface.read(at));
    passages_[sphere] = Passage::open;
  }
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
