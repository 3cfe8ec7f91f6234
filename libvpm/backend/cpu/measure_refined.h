// Computes the refined measure: cells instead of spheres, the surface instead of points
// (measure/README.md).
#pragma once

#include <vpm/query_types.h>

#include <atomic>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "libvpm/backend/cpu/cell_classifier.h"
#include "libvpm/backend/cpu/cell_states.h"
#include "libvpm/backend/cpu/contact_finder.h"
#include "libvpm/backend/cpu/inside_cells.h"
#include "libvpm/backend/cpu/pose_memory.h"
#include "libvpm/backend/cpu/spatial_level.h"
#include "libvpm/backend/cpu/unknown_cells.h"
#include "libvpm/backend/cpu/volume_variance.h"
#include "libvpm/backend/cpu/whole_cells.h"
#include "libvpm/core/parallel.h"
#include "libvpm/measure/body_sum.h"
#include "libvpm/scene/any_body.h"

namespace vpm {

// Decides which cells behind a surface are inside.
template <class Surface>
using InsideOf =
    std::conditional_t<Surface::kTellsInside, CameraVisibility<Surface>, InsideFlood<Surface>>;

// Says when a measure may end: with the whole sum, or, where only a hit is asked for, as soon as a
// part of the tool surely counts.
enum class Until { whole_sum, hit };

// Copies share the level, which is immutable, and measure apart: one for each thread.
class RefinedMeasure {
 public:
  // Uses the options about coherent poses and occluded space.
  RefinedMeasure(const ToolModel& tool, const Level& level, const QueryOptions& options);

  // Returns what a body gives, number `place` of its scene: coherent poses remember each. With one
  // thread, allocates nothing after the first call on a scene. Returns null if it ends at a hit,
  // which coherent poses never do.
  BodySum run(const AnyBody& body, const Pose& pose, std::size_t place = 0) {
    return *run_until(Until::whole_sum, body, pose, place);
  }
  std::optional<BodySum> run_until(Until until, const AnyBody& body, const Pose& pose,
                                   std::size_t place = 0);

  // Does so for any surface. `to_world` maps its frame to the world's.
  template <MeasuredBody Surface>
  BodySum run_on(const Surface& surface, const Pose& to_world, const Pose& pose,
                 std::size_t place = 0) {
    return *run_on_until(Until::whole_sum, surface, to_world, pose, place);
  }
  template <MeasuredBody Surface>
  std::optional<BodySum> run_on_until(Until until, const Surface& surface, const Pose& to_world,
                                      const Pose& pose, std::size_t place = 0) {
    BodySum result;
    if (contacts_) contacts_->start();
    PoseMemory* const memory = memory_of(place);
    const Pose to_surface = pose_in_body(to_world, pose, tool_.center_of_mass);
    const PoseWork<Surface> work{tool_radius_, level_, surface, to_surface, cells_};
    cells_.unseen = {};
    CellClassifier classifier(work);
    if (!classifier.finds_open_groups()) return all_free(work, memory);
    const bool may_end = until == Until::hit && memory == nullptr;
    if (may_end && classifier.finds_volume()) return std::nullopt;
    ParallelRegion region;
    if (!may_end) classifier.classify(region);
    if (next_busy(cells_.cells, 0, level_.size()) == level_.size()) return all_free(work, memory);
    classifier.push_uniform(region);
    CutCells cut(tool_, level_, to_surface, cells_);
    cut.list();
    InsideOf<Surface> inside(work, cut);
    inside.run(region);
    if (memory != nullptr && cut.are_none()) inside.run_from(*memory, to_world);
    result.boundary = static_cast<std::uint32_t>(cells_.cut.size());
    result.inside = add_up(work, inside, region, result.sum);
    if (contacts_) contacts_->run(work);
    if (tells_variance_) result.variance = variance_of(work);
    tell_unseen(work, result);
    if (memory == nullptr) return result;
    if (result.boundary + result.inside > 0)
      remember(work, to_world, inside, *memory);
    else
      memory->turn();  // in free space there is nothing to look for
    return result;
  }

  // Returns the contacts with the body at the last run, in no particular order but always the same,
  // if the options ask for them. They add up to its sum.
  std::span<const CellContact> contacts() const {
    return contacts_ ? contacts_->found() : std::span<const CellContact>();
  }

  // Reads the states of the spheres at the last run, one per sphere.
  void read_states(std::vector<SphereState>& states) const;

  // Measures the next pose of a coherent sequence alone.
  void forget() {
    for (PoseMemory& memory : memories_) memory.forget();
  }

 private:
  // Returns the memory of a body, or null unless poses are coherent.
  PoseMemory* memory_of(std::size_t place) {
    if (!is_coherent_) return nullptr;
    while (memories_.size() <= place) memories_.emplace_back(level_.size(), level_.roots().size());
    return &memories_[place];
  }
  // Returns BodySum::variance. All cells must be classified, and the cut ones listed.
  template <class Surface>
  std::optional<ToolSum::Sum> variance_of(const PoseWork<Surface>& work) const {
    if constexpr (TellsVariance<Surface>) {
      if (const auto found = volume_variance(work, tool_)) return UnseenSum::rounded(*found);
    }
    return std::nullopt;
  }
  // Tells of what does not count how much was not seen. It must be decided which cells count.
  template <class Surface>
  static void tell_unseen(const PoseWork<Surface>& work, BodySum& result) {
    if constexpr (TellsSight<Surface>) result.unseen = work.states.unseen;
    if constexpr (TellsUnknown<Surface>) result.unknown = UnknownCells(work).sum();
  }
  // Returns what a body gives whose cells were all found free.
  template <class Surface>
  BodySum all_free(const PoseWork<Surface>& work, PoseMemory* memory) {
    BodySum result;
    work.states.cut.clear();
    if (tells_variance_) result.variance = variance_of(work);
    tell_unseen(work, result);
    if (memory != nullptr) memory->turn();  // in free space there is nothing to look for
    return result;
  }
  // Adds cut cells and those that `inside` has taken; returns how many of the latter count. The
  // others become free: they were hidden, not inside.
  template <class Surface>
  std::uint32_t add_up(const PoseWork<Surface>& work, const InsideOf<Surface>& inside,
                       ParallelRegion& region, ToolSum& sum) {
    constexpr std::size_t kGrain = 8;
    const auto first_row = [&](std::size_t root) {
      return root < level_.roots().size() ? level_.cluster(static_cast<std::uint32_t>(root)).begin
                                          : level_.size();
    };
    std::atomic<std::uint32_t> all{0};
    region.loop(level_.roots().size(), kGrain, [&](std::size_t begin, std::size_t end) {
      ToolSum of_all;
      UnseenSum unseen;
      const std::uint32_t count =
          add_up(work, inside, first_row(begin), first_row(end), of_all, unseen);
      sum.add_atomically(of_all);
      cells_.unseen.add_atomically(unseen);
      if (count > 0) all.fetch_add(count, std::memory_order_relaxed);
    });
    return all;
  }

  // Adds those in rows [begin, end).
  template <class Surface>
  std::uint32_t add_up(const PoseWork<Surface>& work, const InsideOf<Surface>& inside,
                       std::uint32_t begin, std::uint32_t end, ToolSum& sum, UnseenSum& unseen) {
    std::uint32_t last_cut = kNoRow, count = 0;
    WholeCells whole(work, inside, sum, unseen);
    for_rows_in(CellClass::cut, cells_.cells, begin, end,
                [&](std::uint32_t i) { sum.add(cells_.results[i].sum); });
    const auto add_taken = [&](std::uint32_t i) {
      if (cells_.cells[i] != CellClass::uniform && cells_.cells[i] != CellClass::partial)
        return whole.add(i);
      const ToolSum part = sum_of(work, inside, i, last_cut, unseen);
      if (cells_.keeps_sums) cells_.results[i].sum = part;
      sum.add(part);
      if (counts(part))
        ++count;
      else
        cells_.cells[i] = CellClass::free;  // hidden, not inside
    };
    for_rows_in(FloodState::reached, cells_.flood_states, begin, end, add_taken);
    if (may_enclose(work.surface))
      for_rows_in(FloodState::enclosed, cells_.flood_states, begin, end, add_taken);
    return count + whole.finish();
  }

  // Returns the sum of a uniform or partial cell; takes what is supported from `unseen`.
  template <class Surface>
  ToolSum sum_of(const PoseWork<Surface>& work, const InsideOf<Surface>& inside, std::uint32_t row,
                 std::uint32_t& last_cut, UnseenSum& unseen) const {
    ToolSum sum;
    if (cells_.cells[row] == CellClass::uniform) {
      add_whole(tool_radius_, level_.mass(row), cells_.planes[level_.root(row)].normal, sum);
      return sum;
    }
    sum = cells_.results[row].sum;
    if (!cells_.results[row].is_far) return sum;
    const PieceIndex* const far = cells_.far.data() + level_.first_piece(row);
    auto support = inside.support(row, last_cut);
    add_far_together(
        work.measure_of(level_.cell(row)), {far, cells_.results[row].far_count},
        [&](Vec3 x, Vec3 foot) { return support(x, foot); }, sum, unseen);
    return sum;
  }

  // Remembers the cells that are cut and inside for the next pose.
  template <class Surface>
  void remember(const PoseWork<Surface>& work, const Pose& to_world, InsideOf<Surface>& inside,
                PoseMemory& memory) {
    inside.begin_to_remember(to_world, memory);
    const auto keep_cluster = [&](std::uint32_t root) {
      const CellCluster& cluster = level_.cluster(root);
      for (std::uint32_t i = cluster.begin; i < cluster.end; ++i) {
        if (!cells_.counts(i)) continue;
        const bool is_known = memory.is_known(root);
        if (!is_known || !inside.follows(i)) {
          const SurfaceSample on_surface = work.surface.sample(work.center(i));
          const Vec3 foot = to_world * on_surface.foot;
          if (!on_surface.known || !inside.is_sure(i, foot)) continue;
          if (!is_known) memory.remember(root, cluster, foot);
        }
        if (inside.all_follow()) {
          memory.remember_if(cluster, [&](std::uint32_t k) { return cells_.counts(k); });
          return;
        }
        memory.remember(i);
      }
    };
    for (std::uint32_t i = next_busy(cells_.cells, 0, level_.size()); i < level_.size();) {
      const std::uint32_t root = level_.root(i);
      keep_cluster(root);
      i = next_busy(cells_.cells, level_.cluster(root).end, level_.size());
    }
    memory.turn();
  }

  const ToolModel& tool_;
  ToolRadius tool_radius_;
  std::shared_ptr<const SpatialLevel> shared_level_;
  const SpatialLevel& level_;
  CellStates cells_;
  bool is_coherent_, tells_variance_;
  std::optional<ContactFinder> contacts_;  // if they are asked for
  std::deque<PoseMemory> memories_;        // for each body of the scene, if poses are coherent
};

}  // namespace vpm
