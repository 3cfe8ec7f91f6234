// Defines the parts of a cell (blocks, samples, pieces), what a plane clips of them, and the sums
// of what parts add to an answer.
#pragma once

#include "libvpm/core/division.h"
#include "libvpm/core/fixed_sum.h"
#include "libvpm/core/pose.h"
#include "libvpm/core/vec3.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/scene/body.h"
#include "libvpm/scene/piece_shape.h"

namespace vpm {

// Sums volume, force and torque over parts of a tool, with the same bits in any order. Sums in
// units of the tool: volumes in parts of its volume, arms in parts of its radius. Parts of a tool
// do not overlap, so every sum lies in [-1, 1]; 60 fractional bits hold up to 8.
struct ToolSum {
  using Sum = FixedSum<60>;
  Sum volume, force[3], torque[3];

  friend bool operator==(const ToolSum&, const ToolSum&) = default;

  VPM_HD void add(double part, Vec3 normal, Vec3 arm) { add_moment(part, part * arm, normal); }
  // Adds parts that are pushed along one normal: the sum of their volumes, and the sum of each
  // volume times its arm. Skips what rounds to no volume, so that such parts change no sum.
  VPM_HD void add_moment(double part, Vec3 moment, Vec3 normal) {
    Sum resolved;
    resolved.add(part);
    if (resolved.value == 0) return;
    const Vec3 f = part * normal, t = cross(moment, normal);
    volume.add(resolved);
    force[0].add(f.x), force[1].add(f.y), force[2].add(f.z);
    torque[0].add(t.x), torque[1].add(t.y), torque[2].add(t.z);
  }
  VPM_HD void add(const ToolSum& other) {
    volume.add(other.volume);
    for (int k = 0; k < 3; ++k) force[k].add(other.force[k]), torque[k].add(other.torque[k]);
  }

  // Adds `other`; many threads may do so at once.
  void add_atomically(const ToolSum& other) {
    vpm::add_atomically(volume.value, other.volume.value);
    for (int k = 0; k < 3; ++k) {
      vpm::add_atomically(force[k].value, other.force[k].value);
      vpm::add_atomically(torque[k].value, other.torque[k].value);
    }
  }
};

// Sums the parts of a tool that no camera tells of, in parts of its volume, with the same bits in
// any order. What neither counts as volume nor is here was seen free.
struct UnseenSum {
  using Sum = ToolSum::Sum;
  Sum unseen, out_of_view;  // in holes or occluded; outside of the image

  friend bool operator==(const UnseenSum&, const UnseenSum&) = default;

  // Adds a part of which nothing counts as volume, by what the camera sees in its direction: not
  // mixed.
  VPM_HD void add(Sum part, Sight sight) {
    if (sight == Sight::hole) unseen.add(part);
    if (sight == Sight::out_of_view) out_of_view.add(part);
  }
  VPM_HD void add(double part, Sight sight) {
    if (sight != Sight::seen) add(rounded(part), sight);
  }
  // Adds and takes away a part that the surface hides.
  VPM_HD void add_occluded(double part) { unseen.add(rounded(part)); }
  VPM_HD void remove_occluded(double part) { unseen.value -= rounded(part).value; }
  VPM_HD static Sum rounded(double part) {
    Sum sum;
    sum.add(part);
    return sum;
  }

  VPM_HD void add(const UnseenSum& other) {
    unseen.add(other.unseen);
    out_of_view.add(other.out_of_view);
  }
  // Adds `other`; many threads may do so at once.
  void add_atomically(const UnseenSum& other) {
    vpm::add_atomically(unseen.value, other.unseen.value);
    vpm::add_atomically(out_of_view.value, other.out_of_view.value);
  }
};

// Holds volume and centroid of a block's samples together, which the file does not store.
struct BlockMass {
  Vec3 centroid;      // about the tool's centre of mass
  double weight = 0;  // sum of the samples' weights, in parts of the tool's volume
};

// Finds the shapes of samples beside faces of the solid, four of which share a FaceRow. In a level
// that is ready for queries (numbered_samples), the radius of a sample that has a lane of a row is
// not a length but -1 - k, where k is the number of that lane among those
// of all rows: less than 2^24, which a float holds exactly. So a query that has read a sample knows
// whether it is a ball without reading more.
struct SampleFaces {
  const FaceRow* rows = nullptr;

  // Returns the shape of a sample; a null pointer for a ball.
  VPM_HD FaceInRow of(const CellSample& sample) const {
    return sample.radius < 0 ? row_of(sample).numbers + number_of(sample) % FaceRow::kLanes
                             : nullptr;
  }
  // Returns the row of a sample that is in one.
  VPM_HD const FaceRow& row_of(const CellSample& sample) const {
    return rows[number_of(sample) / FaceRow::kLanes];
  }

 private:
  VPM_HD static std::uint32_t number_of(const CellSample& sample) {
    return static_cast<std::uint32_t>(-1 - sample.radius);
  }
};
// True if some samples of a block, or of a run of them, are in rows. These are the last ones of
// their block, so the last sample answers for all.
VPM_HD inline bool have_faces(const CellSample* samples, std::size_t count) {
  return count > 0 && samples[count - 1].radius < 0;
}

struct CellView {
  const CellBlock* blocks = nullptr;
  const BlockMass* masses = nullptr;
  const CellSample* samples = nullptr;
  std::uint32_t begin = 0, end = 0;  // blocks of the cell
  Vec3 center;                       // the sphere's centre, about the tool's centre of mass, m
  double radius = 0;                 // bounding radius of the cell about `center`, m
  SampleFaces faces;                 // of the level
};

// Describes a compact piece of a cell: a sample, or a block or cell that is taken whole, as if all
// of it were at its centroid.
struct ToolPiece {
  Vec3 at;                           // centroid, about the tool's centre of mass, m
  PieceShape shape{};                // without extent for a block or cell
  double weight = 0;                 // volume, in parts of the tool's
  double extent = 0;                 // bounding radius about the centroid, nearly, m
  std::uint32_t begin = 0, end = 0;  // samples of a block or cell taken whole
};

VPM_HD inline PieceShape shape_of(const CellSample& sample, const SampleFaces& faces) {
  const FaceInRow face = faces.of(sample);
  return {face == nullptr ? sample.radius : number_of(face, FaceRow::farthest), face};
}
VPM_HD inline ToolPiece piece_of(const CellSample& sample, const SampleFaces& faces) {
  const PieceShape shape = shape_of(sample, faces);
  return {widen(sample.center), shape, sample.weight, shape.radius, 0, 0};
}
VPM_HD inline ToolPiece piece_of_ball(const CellSample& sample) {
  return {widen(sample.center), {sample.radius, nullptr}, sample.weight, sample.radius, 0, 0};
}
VPM_HD inline ToolPiece piece_of(const BlockMass& mass, const CellBlock& block) {
  return {mass.centroid, {}, mass.weight, block.radius, block.begin, block.end};
}
VPM_HD inline ToolPiece piece_of(const BlockMass& mass, const CellView& cell) {
  ToolPiece piece{mass.centroid, {}, mass.weight, cell.radius, 0, 0};
  if (cell.begin < cell.end) {
    piece.begin = cell.blocks[cell.begin].begin;
    piece.end = cell.blocks[cell.end - 1].end;
  }
  return piece;
}

// Describes a plane that cuts the tool, in the surface's frame and about the tool's centre of mass.
struct ClipPlane {
  TangentPlane seen;
  Vec3 normal;
  double height = 0;  // signed distance of the centre of mass from the plane, m

  ClipPlane() = default;
  VPM_HD ClipPlane(const TangentPlane& plane, const Pose& to_surface)
      : seen(plane),
        normal(transpose(to_surface.rotation) * plane.normal),
        height(plane.distance(to_surface.translation)) {}
  VPM_HD double distance(Vec3 about_center_of_mass) const {
    return dot(normal, about_center_of_mass) + height;
  }
};

// Holds volume and first moment of the parts of samples behind a plane.
struct ClippedMoments {
  double weight = 0;
  Vec3 moment;  // sum of each weight times its sample's centre
  bool is_cut = false;
};
// Number of partial sums of ClippedMoments: sample k goes to row k % kSumRows, and rows are added
// pairwise by halves. Vector lanes or threads can each add a row and get the same bits.
inline constexpr std::uint32_t kSumRows = 16;

// Returns the weight of a piece behind a plane with this normal, at these signed distances, m, from
// the piece's middle, and in `is_cut` whether the plane cuts it. It has no branches, since vector
// lanes would all wait for the slowest. Real is double or a vector; Shape is BallShape<Real>,
// FaceShape<Real> or, of doubles, PieceShape.
template <class Shape, class Real, class Mask>
[[gnu::always_inline]] VPM_HD inline Real weight_behind(const Shape& shape, const Vec3& normal,
                                                        const Real& distance, const Real& weight,
                                                        Mask& is_cut) {
  const Mask reached = distance < shape.reach_toward(normal);
  is_cut = reached & (distance > -shape.reach_away(normal));
  const Real part = weight * shape.fraction_of_cut(distance, normal);
  return reached ? (is_cut ? part : weight) : Real{};
}
// Adds the part of a sample of this shape behind a plane to its row. Adds zeros too, so that no row
// is ever -0.
template <class Shape>
VPM_HD inline void add_to_row(const Shape& shape, const CellSample& sample, const ClipPlane& plane,
                              ClippedMoments& row, bool& is_cut) {
  bool cut = false;
  const double inside = weight_behind(shape, plane.normal, plane.distance(widen(sample.center)),
                                      double{sample.weight}, cut);
  is_cut |= cut;
  row.weight += inside;
  row.moment += inside * widen(sample.center);
}
// Returns the clipped moments of samples, one after another.
VPM_HD inline ClippedMoments clipped_in_turn(const ClipPlane& plane, const CellSample* samples,
                                             std::uint32_t count, const SampleFaces& faces) {
  ClippedMoments rows[kSumRows];
  for (std::uint32_t k = 0; k < count; ++k)
    add_to_row(shape_of(samples[k], faces), samples[k], plane, rows[k % kSumRows], rows[0].is_cut);
  for (std::uint32_t half = kSumRows / 2; half > 0; half /= 2) {
    for (std::uint32_t r = 0; r < half; ++r) {
      rows[r].weight += rows[r + half].weight;
      rows[r].moment += rows[r + half].moment;
    }
  }
  return rows[0];
}

}  // namespace vpm
