#include "libvpm/query/measure_refined.h"

#include <algorithm>
#include <mutex>

#include "libvpm/query/share_classifier.h"
#include "libvpm/query/share_flood.h"

namespace vpm {

RefinedMeasure::RefinedMeasure(const ToolModel& tool, const Level& level,
                               const QueryOptions& options)
    : tool_(tool),
      reach_(tool.reach),
      counts_points_(options.counts_points),
      level_(tool, level),
      shares_(level_) {
  if (options.coherent) memory_.emplace(level_.size(), level_.roots().size());
}

Result RefinedMeasure::run(const PreparedCloud& cloud, const Pose& pose) {
  ToolSum sum;
  Result result;
  if (cloud.is_organised()) {
    run_on(cloud.depth_surface(), cloud.camera_to_world(), cloud, pose, sum, result);
  } else {
    constexpr double kPlaces = 1.25;  // of the tool's reach: where most places lie that are read
    DiskSurface disks = cloud.disk_surface();
    disks.feet.enter_near(pose * tool_.center_of_mass - cloud.origin(), kPlaces * tool_.reach);
    run_on(disks, Pose{{}, cloud.origin()}, cloud, pose, sum, result);
  }
  sum.write(tool_, pose.rotation, result);
  return result;
}

template <class Surface>
void RefinedMeasure::run_on(const Surface& surface, const Pose& to_world,
                            const PreparedCloud& cloud, const Pose& pose, ToolSum& sum,
                            Result& result) {
  const Pose to_surface = relative_to(to_world, {pose.rotation, pose * tool_.center_of_mass});
  const PointsOfSphere points(cloud, pose);
  ShareClassifier classifier(tool_, reach_, level_, surface, to_surface,
                             counts_points_ ? &points : nullptr, shares_);
  ParallelRegion region;
  result.points = classifier.run(region);
  ShareFlood flood(tool_, reach_, level_, surface, to_surface, shares_);
  flood.run(region);
  if (memory_) {
    if (shares_.cut.empty()) flood.run_from(*memory_, to_world);
    flood.remember(to_world, *memory_);
  }
  for (const std::uint32_t i : shares_.cut) sum.add(shares_.results[i].sum);
  result.boundary = static_cast<std::uint32_t>(shares_.cut.size());
  result.inside = add_inside(surface, to_surface, flood, region, sum);
}

template <class Surface, class Flood>
std::uint32_t RefinedMeasure::add_inside(const Surface& surface, const Pose& to_surface,
                                         const Flood& flood, ParallelRegion& region, ToolSum& sum) {
  constexpr std::size_t kGrain = 512;
  std::mutex adding;
  std::uint32_t inside = 0;
  region.loop(level_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    ToolSum of_all;
    std::uint32_t count = 0;
    for_rows_in(Passage::taken, shares_.passages, begin, end, [&](std::uint32_t i) {
      const ToolSum part = sum_of(surface, to_surface, flood, i);
      of_all.add(part);
      if (part.volume.value != 0)
        ++count;
      else
        shares_.cells[i] = Cell::free;  // the flood passed through the hidden
    });
    const std::lock_guard lock(adding);
    sum.add(of_all);
    inside += count;
  });
  return inside;
}

template <class Surface, class Flood>
ToolSum RefinedMeasure::sum_of(const Surface& surface, const Pose& to_surface, const Flood& flood,
                               std::uint32_t row) const {
  ToolSum sum;
  if (shares_.cells[row] == Cell::pushed) {
    add_whole(reach_, level_.mass(row), shares_.planes[level_.root(row)].normal, sum);
    return sum;
  }
  const CellResult& result = shares_.results[row];
  if (shares_.cells[row] == Cell::partial && !result.is_far) return result.sum;
  const CellView view = level_.cell(row);
  const CellMeasure measure(surface, to_surface, reach_, view);
  const auto nearest = [&] { return flood.nearest_cut_share(row); };
  const bool whole = shares_.cells[row] == Cell::whole;
  if (!whole || !is_compact(level_.reach(row), reach_.length))
    return measure.reached(whole, nearest);
  measure.add_reached(nearest, piece_of(level_.mass(row), view), sum);
  return sum;
}

void RefinedMeasure::read_states(std::vector<SphereState>& states) const {
  std::fill(states.begin(), states.end(), SphereState::outside);
  for (const std::uint32_t i : shares_.cut) states[level_.sphere(i)] = SphereState::boundary;
  for_rows_in(Passage::taken, shares_.passages, 0, level_.size(), [&](std::uint32_t i) {
    if (shares_.cells[i] != Cell::free) states[level_.sphere(i)] = SphereState::inside;
  });
}

}  // namespace vpm
