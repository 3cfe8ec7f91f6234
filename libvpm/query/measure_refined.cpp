#include "libvpm/query/measure_refined.h"

#include <algorithm>
#include <mutex>

#include "libvpm/query/seen_shares.h"
#include "libvpm/query/share_classifier.h"
#include "libvpm/query/share_flood.h"

namespace vpm {
namespace {

// What decides which shares behind a surface are inside.
template <class Surface>
using Inside = std::conditional_t<Surface::kTellsInside, SeenShares<Surface>, ShareFlood<Surface>>;

}  // namespace

RefinedMeasure::RefinedMeasure(const ToolModel& tool, const Level& level,
                               const QueryOptions& options)
    : tool_(tool),
      reach_(tool.reach, options.shadows),
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
  CutShares cut(tool_, level_, to_surface, shares_);
  cut.list();
  Inside<Surface> inside(reach_, level_, surface, to_surface, cut, shares_);
  inside.run(region);
  if (memory_ && cut.are_none()) inside.run_from(*memory_, to_world);
  result.boundary = static_cast<std::uint32_t>(shares_.cut.size());
  result.inside = add_up(surface, to_surface, inside, region, sum);
  if (memory_) remember(surface, to_surface, to_world, inside);
}

template <class Surface, class Inside>
std::uint32_t RefinedMeasure::add_up(const Surface& surface, const Pose& to_surface,
                                     const Inside& inside, ParallelRegion& region, ToolSum& sum) {
  constexpr std::size_t kGrain = 512;
  std::mutex adding;
  std::uint32_t all = 0;
  region.loop(level_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    ToolSum of_all;
    std::uint32_t last_cut = kNoRow;
    std::uint32_t count = 0;
    for_rows_in(Cell::cut, shares_.cells, begin, end,
                [&](std::uint32_t i) { of_all.add(shares_.results[i].sum); });
    for_rows_in(Passage::taken, shares_.passages, begin, end, [&](std::uint32_t i) {
      const ToolSum part = sum_of(surface, to_surface, inside, i, last_cut);
      of_all.add(part);
      if (part.volume.value != 0)
        ++count;
      else
        shares_.cells[i] = Cell::free;  // hidden, not inside
    });
    const std::lock_guard lock(adding);
    sum.add(of_all);
    all += count;
  });
  return all;
}

template <class Surface, class Inside>
ToolSum RefinedMeasure::sum_of(const Surface& surface, const Pose& to_surface, const Inside& inside,
                               std::uint32_t row, std::uint32_t& last_cut) const {
  ToolSum sum;
  if (shares_.cells[row] == Cell::pushed) {
    add_whole(reach_, level_.mass(row), shares_.planes[level_.root(row)].normal, sum);
    return sum;
  }
  const bool partial = shares_.cells[row] == Cell::partial;
  if (partial && !shares_.results[row].is_far) return shares_.results[row].sum;
  const CellView view = level_.cell(row);
  const CellMeasure measure(surface, to_surface, reach_, view);
  Voucher voucher = inside.voucher(row, last_cut);
  const auto vouches = [&](Vec3 x, Vec3 foot) { return voucher(x, foot); };
  if (partial) {
    sum = shares_.results[row].sum;
    measure.add_far(vouches, sum);
  } else if (is_compact(level_.reach(row), reach_.length)) {
    measure.add_whole_piece(vouches, piece_of(level_.mass(row), view), sum);
  } else {
    sum = measure.whole(vouches);
  }
  return sum;
}

// What is cut and inside now.
template <class Surface, class Inside>
void RefinedMeasure::remember(const Surface& surface, const Pose& to_surface, const Pose& to_world,
                              Inside& inside) {
  inside.begin_to_remember(to_world, *memory_);
  const auto keep = [&](std::uint32_t i) {
    const std::uint32_t root = level_.root(i);
    const bool is_known = memory_->is_known(root);
    if (!is_known || !inside.follows(i)) {
      const Reading reading = surface.read(to_surface * level_.cell(i).center);
      const Vec3 foot = to_world * reading.foot;
      if (!reading.known || !inside.is_sure(i, foot)) return;
      if (!is_known) memory_->remember(root, level_.cluster(root), foot);
    }
    memory_->remember(i);
  };
  for (const std::uint32_t i : shares_.cut) keep(i);
  for_rows_in(Passage::taken, shares_.passages, 0, level_.size(), [&](std::uint32_t i) {
    if (shares_.cells[i] != Cell::free) keep(i);
  });
  memory_->turn();
}

void RefinedMeasure::read_states(std::vector<SphereState>& states) const {
  std::fill(states.begin(), states.end(), SphereState::outside);
  for (const std::uint32_t i : shares_.cut) states[level_.sphere(i)] = SphereState::boundary;
  for_rows_in(Passage::taken, shares_.passages, 0, level_.size(), [&](std::uint32_t i) {
    if (shares_.cells[i] != Cell::free) states[level_.sphere(i)] = SphereState::inside;
  });
}

}  // namespace vpm
