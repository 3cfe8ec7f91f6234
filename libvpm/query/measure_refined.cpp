#include "libvpm/query/measure_refined.h"

#include <algorithm>
#include <atomic>

#include "libvpm/query/seen_shares.h"
#include "libvpm/query/share_classifier.h"
#include "libvpm/query/share_flood.h"

namespace vpm {
namespace {

// What decides which shares behind a surface are inside.
template <class Surface>
using Inside = std::conditional_t<Surface::kTellsInside, SeenShares<Surface>, ShareFlood<Surface>>;

std::vector<double> cluster_weights(const SpatialLevel& level) {
  std::vector<double> weights(level.roots().size());
  for (std::uint32_t i = 0; i < level.size(); ++i) weights[level.root(i)] += level.mass(i).weight;
  return weights;
}

}  // namespace

RefinedMeasure::RefinedMeasure(const ToolModel& tool, const Level& level,
                               const QueryOptions& options)
    : tool_(tool),
      reach_(tool.reach, options.shadows),
      counts_points_(options.counts_points),
      level_(tool, level),
      shares_(level_) {
  if (options.coherent) memory_.emplace(level_.size(), level_.roots().size());
  if (options.coherent && options.reuse > 0)
    contacts_.emplace(cluster_weights(level_), level_.groups().size(), reach_, options.reuse);
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
  ContactMemory* const contacts = this->contacts<Surface>();
  if (contacts != nullptr) contacts->turn(cloud.serial(), to_surface);
  ShareClassifier classifier(tool_, reach_, level_, surface, to_surface,
                             counts_points_ ? &points : nullptr, contacts, shares_);
  ParallelRegion region;
  result.points = classifier.run(region);
  CutShares cut(tool_, level_, to_surface, shares_);
  cut.list();
  Inside<Surface> inside(reach_, level_, surface, to_surface, cut, shares_);
  inside.run(region);
  if (memory_ && cut.are_none()) inside.run_from(*memory_, to_world);
  result.boundary = static_cast<std::uint32_t>(shares_.cut.size());
  result.inside = add_up(surface, to_surface, inside, region, sum);
  if (!memory_) return;
  const bool counts_any = result.boundary + result.inside > 0;
  if (counts_any || contacts != nullptr)
    remember(surface, to_surface, to_world, inside);
  else
    memory_->turn();  // in free space there is nothing to look for
}

template <class Known, class Rows>
void RefinedMeasure::for_clusters(std::uint32_t begin, std::uint32_t end,
                                  const ContactMemory* contacts, const Known& known,
                                  const Rows& rows) const {
  const auto first_row = [&](std::uint32_t root) {
    return root < level_.roots().size() ? level_.cluster(root).begin : level_.size();
  };
  std::uint32_t row = first_row(begin);
  for (std::uint32_t root = begin; contacts != nullptr && root < end; ++root) {
    if (contacts->use_of(root) == ContactMemory::Use::none) continue;
    rows(row, first_row(root));
    known(root);
    row = first_row(root + 1);
  }
  rows(row, first_row(end));
}

template <class Surface, class Inside>
std::uint32_t RefinedMeasure::add_up(const Surface& surface, const Pose& to_surface,
                                     const Inside& inside, ParallelRegion& region, ToolSum& sum) {
  constexpr std::size_t kGrain = 8;
  ContactMemory* const contacts = this->contacts<Surface>();
  std::atomic<std::uint32_t> all{0};
  region.loop(level_.roots().size(), kGrain, [&](std::size_t begin, std::size_t end) {
    ToolSum of_all;
    std::uint32_t count = 0;
    for_clusters(
        static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end), contacts,
        [&](std::uint32_t root) {
          if (contacts->is_begun(root)) {
            const Contact& contact = end_contact(surface, to_surface, inside, root);
            of_all.add(contact.sum);
            count += contact.inside;
          } else {
            contacts->add(root, of_all);
            count += contacts->inside(root);
          }
        },
        [&](std::uint32_t first, std::uint32_t last) {
          count += add_up(surface, to_surface, inside, first, last, of_all,
                          [](std::uint32_t, const ToolSum&) {});
        });
    sum.add_atomically(of_all);
    if (count > 0) all.fetch_add(count, std::memory_order_relaxed);
  });
  return all;
}

template <class Surface, class Inside, class Taken>
std::uint32_t RefinedMeasure::add_up(const Surface& surface, const Pose& to_surface,
                                     const Inside& inside, std::uint32_t begin, std::uint32_t end,
                                     ToolSum& sum, const Taken& taken) {
  std::uint32_t last_cut = kNoRow, count = 0;
  for_rows_in(Cell::cut, shares_.cells, begin, end,
              [&](std::uint32_t i) { sum.add(shares_.results[i].sum); });
  for_rows_in(Passage::taken, shares_.passages, begin, end, [&](std::uint32_t i) {
    const ToolSum part = sum_of(surface, to_surface, inside, i, last_cut);
    sum.add(part);
    taken(i, part);
    if (part.volume.value != 0)
      ++count;
    else
      shares_.cells[i] = Cell::free;  // hidden, not inside
  });
  return count;
}

// Of a cluster that was read at this pose: what is behind the surface, to be used again.
template <class Surface, class Inside>
const Contact& RefinedMeasure::end_contact(const Surface& surface, const Pose& to_surface,
                                           const Inside& inside, std::uint32_t root) {
  Contact& contact = contacts_->begun(root);
  const ShareCluster& rows = level_.cluster(root);
  const auto note = [&](std::uint32_t i, const ToolSum& part) {
    Vec3 force = part.force_terms();  // without what has been noted of it
    if (shares_.cells[i] == Cell::partial) force -= shares_.results[i].sum.force_terms();
    contact.slopes.add_pushed(force, reach_.inverse * level_.mass(i).centroid);
  };
  contact.inside = add_up(surface, to_surface, inside, rows.begin, rows.end, contact.sum, note);
  contacts_->end(root);
  return contact;
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
  const auto keep_cluster = [&](std::uint32_t root) {
    const ShareCluster& cluster = level_.cluster(root);
    for (std::uint32_t i = cluster.begin; i < cluster.end; ++i) {
      if (!shares_.counts(i)) continue;
      const bool is_known = memory_->is_known(root);
      if (!is_known || !inside.follows(i)) {
        const Reading reading = surface.read(to_surface * level_.cell(i).center);
        const Vec3 foot = to_world * reading.foot;
        if (!reading.known || !inside.is_sure(i, foot)) continue;
        if (!is_known) memory_->remember(root, cluster, foot);
      }
      if (inside.all_follow()) {
        memory_->remember_if(cluster, [&](std::uint32_t k) { return shares_.counts(k); });
        return;
      }
      memory_->remember(i);
    }
  };
  const auto keep_rows = [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t i = next_busy(shares_.cells, begin, end); i < end;) {
      const std::uint32_t root = level_.root(i);
      keep_cluster(root);
      i = next_busy(shares_.cells, level_.cluster(root).end, end);
    }
  };
  for_clusters(
      0, static_cast<std::uint32_t>(level_.roots().size()), contacts<Surface>(),
      [&](std::uint32_t root) {
        if (contacts_->is_empty(root)) return;
        if (contacts_->use_of(root) == ContactMemory::Use::anew ||
            !memory_->keep(root, level_.cluster(root)))
          keep_cluster(root);
      },
      keep_rows);
  memory_->turn();
}

void RefinedMeasure::read_states(std::vector<SphereState>& states) const {
  std::fill(states.begin(), states.end(), SphereState::outside);
  for (std::uint32_t i = 0; i < level_.size(); ++i) {
    if (shares_.counts(i))
      states[level_.sphere(i)] =
          shares_.cells[i] == Cell::cut ? SphereState::boundary : SphereState::inside;
  }
}

}  // namespace vpm
