// Classifies every cell by how the surface meets it: the tree of groups first, then groups,
// clusters, cells, since the class of a ball holds for all balls in it.
#pragma once

#include <span>

#include "libvpm/backend/cpu/cell_samples.h"
#include "libvpm/backend/cpu/cell_states.h"
#include "libvpm/core/parallel.h"

namespace vpm {

template <class Surface>
class CellClassifier {
 public:
  explicit CellClassifier(const PoseWork<Surface>& work) : work_(work) {}

  // Notes the parts that the tree of groups shows to be free, and adds what of them was not seen.
  // Returns false if the whole tool is free: then no group is left to classify.
  bool finds_open_groups() {
    work_.states.open_groups.clear();
    const std::vector<GroupTreeNode>& tree = work_.level.group_tree();
    std::uint32_t node = 0, end_of_free = 0;  // nodes before it are in a free ball
    while (node < tree.size()) {
      const auto& [ball, next, group] = tree[node];
      bool is_free = node < end_of_free;
      ++node;
      if (group != GroupTreeNode::kNone) {
        is_free ? add_free_rows(ball.begin, ball.end) : work_.states.open_groups.push_back(group);
        continue;
      }
      const Vec3 center = work_.to_surface * ball.center;
      if (!is_free && !tells_of_parts(work_.surface, center, ball.radius)) continue;
      const BallClass in_ball = work_.surface.classify_ball(center, ball.radius);
      if (!is_free && in_ball.side == Side::free) {
        work_.states.set(ball, ClusterClass::free);
        is_free = true;
        end_of_free = next;
      }
      if (is_free && adds_as_one(ball, in_ball)) node = next;
    }
    work_.states.unseen.add(unseen_);
    unseen_ = {};
    return !work_.states.open_groups.empty();
  }

  // Classifies the groups that finds_open_groups() has left.
  void classify(ParallelRegion& region) {
    const std::vector<std::uint32_t>& groups = work_.states.open_groups;
    region.loop(groups.size(), 1, [&](std::size_t begin, std::size_t end) {
      CellClassifier part(work_);
      for (std::size_t k = begin; k < end; ++k) part.classify_group(groups[k]);
      work_.states.unseen.add_atomically(part.unseen_);
    });
  }
  // Does the same until a part of the tool surely counts, and returns true then.
  bool finds_volume() {
    for (const std::uint32_t index : work_.states.open_groups) {
      classify_group(index);
      const CellCluster& rows = work_.level.groups()[index].ball;
      for (std::uint32_t i = rows.begin; i < rows.end; ++i)
        if (surely_counts(i)) return true;
    }
    work_.states.unseen.add(unseen_);
    unseen_ = {};
    return false;
  }
  // Finds the directions of uniform clusters, once all groups are classified.
  void push_uniform(ParallelRegion& region) {
    work_.list_uniform();
    region.loop(work_.states.uniform.size(), kAtOnce, [&](std::size_t begin, std::size_t end) {
      push(std::span(work_.states.uniform).subspan(begin, end - begin));
    });
  }

 private:
  using BallClass = typename Surface::BallClass;

  void classify_group(std::uint32_t index) {
    const CellGroup& group = work_.level.groups()[index];
    const Vec3 center = work_.to_surface * group.ball.center;
    const bool tells =
        group.end - group.begin > 1 && tells_of_parts(work_.surface, center, group.ball.radius);
    BallClass in_ball;
    if (tells) in_ball = work_.surface.classify_ball(center, group.ball.radius);
    if (tells && in_ball.side == Side::free) return set_free(group.ball, in_ball);
    for (std::uint32_t root = group.begin; root < group.end; ++root) {
      const CellCluster& part = work_.level.cluster(root);
      if (tells &&
          is_free_part(work_.surface, in_ball, work_.to_surface * part.center, part.radius))
        set_free(part, in_ball);
      else
        classify(root);
    }
  }

  // True if a classified cell adds to the volume whatever the others are.
  bool surely_counts(std::uint32_t i) const {
    const CellClass found = work_.states.cells[i];
    if (found == CellClass::cut || (Surface::kTellsInside && found == CellClass::partial))
      return counts(work_.states.results[i].sum);
    return Surface::kTellsInside && found == CellClass::uniform &&
           UnseenSum::rounded(work_.level.mass(i).weight).value > 0;
  }

  // Notes a cluster, or a part of one, that is free, and adds what of it was not seen. `in_ball` is
  // the class of a ball about it.
  void set_free(const CellCluster& part, const BallClass& in_ball) {
    work_.states.set(part, ClusterClass::free);
    if (!adds_as_one(part, in_ball)) add_free_rows(part.begin, part.end);
  }
  // Adds the weight of rows of cells, all of them free, to what was not seen. Returns false, and
  // adds nothing, where the class of a ball about them does not tell it for all at once.
  bool adds_as_one(const CellCluster& rows, const BallClass& in_ball) {
    const Sight sight = sight_of<Surface>(in_ball);
    if (sight == Sight::mixed) return false;
    if (sight != Sight::seen) unseen_.add(work_.level.weight(rows.begin, rows.end), sight);
    return true;
  }
  // Adds what was not seen of free rows, part by part.
  void add_free_rows(std::uint32_t begin, std::uint32_t end) {
    if constexpr (TellsSight<Surface>)
      add_unseen(work_.surface, work_.to_surface, work_.level.parts(begin, end), unseen_);
  }

  void classify(std::uint32_t root) {
    const CellCluster& whole = work_.level.cluster(root);
    const Vec3 center = work_.to_surface * whole.center;
    const BallClass in_ball = work_.surface.classify_ball(center, whole.radius);
    if constexpr (TellsUnknown<Surface>) work_.states.cluster_points[root] = in_ball.point;
    ClusterClass found =
        class_of_cluster(work_.surface, in_ball, center, whole.radius, work_.tool_radius.length);
    // A flood asks the middle only where it comes.
    if (Surface::kTellsInside && found == ClusterClass::by_middle)
      found = class_by_middle(work_.surface, work_.surface.sample(center), center, whole.radius,
                              work_.tool_radius.length);
    if (found == ClusterClass::ambiguous) {
      TangentPlane plane;
      if (!finds_cluster_plane(work_.surface, in_ball, center, whole.radius,
                               work_.tool_radius.length, SampleTogether{}, plane))
        return classify_nodes(root);
      work_.states.planes[root] = {plane, work_.to_surface};
      return classify_clipped(root, in_ball);
    }
    if (found == ClusterClass::uniform)
      work_.states.set_uniform(whole);
    else if (found == ClusterClass::free)
      set_free(whole, in_ball);
    else
      work_.states.set(whole, found);
  }

  // Finds the directions of uniform clusters, kAtOnce at most, together.
  void push(std::span<const std::uint32_t> roots) {
    Vec3 centers[kAtOnce], normals[kAtOnce];
    PlaceSample middles[kAtOnce];
    for (std::size_t k = 0; k < roots.size(); ++k)
      centers[k] = work_.to_surface * work_.level.cluster(roots[k]).center;
    sample_places(work_.surface, {centers, roots.size()}, middles);
    find_normals(work_.surface, {middles, roots.size()}, normals);
    for (std::size_t k = 0; k < roots.size(); ++k) work_.set_direction(roots[k], normals[k]);
  }

  // Classifies the cells of a cluster that the surface cuts otherwise than as one plane.
  void classify_nodes(std::uint32_t root) {
    SamplesOnHost<Surface> samples;
    const std::vector<CellTreeNode>& nodes = work_.level.nodes();
    const std::uint32_t first = work_.level.roots()[root], last = nodes[first].next;
    std::uint32_t node = first;
    while (node < last) {
      const auto& [part, next] = nodes[node];
      const Vec3 center = work_.to_surface * part.center;
      const BallClass in_ball = work_.surface.classify_ball(center, part.radius);
      if (const ClusterClass side =
              class_of_ball(work_.surface, in_ball, center, part.radius, work_.tool_radius.length);
          side != ClusterClass::ambiguous) {
        if (side == ClusterClass::free)
          set_free(part, in_ball);
        else
          work_.states.set(part, side);
        node = next;
        continue;
      }
      if (next == node + 1) {
        for (std::uint32_t i = part.begin; i < part.end; ++i) classify_cell(i, samples);
      }
      ++node;
    }
  }

  void classify_cell(std::uint32_t i, SamplesOnHost<Surface>& samples) {
    const CellView view = work_.level.cell(i);
    const Vec3 center = work_.to_surface * view.center;
    const BallClass in_ball = work_.surface.classify_ball(center, view.radius);
    const Side side = side_of(work_.surface, in_ball, center, view.radius);
    if (side != Side::ambiguous) {
      work_.states.set(i, side);
      if (side == Side::free && sight_of<Surface>(in_ball) != Sight::seen) add_free_rows(i, i + 1);
      return;
    }
    CellResult& result = work_.states.results[i];
    result = work_.measure_of(view).run(
        samples, work_.states.far.data() + work_.level.first_piece(i), in_ball.point);
    unseen_.add(result.unseen);
    take_result(i, FloodState::unknown);
  }

  // Classifies the cells of a cluster that is cut by one plane. A node wholly on one side of the
  // plane decides for all its cells.
  void classify_clipped(std::uint32_t root, const BallClass& in_ball) {
    constexpr double kRounding = 1e-9;  // in tool radii: far above rounding
    const ClipPlane& plane = work_.states.planes[root];
    const std::vector<CellTreeNode>& nodes = work_.level.nodes();
    const std::uint32_t first = work_.level.roots()[root], last = nodes[first].next;
    std::uint32_t node = first;
    while (node < last) {
      const auto& [part, next] = nodes[node];
      const PlaneSide side = side_of_plane(plane.distance(part.center),
                                           part.radius + kRounding * work_.tool_radius.length);
      if (side == PlaneSide::before) {
        work_.states.set(part, ClusterClass::free);
        node = next;
      } else if (side == PlaneSide::behind &&
                 !may_hold_free(work_.surface, in_ball, work_.to_surface * part.center,
                                part.radius)) {
        work_.states.set(part, CellClass::uniform, flood_state_of(ClusterClass::cut));
        node = next;
      } else {
        if (next == node + 1) {
          for (std::uint32_t i = part.begin; i < part.end; ++i) classify_clipped(i, plane, in_ball);
        }
        ++node;
      }
    }
  }

  void classify_clipped(std::uint32_t i, const ClipPlane& plane, const BallClass& in_ball) {
    const CellView view = work_.level.cell(i);
    const Vec3 center = work_.to_surface * view.center;
    const PlaneSide side = side_in_cut_cluster(plane.distance(view.center), view.radius, [&] {
      return may_be_free(work_.surface, least_inverse_depth<Surface>(in_ball), center,
                         view.radius) &&
             side_of(work_.surface, work_.surface.classify_ball(center, view.radius), center,
                     view.radius) == Side::free;
    });
    if (side == PlaneSide::before) {
      work_.states.set(i, Side::free);
    } else if (side == PlaneSide::behind) {
      work_.states.set(i, CellClass::uniform, flood_state_of(ClusterClass::cut));
    } else {
      CellResult& result = work_.states.results[i];
      result = {};
      const CellMeasure measure = work_.measure_of(view);
      for (std::uint32_t b = view.begin; b < view.end; ++b)
        measure.add_block(b, plane, SamplesOnHost<Surface>::clipped, result);
      take_result(i, flood_state_of(ClusterClass::cut));
    }
  }

  // Sets the class of a measured cell; an uncut one that is partly inside gets `flood_state`.
  void take_result(std::uint32_t i, FloodState flood_state) {
    const CellClass found = class_of_result(work_.states.results[i]);
    work_.states.set(i, found, found == CellClass::partial ? flood_state : FloodState::closed);
  }

  PoseWork<Surface> work_;
  UnseenSum unseen_;  // of what this object has classified
};

}  // namespace vpm
