// Defines the shapes that stand for a compact piece of the tool: how far one reaches toward a
// plane, and which fraction of it a plane leaves behind. The rest of the measure and the bodies of
// the scene ask these two functions and do not know which shape that is. Contacts also ask where
// the plane cuts it, and how much of it lies how far behind.
#pragma once

#include <cstdint>

#include "libvpm/core/division.h"
#include "libvpm/core/host_device.h"
#include "libvpm/core/pose.h"
#include "libvpm/core/vector_width.h"
#include "libvpm/model/tool_model.h"

namespace vpm {

// Replaces a piece by the ball with its second moment. The fraction of a thin layer depends on the
// second moment only, so the ball is right to second order for any compact piece. Real is double,
// or a vector of doubles; Normal is a direction for each.
template <class Real>
struct BallShape {
  Real radius;

  // Returns the extent of the piece from its middle toward a plane with this normal, m.
  template <class Normal>
  [[gnu::always_inline]] VPM_HD constexpr Real reach_toward(const Normal& /*normal*/) const {
    return radius;
  }
  // Returns its extent the other way, m.
  template <class Normal>
  [[gnu::always_inline]] VPM_HD constexpr Real reach_away(const Normal& /*normal*/) const {
    return radius;
  }
  // Returns the fraction of the piece behind a plane that cuts it at this signed distance, m.
  template <class Normal>
  [[gnu::always_inline]] VPM_HD Real fraction_of_cut(const Real& distance,
                                                     const Normal& /*normal*/) const {
    const Real in_radii = quotient(distance, radius), away = 1 - in_radii;
    return away * away * (2 + in_radii) / 4;
  }
  // Returns how fast that fraction grows as the plane rises, 1/m: the area in which the plane cuts
  // the piece, in parts of its volume.
  template <class Normal>
  [[gnu::always_inline]] VPM_HD Real section_of_cut(const Real& distance,
                                                    const Normal& /*normal*/) const {
    const Real in_radii = quotient(distance, radius);
    return quotient(3 * (1 - in_radii) * (1 + in_radii), 4 * radius);
  }
  // Returns how far the part behind lies behind the piece's middle, along the normal, times the
  // fraction that it is, m.
  template <class Normal>
  [[gnu::always_inline]] VPM_HD Real moment_of_cut(const Real& distance,
                                                   const Normal& /*normal*/) const {
    const Real in_radii = quotient(distance, radius), section = (1 - in_radii) * (1 + in_radii);
    return 3 * radius * section * section / 16;
  }
};

// Replaces a piece beside a face of the solid (SampleFace) by one that ends there, so that nothing
// is behind a plane before the solid is: balls would stick out of the face, all to the same side.
// Seen along a plane's normal it is a density over its extent: the polynomial of the second degree
// with the piece's volume, centroid and second moment. Along the axis that is a layer that ends at
// the face at once, across the axis the density of a ball. Extents and second moment are those of
// two halves of ellipsoids, so both change smoothly as the normal turns. Normals are in the tool's
// axes.
template <class Real>
struct FaceShape {
  PlaceOf<Real> axis;
  Real across;               // square of the extent across the axis, m^2
  Real toward, away, along;  // by how much those of SampleFace along it are larger, m^2

  template <class Normal>
  [[gnu::always_inline]] VPM_HD Real reach_toward(const Normal& normal) const {
    const Real cosine = dot(normal, axis);
    return extent(cosine, cosine < Real{} ? toward : away);
  }
  template <class Normal>
  [[gnu::always_inline]] VPM_HD Real reach_away(const Normal& normal) const {
    const Real cosine = dot(normal, axis);
    return extent(cosine, cosine < Real{} ? away : toward);
  }
  template <class Normal>
  [[gnu::always_inline]] VPM_HD Real fraction_of_cut(const Real& distance,
                                                     const Normal& normal) const {
    return density_along(normal).fraction(distance);
  }
  template <class Normal>
  [[gnu::always_inline]] VPM_HD Real section_of_cut(const Real& distance,
                                                    const Normal& normal) const {
    return density_along(normal).section(distance);
  }
  template <class Normal>
  [[gnu::always_inline]] VPM_HD Real moment_of_cut(const Real& distance,
                                                   const Normal& normal) const {
    return density_along(normal).moment(distance);
  }

 private:
  // A density of volume 1 over [-1, 1], (1 + 2 tilt s + bend (3 s^2 - 1)) / 2, stretched to the
  // piece's extent; distances are those of planes above the piece's middle.
  struct Density {
    Real middle, width;  // twice the height of the extent's middle, and the extent, m
    Real per_width, tilt, bend;

    [[gnu::always_inline]] VPM_HD Real place(const Real& distance) const {
      return (2 * distance - middle) * per_width;
    }
    [[gnu::always_inline]] VPM_HD Real fraction(const Real& distance) const {
      const Real s = place(distance), one = Real{} + 1;
      const Real part = 0.5 * (1 - s) * (1 + (1 + s) * (tilt + bend * s));
      const Real least = part > Real{} ? part : Real{};  // rounding may pass both
      return least < one ? least : one;
    }
    [[gnu::always_inline]] VPM_HD Real section(const Real& distance) const {
      const Real s = place(distance);
      return per_width * (1 + 2 * tilt * s + bend * (3 * s * s - 1));
    }
    [[gnu::always_inline]] VPM_HD Real moment(const Real& distance) const {
      const Real s = place(distance), square = s * s, rest = 1 - square;
      return 0.5 *
             (middle * fraction(distance) +
              width * (rest * (2 + bend * (1 + 3 * square)) / 8 + tilt * (1 - s * square) / 3));
    }
  };
  template <class Normal>
  [[gnu::always_inline]] VPM_HD Density density_along(const Normal& normal) const {
    const Real cosine = dot(normal, axis), five_variances = across + cosine * cosine * along;
    const Real below = reach_toward(normal), above = reach_away(normal);
    const Real middle = below - above, width = below + above, per_width = quotient(1, width);
    return {middle, width, per_width, -1.5 * middle * per_width,
            (3 * five_variances + 3.75 * middle * middle) * per_width * per_width - 1.25};
  }
  [[gnu::always_inline]] VPM_HD Real extent(const Real& cosine, const Real& larger) const {
    const Real square = across + cosine * cosine * larger;
    return square_root(square > Real{} ? square : Real{});
  }
};

// Holds four neighbouring samples, of which one at least is beside a face, as vectors load them:
// their centres, the numbers of their shapes, and how far each reaches from its middle at most, m.
// Lanes past the block's last sample repeat it without weight, so that they are read where it is. A
// ball has the shape whose extents are all its radius.
struct alignas(16) FaceRow {
  enum Number { x, y, z, axis_x, axis_y, axis_z, across, toward, away, along, farthest, kNumbers };
  static constexpr std::uint32_t kLanes = kNeighborSamples;

  // Keeps `farthest` a bound, though axes are unit vectors only as floats are.
  static constexpr float kMargin = 1 + 2e-5F;

  double weights[kLanes] = {};
  float numbers[kNumbers * kLanes] = {};  // number n of lane k at n kLanes + k

  // Sets a lane to a sample and its face; its `sample` is not asked.
  void set(std::uint32_t lane, const CellSample& sample, const SampleFace& face) {
    const float all[] = {sample.center.x,
                         sample.center.y,
                         sample.center.z,
                         face.axis.x,
                         face.axis.y,
                         face.axis.z,
                         face.across,
                         face.toward,
                         face.away,
                         face.along,
                         kMargin * (face.along > face.across ? face.along : face.across)};
    static_assert(sizeof(all) == kNumbers * sizeof(float));
    for (std::uint32_t n = 0; n < kNumbers; ++n) numbers[n * kLanes + lane] = all[n];
    weights[lane] = sample.weight;
  }
  // Fills the lanes after `last` with its numbers, without weight.
  void repeat(std::uint32_t last) {
    for (std::uint32_t lane = last + 1; lane < kLanes; ++lane) {
      for (std::uint32_t n = 0; n < kNumbers; ++n)
        numbers[n * kLanes + lane] = numbers[n * kLanes + last];
    }
  }
};
// Points to the numbers of one sample in a FaceRow, which lie FaceRow::kLanes apart.
using FaceInRow = const float*;
VPM_HD inline double number_of(FaceInRow face, FaceRow::Number number) {
  return double{face[number * FaceRow::kLanes]};
}
// Returns the shape whose numbers `number` returns.
template <class Real, class Number>
[[gnu::always_inline]] VPM_HD inline FaceShape<Real> face_shape(const Number& number) {
  const Real across = number(FaceRow::across), beside = across * across;
  const auto larger = [&](FaceRow::Number of) __attribute__((always_inline)) {
    const Real extent = number(of);
    return extent * extent - beside;
  };
  return {{number(FaceRow::axis_x), number(FaceRow::axis_y), number(FaceRow::axis_z)},
          beside,
          larger(FaceRow::toward),
          larger(FaceRow::away),
          larger(FaceRow::along)};
}
VPM_HD inline FaceShape<double> shape_of(FaceInRow face) {
  return face_shape<double>([face](FaceRow::Number number) { return number_of(face, number); });
}

// The shape of a piece: a ball, or that of a sample beside a face. Normals are in the tool's axes.
struct PieceShape {
  double radius = 0;         // of the ball, m
  FaceInRow face = nullptr;  // of a sample beside one

  VPM_HD double reach_toward(const Vec3& normal) const {
    return face == nullptr ? radius : shape_of(face).reach_toward(normal);
  }
  VPM_HD double reach_away(const Vec3& normal) const {
    return face == nullptr ? radius : shape_of(face).reach_away(normal);
  }
  VPM_HD double fraction_of_cut(double distance, const Vec3& normal) const {
    return face == nullptr ? BallShape<double>{radius}.fraction_of_cut(distance, normal)
                           : shape_of(face).fraction_of_cut(distance, normal);
  }
  VPM_HD double section_of_cut(double distance, const Vec3& normal) const {
    return face == nullptr ? BallShape<double>{radius}.section_of_cut(distance, normal)
                           : shape_of(face).section_of_cut(distance, normal);
  }
  VPM_HD double moment_of_cut(double distance, const Vec3& normal) const {
    return face == nullptr ? BallShape<double>{radius}.moment_of_cut(distance, normal)
                           : shape_of(face).moment_of_cut(distance, normal);
  }
};
// The same for normals in a frame that the tool's axes are turned to.
struct TurnedShape {
  PieceShape shape;
  const Rotation& to_frame;

  VPM_HD double reach_toward(const Vec3& normal) const {
    return shape.reach_toward(in_tool(normal));
  }
  VPM_HD double reach_away(const Vec3& normal) const { return shape.reach_away(in_tool(normal)); }
  VPM_HD double fraction_of_cut(double distance, const Vec3& normal) const {
    return shape.fraction_of_cut(distance, in_tool(normal));
  }

 private:
  VPM_HD Vec3 in_tool(const Vec3& normal) const {
    return shape.face == nullptr ? normal : transpose(to_frame) * normal;
  }
};

// Tells where a body lies: before a plane, toward its normal, behind it, or on both sides.
enum class PlaneSide : std::uint8_t { before, cut, behind };
// Returns the side of a body whose middle is at this signed distance and that reaches so far toward
// the plane, and as far the other way. A body that only touches the plane is not cut.
VPM_HD constexpr PlaneSide side_of_plane(double distance, double reach) {
  return distance >= reach    ? PlaneSide::before
         : distance <= -reach ? PlaneSide::behind
                              : PlaneSide::cut;
}
// Returns the side of a piece whose middle is at this signed distance from a plane.
template <class Shape>
VPM_HD PlaneSide side_of_piece(const Shape& shape, double distance, const Vec3& normal) {
  return distance >= shape.reach_toward(normal)  ? PlaneSide::before
         : distance <= -shape.reach_away(normal) ? PlaneSide::behind
                                                 : PlaneSide::cut;
}

// Returns the fraction of a piece behind a plane with this normal at this signed distance, m, from
// the piece's middle: 0 where the plane has all of it before it, 1 where it has all of it behind.
template <class Shape>
VPM_HD double fraction_behind(const Shape& shape, double distance, const Vec3& normal) {
  const PlaneSide side = side_of_piece(shape, distance, normal);
  return side == PlaneSide::before   ? 0
         : side == PlaneSide::behind ? 1
                                     : shape.fraction_of_cut(distance, normal);
}

// Do the same for a piece that may be beside a face. They are never inlined: most pieces are balls,
// and the code that asks those keeps its few instructions, and on a device its few registers.
[[gnu::noinline]] VPM_HD inline PlaneSide side_of_piece(const TurnedShape& shape, double distance,
                                                        const Vec3& normal) {
  return side_of_piece<TurnedShape>(shape, distance, normal);
}
[[gnu::noinline]] VPM_HD inline double fraction_behind(const TurnedShape& shape, double distance,
                                                       const Vec3& normal) {
  return fraction_behind<TurnedShape>(shape, distance, normal);
}

}  // namespace vpm
