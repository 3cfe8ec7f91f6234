// Depth below a convex solid with few faces: the distance below the nearest of their planes. It is
// concave and linear below each face, so integrals of it are exact.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "libvpm/core/pose.h"
#include "libvpm/model/solid.h"
#include "libvpm/solid/depth_grid.h"

namespace vpm {

// ∫ depth dA and ∫ depth x dA over a flat piece.
struct DepthIntegral {
  double volume = 0;
  Vec3 moment;
};
inline DepthIntegral operator*(double s, const DepthIntegral& of) {
  return {s * of.volume, s * of.moment};
}

class FacePlanes {
 public:
  // All x with normal.x = offset; the normal is of unit length and points out of the solid.
  struct Plane {
    Vec3 normal;
    double offset;
    double depth(Vec3 x) const { return offset - dot(normal, x); }
  };
  // Solids with more faces are sampled, since an integral takes time of the square of how many are
  // near.
  static constexpr std::size_t kMost = 32;

  // Returns the planes of a closed surface about the origin whose vertices are no further from it
  // than `reach`, if it is convex and has no more than kMost.
  static std::optional<FacePlanes> of(std::span<const Vec3> vertices,
                                      std::span<const Triangle> triangles, double reach);

  // Returns the depth of x below the nearest plane and its gradient: negative outside of the solid,
  // and then no further from 0 than the solid is away.
  Depth depth(Vec3 x) const;
  // Returns that depth at x if it is linear within a radius of x.
  std::optional<Depth> linear_depth(Vec3 x, double radius) const;

  // Takes the planes of a solid at a pose, in units of which one metre has `per_metre`.
  void place(const FacePlanes& own, const Pose& pose, double per_metre);

  // Planes that are nearest below some part of a triangle.
  class Near {
   public:
    // What is told of a triangle, parts of which may be outside of the solid.
    struct OfTriangle {
      DepthIntegral integral;  // negative for a triangle that is oriented against `normal`
      double greatest = 0;     // depth
      Vec3 deepest;            // where it is that deep, if it is more than 0
    };
    // Integrates the depth over a triangle in a plane with this unit normal, which must be a part
    // of that of which the planes are.
    OfTriangle of_triangle(const std::array<Vec3, 3>& corner, Vec3 normal) const;

   private:
    friend class FacePlanes;
    Near(std::span<const Plane> planes, const std::array<Vec3, 3>& corner);

    std::array<Plane, kMost> planes_;
    std::size_t count_ = 0;
  };
  Near near(const std::array<Vec3, 3>& corner) const { return {planes_, corner}; }

  std::size_t bytes() const { return planes_.size() * sizeof planes_[0]; }

 private:
  std::vector<Plane> planes_;
};

}  // namespace vpm
