// Measures the part of one cell that lies behind the surface, for host and device.
//
// Samples are compact pieces with centroid, volume and radius, in blocks with an enclosing ball. A
// block without surface counts whole or not at all; in the others each sample counts by its
// fraction. The step of a piece is: sample the surface at its middle (sample_of), note what it
// tells of the cell (note), find the direction that way_out() names, push or divide it (push).
// A backend chooses when it searches for the directions, one by one or several together, and in
// which order it takes the pieces.
#pragma once

#include <cstdint>
#include <span>

#include "libvpm/measure/classify.h"
#include "libvpm/measure/flood_rules.h"
#include "libvpm/measure/tool_piece.h"

namespace vpm {

struct CellResult {
  ToolSum sum;                  // tool axes, arms about the centre of mass
  ContactPlane plane;           // plane.count > 0: the surface cuts the cell
  bool is_far = false;          // a piece needs the support of a plane (is_far_behind)
  std::uint32_t far_count = 0;  // such pieces that run() has listed
  UnseenSum unseen;             // of the cell, with all far pieces that its plane does not support
  std::uint32_t point = kNoPoint;  // disk sampled last, where the next search begins
};

// True if what was found of a cell or of a part of it counts: it has a volume.
VPM_HD inline bool counts(const ToolSum& sum) {
  return sum.volume.value != 0;
}
// Returns the class of a cell that was measured, of which the parts that need no support are added.
VPM_HD inline CellClass class_of_result(const CellResult& result) {
  return result.plane.count > 0                ? CellClass::cut
         : counts(result.sum) || result.is_far ? CellClass::partial
                                               : CellClass::free;
}

// Names the samples [begin, end) of a level.
struct SampleRange {
  const CellSample* all = nullptr;
  std::uint32_t begin = 0, end = 0;
};

// Names a piece of a cell: a sample, or a block that is measured as one piece.
struct PieceIndex {
  static constexpr std::uint32_t kIsBlock = 1U << 31;  // no level has so many samples

  std::uint32_t bits = 0;

  static PieceIndex sample(std::uint32_t k) { return {k}; }
  static PieceIndex block(std::uint32_t b) { return {b | kIsBlock}; }
  bool is_block() const { return (bits & kIsBlock) != 0; }
  std::uint32_t index() const { return bits & ~kIsBlock; }
};

// Adds a mass wholly behind the surface, pushed along a normal in the tool's axes.
VPM_HD inline void add_whole(const ToolRadius& tool, const BlockMass& mass, Vec3 normal,
                             ToolSum& sum) {
  sum.add(mass.weight, normal, tool.inverse * mass.centroid);
}
// Adds the part of a block behind a plane: nothing, all of its mass, or the clipped moments of a
// cut one. `normal` is the plane's, in the tool's axes.
VPM_HD inline void add_by_plane(PlaneSide side, const BlockMass& mass,
                                const ClippedMoments& clipped, Vec3 normal, const ToolRadius& tool,
                                ToolSum& sum) {
  if (side == PlaneSide::behind) add_whole(tool, mass, normal, sum);
  if (side == PlaneSide::cut) sum.add_moment(clipped.weight, tool.inverse * clipped.moment, normal);
}

// Tells along which direction a piece is pushed out of the solid.
enum class WayOut : std::uint8_t {
  none,     // nothing of it is inside
  sampled,  // the surface cuts it: along the normal sampled at its middle
  own,      // along the nearest way out of its middle
  shared,   // along that of the first of its neighbours (neighbors_of) with such a direction
};
// True of directions that are searched for, by the piece or by its neighbour.
VPM_HD constexpr bool is_searched(WayOut way) {
  return way == WayOut::own || way == WayOut::shared;
}

// Returns the group of neighbouring samples to which sample `k` of a block belongs: those of a
// group that are wholly behind the surface are pushed in the direction of the first of them.
VPM_HD constexpr std::uint32_t neighbors_of(std::uint32_t k) {
  return k / kNeighborSamples;
}

template <MeasuredBody Surface>
class CellMeasure {
 public:
  // Maps coordinates about the tool's centre of mass to the surface's frame by `to_surface`.
  VPM_HD CellMeasure(const Surface& surface, const Pose& to_surface, ToolRadius tool_radius,
                     const CellView& cell)
      : surface_(surface),
        to_surface_(to_surface),
        tool_radius_(tool_radius),
        cell_(cell),
        center_(to_surface * cell.center) {}

  // Returns the part of an ambiguous cell that is inside. Lists far pieces in `far`, which has room
  // for all samples and blocks of the cell, and adds them where the cell turns out to be cut;
  // otherwise that is left to add_far(). `samples` is SamplesInTurn or adds the same faster.
  // Searches start at `point`.
  template <class Samples>
  CellResult run(Samples&& samples, PieceIndex* far, std::uint32_t point = kNoPoint) const {
    CellResult result;
    result.point = point;
    for (std::uint32_t b = cell_.begin; b < cell_.end; ++b) add_block(b, samples, far, result);
    samples.flush(*this, result);
    if (result.is_far && result.plane.count > 0) {
      const CutCell own{result.plane, center_, cell_.radius};
      const auto supports = [&](Vec3 x, Vec3 foot) {
        return own.supports(x, foot, tool_radius_.length);
      };
      samples.add_far(*this, {far, result.far_count}, supports, result.sum, result.unseen);
    }
    return result;
  }

  // Adds the far pieces that run() has listed, and takes them from `unseen`, where run() has put
  // them. `supports(x, foot)` is true if the plane of a cut
  // cell supports a place x behind the surface's place `foot`: a surface further away than the
  // tool's radius may be another one than that which cuts the tool.
  template <class Supports>
  void add_far(std::span<const PieceIndex> pieces, const Supports& supports, ToolSum& sum,
               UnseenSum& unseen) const {
    for (const PieceIndex& far : pieces) {
      const ToolPiece piece = piece_of_far(far);
      const PieceSample sampled = sample_piece(piece);
      if (!supports(sampled.x, sampled.on_surface.foot)) continue;
      push(piece, sampled, own_normal(way_out(sampled, false), sampled), surface_, sum);
      unseen.remove_occluded(piece.weight);
    }
  }
  ToolPiece piece_of_far(const PieceIndex& far) const {
    const std::uint32_t k = far.index();
    return far.is_block() ? piece_of(cell_.masses[k], cell_.blocks[k]) : piece_of_sample(k);
  }

  // Holds the class of one block of the cell.
  struct ClassifiedBlock {
    BlockClass found = BlockClass::free;
    TangentPlane plane;  // set for a cut block
    Vec3 center;
    std::uint32_t point = kNoPoint;  // disk where the next search begins
    Sight sight = Sight::seen;
  };
  VPM_HD ClassifiedBlock classify_block(const CellBlock& block) const {
    ClassifiedBlock result;
    result.center = to_surface_ * widen(block.center);
    const auto in_ball = surface_.classify_ball(result.center, block.radius);
    result.point = in_ball.point;
    result.sight = sight_of<Surface>(in_ball);
    result.found = class_of_block(
        surface_, in_ball, result.center, block.radius, tool_radius_,
        [&] { return surface_.sample(result.center); }, result.plane);
    return result;
  }

  // Adds what one block contributes to run().
  template <class Samples>
  void add_block(std::uint32_t b, Samples& samples, PieceIndex* far, CellResult& result) const {
    const CellBlock& block = cell_.blocks[b];
    const ClassifiedBlock sampled = classify_block(block);
    if (sampled.found == BlockClass::free)
      return add_free(cell_.masses[b], sampled.sight, result.unseen);
    if (sampled.point != kNoPoint) result.point = sampled.point;
    if (sampled.found == BlockClass::uncut) {
      add_piece(piece_of(cell_.masses[b], block), PieceIndex::block(b), far, result);
    } else if (sampled.found == BlockClass::cut) {
      add_block(b, {sampled.plane, to_surface_}, Samples::clipped, result);
    } else {
      const auto& near = surface_.around_ball(sampled.center, block.radius, sampled.point);
      samples.add(*this, {cell_.samples, block.begin, block.end}, near, far, result);
    }
  }

  // Holds the surface sample for a piece, and the decisions from it.
  struct PieceSample {
    Vec3 x;
    SurfaceSample on_surface;
    PlaneSide side = PlaneSide::before;  // of the surface; before it where none is known
    bool is_inside = false;              // at least a part of it is
    bool is_far = false;
  };
  VPM_HD PieceSample sample_piece(const ToolPiece& piece, std::uint32_t point = kNoPoint) const {
    const Vec3 x = to_surface_ * piece.at;
    return sample_of(piece, x, sample_for_piece(surface_, x, piece.extent, point));
  }
  // Returns the decisions for a piece at x, surface frame, from a known surface sample.
  VPM_HD PieceSample sample_of(const ToolPiece& piece, Vec3 x,
                               const SurfaceSample& on_surface) const {
    PieceSample sampled{x, on_surface};
    if (on_surface.known) {
      sampled.side = with_shape(piece.shape, [&](const auto& shape) {
        return side_of_piece(shape, on_surface.distance, on_surface.normal);
      });
    }
    sampled.is_inside = sampled.side != PlaneSide::before;
    if (!sampled.is_inside) return sampled;
    sampled.is_far = is_far_behind(surface_, x, on_surface.distance, tool_radius_);
    return sampled;
  }
  // Adds a block or cell on the free side of the surface, which is taken whole: where the sight of
  // its ball is mixed, as it is at its centroid.
  VPM_HD void add_free(const BlockMass& mass, Sight of_ball, UnseenSum& unseen) const {
    if (of_ball == Sight::seen) return;
    unseen.add(mass.weight,
               of_ball == Sight::mixed ? sight_at(surface_, to_surface_ * mass.centroid) : of_ball);
  }
  // Adds a piece that was sampled and that does not count: nothing is known there, or it is far
  // behind the surface. Of one that counts, the part that is before the surface was seen free.
  VPM_HD void add_unseen(const ToolPiece& piece, const PieceSample& sampled,
                         UnseenSum& unseen) const {
    if (sampled.is_far)
      unseen.add_occluded(piece.weight);
    else if (!sampled.on_surface.known)
      unseen.add(piece.weight, sight_at(surface_, sampled.x));
  }
  // Returns along which direction a piece is pushed. Samples share directions, other pieces
  // (is_sample is false) do not.
  VPM_HD static WayOut way_out(const PieceSample& sampled, bool is_sample) {
    if (!sampled.is_inside) return WayOut::none;
    if (sampled.side == PlaneSide::cut) return WayOut::sampled;
    return Surface::kSearchesFoot && is_sample && !sampled.is_far ? WayOut::shared : WayOut::own;
  }
  // Returns that direction for a piece that shares none, for push().
  VPM_HD Vec3 own_normal(WayOut way, const PieceSample& sampled) const {
    return way == WayOut::own ? closest_normal(sampled) : Vec3{};
  }
  // Adds a piece that is inside. Pushes a cut one along the sampled normal, others along
  // `searched`, the direction that was found; divides it where another wall is nearer to a part of
  // it. `near` samples the surface about the piece.
  template <class Near>
  VPM_HD void push(const ToolPiece& piece, const PieceSample& sampled, Vec3 searched,
                   const Near& near, ToolSum& sum) const {
    const bool cut = sampled.side == PlaneSide::cut;
    const ToolPiece part = cut ? part_behind(piece, sampled) : piece;
    const Vec3 normal = cut ? sampled.on_surface.normal : searched;
    OtherWall other;
    if (is_divisible(part.extent, tool_radius_) &&
        finds_other_wall(near, sampled.x, {normal, sampled.on_surface.foot},
                         sampled.on_surface.point, part.extent, kTwoWalls, other))
      add_divided(part, sampled.x, normal, other, sum);
    else
      add_pushed(part, normal, sum);
  }
  // Returns the part of a cut piece behind the surface, with the piece's centroid.
  VPM_HD ToolPiece part_behind(ToolPiece piece, const PieceSample& sampled) const {
    piece.weight *= with_shape(piece.shape, [&](const auto& shape) {
      return surface_.fraction_inside(sampled.on_surface, sampled.x, shape);
    });
    return piece;
  }
  VPM_HD Vec3 closest_normal(const PieceSample& sampled) const {
    return surface_.closest_normal(sampled.x, sampled.on_surface);
  }
  // Adds a piece at x that is divided between two walls; `normal` is the nearest wall's.
  VPM_HD void add_divided(const ToolPiece& piece, Vec3 x, Vec3 normal, const OtherWall& other,
                          ToolSum& sum) const {
    ClippedMoments part;
    if (piece.begin < piece.end) {
      const ClipPlane border(other.border, to_surface_);
      part = clipped_in_turn(border, cell_.samples + piece.begin, piece.end - piece.begin,
                             cell_.faces);
    } else {
      part.weight =
          piece.weight * with_shape({piece.extent, piece.shape.face}, [&](const auto& shape) {
            return fraction_behind(shape, other.border.distance(x), other.border.normal);
          });
      part.moment = part.weight * piece.at;
    }
    sum.add_moment(part.weight, arm(part.moment), in_tool(other.normal));
    sum.add_moment(piece.weight - part.weight, arm(piece.weight * piece.at - part.moment),
                   in_tool(normal));
  }
  // Adds a piece that is pushed along one normal.
  VPM_HD void add_pushed(const ToolPiece& piece, Vec3 normal, ToolSum& sum) const {
    sum.add(piece.weight, in_tool(normal), arm(piece.at));
  }
  VPM_HD void add_to_plane(const PieceSample& sampled, ContactPlane& plane) const {
    const SurfaceSample& at = sampled.on_surface;
    plane.add(at.normal, relative(sampled.x - at.distance * at.normal));
  }

  // Notes a piece's state in its cell's result. Returns true if run() adds the piece.
  VPM_HD bool note(const PieceSample& sampled, CellResult& result) const {
    if (!sampled.is_inside) return false;
    result.is_far |= sampled.is_far;
    if (sampled.side == PlaneSide::cut) add_to_plane(sampled, result.plane);
    return !sampled.is_far;
  }
  // Does so in run(), which lists far pieces and adds what was not seen.
  bool note(const ToolPiece& piece, const PieceSample& sampled, PieceIndex name, PieceIndex* far,
            CellResult& result) const {
    add_unseen(piece, sampled, result.unseen);
    if (sampled.is_far) far[result.far_count++] = name;
    return note(sampled, result);
  }
  // Adds one piece to run()'s result.
  void add_piece(const ToolPiece& piece, PieceIndex name, PieceIndex* far,
                 CellResult& result) const {
    const PieceSample sampled = sample_piece(piece, result.point);
    result.point = sampled.on_surface.point;
    if (note(piece, sampled, name, far, result))
      push(piece, sampled, own_normal(way_out(sampled, false), sampled), surface_, result.sum);
  }
  // Holds the direction found for a run of neighbouring samples.
  struct SharedDirection {
    std::uint32_t neighbors = UINT32_MAX;  // neighbors_of() its samples
    Vec3 normal;
  };
  // Adds sample `k`, the `place`-th of its block.
  template <class Near>
  void add_sample(std::uint32_t k, std::uint32_t place, SharedDirection& shared, PieceIndex* far,
                  CellResult& result, const Near& near) const {
    const ToolPiece piece = piece_of_sample(k);
    const Vec3 x = to_surface_ * piece.at;
    add_sample(k, place, x, sample_for_piece(near, x, piece.extent, result.point), shared, far,
               result, near);
  }
  // Does so for a sample at x, surface frame, from its surface sample.
  template <class Near>
  void add_sample(std::uint32_t k, std::uint32_t place, Vec3 x, const SurfaceSample& on_surface,
                  SharedDirection& shared, PieceIndex* far, CellResult& result,
                  const Near& near) const {
    const ToolPiece piece = piece_of_sample(k);
    const PieceSample sampled = sample_of(piece, x, on_surface);
    result.point = sampled.on_surface.point;
    if (!note(piece, sampled, PieceIndex::sample(k), far, result)) return;
    const WayOut way = way_out(sampled, true);
    if (way == WayOut::shared && shared.neighbors != neighbors_of(place))
      shared = {neighbors_of(place), closest_normal(sampled)};
    push(piece, sampled, way == WayOut::shared ? shared.normal : own_normal(way, sampled), near,
         result.sum);
  }

  VPM_HD void add_to_plane(Vec3 center, const ClipPlane& plane, ContactPlane& mean) const {
    mean.add(plane.seen.normal,
             relative(to_surface_ * center - plane.distance(center) * plane.seen.normal));
  }
  // Adds one block of a cell that is cut by a plane. `clipped` works as clipped_in_turn().
  template <class Clipped>
  VPM_HD void add_block(std::uint32_t b, const ClipPlane& plane, const Clipped& clipped,
                        CellResult& result) const {
    const CellBlock& block = cell_.blocks[b];
    const Vec3 center = widen(block.center);
    const PlaneSide side = side_of_plane(plane.distance(center), block.radius);
    ClippedMoments sums;
    if (side == PlaneSide::cut)
      sums = clipped(plane, cell_.samples + block.begin, block.end - block.begin, cell_.faces);
    if (sums.is_cut) add_to_plane(center, plane, result.plane);
    add_by_plane(side, cell_.masses[b], sums, plane.normal, tool_radius_, result.sum);
  }
  VPM_HD const Surface& surface() const { return surface_; }
  VPM_HD const SampleFaces& faces() const { return cell_.faces; }
  VPM_HD ToolPiece piece_of_sample(std::uint32_t k) const {
    return piece_of(cell_.samples[k], cell_.faces);
  }
  VPM_HD const Pose& to_surface() const { return to_surface_; }
  VPM_HD const ToolRadius& tool_radius() const { return tool_radius_; }
  VPM_HD Vec3 in_tool(Vec3 direction) const { return transpose(to_surface_.rotation) * direction; }

 private:
  // Returns use(shape) with the ball, or with the shape of a sample beside a face, which takes more
  // code.
  template <class Use>
  VPM_HD auto with_shape(const PieceShape& shape, const Use& use) const {
    return shape.face == nullptr ? use(BallShape<double>{shape.radius})
                                 : use(TurnedShape{shape, to_surface_.rotation});
  }
  VPM_HD Vec3 arm(Vec3 about_center_of_mass) const {
    return tool_radius_.inverse * about_center_of_mass;
  }
  VPM_HD Vec3 relative(Vec3 x) const { return 1 / cell_.radius * (x - center_); }

  const Surface& surface_;
  const Pose& to_surface_;
  ToolRadius tool_radius_;
  CellView cell_;
  Vec3 center_;  // in the surface's frame
};

// Adds the samples of ambiguous blocks, and far pieces, one after another.
struct SamplesInTurn {
  template <class Measure, class Near>
  void add(const Measure& measure, const SampleRange& range, const Near& near, PieceIndex* far,
           CellResult& result) const {
    typename Measure::SharedDirection shared;
    for (std::uint32_t k = range.begin; k < range.end; ++k)
      measure.add_sample(k, k - range.begin, shared, far, result, near);
  }
  template <class Measure>
  void flush(const Measure&, CellResult&) const {}
  template <class Measure, class Supports>
  static void add_far(const Measure& measure, std::span<const PieceIndex> pieces,
                      const Supports& supports, ToolSum& sum, UnseenSum& unseen) {
    measure.add_far(pieces, supports, sum, unseen);
  }
  static VPM_HD ClippedMoments clipped(const ClipPlane& plane, const CellSample* samples,
                                       std::uint32_t count, const SampleFaces& faces) {
    return clipped_in_turn(plane, samples, count, faces);
  }
};

}  // namespace vpm
