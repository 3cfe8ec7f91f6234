// Forces of a pair of surfaces: the depth below each, over the part of the
// other inside. It is taken for linear over pieces. Where the solids share much
// for their size, the size of pieces is all that matters. Where they share
// little, a piece of the largest size may be far longer than it is deep: then
// samples tell whether a piece may stay as it is, or else it is cut.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "libvpm/solid/surface_pair.h"

namespace vpm {
namespace {

// Largest pieces: the radius of whole ones relative to the reach, half their
// slab's thickness relative to the depth, and the longest edge relative to the
// reach, of triangles and cells of triangles and of crossed triangles as a whole.
constexpr double kPatchRadius = 1.0 / 16, kPatchThickness = 0.5, kCell = 0.17, kCrossed = 0.12;
// Pieces may be so many times as large at most where a surface's force counts little.
constexpr double kMostEasier = 16;
// Volume relative to the cubed reach below which a solid is thin: forces on its two sides nearly
// cancel out, so that cells must be smaller, but not by more than this factor.
constexpr double kThin = 0.5, kLeastOfThin = 0.5;
// How the depth bends in a piece is told from the other's grid at the corners, as far as it is so
// many of its cells deep, and fully a quarter of a cell deeper; but only in pieces this many times
// as long as its cells, since it errs by a quarter of a cell at creases.
constexpr double kTrustedCells = 1, kTrusted = 4, kBendingCells = 4.25;
// Where the other solid's planes cut a piece, the depth in it is taken below their mean plane if
// they agree: if the squared length of the mean of their unit normals is less than 1 by no more
// than this. Where they disagree the other solid has a crease.
constexpr double kDisagreeing = 0.04;
// Mean depth, relative to the smaller reach, from which on no piece is looked
// at twice, and the least one that is told from none.
constexpr double kDeep = 1.0 / 32, kLeastDepth = 1e-5;
// Error of the integral of the depth over all that is inside, relative to the
// volume and to that of the smaller solid; pieces share it by their areas, and
// none needs less than its part.
constexpr double kError = 0.02, kErrorOfSmaller = 1e-3, kLeastPart = 1.0 / 256;
// Size of the smallest pieces relative to the mean depth.
constexpr double kSmallest = 0.1;
// Pieces up to so many times as large are sampled where samples tell whether
// they may stay, or to foretell smaller ones.
constexpr double kForetelling = 4;
// Cells of the other's grid by which depths below planes may differ from it.
constexpr double kPlausibleCells = 0.1;
// From what part of a limit on one way of sampling gives way to another: between, both are mixed,
// so that forces do not jump. Of errors, and of sizes.
constexpr double kMixedErrors = 0.5, kMixedSizes = 0.95;
// Scale of the sums of forces: one by which pieces of all of the area inside would be 1 or so, but
// rounding of the largest pieces stays far below. Areas that are smaller are taken for this one.
constexpr double kMostScale = 0x1p40, kLeastArea = 0x1p-200;
// Pieces that tell how deep thin solids are.
constexpr std::size_t kProbes = 8;

double square(double v) {
  return v * v;
}

// Returns the share of what is right up to a limit: 1 up to a part of it, and falling to 0 there.
double share_below(double limit, double v, double part = kMixedErrors) {
  if (v <= part * limit) return 1;
  return v < limit ? (limit - v) / (limit - part * limit) : 0;
}

// Returns the mean over a piece of the depth less `linear`, which is its tangent at the middle of
// the piece: a triangle with these corners, or a part of it. It is taken from the grid's depths at
// the corners by the rule that is right where the depth bends evenly. All in one frame, which
// `to_other` maps to the other solid's.
double mean_bend(const SolidSurface& other, const Pose& to_other,
                 const std::array<Vec3, 3>& corners, Vec3 middle, const Depth& linear) {
  const auto& [a, b, c] = corners;
  const Vec3 normal = cross(b - a, c - a);
  const double normal2 = squared_norm(normal), per_cell = 1 / other.grid_cell();
  if (!(normal2 > 0)) return 0;
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double depth = other.grid_depth(to_other * corners[k]);
    const double trust = std::clamp(kTrusted * (per_cell * depth - kTrustedCells), 0.0, 1.0);
    if (!(trust > 0)) continue;
    const Vec3 p = corners[(k + 1) % 3] - middle, q = corners[(k + 2) % 3] - middle;
    // Barycentric coordinate of the middle; in slivers rounding may tell more.
    const double part = std::clamp(dot(cross(p, q), normal) / normal2, 0.0, 1.0);
    const double foretold = linear.value + dot(linear.gradient, corners[k] - middle);
    sum += part * trust * (depth - foretold);
  }
  return sum / 4;
}

// Returns the force on what is below a node, where the depth is linear: `depth` at the place x.
ForceAndTorque linear_force_of(const SurfaceTree& tree, std::uint32_t node, const Depth& depth,
                               Vec3 x) {
  if (const ForceMoments* moments = tree.force_moments(node))
    return linear_force(*moments, depth, x);
  const SurfaceTree::Summary& below = tree.summaries()[node];
  ForceAndTorque sum;
  for (std::uint32_t t = below.first; t < below.end; ++t) {
    const ForceAndTorque f = linear_force(tree.corners(t), depth, x);
    sum.force += f.force, sum.torque += f.torque;
  }
  return sum;
}

}  // namespace

// Chooses by the mean depth: that of what is shared, of which the volume is the
// product with the area inside, or for thin solids, which may be deep inside
// though they share little, that of the largest pieces.
SurfacePair::Precision SurfacePair::precision() {
  const double reach = per_unit_ * std::min(roles_[0].solid->reach(), roles_[1].solid->reach());
  const double flux = sums_.inner[0].moments.flux() + sums_.inner[1].moments.flux();
  const double per_unit3 = per_unit_ * per_unit_ * per_unit_, volume = per_unit3 * flux / 3;
  const double area = area_inside();
  if (!(area > 0)) return {};
  const double depth = std::max(volume / area, kLeastDepth * reach), deep = kDeep * reach;
  const double part =
      std::min((depth < deep ? std::max(depth, depth_of_largest()) : depth) / deep, 1.0);
  const double smaller = std::min(roles_[0].solid->volume(), roles_[1].solid->volume());
  const double error = std::min(kError * depth * area, kErrorOfSmaller * per_unit3 * smaller);
  return {part * std::sqrt(part), error / area, kLeastPart * error, kSmallest * depth, depth};
}

// Returns the mean depth at the middles of the largest pieces, by their areas;
// half of it, since the middles of few are deeper than most.
double SurfacePair::depth_of_largest() {
  probes_.clear();
  for (std::uint32_t role = 0; role < 2; ++role)
    for (const CrossedTriangle& triangle : roles_[role].crossed)
      if (const double area = triangle.area(); area > 0)
        probes_.push_back({area, triangle.mean() / area, role});
  for (const WholePiece& piece : whole_pieces_) {
    const Role& role = roles_[piece.role];
    const bool is_triangle = (piece.child & kLeaf) != 0;
    const auto [a, b, c] = role.tree->corners(is_triangle ? piece.child & ~kLeaf : 0);
    const SurfaceTree::Patch& patch = role.tree->patches()[is_triangle ? 0 : piece.child];
    const double area = is_triangle ? 0.5 * norm(cross(b - a, c - a)) : double{patch.area};
    const Vec3 middle = is_triangle ? (a + b + c) / 3 : widen(patch.middle);
    probes_.push_back(
        {per_unit_ * per_unit_ * area, per_unit_ * (role.to_first * middle), piece.role});
  }
  const auto order = [](const Probe& p) {
    return std::tuple(-p.area, p.place.x, p.place.y, p.place.z, p.role);
  };
  const std::size_t count = std::min(probes_.size(), kProbes);
  std::ranges::partial_sort(probes_, probes_.begin() + static_cast<std::ptrdiff_t>(count), {},
                            order);
  double sum = 0, areas = 0;
  for (const auto& [area, place, role] : std::span(probes_).first(count)) {
    sum += area * std::max(depth_at(role, place).depth.value, 0.0);
    areas += area;
  }
  return areas > 0 ? sum / areas / 2 : 0;
}

// Sets how large pieces of a surface may be, by the shapes and volumes of both solids alone: so
// forces do not jump at other sizes.
void SurfacePair::set_sizes(Role& role, const SolidSurface& other) {
  const double reach = role.solid->reach(), ratio = role.solid->volume() / other.volume();
  // The depth below the other counts by the square of its volume (shared_of in solid_pair.cpp).
  role.ease = std::max(ratio * ratio, 1.0);
  const double size = std::min(std::sqrt(std::max(ratio, 1.0)), kMostEasier) * reach;
  const double thinness = role.solid->volume() / (kThin * reach * reach * reach);
  const double of_thin = std::clamp(std::sqrt(std::sqrt(thinness)), kLeastOfThin, 1.0);
  role.largest_patch = kPatchRadius * size;
  role.largest_cell = kCell * of_thin * size;
  role.largest_crossed = kCrossed * of_thin * size;
  role.largest_judged = kCrossed * size;
}

// Returns how far an error of the integral over an area may stay.
double SurfacePair::share_of_precise(std::size_t which, double error, double area) const {
  return share_below(std::max(precision_.depth * area, precision_.product),
                     error / roles_[which].ease);
}

// Adds the forces on all that is inside, after all moments are summed.
void SurfacePair::add_forces() {
  const double area = std::max(area_inside(), kLeastArea);
  wrench_scale_ = std::min(std::ldexp(1.0, -std::ilogb(area)), kMostScale);
  const bool is_below_planes[2] = {planes_below(0) != nullptr, planes_below(1) != nullptr};
  if (!(is_below_planes[0] && is_below_planes[1])) precision_ = precision();
  for (std::size_t role = 0; role < 2; ++role) {
    face_ = 0;
    for (const CrossedTriangle& triangle : roles_[role].crossed) {
      is_below_planes[role] ? add_force_below_planes(role, triangle)
                            : add_force_of_crossed(role, triangle);
      ++face_;
    }
  }
  face_ = kNone;
  for (whole_ = 0; whole_ < whole_pieces_.size(); ++whole_) {
    const auto& [role, child, element] = whole_pieces_[whole_];
    is_below_planes[role] ? add_force_of_whole_below_planes(role, child)
                          : add_force_of_whole(role, child);
  }
}

// Adds the force on all below a node, or on a triangle, which lies inside as a
// whole.
void SurfacePair::add_force_of_whole(std::size_t which, std::uint32_t child) {
  if ((child & kLeaf) != 0) return add_force_of_triangle(which, child & ~kLeaf, {});
  patches_.assign(1, {child, {}});
  while (!patches_.empty()) {
    auto [node, foretold] = patches_.back();
    patches_.pop_back();
    foretold.weight -= add_force_of_patch(which, node, foretold);
    if (!(foretold.weight > 0)) continue;
    for (const std::uint32_t below : roles_[which].tree->nodes()[node].child) {
      if (below == kNone) continue;
      if ((below & kLeaf) != 0)
        add_force_of_triangle(which, below & ~kLeaf, foretold);
      else
        patches_.push_back({below, foretold});
    }
  }
}

// Adds the force on what is below a node, less where it is not as was foretold and none where it is
// too large or too thick; returns with what weight, and tells what to expect below.
double SurfacePair::add_force_of_patch(std::size_t which, std::uint32_t node, Foretold& foretold) {
  Role& role = roles_[which];
  const SurfaceTree::Patch& patch = role.tree->patches()[node];
  const double most = role.largest_patch;
  if (patch.radius > (precision_.size < 1 ? kForetelling * most : most)) return 0;
  const Vec3 middle = widen(patch.middle);
  Depth depth = roles_[1 - which].solid->depth(role.to_other * middle);
  ++sums_.depths;
  depth.gradient = transpose(role.to_other.rotation) * depth.gradient;
  const double error = per_unit_ * std::abs(foretold.at(middle) - depth.value),
               area = per_unit_ * per_unit_ * patch.area;
  const double share = std::max(
      share_of_small(patch.radius, most),
      foretold.is_known ? share_of_precise(which, foretold.weight * error * area, area) : 0);
  const double weight = share * foretold.weight;
  foretold.depth = depth, foretold.place = middle, foretold.is_known = true;
  if (patch.radius > most || patch.thickness > kPatchThickness * depth.value || !(weight > 0))
    return 0;
  add_force_of_node(which, node, depth, middle, weight);
  return weight;
}

// Adds a weight of the force on what is below a node, over which the depth is linear: `depth` at a
// place, in the surface's own frame.
void SurfacePair::add_force_of_node(std::size_t which, std::uint32_t node, const Depth& depth,
                                    Vec3 middle, double weight) {
  Role& role = roles_[which];
  const double unit3 = weight * per_unit_ * per_unit_ * per_unit_, unit4 = unit3 * per_unit_;
  const ForceAndTorque f = linear_force_of(*role.tree, node, depth, middle);
  const ForceAndTorque added{unit3 * f.force, unit4 * f.torque};
  add_wrench(role.sums.whole_wrench, added);
  if (!with_contacts_) return;
  const SurfaceTree::Summary& below = role.tree->summaries()[node];
  note_force_of_whole(which, added, depth, middle, role.tree->patches()[node].radius, below.first,
                      below.end);
}

// Returns how far a piece is taken without a second look.
double SurfacePair::share_of_small(double size, double most) const {
  if (precision_.size < 1) return share_below(precision_.size * most, size, kMixedSizes);
  return size <= most ? 1 : 0;
}

void SurfacePair::add_force_of_triangle(std::size_t which, std::uint32_t triangle,
                                        const Foretold& before) {
  Role& role = roles_[which];
  const std::array<Vec3, 3> corners = role.tree->corners(triangle);
  const double most = role.largest_cell, longest = role.tree->longest_edge(triangle);
  const PlacedTriangle at = placed(role, triangle);
  DepthCell cell{at.corner, {1, 1, 1}, {}, {}};
  for (Vec3& corner : cell.corner) corner = per_unit_ * corner;
  const Vec3 normal = normalized_or_zero(at.normal);
  if (longest > most) return add_force_of_cells(which, cell, normal, before.weight);
  const Vec3 middle = (corners[0] + corners[1] + corners[2]) / 3;
  const SolidSurface& other = *roles_[1 - which].solid;
  Depth depth = other.depth(role.to_other * middle);
  ++sums_.depths;
  depth.gradient = transpose(role.to_other.rotation) * depth.gradient;
  const double error = per_unit_ * std::abs(before.at(middle) - depth.value),
               area = 0.5 * per_unit_ * per_unit_ * norm(at.normal);
  const double share =
      std::max(share_of_small(longest, most),
               before.is_known ? share_of_precise(which, before.weight * error * area, area) : 0);
  if (share < 1) add_force_of_cells(which, cell, normal, (1 - share) * before.weight);
  if (!(share > 0)) return;
  if (longest > kBendingCells * other.grid_cell())
    depth.value += mean_bend(other, role.to_other, corners, middle, depth);
  const ForceAndTorque f = linear_force(corners, depth, middle);
  const double unit3 = share * before.weight * per_unit_ * per_unit_ * per_unit_;
  const ForceAndTorque added{unit3 * f.force, unit3 * per_unit_ * f.torque};
  add_wrench(role.sums.whole_wrench, added);
  if (with_contacts_)
    note_force_of_whole(which, added, depth, middle, role.solid->reach(), triangle, triangle + 1);
}

// Adds the force on the part of a crossed triangle inside: at once if it is
// small, else cell by cell.
void SurfacePair::add_force_of_crossed(std::size_t which, const CrossedTriangle& triangle) {
  Role& role = roles_[which];
  cut_segments_.clear(), cut_points_.clear();
  for (std::uint32_t k = triangle.last_segment; k != CrossedTriangle::kEnd;
       k = role.segments[k].second)
    cut_segments_.push_back(role.segments[k].first);
  const double most = precision_.size * role.largest_crossed;
  if (role.tree->longest_edge(triangle.triangle) <= most) {
    const auto piece = add_force_of_cut(which, triangle, cut_segments_);
    if (piece && with_contacts_) note_force_of_face(which, triangle, *piece);
    return;
  }
  for (std::uint32_t k = triangle.last_point; k != CrossedTriangle::kEnd; k = role.points[k].second)
    cut_points_.push_back(role.points[k].first);
  DepthCell cell{triangle.corner, {}, cut_segments_, cut_points_};
  for (std::size_t k = 0; k < 3; ++k)
    cell.is_inside[k] = is_inside(which, role.tree->triangles()[triangle.triangle][k]) ? 1 : 0;
  add_force_of_cells(which, cell, triangle.normal, 1);
}

// Sums up the part inside of one cell after the other of a triangle.
class SurfacePair::CellVisitor {
 public:
  struct Value {
    double area = 0;
    DepthIntegral integral;
    Foretold sampled;
    bool is_large = false;
  };

  CellVisitor(SurfacePair& pair, std::size_t role, Vec3 normal)
      : pair_(pair),
        role_(role),
        normal_(normal),
        most2_(square(pair.per_unit_ * pair.roles_[role].largest_judged)),
        sampled2_(square(pair.per_unit_ * pair.roles_[role].largest_cell)),
        small2_(
            std::max(square(pair.precision_.size) * sampled2_, square(pair.precision_.smallest))) {
    if (pair.precision_.size < 1)
      sampled2_ = square(kForetelling) * most2_, small_part_ = kMixedSizes;
  }

  bool is_too_large(const DepthCell& cell) const { return cell.longest_edge2() > sampled2_; }
  bool is_large(const DepthCell& cell) const { return cell.longest_edge2() > most2_; }
  double take_if_small(const DepthCell& cell, double weight) {
    const double taken = weight * share_below(small2_, cell.longest_edge2(), small_part_);
    if (taken > 0) pair_.add_force_of_small_cell(role_, cell, normal_, taken);
    return weight - taken;
  }

  Value value(const DepthCell& cell) {
    const auto& [a, b, c] = cell.corner;
    if (cell.is_whole()) {
      if (cell.is_inside[0] == 0) return {};
      const double area = 0.5 * norm(cross(b - a, c - a));
      const Vec3 middle = (a + b + c) / 3;
      const Foretold sampled = pair_.depth_at(role_, middle);
      const Vec3 p = a - middle, q = b - middle, r = c - middle, g = sampled.depth.gradient;
      const Vec3 slope = (dot(g, p) * p + dot(g, q) * q + dot(g, r) * r) / 12;
      const double depth = sampled.depth.value;
      return {area, {depth * area, area * (depth * middle + slope)}, sampled, is_large(cell)};
    }
    CrossedTriangle part;
    part.set_corners(cell.corner, normal_);
    pair_.add_cuts(cell, part);
    const double area = part.area();
    if (!(area > 0)) return {};  // rounding
    const Vec3 middle = part.mean() / area;
    auto& planes = pair_.planes_;
    planes.clear();
    for (const CutSegment& s : cell.segments) {
      const CrossedTriangle& other = pair_.roles_[1 - role_].crossed[s.other];
      planes.push_back({other.normal, dot(other.normal, other.corner[0])});
    }
    const Foretold sampled = pair_.depth_at(role_, middle);
    return {area, pair_.fan_.integral(cell, normal_, planes, middle, sampled.depth), sampled,
            is_large(cell)};
  }

  bool is_negligible(const Value& value, double weight) const {
    return weight * value.area * std::abs(value.sampled.depth.value) <=
           pair_.roles_[role_].ease * pair_.precision_.product;
  }

  double agreement(Value& value, const Value& first, const Value& second, double weight) const {
    const DepthIntegral &p = first.integral, &q = second.integral;
    const DepthIntegral sum{p.volume + q.volume, p.moment + q.moment};
    const double more = sum.volume - value.integral.volume;
    const Vec3 shift = sum.moment - value.integral.moment - more * value.sampled.place;
    const double size = norm(first.sampled.place - second.sampled.place);
    const double error = std::max(std::abs(more), kShift * norm(shift) / size);
    value.integral = sum;
    const double least = std::min(first.area, second.area) / kLeastHalf;
    return std::min({pair_.share_of_precise(role_, weight * error, value.area),
                     1 - share_below(value.area, least),
                     value.is_large ? share_below(kShallow * pair_.precision_.mean,
                                                  value.sampled.depth.value, kMixedShallow)
                                    : 1});
  }

  void take(const DepthCell& cell, const Value& value, double weight) {
    const ForceAndTorque f = weight * force_on_face(value.integral, normal_);
    pair_.add_wrench(pair_.roles_[role_].sums.cut_wrench, f);
    const Foretold& s = value.sampled;
    if (pair_.with_contacts_)
      pair_.note_force_of_cell(role_, cell, {s.depth, s.place, f, s.place, weight}, normal_);
  }

 private:
  // Halves that hold less of the part inside do not tell whether its integral
  // is right.
  static constexpr double kLeastHalf = 1.0 / 8;
  // Halves may move the integral's middle so far, relative to their distance,
  // times its error.
  static constexpr double kShift = 1;
  // Cells above the largest size may stay where they are not deeper than so
  // many mean depths; the middle of a slab, whose depth is the mean one, stays as a whole.
  static constexpr double kShallow = 1.3, kMixedShallow = 0.8;

  SurfacePair& pair_;
  std::size_t role_;
  Vec3 normal_;
  double most2_, sampled2_, small2_;  // squared longest edges, in the unit
  double small_part_ = 1;
};

// Adds the force on that part of a triangle of solid `which` that lies inside of the other solid,
// cell by cell.
void SurfacePair::add_force_of_cells(std::size_t which, const DepthCell& cell, Vec3 normal,
                                     double weight) {
  CellVisitor visitor(*this, which, normal);
  cells_.run(cell, normal, weight, visitor);
}

// Adds what bounds the part of a cell inside.
void SurfacePair::add_cuts(const DepthCell& cell, CrossedTriangle& part) {
  for (const CutSegment& s : cell.segments) part.add_segment(s.start, s.end);
  for (const CutPoint& point : cell.points)
    part.add_crossing(static_cast<unsigned>(point.edge), point.sign, point.place);
  for (unsigned k = 0; k < 3; ++k)
    if (cell.is_inside[k] != 0) part.add_corner_inside(k);
}

void SurfacePair::add_force_of_small_cell(std::size_t which, const DepthCell& cell, Vec3 normal,
                                          double weight) {
  const auto& [a, b, c] = cell.corner;
  LinearPiece piece;
  if (cell.is_whole()) {
    piece =
        add_cut_force(which, triangle_force_moments(a, b, c),
                      bent(which, cell, depth_at(which, (a + b + c) / 3), (a + b + c) / 3), weight);
  } else {
    CrossedTriangle part;
    part.set_corners(cell.corner, normal);
    add_cuts(cell, part);
    const double area = part.area();
    if (!(area > 0)) return;  // rounding
    const Vec3 middle = part.mean() / area;
    Foretold linear = plane_across(which, cell.segments);
    const double share = share_of_plausible(which, linear, middle);
    linear = bent(which, cell, mixed_with_depth(which, linear, share, middle), middle);
    piece = add_cut_force(which, part.moments(), linear, weight);
    piece.middle = middle;
  }
  if (with_contacts_) note_force_of_cell(which, cell, piece, normal);
}

// Returns a depth that is linear over the part of a cell inside and has the mean of one that bends,
// given its tangent at the middle of that part.
SurfacePair::Foretold SurfacePair::bent(std::size_t which, const DepthCell& cell, Foretold linear,
                                        Vec3 middle) const {
  const SolidSurface& other = *roles_[1 - which].solid;
  if (!(cell.longest_edge2() > square(kBendingCells * per_unit_ * other.grid_cell())))
    return linear;
  const Pose to_other = which == 0 ? roles_[0].to_other : Pose{};
  std::array<Vec3, 3> corners = cell.corner;
  for (Vec3& corner : corners) corner = unit_ * corner;
  const Depth at_middle{unit_ * linear.at(middle), linear.depth.gradient};
  linear.depth.value += per_unit_ * mean_bend(other, to_other, corners, unit_ * middle, at_middle);
  return linear;
}

// Adds the force on the part of a crossed triangle: below the planes that cross
// it, or below the closest point where these disagree. Returns nothing where
// nothing crosses it.
std::optional<SurfacePair::LinearPiece> SurfacePair::add_force_of_cut(
    std::size_t which, const CrossedTriangle& triangle, std::span<const CutSegment> segments) {
  Foretold linear = plane_across(which, segments);
  if (!linear.is_known) return std::nullopt;
  const Vec3 middle = triangle.middle();
  if (triangle.area() > 0)
    linear = mixed_with_depth(which, linear, share_of_agreeing(linear), middle);
  LinearPiece piece = add_cut_force(which, triangle.moments(), linear, 1);
  piece.middle = middle;
  return piece;
}

// Returns how far the planes that cut a piece agree.
double SurfacePair::share_of_agreeing(const Foretold& below_planes) {
  if (!below_planes.is_known) return 0;
  return share_below(kDisagreeing, 1 - squared_norm(below_planes.depth.gradient));
}

// Returns how far the depth below the planes that cut a cell may stand for that at its middle: as
// far as they agree, and the other's grid agrees with them. Where it does not, another face is
// nearer, as beside flush ones.
double SurfacePair::share_of_plausible(std::size_t which, const Foretold& below_planes,
                                       Vec3 middle) const {
  const double agreeing = share_of_agreeing(below_planes);
  if (!(agreeing > 0)) return 0;
  const Pose to_other = which == 0 ? roles_[0].to_other : Pose{};
  const SolidSurface& other = *roles_[1 - which].solid;
  const double error =
      other.grid_depth(to_other * (unit_ * middle)) - unit_ * below_planes.at(middle);
  return std::min(agreeing, share_below(kPlausibleCells * other.grid_cell(), std::abs(error)));
}

// Returns the weighted mean of two depths that are linear about a place: of the depth below planes
// that cut a piece there, with weight `share`, and of what depth_at() finds, with the rest of 1.
SurfacePair::Foretold SurfacePair::mixed_with_depth(std::size_t which, const Foretold& below_planes,
                                                    double share, Vec3 place) {
  if (!(share < 1)) return below_planes;
  Foretold at = depth_at(which, place);
  if (share > 0) {
    at.depth.value += share * (below_planes.at(place) - at.depth.value);
    at.depth.gradient += share * (below_planes.depth.gradient - at.depth.gradient);
  }
  return at;
}

// Returns the depth below the mean of the planes that cut a triangle, weighted
// by the lengths of the cuts. Known if there is any.
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

// Returns the depth below the other's surface at a place in the first's frame;
// in the unit.
SurfacePair::Foretold SurfacePair::depth_at(std::size_t which, Vec3 place) {
  const Pose to_other = which == 0 ? roles_[0].to_other : Pose{};
  Depth depth = roles_[1 - which].solid->depth(to_other * (unit_ * place));
  ++sums_.depths;
  depth.value *= per_unit_;
  depth.gradient = transpose(to_other.rotation) * depth.gradient;
  return {depth, place, true};
}

SurfacePair::LinearPiece SurfacePair::add_cut_force(std::size_t which, const ForceMoments& moments,
                                                    const Foretold& linear, double weight) {
  const ForceAndTorque f = weight * linear_force(moments, linear.depth, linear.place);
  add_wrench(roles_[which].sums.cut_wrench, f);
  return {linear.depth, linear.place, f, linear.place, weight};
}

}  // namespace vpm
