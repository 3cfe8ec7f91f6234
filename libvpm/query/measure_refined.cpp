#include "libvpm/query/measure_refined.h"

#include <algorithm>
#include <atomic>

#include "libvpm/core/parallel.h"
#include "libvpm/query/passage.h"

namespace vpm {

RefinedMeasure::RefinedMeasure(const ToolModel& tool, const Level& level, bool coherent)
    : tool_(tool), level_(tool, level) {
  if (coherent) memory_.emplace(level_.size());
  cells_.resize(level_.size());
  results_.resize(level_.size());
  passages_.resize(level_.size());
  squared_gaps_.resize(level_.size());
  cut_.reserve(level_.size());
  inside_.reserve(level_.size());
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
    states[level_.sphere(i)] = SphereState::boundary;
    sum.add(results_[i].sum);
  }
  result.boundary = static_cast<std::uint32_t>(cut_.size());
  for (const std::uint32_t i : inside_) {
    if (results_[i].sum.volume.value == 0) continue;  // the flood passed through the hidden
    states[level_.sphere(i)] = SphereState::inside;
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
  const std::vector<ShareTreeNode>& nodes = level_.nodes();
  parallel_for(level_.roots().size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::uint32_t found_here = 0;
    for (std::size_t root = begin; root < end; ++root) {
      std::uint32_t node = level_.roots()[root];
      const std::uint32_t after = nodes[node].next;
      while (node < after) {
        const auto& [cluster, next] = nodes[node];
        const bool is_leaf = next == node + 1;
        if (classify_cluster(surface, to_surface, cluster)) {
          node = next;
          continue;
        }
        if (is_leaf) {
          for (std::uint32_t i = cluster.begin; i < cluster.end; ++i)
            found_here += classify_share(surface, to_surface, points, i);
        }
        ++node;
      }
    }
    if (found_here > 0) found.fetch_add(found_here, std::memory_order_relaxed);
  });
  return found;
}

// False where the surface may pass through the cluster.
template <class Surface>
bool RefinedMeasure::classify_cluster(const Surface& surface, const Pose& to_surface,
                                      const ShareCluster& cluster) {
  const Vec3 center = to_surface * cluster.center;
  const auto look = surface.look_at_ball(center, cluster.reach);
  if (look.side == Side::mixed) return false;
  Cell cell = look.side == Side::free ? Cell::free : Cell::open;
  Passage passage = Passage::unknown;
  if (look.side == Side::behind) {
    cell = Cell::whole;
    if (surface.largest_gap(look, center, cluster.reach) < tool_.reach) passage = Passage::near;
  }
  std::fill(cells_.begin() + cluster.begin, cells_.begin() + cluster.end, cell);
  std::fill(passages_.begin() + cluster.begin, passages_.begin() + cluster.end, passage);
  return true;
}

template <class Surface>
std::uint32_t RefinedMeasure::classify_share(const Surface& surface, const Pose& to_surface,
                                             const PointsOfSphere& points, std::uint32_t i) {
  passages_[i] = Passage::unknown;
  const CellView view = level_.cell(i);
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
    const Sphere& sphere = tool_.spheres[level_.sphere(i)];
    const auto look = surface.look_at_ball(to_surface * view.center, sphere.radius);
    if (look.side == Side::mixed) return points.count(sphere, look);
  }
  return 0;
}

// The surface enters the tool through cut shares; from there every share behind it that the graph
// reaches is inside. Which ones does not depend on the order of the traversal.
template <class Surface>
void RefinedMeasure::flood(const Surface& surface, const Pose& to_surface) {
  cut_.clear();
  inside_.clear();
  for (std::uint32_t i = 0; i < level_.size(); ++i) {
    if (cells_[i] == Cell::cut) cut_.push_back(i);
  }
  const auto take = [&](std::uint32_t j) {
    passages_[j] = Passage::taken;
    inside_.push_back(j);
  };
  for (const std::uint32_t i : cut_) {
    for (const std::uint32_t j : level_.neighbors(i)) {
      if (is_passable(surface, to_surface, j) && enters(surface, to_surface, i, j)) take(j);
    }
  }
  for (std::size_t next = 0; next < inside_.size(); ++next) {
    const std::uint32_t i = inside_[next];
    for (const std::uint32_t j : level_.neighbors(i)) {
      if (is_passable(surface, to_surface, j)) take(j);
    }
  }
}

// The surface passes through no share: those stay inside that were, or were cut, as long as they
// are behind the same surface; so does what the graph reaches from them near it.
template <class Surface>
void RefinedMeasure::flood_from_memory(const Surface& surface, const Pose& to_surface,
                                       const Pose& to_world) {
  const auto take = [&](std::uint32_t i) {
    if (cells_[i] == Cell::open) cells_[i] = Cell::whole;
    passages_[i] = Passage::taken;
    inside_.push_back(i);
  };
  const auto is_behind = [&](std::uint32_t i, const auto& holds) {
    if (cells_[i] == Cell::free || passages_[i] == Passage::taken) return false;
    const Vec3 at = to_surface * level_.cell(i).center;
    const Reading reading = surface.read(at);
    if (!reading.known || (cells_[i] == Cell::open && !(reading.distance < 0))) return false;
    return holds(at, reading.foot);
  };
  for (std::uint32_t i = 0; i < level_.size(); ++i) {
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
    for (const std::uint32_t j : level_.neighbors(i)) {
      if (is_behind(j, is_near)) take(j);
    }
  }
}

template <class Surface>
void RefinedMeasure::remember(const Surface& surface, const Pose& to_surface,
                              const Pose& to_world) {
  memory_->forget();
  const auto keep = [&](std::uint32_t i) {
    const Reading reading = surface.read(to_surface * level_.cell(i).center);
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
      const CellMeasure measure(surface, to_surface, tool_.reach, level_.cell(i));
      if (whole && is_compact(level_.reach(i), tool_.reach)) {
        results_[i].sum = ToolSum{};
        measure.add_reached(nearest, piece_of(level_.mass(i)), results_[i].sum);
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
  const Vec3 at = to_surface * level_.cell(j).center;
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
                            std::uint32_t row) {
  if (passages_[row] == Passage::near) {
    const Vec3 at = to_surface * level_.cell(row).center;
    squared_gaps_[row] = squared_gap(at, surface.read(at));
    passages_[row] = Passage::open;
  }
  return lies_near_sheet(squared_gaps_[row], level_.reach(cut), level_.reach(row)) ||
         cut_share(to_surface, cut).height(to_surface * level_.cell(row).center) < 0;
}

// Equal distances go to the sphere with the smaller index.
std::uint32_t RefinedMeasure::nearest_cut(std::uint32_t row) const {
  const Vec3 center = tool_.spheres[level_.sphere(row)].center;
  const auto rank = [&](std::uint32_t cut) {
    const std::uint32_t sphere = level_.sphere(cut);
    return std::pair(squared_norm(tool_.spheres[sphere].center - center), sphere);
  };
  return *std::min_element(cut_.begin(), cut_.end(),
                           [&](std::uint32_t a, std::uint32_t b) { return rank(a) < rank(b); });
}

CutShare RefinedMeasure::cut_share(const Pose& to_surface, std::uint32_t cut) const {
  return {results_[cut].plane, to_surface * level_.cell(cut).center, level_.reach(cut)};
}

}  // namespace vpm
