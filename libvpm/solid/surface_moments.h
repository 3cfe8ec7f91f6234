// Integrals over a piece of surface with unit normal n: what the divergence theorem needs for the
// volume, its centroid and its gradient, and what a force linear in x needs.
#pragma once

#include <array>

#include "libvpm/core/pose.h"
#include "libvpm/core/vector_width.h"

namespace vpm {

// Products of coordinates in the order xx, yy, zz, xy, xz, yz.
using Products = std::array<double, 6>;

VPM_HD inline Products operator*(double s, const Products& p) {
  return {s * p[0], s * p[1], s * p[2], s * p[3], s * p[4], s * p[5]};
}
// Multiplies the symmetric matrix of the products by v.
VPM_HD inline Vec3 times(const Products& p, Vec3 v) {
  return {p[0] * v.x + p[3] * v.y + p[4] * v.z, p[3] * v.x + p[1] * v.y + p[5] * v.z,
          p[4] * v.x + p[5] * v.y + p[2] * v.z};
}

// Products in vectors: xx, yy, zz and xy in one of them, xz and yz in the other.
template <class Four>
struct ProductLanes {
  Four four, two;
};

// Returns the mean of the products over the triangle a, b, c (exact for polynomials of degree 2).
template <class Four = FourNumbers>
[[gnu::always_inline]] VPM_HD inline ProductLanes<Four> mean_product_lanes(Vec3 a, Vec3 b, Vec3 c) {
  ProductLanes<Four> sum{};
  const Vec3 places[]{a, b, c, a + b + c};
  for (const Vec3& v : places) {
    sum.four += Four{v.x, v.y, v.z, v.x} * Four{v.x, v.y, v.z, v.y};
    sum.two += Four{v.x, v.y, 0, 0} * Four{v.z, v.z, 0, 0};
  }
  return {sum.four / 12, sum.two / 12};
}
VPM_HD inline Products mean_products(Vec3 a, Vec3 b, Vec3 c) {
  const auto [four, two] = mean_product_lanes(a, b, c);
  return {four[0], four[1], four[2], four[3], two[0], two[1]};
}

struct SurfaceMoments {
  Vec3 area;              // ∫ n dA, m^2
  Vec3 by_x, by_y, by_z;  // ∫ x n dA, ∫ y n dA, ∫ z n dA, m^3
  Vec3 first;             // ∫ x (x.n) dA, m^4: four times ∫ x dV of what the surface encloses

  // Returns ∫ x.n dA: three times the volume that the surface encloses.
  VPM_HD double flux() const { return by_x.x + by_y.y + by_z.z; }
  // Returns ∫ x cross n dA.
  VPM_HD Vec3 turn() const { return {by_y.z - by_z.y, by_z.x - by_x.z, by_x.y - by_y.x}; }

  VPM_HD void add(const SurfaceMoments& o) {
    area += o.area, by_x += o.by_x, by_y += o.by_y, by_z += o.by_z, first += o.first;
  }
};

// Returns the moments of a flat piece with the area vector `area` times `fraction`, given
// ∫ x dA / |area| and ∫ x x dA / |area|.
VPM_HD inline SurfaceMoments flat_moments(Vec3 area, double fraction, Vec3 mean,
                                          const Products& products) {
  return {fraction * area, mean.x * area, mean.y * area, mean.z * area, times(products, area)};
}

VPM_HD inline SurfaceMoments triangle_moments(Vec3 a, Vec3 b, Vec3 c) {
  return flat_moments(0.5 * cross(b - a, c - a), 1, (a + b + c) / 3, mean_products(a, b, c));
}

// Returns the moments of a surface that is moved by a pose.
inline SurfaceMoments moved(const SurfaceMoments& m, const Pose& pose) {
  const Rotation& r = pose.rotation;
  const Vec3 t = pose.translation, back = transpose(r) * t, area = r * m.area;
  // ∫ x (t.n) dA about the old origin.
  const Vec3 along{dot(m.by_x, back), dot(m.by_y, back), dot(m.by_z, back)};
  const Vec3 x = r * m.by_x, y = r * m.by_y, z = r * m.by_z;
  const auto by = [&](Vec3 row, double shift) {
    return row.x * x + row.y * y + row.z * z + shift * area;
  };
  return {area, by(r.row0, t.x), by(r.row1, t.y), by(r.row2, t.z),
          r * (m.first + along) + (m.flux() + dot(t, area)) * t};
}

// Returns the moments of a surface that is `s` times as large.
VPM_HD inline SurfaceMoments scaled(const SurfaceMoments& m, double s) {
  const double s2 = s * s, s3 = s2 * s;
  return {s2 * m.area, s3 * m.by_x, s3 * m.by_y, s3 * m.by_z, s3 * s * m.first};
}

// Second moments beside, for forces that are linear over a piece.
struct ForceMoments {
  SurfaceMoments surface;
  std::array<Vec3, 6> by_product;  // ∫ xx n dA and so on, in the order of Products

  void add(const ForceMoments& o) {
    surface.add(o.surface);
    for (std::size_t k = 0; k < by_product.size(); ++k) by_product[k] += o.by_product[k];
  }
};

// Returns the moments of a flat piece as flat_moments() does.
inline ForceMoments flat_force_moments(Vec3 area, double fraction, Vec3 mean, const Products& p) {
  ForceMoments m{flat_moments(area, fraction, mean, p), {}};
  for (std::size_t k = 0; k < p.size(); ++k) m.by_product[k] = p[k] * area;
  return m;
}

inline ForceMoments triangle_force_moments(Vec3 a, Vec3 b, Vec3 c) {
  return flat_force_moments(0.5 * cross(b - a, c - a), 1, (a + b + c) / 3, mean_products(a, b, c));
}

}  // namespace vpm
