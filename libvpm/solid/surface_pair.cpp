#include "libvpm/solid/surface_pair.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "libvpm/core/lanes.h"

namespace vpm {
namespace {

// Triangles whose memory is asked for before they are placed.
constexpr std::size_t kAhead = 6;

}  // namespace

SurfaceMoments SurfacePair::moments_of(const SurfaceMoments& whole, const SurfaceMoments& cut,
                                       double unit, const Pose& to_first) {
  SurfaceMoments moments = moved(scaled(whole, unit), to_first);
  moments.add(scaled(cut, unit));
  return moments;
}

SurfacePair::SurfacePair(const SolidSurface& first, const SolidSurface& second)
    : unit_(unit_for(first.reach(), second.reach())), per_unit_(1 / unit_) {
  for (std::size_t k = 0; k < 2; ++k) {
    Role& role = roles_[k];
    role.solid = k == 0 ? &first : &second;
    role.tree = &role.solid->tree();
    role.is_summed_by_triangles = k == 1 && outgrows(second.reach(), unit_);
    set_sizes(role, k == 0 ? second : first);
    const std::size_t triangles = role.tree->triangles().size();
    role.crossed_stamp.assign(triangles, 0);
    role.crossed_place.assign(triangles, 0);
    role.place_of.assign(triangles, {});
    role.node_stamp.assign(role.tree->nodes().size(), 0);
    role.corner_stamp.assign(role.tree->vertices().size(), 0);
    role.is_inside.assign(role.tree->vertices().size(), 0);
  }
}

SurfacePairSums SurfacePair::run(const Pose& pose, bool with_force, bool with_contacts) {
  start(pose, with_force, with_contacts);
  const SurfaceTree &first = *roles_[0].tree, &second = *roles_[1].tree;
  if (PlacedBounds(second.bounds(0, 0), pose).children_that_meet(first.nodes()[0]) == 0)
    return sums_;
  list_triangles();
  drop_apart(roles_[0].placed, roles_[1].placed, candidates_, signs_);
  meet_all();
  for (std::size_t role = 0; role < 2; ++role) mark_crossed(role);
  if (with_contacts_) join_crossed();
  for (std::size_t role = 0; role < 2; ++role) {
    add_crossed(role);
    add_whole(role);
    sums_.inner[role].moments = moments_of(roles_[role], roles_[role].sums);
    sums_.area = std::max(sums_.area, unit_ * unit_ * roles_[role].sums.area.real());
  }
  if (with_force_) {
    add_forces();
    for (std::size_t role = 0; role < 2; ++role)
      sums_.inner[role] = result(roles_[role], roles_[role].sums);
  }
  if (with_contacts_) find_contacts();
  return sums_;
}

void SurfacePair::start(const Pose& pose, bool with_force, bool with_contacts) {
  if (++stamp_ == 0) {  // wrapped: forget all stamps
    for (Role& role : roles_) {
      for (auto* stamps : {&role.crossed_stamp, &role.node_stamp, &role.corner_stamp})
        stamps->assign(stamps->size(), 0);
      role.place_of.assign(role.place_of.size(), {});
    }
    stamp_ = 1;
  }
  with_force_ = with_force, with_contacts_ = with_contacts, wrench_scale_ = 1;
  contacts_.clear(), whole_pieces_.clear(), force_pieces_.clear();
  if (with_contacts && !parts_)
    parts_ = std::make_unique<ContactParts>(*roles_[0].tree, *roles_[1].tree);
  if (with_contacts) parts_->start();
  sums_ = {};
  roles_[0].to_first = {}, roles_[0].to_other = inverse(pose);
  roles_[1].to_first = pose, roles_[1].to_other = pose;
  for (std::size_t k = 0; k < 2 && with_force; ++k)
    if (const FacePlanes* planes = planes_below(k))
      roles_[k].other_planes.place(*planes, roles_[1 - k].to_first, per_unit_);
  for (Role& role : roles_) {
    role.listed.clear();
    role.crossed.clear(), role.segments.clear(), role.points.clear();
    role.sums = {};
  }
}

PlacedTriangle SurfacePair::placed(const Role& role, std::uint32_t triangle) const {
  std::array<Vec3, 3> corners = role.tree->corners(triangle);
  if (&role == &roles_[1])
    for (Vec3& corner : corners) corner = role.to_first * corner;
  return placed_triangle(corners, role.tree->longest_edge(triangle),
                         role.tree->triangles()[triangle]);
}

// Returns the triangle's place in the role's lists for this pose.
[[gnu::always_inline]] inline std::uint32_t SurfacePair::place_of(Role& role,
                                                                  std::uint32_t triangle) {
  Listed& listed = role.place_of[triangle];
  if (listed.stamp != stamp_) {
    listed = {stamp_, static_cast<std::uint32_t>(role.listed.size())};
    role.listed.push_back(triangle);
  }
  return listed.place;
}

// Lists the pairs of triangles whose bounds meet, and places each triangle once: in loops of their
// own, since these wait for memory.
void SurfacePair::list_triangles() {
  const auto pairs = walk_.run(*roles_[0].tree, *roles_[1].tree, roles_[1].to_first);
  sums_.candidates = pairs.size();
  candidates_.resize(pairs.size());
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (k + kAhead < pairs.size()) {
      __builtin_prefetch(&roles_[0].place_of[pairs[k + kAhead].a]);
      __builtin_prefetch(&roles_[1].place_of[pairs[k + kAhead].b]);
    }
    candidates_[k] = {place_of(roles_[0], pairs[k].a), place_of(roles_[1], pairs[k].b)};
  }
  for (Role& role : roles_) {
    const std::size_t count = role.listed.size();
    if (role.placed.size() < count) role.placed.resize(count);
    const SurfaceTree& tree = *role.tree;
    for (std::size_t k = 0; k < count; ++k) {
      if (k + 2 * kAhead < count)
        __builtin_prefetch(&tree.triangles()[role.listed[k + 2 * kAhead]]);
      if (k + kAhead < count)
        for (const std::uint32_t v : tree.triangles()[role.listed[k + kAhead]])
          __builtin_prefetch(&tree.vertices()[v]);
      role.placed[k] = placed(role, role.listed[k]);
    }
  }
}

VPM_AVX2_CLONES
void SurfacePair::meet_all() {
  TriangleCrossing crossing;
  for (std::size_t k = 0; k < candidates_.size(); ++k) meet(candidates_[k], signs_[k], crossing);
}

// Finds how two triangles meet, and adds what follows. `crossing` is scratch.
void SurfacePair::meet(CandidatePair places, const PairSigns& signs, TriangleCrossing& crossing) {
  const std::uint32_t first_triangle = roles_[0].listed[places.a],
                      second_triangle = roles_[1].listed[places.b];
  const PlacedTriangle &a = roles_[0].placed[places.a], &b = roles_[1].placed[places.b];
  const Meeting meeting = cross_triangles(a, b, signs, crossing);
  if (meeting == Meeting::undecided) ++sums_.undecided;
  if (meeting != Meeting::crossing) return;
  ++sums_.crossings;
  CrossedTriangle &of_a = crossed(roles_[0], first_triangle, a),
                  &of_b = crossed(roles_[1], second_triangle, b);
  const Vec3 start = per_unit_ * crossing.start, end = per_unit_ * crossing.end;
  of_a.add_segment(start, end);
  of_b.add_segment(end, start);
  for (int k = 0; k < crossing.first_count; ++k) {
    const EdgeCrossing& at = crossing.of_first[static_cast<std::size_t>(k)];
    of_a.add_crossing(static_cast<unsigned>(at.edge), at.sign, per_unit_ * at.place);
  }
  for (int k = 0; k < crossing.second_count; ++k) {
    const EdgeCrossing& at = crossing.of_second[static_cast<std::size_t>(k)];
    of_b.add_crossing(static_cast<unsigned>(at.edge), at.sign, per_unit_ * at.place);
  }
  if (with_contacts_)
    parts_->add({roles_[0].crossed_place[first_triangle], roles_[1].crossed_place[second_triangle]},
                crossing, per_unit_);
  if (!with_force_) return;
  const std::uint32_t number =
      with_contacts_ ? static_cast<std::uint32_t>(parts_->segments().size() - 1) : 0;
  note_cut(0, of_a, of_b, {start, end, 0, number},
           std::span(crossing.of_first).first(static_cast<std::size_t>(crossing.first_count)));
  note_cut(1, of_b, of_a, {end, start, 0, number},
           std::span(crossing.of_second).first(static_cast<std::size_t>(crossing.second_count)));
}

// Notes for the force that the other's triangle cuts this one along a segment.
void SurfacePair::note_cut(std::size_t which, CrossedTriangle& triangle,
                           const CrossedTriangle& other, CutSegment segment,
                           std::span<const EdgeCrossing> crossings) {
  Role& role = roles_[which];
  segment.other = roles_[1 - which].crossed_place[other.triangle];
  role.segments.emplace_back(segment, triangle.last_segment);
  triangle.last_segment = static_cast<std::uint32_t>(role.segments.size() - 1);
  for (const EdgeCrossing& at : crossings) {
    const CutPoint point{per_unit_ * at.place, at.sign, static_cast<std::size_t>(at.edge),
                         segment.segment};
    role.points.emplace_back(point, triangle.last_point);
    triangle.last_point = static_cast<std::uint32_t>(role.points.size() - 1);
  }
}

CrossedTriangle& SurfacePair::crossed(Role& role, std::uint32_t triangle,
                                      const PlacedTriangle& at) {
  if (role.crossed_stamp[triangle] != stamp_) {
    role.crossed_stamp[triangle] = stamp_;
    role.crossed_place[triangle] = static_cast<std::uint32_t>(role.crossed.size());
    CrossedTriangle& added = role.crossed.emplace_back();
    added.triangle = triangle;
    const auto& [a, b, c] = at.corner;
    added.set_corners({per_unit_ * a, per_unit_ * b, per_unit_ * c}, normalized_or_zero(at.normal));
  }
  return role.crossed[role.crossed_place[triangle]];
}

bool SurfacePair::is_inside(std::size_t which, std::uint32_t vertex) {
  Role& role = roles_[which];
  if (role.corner_stamp[vertex] != stamp_) {
    role.corner_stamp[vertex] = stamp_;
    role.is_inside[vertex] =
        roles_[1 - which].solid->holds(role.to_other * role.tree->vertices()[vertex]);
  }
  return role.is_inside[vertex] != 0;
}

// Takes the sides of vertices from the crossings of their edges, and stamps the nodes above.
void SurfacePair::mark_crossed(std::size_t which) {
  Role& role = roles_[which];
  for (const CrossedTriangle& triangle : role.crossed) {
    const Triangle& corners = role.tree->triangles()[triangle.triangle];
    for (std::size_t edge = 0; edge < 3; ++edge) {
      // One that enters once more than it leaves comes from outside and ends inside.
      const int entries = triangle.entries[edge];
      if (entries == 0) continue;
      if (std::abs(entries) > 1) ++sums_.undecided;
      const std::uint32_t from = corners[edge], to = corners[(edge + 1) % 3];
      role.corner_stamp[from] = role.corner_stamp[to] = stamp_;
      role.is_inside[from] = entries<0, role.is_inside[to] = entries> 0;
    }
    for (std::uint32_t k = role.tree->parent_of(triangle.triangle); role.node_stamp[k] != stamp_;
         k = role.tree->node_above(k))
      role.node_stamp[k] = stamp_;
  }
}

VPM_AVX2_CLONES
void SurfacePair::add_crossed(std::size_t which) {
  Role& role = roles_[which];
  for (CrossedTriangle& triangle : role.crossed) {
    triangle.add_corners_inside(is_inside(which, role.tree->triangles()[triangle.triangle][2]));
    const double area = triangle.area();
    role.sums.area.add(area);
    role.sums.cut.add(flat_moments(triangle.normal, area, triangle.mean(), triangle.products()));
  }
}

// Adds the largest nodes that nothing crosses and that lie inside: one vertex tells for each.
void SurfacePair::add_whole(std::size_t which) {
  Role& role = roles_[which];
  const SurfaceTree& tree = *role.tree;
  const PlacedBounds all(roles_[1 - which].tree->bounds(0, 0), roles_[1 - which].to_other);
  pending_.assign(1, 0);
  while (!pending_.empty()) {
    const SurfaceTree::Node& node = tree.nodes()[pending_.back()];
    pending_.pop_back();
    const unsigned meets = all.children_that_meet(node);
    for (std::size_t k = 0; k < 4; ++k) {
      if ((meets >> k & 1) == 0) continue;
      const std::uint32_t child = node.child[k];
      if ((child & kLeaf) != 0) {
        add_whole_triangle(which, child & ~kLeaf);
        continue;
      }
      const SurfaceTree::Summary& summary = tree.summaries()[child];
      if (role.node_stamp[child] == stamp_ || !summary.is_connected ||
          role.is_summed_by_triangles) {
        pending_.push_back(child);
        continue;
      }
      if (!is_inside(which, tree.triangles()[summary.first][0])) continue;
      const bool has_patches = !tree.patches().empty();
      const double area = has_patches ? tree.patches()[child].area : norm(tree.moments(child).area);
      add_moments(role, child, role.sums);
      role.sums.area.add(per_unit_ * per_unit_ * area);
      note_whole(which, child);
    }
  }
}

void SurfacePair::add_whole_triangle(std::size_t which, std::uint32_t triangle) {
  Role& role = roles_[which];
  if (role.crossed_stamp[triangle] == stamp_) return;
  const Triangle& corners = role.tree->triangles()[triangle];
  std::uint32_t asked = corners[0];
  for (const std::uint32_t v : corners)
    if (role.corner_stamp[v] == stamp_) asked = v;
  const bool inside = is_inside(which, asked);
  for (const std::uint32_t v : corners) role.corner_stamp[v] = stamp_, role.is_inside[v] = inside;
  if (!inside) return;
  const auto [a, b, c] = role.tree->corners(triangle);
  add_moments(role, triangle | kLeaf, role.sums);
  role.sums.area.add(per_unit_ * per_unit_ * norm(0.5 * cross(b - a, c - a)));
  note_whole(which, triangle | kLeaf);
}

// Adds to one solid's sums the moments of a triangle of it, or of all triangles below a node, which
// lie whole inside the other solid.
void SurfacePair::add_moments(const Role& role, std::uint32_t child, RoleSums& sums) const {
  if ((child & kLeaf) == 0) return sums.whole.add(scaled(role.tree->moments(child), per_unit_));
  const std::uint32_t triangle = child & ~kLeaf;
  const bool is_placed = role.is_summed_by_triangles;
  const auto [a, b, c] = is_placed ? placed(role, triangle).corner : role.tree->corners(triangle);
  (is_placed ? sums.cut : sums.whole).add(scaled(triangle_moments(a, b, c), per_unit_));
}

// Notes what lies inside as a whole, for its force and its contact.
void SurfacePair::note_whole(std::size_t which, std::uint32_t child) {
  ++sums_.whole;
  if (with_force_ || (with_contacts_ && !is_one_contact_))
    whole_pieces_.push_back({static_cast<std::uint32_t>(which), child, kNone});
}

SurfaceMoments SurfacePair::moments_of(const Role& role, const RoleSums& sums) const {
  return moments_of(sums.whole.real(), sums.cut.real(), unit_, role.to_first);
}

InnerSurface SurfacePair::result(const Role& role, const RoleSums& sums) const {
  const double unit3 = unit_ * unit_ * unit_ / wrench_scale_, unit4 = unit3 * unit_;
  const Vec3 force = role.to_first.rotation * (unit3 * sums.whole_wrench.force.real());
  const Vec3 torque = role.to_first.rotation * (unit4 * sums.whole_wrench.torque.real()) +
                      cross(role.to_first.translation, force);
  return {moments_of(role, sums), force + unit3 * sums.cut_wrench.force.real(),
          torque + unit4 * sums.cut_wrench.torque.real()};
}

}  // namespace vpm
