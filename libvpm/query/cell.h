// The part of one sphere's share that lies behind the surface.
//
// The share is known as samples: compact pieces with centroid, volume and size, in blocks with an
// enclosing ball. A block that the surface cannot reach counts whole or not at all; where it may
// pass, each sample gives the fraction of a ball of its size. One definition for host and device.
#pragma once

#include "libvpm/model/tool_model.h"
#include "libvpm/query/ball_fraction.h"
#include "libvpm/query/surface.h"
#include "libvpm/query/tool_sum.h"

namespace vpm {

// What a level knows of its blocks beyond the file: volume and centroid of the samples together.
struct BlockMass {
  Vec3 centroid;      // about the tool's centre of mass
  double weight = 0;  // sum of the samples' weights
};

struct CellView {
  const CellBlock* blocks = nullptr;
  const BlockMass* masses = nullptr;
  const CellSample* samples = nullptr;
  std::uint32_t begin = 0, end = 0;  // blocks of the cell
  Vec3 center;                       // of the sphere, about the tool's centre of mass
  double reach = 0;                  // of the share, from the sphere's centre
};

// The surface inside a cell, averaged: used for what lies out of the direct view.
struct ContactPlane {
  // Unit normals, and feet relative to the cell's reach: |terms| <= kSheetReach < 8; 2^20 samples
  // fit.
  using Sum = FixedSum<40>;
  Sum normal[3], foot[3];
  std::int64_t count = 0;

  VPM_HD void add(Vec3 n, Vec3 relative_foot) {
    normal[0].add(n.x), normal[1].add(n.y), normal[2].add(n.z);
    foot[0].add(relative_foot.x), foot[1].add(relative_foot.y), foot[2].add(relative_foot.z);
    ++count;
  }
  // Height of a place above the plane, both relative to the cell's centre and reach; negative
  // behind it.
  VPM_HD double height(Vec3 relative) const {
    const double per = 1 / static_cast<double>(count);
    const Vec3 n{normal[0].real(), normal[1].real(), normal[2].real()};
    const Vec3 p{per * foot[0].real(), per * foot[1].real(), per * foot[2].real()};
    return dot(normalized_or_zero(n), relative - p);
  }
  // Whether a place lies behind the plane and what hides it belongs to the same surface: not to an
  // object more than `near` in front of it. Where there is no plane nothing speaks against.
  VPM_HD bool vouches_for(Vec3 relative, Vec3 hiding, double near) const {
    return count == 0 || (height(relative) < 0 && height(hiding) <= near);
  }
};

// A cut share, in the surface's frame: its plane speaks for what is too far behind the surface, or
// out of sight.
struct CutShare {
  ContactPlane plane;
  Vec3 center;
  double reach = 0;

  VPM_HD Vec3 relative(Vec3 x) const { return 1 / reach * (x - center); }
  VPM_HD double height(Vec3 x) const { return plane.height(relative(x)); }  // in reaches
};

struct CellResult {
  ToolSum sum;                     // tool axes, arms about the centre of mass
  ContactPlane plane;              // plane.count > 0: the surface cuts the cell
  bool is_far = false;             // a piece is further behind the surface than the tool's reach
  std::uint32_t point = kNoPoint;  // of disks: where the surface was read last
};

// A surface further than this many reaches from the cell's centre, or than the tool's reach from
// the cell, may be another one than that which cuts the cell: a place behind it is merely hidden by
// it (a silhouette before a background), unless the cell's own plane vouches for both.
inline constexpr double kSheetReach = 3;

// The tool's reach, and its inverse, which scales arms.
struct ToolReach {
  double length = 0, inverse = 0;  // m, 1/m

  ToolReach() = default;
  VPM_HD ToolReach(double reach) : length(reach), inverse(1 / reach) {}
};

// A plane that crosses the tool: as the surface shows it, and in the tool's axes about its centre
// of mass.
struct CrossingPlane {
  TangentPlane seen;
  Vec3 normal;
  double height = 0;  // of the centre of mass

  CrossingPlane() = default;
  VPM_HD CrossingPlane(const TangentPlane& plane, const Pose& to_surface)
      : seen(plane),
        normal(transpose(to_surface.rotation) * plane.normal),
        height(plane.distance(to_surface.translation)) {}
  VPM_HD double distance(Vec3 about_center_of_mass) const {
    return dot(normal, about_center_of_mass) + height;
  }
};

// Of samples behind a plane, added in their order.
struct CrossedSums {
  double weight = 0;
  Vec3 moment;  // of each weight times its sample's centre
  bool is_cut = false;
};
// The weight of a sample that lies behind a plane.
VPM_HD inline double weight_behind(const CellSample& sample, const CrossingPlane& plane,
                                   bool& is_cut) {
  const double distance = plane.distance(widen(sample.center));
  if (distance >= sample.radius) return 0;
  if (distance <= -sample.radius) return sample.weight;
  is_cut = true;
  return sample.weight * ball_fraction_inside(distance / sample.radius);
}
VPM_HD inline CrossedSums crossed_in_turn(const CrossingPlane& plane, const CellSample* samples,
                                          std::uint32_t count) {
  CrossedSums sums;
  for (std::uint32_t k = 0; k < count; ++k) {
    const double inside = weight_behind(samples[k], plane, sums.is_cut);
    if (inside == 0) continue;
    sums.weight += inside;
    sums.moment += inside * widen(samples[k].center);
  }
  return sums;
}

// A compact piece of a share: a sample, or what is not cut taken whole (radius 0): a block, or the
// share.
struct SharePiece {
  Vec3 at;  // centroid, about the tool's centre of mass
  double radius = 0, weight = 0;
  double extent = 0;                 // no part is further from the centroid, nearly
  std::uint32_t begin = 0, end = 0;  // its samples, of what is taken whole
};
VPM_HD inline SharePiece piece_of(const CellSample& sample) {
  return {widen(sample.center), sample.radius, sample.weight, sample.radius, 0, 0};
}
VPM_HD inline SharePiece piece_of(const BlockMass& mass, const CellBlock& block) {
  return {mass.centroid, 0, mass.weight, block.radius, block.begin, block.end};
}
VPM_HD inline SharePiece piece_of(const BlockMass& mass, const CellView& share) {
  SharePiece piece{mass.centroid, 0, mass.weight, share.reach, 0, 0};
  if (share.begin < share.end) {
    piece.begin = share.blocks[share.begin].begin;
    piece.end = share.blocks[share.end - 1].end;
  }
  return piece;
}

// Adds what is wholly behind the surface, pushed along a normal in the tool's axes.
VPM_HD inline void add_whole(ToolReach tool, const BlockMass& mass, Vec3 normal, ToolSum& sum) {
  sum.add(mass.weight, normal, tool.inverse * mass.centroid);
}

// A block sees one plane where that is right to its radius, and to this part of the tool's reach:
// blocks of few large shares are wider than what they may overlook.
inline constexpr double kFlatness = 0.1;

template <class Surface>
class CellMeasure {
 public:
  // What hides a piece is another surface, maybe: those wait until the cell's plane is known.
  enum class Pass { seen, hidden };

  // `to_surface` maps coordinates about the tool's centre of mass to the surface's; `reach` is the
  // tool's, and scales the arms.
  VPM_HD CellMeasure(const Surface& surface, const Pose& to_surface, ToolReach tool_reach,
                     const CellView& cell)
      : surface_(surface),
        to_surface_(to_surface),
        tool_reach_(tool_reach),
        cell_(cell),
        center_(to_surface * cell.center) {}

  // `samples`: SamplesInTurn, or what adds the same sooner.
  template <class Samples>
  VPM_HD CellResult run(Samples samples) const {
    CellResult result;
    bool any_hidden = false;
    for (std::uint32_t b = cell_.begin; b < cell_.end; ++b)
      any_hidden |= add_block(b, Pass::seen, samples, result);
    if (any_hidden) {
      for (std::uint32_t b = cell_.begin; b < cell_.end; ++b)
        add_block(b, Pass::hidden, samples, result);
    }
    samples.flush(*this, result);
    return result;
  }

  // What of an uncut share that the flood has reached is inside, where run() does not know it
  // because it is far. `whole`: all of it is behind some surface; `nearest` gives the nearest cut
  // share, where it is needed.
  template <class Nearest>
  VPM_HD ToolSum reached(bool whole, const Nearest& nearest) const {
    ToolSum sum;
    for (std::uint32_t b = cell_.begin; b < cell_.end; ++b) {
      const CellBlock& block = cell_.blocks[b];
      const Side side = whole ? Side::behind : side_of(block);
      if (side == Side::free) continue;
      if (side != Side::mixed) {
        add_reached(nearest, piece_of(cell_.masses[b], block), sum);
        continue;
      }
      for (std::uint32_t s = block.begin; s < block.end; ++s)
        add_reached(nearest, piece_of(cell_.samples[s]), sum);
    }
    return sum;
  }

  // The side of one block of the cell.
  VPM_HD Side side_of(const CellBlock& block) const {
    return surface_.look_at_ball(to_surface_ * widen(block.center), block.radius).side;
  }

  // How well one plane must fit to serve a whole block, m.
  VPM_HD double flat_tolerance(double block_radius) const {
    const double most = kFlatness * tool_reach_.length;
    return block_radius < most ? block_radius : most;
  }

  // How the surface meets one block of the cell.
  struct BlockLook {
    Side side = Side::free;
    bool is_flat = false;  // of mixed blocks: the surface crosses it as one plane
    TangentPlane tangent;
    Vec3 center;
    std::uint32_t point = kNoPoint;  // where to begin to read the surface
  };
  VPM_HD BlockLook look_at(const CellBlock& block) const {
    BlockLook result;
    result.center = to_surface_ * widen(block.center);
    const auto look = surface_.look_at_ball(result.center, block.radius);
    result.side = look.side;
    result.point = look.point;
    result.is_flat =
        look.side == Side::mixed &&
        surface_.is_flat(look, result.center, flat_tolerance(block.radius), result.tangent) &&
        is_of_one_wall(result.center, block.radius, result.tangent, look.point);
    return result;
  }
  // Whether a block where the surface is one plane is pushed along its normal: it may be a part of
  // another surface than that which cuts the cell, or another wall may be nearer.
  VPM_HD bool is_of_one_wall(Vec3 center, double radius, const TangentPlane& tangent,
                             std::uint32_t point) const {
    OtherWall other;
    return !is_hidden(tangent.foot) &&
           !(is_divisible(radius) &&
             surface_.find_other_wall(center, tangent, point, radius, kOneDirection, other));
  }

  // Adds what one block contributes to run(): first of all that is seen, then, knowing the plane,
  // of what is hidden. Returns whether something was left for the second pass.
  template <class Samples>
  VPM_HD bool add_block(std::uint32_t b, Pass pass, Samples& samples, CellResult& result) const {
    const CellBlock& block = cell_.blocks[b];
    const BlockLook look = look_at(block);
    if (look.side == Side::free) return false;
    result.point = look.point;
    if (look.side != Side::mixed)
      return add_piece(piece_of(cell_.masses[b], block), pass, result, surface_);
    if (look.is_flat) {
      if (pass == Pass::hidden) return false;
      result.is_far |= is_far(look.tangent.distance(look.center));
      add_block<Samples>(b, {look.tangent, to_surface_}, result);
      return false;
    }
    const auto& near = surface_.around_ball(look.center, block.radius, look.point);
    return samples.add(*this, cell_.samples + block.begin, block.end - block.begin, pass, near,
                       result);
  }

  // Whether a place of the surface may be another one's than that which cuts the cell.
  VPM_HD bool is_hidden(Vec3 foot) const {
    const double beyond = (kSheetReach - 1) * cell_.reach;
    const double near = cell_.reach + (beyond < tool_reach_.length ? beyond : tool_reach_.length);
    return squared_norm(foot - center_) > near * near;
  }

  // Whether a place at this signed distance is further behind the surface than the tool's reach.
  VPM_HD bool is_far(double distance) const { return distance < -tool_reach_.length; }

  // One piece as the surface shows it.
  struct PieceLook {
    Vec3 x;
    Reading reading;
    bool is_inside = false;  // a part of it at least; the rest is said of such only
    bool is_far = false;     // further behind the surface than the tool's reach
    bool is_hidden = false;  // by another surface than that of the cell, maybe
  };
  VPM_HD PieceLook look_at(const SharePiece& piece, std::uint32_t point = kNoPoint) const {
    return look_at(piece, point, surface_);
  }
  // `near`: the surface as far as it concerns the piece.
  template <class Near>
  VPM_HD PieceLook look_at(const SharePiece& piece, std::uint32_t point, const Near& near) const {
    const Vec3 x = to_surface_ * piece.at;
    return look_of(piece, x, near.read(x, point));
  }
  // The same of a piece at x of the surface's frame, where that was read.
  VPM_HD PieceLook look_of(const SharePiece& piece, Vec3 x, const Reading& reading) const {
    PieceLook look{x, reading};
    look.is_inside = reading.known && reading.distance < piece.radius;
    if (!look.is_inside) return look;
    look.is_far = is_far(reading.distance);
    look.is_hidden = is_hidden(reading.foot);
    return look;
  }
  // Whether the cell's own plane vouches for a hidden piece.
  VPM_HD bool is_vouched_for(const PieceLook& look, const ContactPlane& plane) const {
    return plane.vouches_for(relative(look.x), relative(look.reading.foot),
                             tool_reach_.length / cell_.reach);
  }
  VPM_HD static bool is_cut(const SharePiece& piece, const PieceLook& look) {
    return look.reading.distance > -piece.radius;
  }
  VPM_HD double weight_inside(const SharePiece& piece, const PieceLook& look) const {
    return piece.weight *
           (is_cut(piece, look) ? surface_.fraction_inside(look.reading, look.x, piece.radius) : 1);
  }
  // Adds a piece that is inside.
  VPM_HD void add(const SharePiece& piece, const PieceLook& look, ToolSum& sum) const {
    if (is_cut(piece, look)) {
      sum.add(weight_inside(piece, look), in_tool(look.reading.normal), arm(piece.at));
      return;
    }
    const Vec3 normal = surface_.closest_normal(look.x, look.reading);
    OtherWall other;
    if (is_divisible(piece.extent) &&
        surface_.find_other_wall(look.x, {normal, look.reading.foot}, look.reading.point,
                                 piece.extent, kTwoWalls, other))
      add_divided(piece, look.x, normal, other, sum);
    else
      add_pushed(piece, normal, sum);
  }
  VPM_HD bool is_divisible(double extent) const {
    return extent >= kLeastDivided * tool_reach_.length;
  }
  // Adds a piece at x that is shared out between two walls; its middle is nearer to the one with
  // this normal.
  VPM_HD void add_divided(const SharePiece& piece, Vec3 x, Vec3 normal, const OtherWall& other,
                          ToolSum& sum) const {
    CrossedSums part;
    if (piece.begin < piece.end) {
      const CrossingPlane border(other.border, to_surface_);
      part = crossed_in_turn(border, cell_.samples + piece.begin, piece.end - piece.begin);
    } else {
      part.weight = piece.weight * ball_fraction_inside(other.border.distance(x) / piece.extent);
      part.moment = part.weight * piece.at;
    }
    sum.add_moment(part.weight, arm(part.moment), in_tool(other.normal));
    sum.add_moment(piece.weight - part.weight, arm(piece.weight * piece.at - part.moment),
                   in_tool(normal));
  }
  // The same of one that is not cut, with its direction.
  VPM_HD void add_pushed(const SharePiece& piece, Vec3 normal, ToolSum& sum) const {
    sum.add(piece.weight, in_tool(normal), arm(piece.at));
  }
  VPM_HD void add_to_plane(const PieceLook& look, ContactPlane& plane) const {
    plane.add(look.reading.normal, relative(look.reading.foot));
  }

  // What a pass of run() does with a piece. Notes what it says of its share; the sum is left to the
  // caller.
  enum class Take { leave, wait, add };  // wait: for the second pass
  VPM_HD Take take(const SharePiece& piece, const PieceLook& look, Pass pass,
                   CellResult& result) const {
    if (!look.is_inside) return Take::leave;
    result.is_far |= look.is_far;
    if (look.is_hidden != (pass == Pass::hidden)) return look.is_hidden ? Take::wait : Take::leave;
    if (look.is_hidden && !is_vouched_for(look, result.plane)) return Take::leave;
    if (is_cut(piece, look) && !look.is_hidden) add_to_plane(look, result.plane);
    return Take::add;
  }
  // Adds what one piece contributes to a pass. Returns whether it waits.
  template <class Near>
  VPM_HD bool add_piece(const SharePiece& piece, Pass pass, CellResult& result,
                        const Near& near) const {
    const PieceLook look = look_at(piece, result.point, near);
    result.point = look.reading.point;
    const Take taken = take(piece, look, pass, result);
    if (taken == Take::add) add(piece, look, result.sum);
    return taken == Take::wait;
  }

  // Adds what one piece contributes to reached().
  template <class Nearest>
  VPM_HD void add_reached(const Nearest& nearest, const SharePiece& piece, ToolSum& sum) const {
    const PieceLook look = look_at(piece);
    if (!look.is_inside) return;
    if (look.is_far) {
      const CutShare cut = nearest();
      if (!cut.plane.vouches_for(cut.relative(look.x), cut.relative(look.reading.foot),
                                 tool_reach_.length / cut.reach))
        return;
    }
    add(piece, look, sum);
  }

  // Adds a block that a plane crosses.
  VPM_HD void add_crossed(const CellBlock& block, const CrossingPlane& plane,
                          const CrossedSums& sums, CellResult& result) const {
    if (sums.is_cut) {
      const Vec3 x = widen(block.center);
      result.plane.add(plane.seen.normal,
                       relative(to_surface_ * x - plane.distance(x) * plane.seen.normal));
    }
    result.sum.add_moment(sums.weight, arm(sums.moment), plane.normal);
  }
  // Adds one block of a share that lies where the surface is one plane.
  template <class Samples>
  VPM_HD void add_block(std::uint32_t b, const CrossingPlane& plane, CellResult& result) const {
    const CellBlock& block = cell_.blocks[b];
    const double distance = plane.distance(widen(block.center));
    if (distance >= block.radius) return;
    if (distance <= -block.radius) {
      add_whole(tool_reach_, cell_.masses[b], plane.normal, result.sum);
      return;
    }
    const CrossedSums sums =
        Samples::crossed(plane, cell_.samples + block.begin, block.end - block.begin);
    add_crossed(block, plane, sums, result);
  }
  VPM_HD const Surface& surface() const { return surface_; }
  VPM_HD const Pose& to_surface() const { return to_surface_; }
  VPM_HD Vec3 in_tool(Vec3 direction) const { return transpose(to_surface_.rotation) * direction; }

 private:
  VPM_HD Vec3 arm(Vec3 about_center_of_mass) const {
    return tool_reach_.inverse * about_center_of_mass;
  }
  VPM_HD Vec3 relative(Vec3 x) const { return 1 / cell_.reach * (x - center_); }

  const Surface& surface_;
  const Pose& to_surface_;
  ToolReach tool_reach_;
  CellView cell_;
  Vec3 center_;  // in the surface's frame
};

// The samples of a block that the surface may cut, one after another.
struct SamplesInTurn {
  // Returns whether some wait for the second pass.
  template <class Measure, class Near>
  VPM_HD bool add(const Measure& measure, const CellSample* samples, std::uint32_t count,
                  typename Measure::Pass pass, const Near& near, CellResult& result) const {
    bool any_waits = false;
    for (std::uint32_t k = 0; k < count; ++k)
      any_waits |= measure.add_piece(piece_of(samples[k]), pass, result, near);
    return any_waits;
  }
  template <class Measure>
  VPM_HD void flush(const Measure&, CellResult&) const {}  // nothing is put off
  static VPM_HD CrossedSums crossed(const CrossingPlane& plane, const CellSample* samples,
                                    std::uint32_t count) {
    return crossed_in_turn(plane, samples, count);
  }
};

}  // namespace vpm
