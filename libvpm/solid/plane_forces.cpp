// Forces below a convex solid with few faces: the depth below it is linear below each, so they are
// summed exactly, without samples.
#include <algorithm>
#include <array>
#include <cmath>

#include "libvpm/solid/surface_pair.h"

namespace vpm {
namespace {

// Terms of sums that are smaller need no more digits, in the unit.
constexpr double kLeastTerm = 0x1p-200;

}  // namespace

// Adds the force on the part of a crossed triangle inside, which is made of oriented triangles
// (crossed_triangle.h): those of their parts that lie outside of it cancel out.
void SurfacePair::add_force_below_planes(std::size_t which, const CrossedTriangle& triangle) {
  Role& role = roles_[which];
  const auto& [a, b, c] = triangle.corner;
  const FacePlanes::Near near = role.other_planes.near(triangle.corner);
  // Scales the terms to 1 or so, since sums are rounded as such.
  const bool is_far = triangle.is_far();  // then what is inside is of the size of the unit
  const double most = is_far ? 1
                             : std::abs(role.other_planes.depth(a).value) +
                                   std::max(norm(b - a), norm(c - a)),
               area = is_far ? 1 : 0.5 * norm(cross(b - a, c - a)),
               scale = std::ldexp(1.0, -std::ilogb(std::max(most * area, kLeastTerm)));
  WideSum volume;
  WideVec3 moment;
  const auto add = [&](double sign, Vec3 p, Vec3 q, std::uint32_t element) {
    const auto found = near.of_triangle({triangle.from(), p, q}, triangle.normal);
    volume.add(scale * sign * found.integral.volume);
    moment.add(scale * sign * found.integral.moment);
    if (with_contacts_)
      note_force_below_planes(which, element, sign * found.integral, triangle.normal, found);
  };
  for (std::uint32_t k = triangle.last_segment; k != CrossedTriangle::kEnd;
       k = role.segments[k].second) {
    const CutSegment& s = role.segments[k].first;
    add(1, s.start, s.end, s.segment);
  }
  for (std::uint32_t k = triangle.last_point; k != CrossedTriangle::kEnd;
       k = role.points[k].second) {
    const CutPoint& at = role.points[k].first;
    triangle.for_crossing(static_cast<unsigned>(at.edge), at.sign, at.place,
                          [&](double sign, Vec3 p, Vec3 q) { add(sign, p, q, at.segment); });
  }
  const bool is_split = with_contacts_ && !is_one_contact_;
  for (unsigned k = is_far ? 0 : 2; k < 3; ++k) {
    if (!is_inside(which, role.tree->triangles()[triangle.triangle][k])) continue;
    const std::uint32_t element =
        is_split ? parts_->corner(static_cast<std::uint32_t>(which), face_, k) : 0;
    triangle.for_corner(k, [&](double sign, Vec3 p, Vec3 q) { add(sign, p, q, element); });
  }
  const ForceAndTorque f =
      force_on_face({volume.real() / scale, moment.real() / scale}, triangle.normal);
  add_wrench(role.sums.cut_wrench, f);
}

// Adds the force on all below a node, or on a triangle, which lies inside as a whole.
void SurfacePair::add_force_of_whole_below_planes(std::size_t which, std::uint32_t child) {
  Role& role = roles_[which];
  const FacePlanes& planes = *roles_[1 - which].solid->face_planes();
  pending_.assign(1, child);
  while (!pending_.empty()) {
    const std::uint32_t top = pending_.back();
    pending_.pop_back();
    if (top == kNone) continue;
    if ((top & kLeaf) != 0) {
      const PlacedTriangle at = placed(role, top & ~kLeaf);
      std::array<Vec3, 3> corner = at.corner;
      for (Vec3& x : corner) x = per_unit_ * x;
      const Vec3 normal = normalized_or_zero(at.normal);
      const auto found = role.other_planes.near(corner).of_triangle(corner, normal);
      const ForceAndTorque f = force_on_face(found.integral, normal);
      add_wrench(role.sums.cut_wrench, f);
      if (with_contacts_) note_force_below_planes(which, whole_, found.integral, normal, found);
      continue;
    }
    const SurfaceTree::Patch& patch = role.tree->patches()[top];
    const Vec3 middle = widen(patch.middle);
    if (std::optional<Depth> depth = planes.linear_depth(role.to_other * middle, patch.radius)) {
      depth->gradient = transpose(role.to_other.rotation) * depth->gradient;
      add_force_of_node(which, top, *depth, middle, 1);
    } else {
      const auto& below = role.tree->nodes()[top].child;
      pending_.insert(pending_.end(), below.begin(), below.end());
    }
  }
}

// Notes the force on an oriented triangle, and the deepest place in it, in the first's frame and
// the unit. `element` is the part of the contacts that it belongs to, or the number of a whole
// piece.
void SurfacePair::note_force_below_planes(std::size_t which, std::uint32_t element,
                                          const DepthIntegral& integral, Vec3 normal,
                                          const FacePlanes::Near::OfTriangle& of_triangle) {
  const double depth = of_triangle.greatest;
  const DeepPlace deepest = depth > 0 ? DeepPlace{unit_ * depth, unit_ * of_triangle.deepest,
                                                  static_cast<std::uint32_t>(which)}
                                      : DeepPlace{};
  if (is_one_contact_) return note_deep_places(deepest, deepest);
  force_pieces_.push_back({static_cast<std::uint32_t>(which),
                           true,
                           face_ == kNone,
                           element,
                           force_on_face(integral, normal),
                           {{deepest, deepest}}});
}

}  // namespace vpm
