// Contacts of a pair of surfaces: the sums of each connected part of the boundary of what both
// contain. Sums of doubles are exact here (wide_sum.h), so the part with most pieces is what all
// others leave of the total.
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "libvpm/core/box.h"
#include "libvpm/solid/surface_pair.h"

namespace vpm {
namespace {

// Parts whose area vectors miss to add up to 0 by more than this, relative to the smaller reach
// squared, are no contact by themselves.
constexpr double kOpen = 1e-9;

double volume_of(const SurfaceContact& c) {
  return (c.inner[0].moments.flux() + c.inner[1].moments.flux()) / 3;
}

void take_deeper(DeepPlace& deepest, const DeepPlace& other) {
  const auto key = [](const DeepPlace& p) {
    return std::tuple(p.depth, p.place.x, p.place.y, p.place.z, p.role);
  };
  if (key(other) > key(deepest)) deepest = other;
}

void add(SurfaceContact& sum, const SurfaceContact& c) {
  for (std::size_t role = 0; role < 2; ++role) {
    sum.inner[role].moments.add(c.inner[role].moments);
    sum.inner[role].force += c.inner[role].force;
    sum.inner[role].torque += c.inner[role].torque;
  }
  for (std::size_t k = 0; k < 2; ++k) take_deeper(sum.deepest[k], c.deepest[k]);
}

bool holds(const Box& box, const Box& other) {
  const Vec3 low = other.low - box.low, high = box.high - other.high;
  return std::min({low.x, low.y, low.z, high.x, high.y, high.z}) >= 0;
}

}  // namespace

void SurfacePair::RoleSums::subtract(const RoleSums& o) {
  cut.subtract(o.cut), whole.subtract(o.whole);
  cut_wrench.subtract(o.cut_wrench), whole_wrench.subtract(o.whole_wrench);
}

double SurfacePair::greatest_depth(const SurfaceContact& contact) const {
  double most = 0;
  for (const DeepPlace& at : contact.deepest) {
    if (!(at.depth > 0)) continue;
    const Pose to_other = at.role == 0 ? roles_[0].to_other : Pose{};
    most = std::max(most, roles_[1 - at.role].solid->depth(to_other * at.place).value);
  }
  return most;
}

// Joins what is crossed. Where the segments form one part, and each surface is one, all is one
// contact: a piece without segments would be a whole surface.
void SurfacePair::join_crossed() {
  const bool are_one =
      roles_[0].tree->summaries()[0].is_connected && roles_[1].tree->summaries()[0].is_connected;
  parts_->join_along_edges({roles_[0].crossed, roles_[1].crossed});
  is_one_contact_ = are_one && parts_->parts_of_segments() < 2;
  if (!is_one_contact_ || with_force_)
    parts_->join_across_faces(
        [this](std::uint32_t role, std::uint32_t vertex) { return is_inside(role, vertex); });
  is_one_contact_ = is_one_contact_ || (are_one && parts_->parts_of_segments() < 2);
  if (is_one_contact_) contacts_.assign(1, {});
}

void SurfacePair::note_deep_places(const DeepPlace& sampled, const DeepPlace& linear) {
  take_deeper(contacts_[0].deepest[0], sampled);
  take_deeper(contacts_[0].deepest[1], linear);
}

// Notes the force on triangles that lie inside as a whole, from `begin` to before `end`, and the
// deepest of their corners, which are within the radius of a place. `depth` is taken there, in the
// surface's own frame.
void SurfacePair::note_force_of_whole(std::size_t which, const ForceAndTorque& force,
                                      const Depth& depth, Vec3 place, double radius,
                                      std::uint32_t begin, std::uint32_t end) {
  if (is_one_contact_ && depth.value + radius < contacts_[0].deepest[0].depth) return;
  const SurfaceTree& tree = *roles_[which].tree;
  const Vec3 g = depth.gradient;
  double most = -std::numeric_limits<double>::infinity();
  std::uint32_t deepest = 0;
  for (std::uint32_t t = begin; t < end; ++t)
    for (const std::uint32_t v : tree.triangles()[t]) {
      const double along = dot(g, tree.vertices()[v]);
      if (along > most || (along == most && v < deepest)) most = along, deepest = v;
    }
  const auto role = static_cast<std::uint32_t>(which);
  const Pose& to_first = roles_[which].to_first;
  const DeepPlace sampled{depth.value, to_first * place, role},
      linear{depth.value + most - dot(g, place), to_first * tree.vertices()[deepest], role};
  if (is_one_contact_) return note_deep_places(sampled, linear);
  force_pieces_.push_back({role, false, true, whole_, force, {{sampled, linear}}});
}

// Notes the force on a piece of a crossed triangle, how deep the middle of what is inside of it is,
// and the deepest of those of its corners that are inside. Without corners it is a part of a piece,
// whose middle was not sampled.
void SurfacePair::note_cut_force(std::size_t which, std::uint32_t element, const LinearPiece& piece,
                                 std::span<const Vec3> corners, unsigned inside) {
  const auto role = static_cast<std::uint32_t>(which);
  const auto deep_at = [&](Vec3 x) {
    const double depth = piece.depth.value + dot(piece.depth.gradient, x - piece.place);
    return DeepPlace{unit_ * depth, unit_ * x, role};
  };
  const DeepPlace at_middle = deep_at(piece.middle);
  DeepPlace deepest = at_middle;
  for (std::size_t k = 0; k < corners.size(); ++k)
    if ((inside >> k & 1) != 0) take_deeper(deepest, deep_at(corners[k]));
  if (is_one_contact_) return note_deep_places(at_middle, deepest);
  const DeepPlace sampled = corners.empty() ? DeepPlace{} : at_middle;
  force_pieces_.push_back({role, true, face_ == kNone, element, piece.force, {{sampled, deepest}}});
}

// Returns the piece with the force on a part of it alone.
SurfacePair::LinearPiece SurfacePair::part_of(const LinearPiece& piece,
                                              const CrossedTriangle& part) {
  LinearPiece of_part = piece;
  of_part.force = piece.weight * linear_force(part.moments(), piece.depth, piece.place);
  of_part.middle = part.middle();
  return of_part;
}

void SurfacePair::note_force_of_face(std::size_t which, const CrossedTriangle& triangle,
                                     const LinearPiece& piece) {
  const auto role = static_cast<std::uint32_t>(which);
  const unsigned inside = parts_->corners_inside(role, face_);
  const std::uint32_t only = is_one_contact_ ? 0 : parts_->part_of_face(role, face_);
  if (only != kNone) return note_cut_force(which, only, piece, triangle.corner, inside);
  for (const std::uint32_t part : parts_->parts_of_face(role, face_)) {
    const CrossedTriangle of_part = parts_->piece(role, face_, part);
    note_cut_force(which, part, part_of(piece, of_part), {}, 0);
  }
}

void SurfacePair::note_force_of_cell(std::size_t which, const DepthCell& cell,
                                     const LinearPiece& piece, Vec3 normal) {
  unsigned inside = cell.is_whole() ? 7 : 0;
  for (std::size_t k = 0; k < 3; ++k) inside |= cell.is_inside[k] != 0 ? 1u << k : 0;
  if (face_ == kNone || is_one_contact_)  // of a triangle that is inside as a whole
    return note_cut_force(which, whole_, piece, cell.corner, inside);
  const auto role = static_cast<std::uint32_t>(which);
  std::uint32_t part = parts_->part_of_face(role, face_);
  if (part == kNone && cell.segments.empty()) part = parts_->element_at(role, face_, piece.middle);
  if (part == kNone) {
    part = parts_->find(cell.segments[0].segment);
    for (const CutSegment& s : cell.segments)
      if (parts_->find(s.segment) != part)
        return note_force_of_split_cell(which, cell, piece, normal);
  }
  note_cut_force(which, part, piece, cell.corner, inside);
}

// Notes the force on each part of a cell that holds pieces of several contacts.
void SurfacePair::note_force_of_split_cell(std::size_t which, const DepthCell& cell,
                                           const LinearPiece& piece, Vec3 normal) {
  const auto role = static_cast<std::uint32_t>(which);
  // Returns the part to which the segment belongs that ends nearest to a place.
  const auto part_at = [&](Vec3 x) {
    const auto distance2 = [&](const CutSegment& s) {
      return std::min(squared_norm(s.start - x), squared_norm(s.end - x));
    };
    return parts_->find(std::ranges::min_element(cell.segments, {}, distance2)->segment);
  };
  std::vector<std::uint32_t> parts;
  for (const CutSegment& s : cell.segments) parts.push_back(parts_->find(s.segment));
  std::ranges::sort(parts);
  parts.erase(std::unique(parts.begin(), parts.end()), parts.end());
  for (const std::uint32_t part : parts) {
    CrossedTriangle of_part;
    of_part.set_corners(cell.corner, normal);
    for (const CutSegment& s : cell.segments)
      if (parts_->find(s.segment) == part) of_part.add_segment(s.start, s.end);
    for (const CutPoint& point : cell.points)
      if (part_at(point.place) == part)
        of_part.add_crossing(static_cast<unsigned>(point.edge), point.sign, point.place);
    for (unsigned k = of_part.is_far() ? 0 : 2; k < 3; ++k)
      if (cell.is_inside[k] != 0 &&
          parts_->find(parts_->element_at(role, face_, cell.corner[k])) == part)
        of_part.add_corner_inside(k);
    note_cut_force(which, part, part_of(piece, of_part), {}, 0);
  }
}

void SurfacePair::find_contacts() {
  if (is_one_contact_) {
    contacts_[0].inner = sums_.inner;
    return;
  }
  for (WholePiece& piece : whole_pieces_)
    piece.element = parts_->join_whole(piece.role, piece.child);
  number_contacts();
  if (contacts_.empty()) return;
  sum_contacts();
  for (const ForcePiece& piece : force_pieces_) {
    SurfaceContact& contact = contacts_[contact_of(piece)];
    for (std::size_t k = 0; k < 2; ++k) take_deeper(contact.deepest[k], piece.deepest[k]);
  }
  if (contacts_.size() > 1) merge_contacts();
}

std::uint32_t SurfacePair::contact_of(const ForcePiece& piece) {
  const std::uint32_t element =
      piece.is_of_whole ? whole_pieces_[piece.source].element : piece.source;
  return number_of_[parts_->find(element)];
}

// Numbers the contacts in the order in which segments, then whole pieces, name them.
void SurfacePair::number_contacts() {
  number_of_.assign(parts_->elements(), kNone);
  std::uint32_t count = 0;
  const auto number = [&](std::uint32_t element) {
    std::uint32_t& at = number_of_[parts_->find(element)];
    if (at == kNone) at = count++;
  };
  for (std::uint32_t k = 0; k < parts_->segments().size(); ++k) number(k);
  for (const WholePiece& piece : whole_pieces_) number(piece.element);
  contact_sums_.assign(count, {});
  contacts_.assign(count, {});
}

void SurfacePair::sum_contacts() {
  std::vector<std::uint32_t> pieces(contacts_.size());
  for (const WholePiece& piece : whole_pieces_) ++pieces[number_of_[parts_->find(piece.element)]];
  for (std::uint32_t k = 0; k < parts_->segments().size(); ++k)
    ++pieces[number_of_[parts_->find(k)]];
  const auto largest =
      static_cast<std::uint32_t>(std::ranges::max_element(pieces) - pieces.begin());
  add_pieces(largest);
  for (std::uint32_t role = 0; role < 2; ++role) {
    RoleSums& rest = contact_sums_[largest][role];
    rest = roles_[role].sums;
    for (std::uint32_t k = 0; k < contacts_.size(); ++k)
      if (k != largest) rest.subtract(contact_sums_[k][role]);
    for (std::uint32_t k = 0; k < contacts_.size(); ++k)
      contacts_[k].inner[role] = result(roles_[role], contact_sums_[k][role]);
  }
}

// Adds the pieces of all contacts but the one with most.
void SurfacePair::add_pieces(std::uint32_t largest) {
  for (const auto& [role, child, element] : whole_pieces_) {
    const std::uint32_t contact = number_of_[parts_->find(element)];
    if (contact == largest) continue;
    add_moments(roles_[role], child, contact_sums_[contact][role]);
  }
  const auto add_flat = [&](std::uint32_t role, std::uint32_t part, const CrossedTriangle& piece) {
    contact_sums_[number_of_[part]][role].cut.add(
        flat_moments(piece.normal, piece.area(), piece.mean(), piece.products()));
  };
  for (std::uint32_t role = 0; role < 2; ++role)
    for (std::uint32_t f = 0; f < roles_[role].crossed.size(); ++f) {
      const std::uint32_t only = parts_->part_of_face(role, f);
      if (only != kNone) {
        if (number_of_[only] != largest) add_flat(role, only, roles_[role].crossed[f]);
        continue;
      }
      for (const std::uint32_t part : parts_->parts_of_face(role, f))
        if (number_of_[part] != largest) add_flat(role, part, parts_->piece(role, f, part));
    }
  for (const ForcePiece& piece : force_pieces_) {
    const std::uint32_t contact = contact_of(piece);
    if (contact == largest) continue;
    RoleSums& sums = contact_sums_[contact][piece.role];
    add_wrench(piece.is_cut ? sums.cut_wrench : sums.whole_wrench, piece.force);
  }
}

// Joins what is no contact by itself: parts that do not close, where signs and rounding disagree,
// with each other, and walls of hollows, whose volume is negative, with what is around them.
void SurfacePair::merge_contacts() {
  const double reach = std::min(roles_[0].solid->reach(), roles_[1].solid->reach());
  std::vector<std::uint32_t> into(contacts_.size());
  std::uint32_t open = kNone;
  for (std::uint32_t k = 0; k < contacts_.size(); ++k) {
    const auto& inner = contacts_[k].inner;
    const bool closes =
        norm(inner[0].moments.area + inner[1].moments.area) <= kOpen * reach * reach;
    if (!closes && open == kNone) open = k;
    into[k] = !closes ? open : volume_of(contacts_[k]) < 0 ? around_hollow(k) : k;
  }
  std::size_t kept = 0;
  for (std::uint32_t k = 0; k < contacts_.size(); ++k)
    if (into[k] != k) add(contacts_[into[k]], contacts_[k]);
  for (std::uint32_t k = 0; k < contacts_.size(); ++k)
    if (into[k] == k) contacts_[kept++] = contacts_[k];
  contacts_.resize(kept);
}

// Returns the smallest contact whose box holds that of a hollow's wall, or else the largest.
std::uint32_t SurfacePair::around_hollow(std::uint32_t hollow) {
  const Box inner = box_of(hollow);
  std::uint32_t around = kNone, largest = hollow;
  for (std::uint32_t k = 0; k < contacts_.size(); ++k) {
    const double volume = volume_of(contacts_[k]);
    if (volume > volume_of(contacts_[largest])) largest = k;
    if (volume > 0 && (around == kNone || volume < volume_of(contacts_[around])) &&
        holds(box_of(k), inner))
      around = k;
  }
  return around != kNone ? around : largest;
}

// Returns the box about a contact, in the first's frame.
Box SurfacePair::box_of(std::uint32_t contact) {
  Box box;
  for (std::uint32_t k = 0; k < parts_->segments().size(); ++k)
    if (number_of_[parts_->find(k)] == contact)
      for (const Vec3 x : {parts_->segments()[k].start, parts_->segments()[k].end})
        box.add(unit_ * x);
  for (const auto& [role, child, element] : whole_pieces_) {
    if (number_of_[parts_->find(element)] != contact) continue;
    const SurfaceTree& tree = *roles_[role].tree;
    const bool is_triangle = (child & kLeaf) != 0;
    const std::uint32_t first = is_triangle ? child & ~kLeaf : tree.summaries()[child].first,
                        end = is_triangle ? first + 1 : tree.summaries()[child].end;
    for (std::uint32_t t = first; t < end; ++t)
      for (const Vec3& corner : tree.corners(t)) box.add(roles_[role].to_first * corner);
  }
  return box;
}

}  // namespace vpm
