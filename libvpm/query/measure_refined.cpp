#include "libvpm/query/measure_refined.h"

#include <algorithm>
#include <atomic>

#include "libvpm/core/parallel.h"
#include "libvpm/query/passage.h"
#include "libvpm/query/patch.h"

namespace vpm {

RefinedMeasure::RefinedMeasure(const ToolModel& tool, const Level& level, bool coherent)
    : tool_(tool), reach_(tool.reach), level_(tool, level) {
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
  std::fill(states.begin(), states.end(), SphereState::outside);
  ToolSum sum;
  Result result;
  const auto run_on = [&](const auto& surface, const Pose& frame) {
    const Pose to_surface = relative_to(frame, from_center_of_mass);
    result.points = find_inside(surface, to_surface, frame, points);
    result.boundary = static_cast<std::uint32_t>(cut_.size());
    result.inside = add_up(states, sum);
  };
  if (cloud.is_organised())
    run_on(cloud.depth_surface(), cloud.camera_to_world());
  else
    run_on(cloud.disk_surface(), Pose{{}, cloud.origin()});
  sum.write(tool_, pose.rotation, result);
  return result;
}

template <class Surface>
std::uint32_t RefinedMeasure::find_inside(const Surface& surface, const Pose& to_surface,
                                          const Pose& to_world, const PointsOfSphere& points) {
  const std::uint32_t found = classify(surface, to_surface, points);
  flood(surface, to_surface);
  if (memory_) {
    if (cut_.empty()) flood_from_memory(surface, to_surface, to_world);
    remember(surface, to_surface, to_world);
  }
  count_inside(surface, to_surface);
  return found;
}

std::uint32_t RefinedMeasure::add_up(std::vector<SphereState>& states, ToolSum& sum) const {
  for (const std::uint32_t i : cut_) {
    states[level_.sphere(i)] = SphereState::boundary;
    sum.add(results_[i].sum);
  }
  std::uint32_t inside = 0;
  for (const std::uint32_t i : inside_) {
    if (results_[i].sum.volume.value == 0) continue;  // the flood passed through the hidden
    states[level_.sphere(i)] = SphereState::inside;
    sum.add(results_[i].sum);
    ++inside;
  }
  return inside;
}

template <class Surface>
std::uint32_t RefinedMeasure::classify(const Surface& surface, const Pose& to_surface,
                                       const PointsOfSphere& points) {
  std::atomic<std::uint32_t> found{0};
  constexpr std::size_t kGrain = 4;
  parallel_for(level_.roots().size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::uint32_t found_here = 0;
    for (std::size_t root = begin; root < end; ++root)
      found_here += classify_cluster(surface, to_surface, points, level_.roots()[root]);
    if (found_here > 0) found.fetch_add(found_here, std::memory_order_relaxed);
  });
  return found;
}

template <class Surface>
std::uint32_t RefinedMeasure::classify_cluster(const Surface& surface, const Pose& to_surface,
                                               const PointsOfSphere& points, std::uint32_t root) {
  const ShareCluster& cluster = level_.nodes()[root].cluster;
  const Vec3 center = to_surface * cluster.center;
  const auto look = surface.look_at_ball(center, cluster.reach);
  if (look.side == Side::mixed) {
    TangentPlane plane;
    return is_patch(cluster.reach, tool_.reach) &&
                   sees_patch(surface, look, center, cluster.reach, plane)
               ? classify_crossed(surface, to_surface, points, cluster, look, {plane, to_surface})
               : classify_nodes(surface, to_surface, points, root);
  }
  decide(surface, look, cluster, center);
  if (passages_[cluster.begin] == Passage::near && is_patch(cluster.reach, tool_.reach))
    count_behind(
        surface, to_surface, cluster,
        transpose(to_surface.rotation) * surface.closest_normal(center, surface.read(center)));
  return 0;
}

// Clusters in a cluster before shares: what holds for a ball holds for the balls in it.
template <class Surface>
std::uint32_t RefinedMeasure::classify_nodes(const Surface& surface, const Pose& to_surface,
                                             const PointsOfSphere& points, std::uint32_t root) {
  const std::vector<ShareTreeNode>& nodes = level_.nodes();
  std::uint32_t found = 0, node = root;
  while (node < nodes[root].next) {
    const auto& [cluster, next] = nodes[node];
    const bool is_leaf = next == node + 1;
    const Vec3 center = to_surface * cluster.center;
    const auto look = surface.look_at_ball(center, cluster.reach);
    if (look.side != Side::mixed) {
      decide(surface, look, cluster, center);
      node = next;
      continue;
    }
    if (is_leaf) {
      for (std::uint32_t i = cluster.begin; i < cluster.end; ++i)
        found += classify_share(surface, to_surface, points, i);
    }
    ++node;
  }
  return found;
}

// Of a cluster through which the surface does not pass.
template <class Surface>
void RefinedMeasure::decide(const Surface& surface, const typename Surface::Look& look,
                            const ShareCluster& cluster, Vec3 center) {
  Cell cell = look.side == Side::free ? Cell::free : Cell::open;
  Passage passage = Passage::unknown;
  if (look.side == Side::behind) {
    cell = Cell::whole;
    if (surface.largest_gap(look, center, cluster.reach) < tool_.reach) passage = Passage::near;
  }
  std::fill(cells_.begin() + cluster.begin, cells_.begin() + cluster.end, cell);
  std::fill(passages_.begin() + cluster.begin, passages_.begin() + cluster.end, passage);
}

// Of a patch wholly behind the surface near it: one direction for all shares.
template <class Surface>
void RefinedMeasure::count_behind(const Surface& surface, const Pose& to_surface,
                                  const ShareCluster& cluster, Vec3 normal) {
  for (std::uint32_t i = cluster.begin; i < cluster.end; ++i) {
    results_[i] = {};
    CellMeasure(surface, to_surface, reach_, level_.cell(i))
        .add_whole(level_.mass(i), normal, results_[i].sum);
    cells_[i] = Cell::partial;
  }
}

// Of a patch through which the surface passes as one plane. What a share's own pixels show to be
// free is free, whatever the mean of all says.
template <class Surface>
std::uint32_t RefinedMeasure::classify_crossed(const Surface& surface, const Pose& to_surface,
                                               const PointsOfSphere& points,
                                               const ShareCluster& cluster,
                                               const typename Surface::Look& look,
                                               const CrossingPlane& plane) {
  std::uint32_t found = 0;
  for (std::uint32_t i = cluster.begin; i < cluster.end; ++i) {
    const CellView view = level_.cell(i);
    const double distance = plane.distance(view.center);
    passages_[i] = Passage::open;
    squared_gaps_[i] = distance * distance;
    cells_[i] = Cell::free;
    const Vec3 center = to_surface * view.center;
    if (distance < view.reach && !(surface.may_be_free(look, center, view.reach) &&
                                   surface.side_of_ball(center, view.reach) == Side::free)) {
      const CellMeasure measure(surface, to_surface, reach_, view);
      CellResult& result = results_[i];
      result = {};
      if (distance <= -view.reach)
        measure.add_whole(level_.mass(i), plane.normal, result.sum);
      else
        for (std::uint32_t b = view.begin; b < view.end; ++b) measure.add_block(b, plane, result);
      cells_[i] = cell_of(result);
    }
    if (surface.may_touch(look, center, level_.radius(i)))
      found += count_points(surface, points, i, center);
  }
  return found;
}

// Points in the sphere of a share; `center` is the sphere's, in the surface's frame.
template <class Surface>
std::uint32_t RefinedMeasure::count_points(const Surface& surface, const PointsOfSphere& points,
                                           std::uint32_t i, Vec3 center) const {
  const auto look = surface.look_at_ball(center, level_.radius(i));
  return look.side == Side::mixed ? points.count(tool_.spheres[level_.sphere(i)], look) : 0;
}

template <class Surface>
std::uint32_t RefinedMeasure::classify_share(const Surface& surface, const Pose& to_surface,
                                             const PointsOfSphere& points, std::uint32_t i) {
  passages_[i] = Passage::unknown;
  const CellView view = level_.cell(i);
  const Vec3 center = to_surface * view.center;
  const Side side = surface.side_of_ball(center, view.reach);
  if (side == Side::free) {
    cells_[i] = Cell::free;
  } else if (side == Side::behind) {
    cells_[i] = Cell::whole;
  } else if (side == Side::uncut) {
    cells_[i] = Cell::open;
  } else {
    results_[i] = CellMeasure(surface, to_surface, reach_, view).run();
    cells_[i] = cell_of(results_[i]);
    return count_points(surface, points, i, center);
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
      const CellMeasure measure(surface, to_surface, reach_, level_.cell(i));
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
