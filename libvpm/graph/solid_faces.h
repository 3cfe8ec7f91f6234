// Finds the face of a solid beside a piece of it, and the shape that ends there.
#pragma once

#include <optional>

#include "libvpm/mesh/triangle_bvh.h"
#include "libvpm/model/tool_model.h"

namespace vpm {

// Symmetric matrix of second moments.
struct Moment {
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;

  static Moment of_ball(double radius) {
    const double each = radius * radius / 5;
    return {each, each, each, 0, 0, 0};
  }
  // Adds a box with edges along the axes, of this weight, about `d`.
  void add(double weight, Vec3 d, Vec3 half_edges) {
    xx += weight * (d.x * d.x + half_edges.x * half_edges.x / 3);
    yy += weight * (d.y * d.y + half_edges.y * half_edges.y / 3);
    zz += weight * (d.z * d.z + half_edges.z * half_edges.z / 3);
    xy += weight * d.x * d.y;
    xz += weight * d.x * d.z;
    yz += weight * d.y * d.z;
  }
  void scale(double by) {
    for (double* const entry : {&xx, &yy, &zz, &xy, &xz, &yz}) *entry *= by;
  }
  // Returns the moment along a unit vector.
  double along(Vec3 u) const {
    return u.x * (xx * u.x + 2 * (xy * u.y + xz * u.z)) + u.y * (yy * u.y + 2 * yz * u.z) +
           zz * u.z * u.z;
  }
};

class SolidFaces {
 public:
  // `boundary` is closed and without crossings. `radius` is its largest distance from the centre of
  // mass.
  SolidFaces(const Solid& boundary, double radius);

  // Returns the shape of a piece about a centroid in the solid, of this moment radius and second
  // moment per volume; none where the ball of that radius stays within the solid. Moves a centroid
  // that lies outside by rounding, or on the surface, to just below it. Thread-safe.
  std::optional<SampleFace> beside(Vec3& centroid, double radius, const Moment& moment) const;

 private:
  TriangleBvh tree_;
  double excess_;  // by which shapes may stick out of curved faces
};

}  // namespace vpm
