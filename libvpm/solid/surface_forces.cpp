// Forces of a pair of surfaces: the depth below each, over the part of the other inside. It is
// taken for linear over pieces. Where the solids share much for their size, the size of pieces is
// all that matters. Where they share little, a piece of the largest size may be far longer than it
// is deep: then samples tell whether a piece may stay as it is, or else it is cut.
#include <algorithm>
#include <cmath>

#include "libvpm/solid/surface_pair.h"

namespace vpm {
namespace {

// Largest pieces: the radius of whole ones relative to the reach, half their slab's thickness
// relative to the depth, and the longest edge of triangles and cells of triangles relative to the
// reach.
constexpr double kPatchRadius = 1.0 / 16, kPatchThickness = 0.5, kCell = 0.12;
// Planes that cross a triangle stand for the depth below them if their mean normal is so long;
// where they disagree there is a crease.
constexpr double kAgreeing2 = 0.97;
// Mean depth, relative to the smaller reach, from which on no piece is looked at twice, and the
// least one that is told from none.
constexpr double kDeep = 1.0 / 64, kLeastDepth = 1e-5;
// Error of the depth of a piece, relative to the mean depth, and of its product with its area,
// relative to the volume.
constexpr double kDepthError = 0.03, kProductError = kDepthError / 128;
// Size of the smallest pieces relative to the mean depth.
constexpr double kSmallest = 0.1;
// Whole pieces so many times as large as the largest are sampled to foretell smaller ones.
constexpr double kForetelling = 4;

double square(double v) {
  return v * v;
}

}  // namespace

// Chooses by the mean depth, of which the volume is the product with the area inside.
SurfacePair::Precision SurfacePair::precision() const {
  const double reach = per_unit_ * std::min(roles_[0].solid->reach(), roles_[1].solid->reach());
  const double flux = sums_.inner[0].moments.flux() + sums_.inner[1].moments.flux();
  const double volume = per_unit_ * per_unit_ * per_unit_ * flux / 3;
  const double area = std::max(roles_[0].sums.area.real(), roles_[1].sums.area.real());
  if (!(area > 0)) return {};
  const double depth = std::max(volume / area, kLeastDepth * reach);
  const double part = std::min(depth / (kDeep * reach), 1.0);
  return {part * std::sqrt(part), kDepthError * depth, kProductError * depth * area,
          kSmallest * depth};
}

bool SurfacePair::is_precise(double error, double area) const {
  return error <= precision_.depth || error * area <= precision_.product;
}

// Adds the forces on all that is inside, after all moments are summed.
void SurfacePair::add_forces() {
  precision_ = precision();
  for (std::size_t role = 0; role < 2; ++role) {
    face_ = 0;
    for (const CrossedTriangle& triangle : roles_[role].crossed) {
      add_force_of_crossed(role, triangle);
      ++face_;
    }
  }
  face_ = kNone;
  for (whole_ = 0; whole_ < whole_pieces_.size(); ++whole_)
    add_force_of_whole(whole_pieces_[whole_].role, whole_pieces_[whole_].child);
}

// Adds the force on all below a node, or on a triangle, which lies inside as a whole.
void SurfacePair::add_force_of_whole(std::size_t which, std::uint32_t child) {
  if ((child & kLeaf) != 0) return add_force_of_triangle(which, child & ~kLeaf, {});
  patches_.assign(1, {child, {}});
  while (!patches_.empty()) {
    auto [node, foretold] = patches_.back();
    patches_.pop_back();
    if (add_force_of_patch(which, node, foretold)) continue;
    for (const std::uint32_t below : roles_[which].tree->nodes()[node].child) {
      if (below == kNone) continue;
      if ((below & kLeaf) != 0)
        add_force_of_triangle(which, below & ~kLeaf, foretold);
      else
        patches_.push_back({below, foretold});
    }
  }
}

// Adds the force on what is below a node, unless it is too large, too thick or not as was foretold;
// then tells what to expect below.
bool SurfacePair::add_force_of_patch(std::size_t which, std::uint32_t node, Foretold& foretold) {
  Role& role = roles_[which];
  const SurfaceTree::Patch& patch = role.tree->patches()[node];
  const double most = kPatchRadius * role.solid->reach();
  if (patch.radius > (precision_.size < 1 ? kForetelling * most : most)) return false;
  Depth depth = roles_[1 - which].solid->depth(role.to_other * patch.middle);
  ++sums_.depths;
  depth.gradient = transpose(role.to_other.rotation) * depth.gradient;
  const double error = per_unit_ * std::abs(foretold.at(patch.middle) - depth.value);
  const bool is_as_foretold =
      patch.radius <= precision_.size * most ||
      (foretold.is_known && is_precise(error, per_unit_ * per_unit_ * patch.area));
  foretold = {depth, patch.middle, true};
  if (patch.radius > most || patch.thickness > kPatchThickness * depth.value || !is_as_foretold)
    return false;
  const double unit3 = per_unit_ * per_unit_ * per_unit_, unit4 = unit3 * per_unit_;
  const ForceAndTorque f = linear_force(patch.moments, depth, patch.middle);
  const ForceAndTorque added{unit3 * f.force, unit4 * f.torque};
  role.sums.whole_wrench.add(added.force, added.torque);
  const SurfaceTree::Summary& below = role.tree->summaries()[node];
  if (with_contacts_)
    note_force_of_whole(which, added, depth, patch.middle, patch.radius, below.first, below.end);
  return true;
}

void SurfacePair::add_force_of_triangle(std::size_t which, std::uint32_t triangle,
                                        const Foretold& before) {
  Role& role = roles_[which];
  const auto [a, b, c] = role.tree->corners(triangle);
  const double most = kCell * role.solid->reach(), longest = role.tree->longest_edge(triangle);
  const PlacedTriangle at = placed(role, triangle);
  DepthCell cell{at.corner, {1, 1, 1}, {}, {}};
  for (Vec3& corner : cell.corner) corner = per_unit_ * corner;
  const Vec3 normal = normalized_or_zero(at.normal);
  if (longest > most) return add_force_of_cells(which, cell, normal, {});
  const Vec3 middle = (a + b + c) / 3;
  Depth depth = roles_[1 - which].solid->depth(role.to_other * middle);
  ++sums_.depths;
  const Vec3 gradient = depth.gradient;
  depth.gradient = transpose(role.to_other.rotation) * gradient;
  const double error = per_unit_ * std::abs(before.at(middle) - depth.value),
               area = 0.5 * per_unit_ * per_unit_ * norm(at.normal);
  if (longest > precision_.size * most && !(before.is_known && is_precise(error, area)))
    return add_force_of_cells(which, cell, normal, {});
  const ForceAndTorque f = linear_force(triangle_force_moments(a, b, c), depth, middle);
  const double unit3 = per_unit_ * per_unit_ * per_unit_;
  const ForceAndTorque added{unit3 * f.force, unit3 * per_unit_ * f.torque};
  role.sums.whole_wrench.add(added.force, added.torque);
  if (with_contacts_)
    note_force_of_whole(which, added, depth, middle, role.solid->reach(), triangle, triangle + 1);
}

// Adds the force on the part of a crossed triangle inside: at once if it is small, else cell by
// cell.
void SurfacePair::add_force_of_crossed(std::size_t which, const CrossedTriangle& triangle) {
  Role& role = roles_[which];
  cut_segments_.clear(), cut_points_.clear();
  for (std::uint32_t k = triangle.last_segment; k != CrossedTriangle::kEnd;
       k = role.segments[k].second)
    cut_segments_.push_back(role.segments[k].first);
  const double most = precision_.size * kCell * role.solid->reach();
  if (role.tree->longest_edge(triangle.triangle) <= most) {
    Foretold linear = plane_across(which, cut_segments_);
    if (!linear.is_known) return;
    const double area = triangle.area.real();
    if (squared_norm(linear.depth.gradient) < kAgreeing2 && area > 0)
      linear = depth_at(which, triangle.mean.real() / area);
    LinearPiece piece = add_cut_force(which, triangle.moments(), linear);
    piece.middle = area > 0 ? triangle.mean.real() / area : triangle.corner[0];
    if (with_contacts_) note_force_of_face(which, triangle, piece);
    return;
  }
  for (std::uint32_t k = triangle.last_point; k != CrossedTriangle::kEnd; k = role.points[k].second)
    cut_points_.push_back(role.points[k].first);
  DepthCell cell{triangle.corner, {}, cut_segments_, cut_points_};
  for (std::size_t k = 0; k < 3; ++k)
    cell.is_inside[k] = is_inside(which, role.tree->triangles()[triangle.triangle][k]) ? 1 : 0;
  add_force_of_cells(which, cell, triangle.normal, {});
}

// Adds the force on the part of a triangle inside, cell by cell.
void SurfacePair::add_force_of_cells(std::size_t which, const DepthCell& triangle, Vec3 normal,
                                     const Foretold& foretold) {
  const double most2 = square(per_unit_ * kCell * roles_[which].solid->reach()),
               small2 = std::max(square(precision_.size) * most2, square(precision_.smallest));
  cells_.run(triangle, normal, foretold, [&](const DepthCell& cell, Foretold& known) {
    const double longest2 = cell.longest_edge2();
    if (longest2 > most2) return false;
    const bool is_small = longest2 <= small2;
    return cell.is_whole() ? add_force_of_whole_cell(which, cell, normal, is_small, known)
                           : add_force_of_cut_cell(which, cell, normal, is_small);
  });
}

bool SurfacePair::add_force_of_whole_cell(std::size_t which, const DepthCell& cell, Vec3 normal,
                                          bool is_small, Foretold& foretold) {
  const auto& [a, b, c] = cell.corner;
  const Foretold here = depth_at(which, (a + b + c) / 3), before = foretold;
  foretold = here;
  const double error = std::abs(before.at(here.place) - here.depth.value);
  if (!is_small && !(before.is_known && is_precise(error, 0.5 * norm(cross(b - a, c - a)))))
    return false;
  const LinearPiece piece = add_cut_force(which, triangle_force_moments(a, b, c), here);
  if (with_contacts_) note_force_of_cell(which, cell, piece, normal);
  return true;
}

// The depth is that below the planes that cut the cell, or that near the middle of what is inside:
// the first is right at the cuts, the second in the middle, and each is judged where it may be
// wrong.
bool SurfacePair::add_force_of_cut_cell(std::size_t which, const DepthCell& cell, Vec3 normal,
                                        bool is_small) {
  CrossedTriangle part;
  part.corner = cell.corner, part.normal = normal;
  for (const CutSegment& s : cell.segments) part.add_segment(s.start, s.end);
  for (const CutPoint& point : cell.points)
    if (point.edge == 1) part.add_far_point(point.sign, point.place);
  if (cell.is_inside[2] != 0) part.add_corner_inside();
  Foretold linear = plane_across(which, cell.segments);
  if (!linear.is_known) return true;  // nothing is inside but what rounding left
  const double area = part.area.real();
  const Vec3 middle = area > 0 ? part.mean.real() / area : cell.corner[0];
  if (is_small) {
    if (squared_norm(linear.depth.gradient) < kAgreeing2 && area > 0)
      linear = depth_at(which, middle);
  } else {
    const double longest = std::sqrt(cell.longest_edge2());
    const Foretold sampled = depth_at(which, middle);
    const double error_of_plane = std::abs(linear.at(middle) - sampled.depth.value) * area +
                                  error_at_border(which, cell.segments, normal, longest, linear);
    const double error_of_sample = error_at_border(which, cell.segments, normal, longest, sampled);
    if (error_of_sample < error_of_plane) linear = sampled;
    const double error = std::min(error_of_plane, error_of_sample);
    if (!(error <= precision_.depth * area || error <= precision_.product)) return false;
  }
  LinearPiece piece = add_cut_force(which, part.moments(), linear);
  piece.middle = middle;
  if (with_contacts_) note_force_of_cell(which, cell, piece, normal);
  return true;
}

// Returns the depth below the mean of the planes that cut a triangle, weighted by the lengths of
// the cuts. Known if there is any.
SurfacePair::Foretold SurfacePair::plane_across(std::size_t which,
                                                std::span<const CutSegment> segments) const {
  WideVec3 normal;
  WideSum offset, weight;
  for (const CutSegment& s : segments) {
    const CrossedTriangle& other = roles_[1 - which].crossed[s.other];
    const double length = norm(s.end - s.start);
    normal.add(length * other.normal);
    offset.add(length * dot(other.normal, other.corner[0]));
    weight.add(length);
  }
  const double sum = weight.real();
  if (!(sum > 0)) return {};
  return {{offset.real() / sum, -normal.real() / sum}, {}, true};
}

// Returns by how much the integral of a linear depth may be wrong since the depth is 0 at the cuts
// and grows from there as that below the planes that cut. None reaches farther than `most`.
double SurfacePair::error_at_border(std::size_t which, std::span<const CutSegment> segments,
                                    Vec3 normal, double most, const Foretold& linear) const {
  WideSum sum;
  for (const CutSegment& s : segments) {
    const double from = linear.at(s.start), to = linear.at(s.end);
    const double mean = std::sqrt((from * from + from * to + to * to) / 3);
    const double slope = norm(cross(roles_[1 - which].crossed[s.other].normal, normal));
    const double width = mean < 2 * slope * most ? mean / (2 * slope) : most;
    sum.add(norm(s.end - s.start) * mean * width);
  }
  return sum.real();
}

// Returns the depth below the other's surface at a place in the first's frame; in the unit.
SurfacePair::Foretold SurfacePair::depth_at(std::size_t which, Vec3 place) {
  const Pose to_other = which == 0 ? roles_[0].to_other : Pose{};
  Depth depth = roles_[1 - which].solid->depth(to_other * (unit_ * place));
  ++sums_.depths;
  depth.value *= per_unit_;
  depth.gradient = transpose(to_other.rotation) * depth.gradient;
  return {depth, place, true};
}

SurfacePair::LinearPiece SurfacePair::add_cut_force(std::size_t which, const ForceMoments& moments,
                                                    const Foretold& linear) {
  const ForceAndTorque f = linear_force(moments, linear.depth, linear.place);
  roles_[which].sums.cut_wrench.add(f.force, f.torque);
  return {linear.depth, linear.place, f, linear.place};
}

}  // namespace vpm
