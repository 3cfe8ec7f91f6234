// Decides which cells are inside: those behind the surface that a camera has seen, or those that a
// flood reaches from cut cells.
#pragma once

#include <algorithm>
#include <span>

#include "libvpm/backend/cpu/cell_samples.h"
#include "libvpm/backend/cpu/cell_states.h"
#include "libvpm/backend/cpu/pose_memory.h"
#include "libvpm/core/parallel.h"
#include "libvpm/measure/flood_rules.h"

namespace vpm {

// Decides where a camera has seen the surface: cells behind it within the tool radius are inside.
// Further behind, the nearest cut cell's plane or the pose memory decides.
template <class Surface>
class CameraVisibility {
 public:
  CameraVisibility(const PoseWork<Surface>& work, const CutCells& cut) : work_(work), cut_(cut) {}

  void run(const ParallelRegion&) {
    std::transform(work_.states.cells.begin(), work_.states.cells.end(),
                   work_.states.flood_states.begin(), [](CellClass cell) {
                     return cell == CellClass::free || cell == CellClass::cut ? FloodState::closed
                                                                              : FloodState::reached;
                   });
  }

  // Keeps cells inside that were inside or cut at the last pose, as long as they are behind the
  // same surface. For a pose at which the surface cuts no cell.
  void run_from(PoseMemory& memory, const Pose& to_world) {
    memory_ = &memory;
    memory.for_cells([&](std::uint32_t i) {
      if (stays(i, memory, to_world))
        any_stays_ = true;
      else
        memory.forget(i);
    });
  }

  auto support(std::uint32_t row, std::uint32_t& last_cut) const {
    return cut_.support(row, work_.tool_radius.length, follows(row), last_cut);
  }

  // Sets up which cells the next pose remembers. Cells that count only because something hides them
  // are left out: what hides them must be within the tool radius before the mean plane of the
  // last cut cells, and where nothing is cut, near them, and some cell must have stayed.
  void begin_to_remember(const Pose& to_world, PoseMemory& memory) {
    to_world_ = to_world;
    if (!cut_.are_none()) memory.touch(mean_plane_of_cut());
    plane_ = memory.touched();
  }
  // True if one remembered cell makes its whole cluster remembered; else follows() decides.
  bool all_follow() const { return !cut_.are_none(); }
  bool follows(std::uint32_t row) const { return memory_ != nullptr && memory_->was_inside(row); }
  // True if a cell behind the surface's place `foot`, world frame, may be remembered.
  bool is_sure(std::uint32_t row, Vec3 foot) const {
    if (follows(row)) return true;
    if (plane_.distance(foot) > work_.tool_radius.length) return false;
    const double squared = squared_norm(foot - to_world_ * work_.center(row));
    return !cut_.are_none() || (any_stays_ && !is_hidden_cell(squared, work_.tool_radius.length));
  }

 private:
  bool stays(std::uint32_t row, const PoseMemory& memory, const Pose& to_world) const {
    if (work_.states.cells[row] == CellClass::free) return false;
    const SurfaceSample on_surface = work_.surface.sample(work_.center(row));
    return on_surface.known && memory.is_near(work_.level.root(row), to_world * on_surface.foot,
                                              work_.tool_radius.length);
  }
  TangentPlane mean_plane_of_cut() const {
    Vec3 normal, foot;
    for (const std::uint32_t i : work_.states.cut) {
      const CutCell cut = cut_.at(i);
      normal += cut.plane.normals();
      foot += cut.center + cut.radius * cut.plane.mean_foot();
    }
    foot = 1 / static_cast<double>(work_.states.cut.size()) * foot;
    return {to_world_.rotation * normalized_or_zero(normal), to_world_ * foot};
  }

  PoseWork<Surface> work_;
  const CutCells& cut_;
  Pose to_world_;                       // maps the surface's frame to the world's
  TangentPlane plane_;                  // mean plane of the last cut cells, world frame
  const PoseMemory* memory_ = nullptr;  // set where nothing is cut
  bool any_stays_ = false;
};

// Decides where points were seen from unknown places: cells behind the surface that the graph
// reaches from cut cells are inside, and others that the body encloses. The order of traversal does
// not matter.
template <class Surface>
class InsideFlood {
 public:
  InsideFlood(const PoseWork<Surface>& work, const CutCells& cut) : work_(work), cut_(cut) {}

  // Floods with all threads of the region, each in its part of the tool. Steps to other parts wait
  // a round.
  void run(ParallelRegion& region) {
    if constexpr (SearchesFour<Surface>) work_.states.points.assign(work_.level.size(), kNoPoint);
    split(region.threads());
    region.loop(work_.states.part_count, 1,
                [&](std::size_t k, std::size_t) { enter(work_.states.parts[k]); });
    while (change_round()) {
      region.loop(work_.states.part_count, 1,
                  [&](std::size_t k, std::size_t) { take_up(work_.states.parts[k]); });
    }
    if (!may_enclose(work_.surface)) return;
    constexpr std::size_t kGrain = 8;
    region.loop(work_.level.roots().size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t root = begin; root < end; ++root)
        take_enclosed(static_cast<std::uint32_t>(root));
    });
  }

  // Keeps cells inside that were inside or cut at the last pose, as long as they are behind the
  // same surface, and floods from them. For a pose at which the surface cuts no cell.
  void run_from(const PoseMemory& memory, const Pose& to_world) {
    FloodPart& part = work_.states.parts.front();
    const auto take_open = [&](std::uint32_t i) {
      if (work_.states.cells[i] == CellClass::no_surface) work_.states.cells[i] = CellClass::whole;
      take(part, i);
    };
    memory.for_cells([&](std::uint32_t i) {
      if (is_behind(i, [&](Vec3, Vec3 foot) {
            return memory.is_near(work_.level.root(i), to_world * foot, work_.tool_radius.length);
          }))
        take_open(i);
    });
    const auto is_near = [&](Vec3 at, Vec3 foot) {
      return squared_norm(foot - at) <= work_.tool_radius.length * work_.tool_radius.length;
    };
    while (!part.front.empty()) {
      for (const std::uint32_t j : work_.level.neighbors(next_of(part))) {
        if (is_behind(j, is_near)) take_open(j);
      }
    }
  }

  // Returns the support for a cell that was taken. One that the body encloses needs no plane.
  auto support(std::uint32_t row, std::uint32_t& last_cut) const {
    return [is_enclosed = work_.states.flood_states[row] == FloodState::enclosed,
            by_plane = cut_.support(row, work_.tool_radius.length, true, last_cut)](
               Vec3 x, Vec3 foot) mutable { return is_enclosed || by_plane(x, foot); };
  }
  // Remembers all cells that count (see CameraVisibility).
  static void begin_to_remember(const Pose&, const PoseMemory&) {}
  static bool follows(std::uint32_t) { return true; }
  static bool all_follow() { return true; }
  static bool is_sure(std::uint32_t, Vec3) { return true; }

 private:
  static constexpr std::size_t kRowsOfChunk = 128;  // counted in a byte

  // Splits the rows among threads by estimated work.
  void split(int threads) {
    constexpr std::size_t kFewCut = 128;  // fewer take less time than two rounds
    const std::size_t count =
        std::clamp<std::size_t>(work_.states.cut.size() / kFewCut, 1, threads);
    work_.states.parts.resize(std::max(count, work_.states.parts.size()));
    work_.states.part_count = count;
    const std::uint64_t all = count > 1 ? estimate_work() : 0;
    std::uint64_t before = 0;
    std::size_t chunk = 0;
    std::uint32_t begin = 0;
    for (std::size_t k = 0; k < count; ++k) {
      for (; k + 1 < count && before < (k + 1) * all / count; ++chunk)
        before += work_.states.work[chunk];
      FloodPart& part = work_.states.parts[k];
      part.begin = begin;
      part.end = begin =
          k + 1 < count ? first_of_cluster(chunk * kRowsOfChunk) : work_.level.size();
      part.front.clear();
      part.leaving.clear();
      part.last_cut = kNoRow;
      part.left.clear();
    }
  }

  // Fills work_.states.work and returns its sum: a step for each cell that is not free, and more
  // for a cut one, whose plane is asked.
  std::uint64_t estimate_work() {
    constexpr std::uint32_t kStepsFromCut = 2;
    const std::vector<CellClass>& cells = work_.states.cells;
    std::uint64_t all = 0;
    work_.states.work.clear();
    auto cut = work_.states.cut.begin();
    for (std::size_t begin = 0; begin < cells.size(); begin += kRowsOfChunk) {
      const std::size_t end = std::min(begin + kRowsOfChunk, cells.size());
      std::uint8_t steps = 0;
      for (std::size_t i = begin; i < end; ++i) steps += cells[i] != CellClass::free;
      std::uint32_t work = steps;
      for (; cut < work_.states.cut.end() && *cut < end; ++cut) work += kStepsFromCut;
      work_.states.work.push_back(work);
      all += work;
    }
    return all;
  }

  std::span<FloodPart> parts() const {
    return {work_.states.parts.data(), work_.states.part_count};
  }

  std::uint32_t first_of_cluster(std::size_t row) const {
    return row < work_.level.size()
               ? work_.level.cluster(work_.level.root(static_cast<std::uint32_t>(row))).begin
               : work_.level.size();
  }

  // Floods a part from its cut cells.
  void enter(FloodPart& part) {
    const auto first =
        std::lower_bound(work_.states.cut.begin(), work_.states.cut.end(), part.begin);
    const auto last = std::lower_bound(first, work_.states.cut.end(), part.end);
    for (auto i = first; i < last; ++i) {
      for (const std::uint32_t j : work_.level.neighbors(*i)) step(part, *i, j);
    }
    spread(part);
  }

  // Floods a part from the steps that other parts left to it.
  void take_up(FloodPart& part) {
    for (const FloodPart& other : parts()) {
      for (const FloodPart::Step& s : other.left) {
        if (part.owns(s.to)) step(part, s.from, s.to);
      }
    }
    spread(part);
  }

  void spread(FloodPart& part) {
    while (!part.front.empty()) {
      const std::uint32_t i = next_of(part);
      for (const std::uint32_t j : work_.level.neighbors(i)) {
        if (!part.owns(j))
          part.leaving.push_back({i, j});
        else if (is_passable(part, j))
          take(part, j);
      }
    }
  }

  void step(FloodPart& part, std::uint32_t from, std::uint32_t to) {
    if (!part.owns(to)) {
      part.leaving.push_back({from, to});
    } else if (is_passable(part, to) &&
               (work_.states.cells[from] != CellClass::cut || enters(from, to))) {
      take(part, to);
    }
  }

  // Hands over the steps between parts. Returns false if there are none.
  bool change_round() {
    bool goes_on = false;
    for (FloodPart& part : parts()) {
      part.left.clear();
      part.left.swap(part.leaving);
      goes_on = goes_on || !part.left.empty();
    }
    return goes_on;
  }

  // True if it is open whether a row that no flood has reached is inside.
  bool may_be_enclosed(std::uint32_t row) const {
    const CellClass cell = work_.states.cells[row];
    if (cell == CellClass::free || cell == CellClass::cut || work_.states.is_taken(row))
      return false;
    return cell != CellClass::no_surface || work_.states.flood_states[row] != FloodState::closed;
  }
  // Takes the cells of a cluster that no flood has reached and that the body encloses.
  void take_enclosed(std::uint32_t root) {
    const CellCluster& cluster = work_.level.cluster(root);
    std::uint32_t first = cluster.begin;
    while (first < cluster.end && !may_be_enclosed(first)) ++first;
    if (first == cluster.end) return;
    const Vec3 middle = work_.to_surface * cluster.center;
    const bool as_one = is_enclosed_as_one(work_.surface, middle, cluster.radius);
    if (as_one && !encloses(work_.surface, middle)) return;
    if (work_.states.flood_states[first] == FloodState::middle) decide_cluster(root);
    for (std::uint32_t i = first; i < cluster.end; ++i) {
      if (!may_be_enclosed(i)) continue;
      const Vec3 at = work_.center(i);
      if (!as_one && !encloses(work_.surface, at)) continue;
      if (work_.states.cells[i] == CellClass::no_surface) {
        if (!is_behind_surface(sample_center(i))) continue;
        work_.states.cells[i] = CellClass::whole;
      }
      work_.states.flood_states[i] = FloodState::enclosed;
    }
  }

  void take(FloodPart& part, std::uint32_t j) {
    work_.states.flood_states[j] = FloodState::reached;
    part.front.push_back(j);
  }
  static std::uint32_t next_of(FloodPart& part) {
    const std::uint32_t next = part.front.back();
    part.front.pop_back();
    return next;
  }

  bool is_passable(FloodPart& part, std::uint32_t j) {
    FloodState& flood_state = work_.states.flood_states[j];
    if (flood_state == FloodState::closed || flood_state == FloodState::reached) return false;
    if (flood_state == FloodState::middle) decide_cluster(work_.level.root(j));
    if (flood_state == FloodState::unknown) flood_state = find_flood_state(part, j);
    return flood_state != FloodState::closed;
  }

  // Decides a cluster without surface by its middle. Only the part that owns it may call this.
  void decide_cluster(std::uint32_t root) {
    const CellCluster& cluster = work_.level.cluster(root);
    const Vec3 at = work_.to_surface * cluster.center;
    const SurfaceSample middle = work_.surface.sample(at);
    const ClusterClass found =
        class_by_middle(work_.surface, middle, at, cluster.radius, work_.tool_radius.length);
    if (found == ClusterClass::uniform)
      work_.push(cluster, root, middle);
    else
      work_.states.set(cluster, found);
  }

  // Samples the surface at the centre of a row.
  SurfaceSample sample_center(std::uint32_t row) const {
    if constexpr (SearchesFour<Surface>) {
      const std::vector<std::uint32_t>& points = work_.states.points;
      if (points[row] == kNoPoint) search_from(row);
      return work_.surface.sample_of_point(work_.center(row), points[row]);
    } else {
      return work_.surface.sample(work_.center(row));
    }
  }
  // Searches the points nearest to the centres of a row and of three more of its cluster, of which
  // the flood is likely to ask next. Only the part that owns them may call this.
  void search_from(std::uint32_t row) const {
    std::vector<std::uint32_t>& points = work_.states.points;
    const CellCluster& cluster = work_.level.cluster(work_.level.root(row));
    std::uint32_t rows[4], found = 0;
    for (std::uint32_t i = row; i < cluster.end && found < 4; ++i) {
      const FloodState state = work_.states.flood_states[i];
      const bool may_ask = state == FloodState::unknown || state == FloodState::near;
      if (i == row || (may_ask && points[i] == kNoPoint)) rows[found++] = i;
    }
    Vec3 places[4];
    for (std::uint32_t k = 0; k < 4; ++k) places[k] = work_.center(rows[std::min(k, found - 1)]);
    SurfaceSample on_surface_at[4];
    const std::uint32_t near = row > cluster.begin ? points[row - 1] : kNoPoint;
    work_.surface.sample_four(places, near, on_surface_at);
    for (std::uint32_t k = 0; k < found; ++k) points[rows[k]] = on_surface_at[k].point;
  }

  FloodState find_flood_state(FloodPart& part, std::uint32_t j) {
    const Vec3 at = work_.center(j);
    const SurfaceSample on_surface = sample_center(j);
    if (work_.states.cells[j] == CellClass::no_surface) {
      if (!is_behind_surface(on_surface)) return FloodState::closed;
      work_.states.cells[j] = CellClass::whole;
    }
    work_.states.squared_gaps[j] = squared_gap(on_surface);
    const bool is_hidden = is_hidden_cell(work_.states.squared_gaps[j], work_.tool_radius.length);
    return passes(is_hidden, [&] { return cut_.nearest_to(j, part.last_cut).is_behind(at); })
               ? FloodState::open
               : FloodState::closed;
  }

  bool enters(std::uint32_t cut, std::uint32_t row) {
    return vpm::enters(squared_gap_of(row), work_.level.cell_radius(cut),
                       work_.level.cell_radius(row),
                       [&] { return cut_.at(cut).is_behind(work_.center(row)); });
  }
  double squared_gap_of(std::uint32_t row) {
    if (work_.states.flood_states[row] == FloodState::planar) {
      const double distance =
          work_.states.planes[work_.level.root(row)].distance(work_.level.cell(row).center);
      return distance * distance;
    }
    if (work_.states.flood_states[row] == FloodState::near) {
      work_.states.squared_gaps[row] = squared_gap(sample_center(row));
      work_.states.flood_states[row] = FloodState::open;
    }
    return work_.states.squared_gaps[row];
  }

  template <class Holds>
  bool is_behind(std::uint32_t i, const Holds& holds) const {
    if (work_.states.cells[i] == CellClass::free || work_.states.is_taken(i)) return false;
    const Vec3 at = work_.center(i);
    const SurfaceSample on_surface = work_.surface.sample(at);
    if (!on_surface.known ||
        (work_.states.cells[i] == CellClass::no_surface && !(on_surface.distance < 0)))
      return false;
    return holds(at, on_surface.foot);
  }

  PoseWork<Surface> work_;
  const CutCells& cut_;
};

}  // namespace vpm
