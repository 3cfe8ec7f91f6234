// Arithmetic of normals: from a window's sums to a unit vector. IEEE operations and square roots
// only, in a fixed order, so that every compiler and device gives the same bits. Everything is
// inlined, since calls inside loops over pixels prevent vector code.
//
// Real is float, double, or a vector of these (core/lanes.h).
#pragma once

#include <type_traits>

#include "libvpm/cloud/camera.h"
#include "libvpm/cloud/window_span.h"

namespace vpm {

// Sums over a column or a window of inverse depth s, and of s times the offset from the middle.
// They are accumulated as differences from the centre, so that floats keep their digits.
template <class Real>
struct PlaneColumn {
  Real s{}, vs{};
};
template <class Real>
struct PlaneWindow {
  Real s{}, us{}, vs{};
};

// Accumulates a column outwards from its pixel in the centre's row. Pixels beyond the image must be
// given as equal to that pixel.
template <class Real>
struct PlaneRows {
  Real centre{}, off{}, v_off{};

  [[gnu::always_inline]] VPM_HD void add(const Real& below, const Real& above, float distance) {
    const Real b = below - centre, a = above - centre;
    off += b + a;
    add_times<Real>(distance, b - a, v_off);
  }
  template <class Down>
  [[gnu::always_inline]] VPM_HD PlaneColumn<Real> sums(const Down& down) const {
    return {off + static_cast<float>(down.count()) * centre, down.about_middle(v_off, off)};
  }
};
// Sums a column; at(dv) returns the inverse depth of each of its pixels inside the image.
template <class Real, class Down, class At>
[[gnu::always_inline]] VPM_HD inline PlaneColumn<Real> sum_rows(const Down& down, int radius,
                                                                const At& at) {
  PlaneRows<Real> rows{.centre = at(0)};
  const auto held = [&](int dv) __attribute__((always_inline)) {
    return down.has(dv) ? at(dv) : rows.centre;
  };
#ifdef __CUDA_ARCH__
#pragma unroll
#endif
  for (int d = 1; d <= radius; ++d) rows.add(held(d), held(-d), static_cast<float>(d));
  return rows.sums(down);
}
// Accumulates columns outwards from the window's central column. Columns beyond the image must be
// given as equal to it in s and zero in vs.
template <class Real>
struct PlaneColumns {
  Real centre, off{}, u_off{}, vs;

  [[gnu::always_inline]] VPM_HD explicit PlaneColumns(const PlaneColumn<Real>& column)
      : centre(column.s), vs(column.vs) {}
  [[gnu::always_inline]] VPM_HD void add(const PlaneColumn<Real>& right,
                                         const PlaneColumn<Real>& left, float distance) {
    const Real r = right.s - centre, l = left.s - centre;
    off += r + l;
    add_times<Real>(distance, r - l, u_off);
    vs += right.vs + left.vs;
  }
  template <class Across>
  [[gnu::always_inline]] VPM_HD PlaneWindow<Real> sums(const Across& across) const {
    return {off + static_cast<float>(across.count()) * centre, across.about_middle(u_off, off), vs};
  }
};
// Sums a window; column(du) returns the sums of each column inside the image.
template <class Real, class Across, class Column>
[[gnu::always_inline]] VPM_HD inline PlaneWindow<Real> sum_columns(const Across& across, int radius,
                                                                   const Column& column) {
  PlaneColumns<Real> sums(column(0));
  const auto held = [&](int du) __attribute__((always_inline)) {
    return across.has(du) ? column(du) : PlaneColumn<Real>{sums.centre, {}};
  };
#ifdef __CUDA_ARCH__
#pragma unroll
#endif
  for (int d = 1; d <= radius; ++d) sums.add(held(d), held(-d), static_cast<float>(d));
  return sums.sums(across);
}

// Returns the unit normal, towards the sensor, of the plane whose inverse depth at offset (du, dv)
// from pixel (u, v) is a du + b dv + c. With u = fx X/Z + cx, that plane is a fx X + b fy Y + (a
// (cx - u) + b (cy - v) + c) Z = 1. (du_axis, dv_axis) is the optical axis (cx - u, cy - v).
struct PlaneSlopes {
  float a, b, c;
};

[[gnu::always_inline]] VPM_HD inline Vec3f normal_of_plane(const PlaneSlopes& plane, float fx,
                                                           float fy, float du_axis, float dv_axis) {
  const float x = plane.a * fx, y = plane.b * fy;
  const float z = plane.a * du_axis + plane.b * dv_axis + plane.c;
  const float scale = -reciprocal(square_root(x * x + y * y + z * z));
  return {x * scale, y * scale, z * scale};
}

// Returns slopes, and inverse depth at the window's middle, relative to the centre's inverse depth.
[[gnu::always_inline]] VPM_HD inline PlaneSlopes plane_of_sums(const WindowShape& shape,
                                                               const PlaneWindow<float>& sums,
                                                               float centre) {
  const float unit = reciprocal(centre);
  return {sums.us * shape.per_us * unit, sums.vs * shape.per_vs * unit,
          sums.s * shape.per_count * unit};
}
// Returns the normal of a smooth window. Zero if the plane is behind the sensor at the window's
// centre: without an edge gate, a window cut by the image's border can be that wild.
[[gnu::always_inline]] VPM_HD inline Vec3f normal_of_smooth_window(const WindowShape& shape,
                                                                   const PlaneSlopes& plane,
                                                                   float fx, float fy,
                                                                   float du_axis, float dv_axis) {
  const bool found = plane.c - (plane.a * shape.u + plane.b * shape.v) > 0;
  const Vec3f n = normal_of_plane(plane, fx, fy, du_axis - shape.u, dv_axis - shape.v);
  return {found ? n.x : 0, found ? n.y : 0, found ? n.z : 0};
}

// True if a gated window keeps a pixel: its inverse depth `value` is measured, and `difference`
// (value relative to the centre's, minus 1) is within `allowed` of what the centre's surface has
// there, `expected`.
template <class Real>
[[gnu::always_inline]] VPM_HD inline auto is_in_gate(Real value, Real difference, Real expected,
                                                     std::type_identity_t<Real> allowed) {
  const Real off = difference - expected;
  return (off <= allowed) & (off >= -allowed) & (value > 0.0F);
}

// True if a pixel is measured and differs from the centre by more than the gate.
template <class Real>
[[gnu::always_inline]] VPM_HD inline auto is_beyond_gate(Real value, Real difference, Real gate) {
  return ((difference > gate) | (difference < -gate)) & (value > 0.0F);
}

// Sums eight columns pairwise; columns that the window lacks must be 0. Gated windows use this
// order.
inline constexpr int kFoldedColumns = 8;
template <class Sums>
[[gnu::always_inline]] VPM_HD inline Sums fold(const Sums* c) {
  return ((c[0] + c[4]) + (c[2] + c[6])) + ((c[1] + c[5]) + (c[3] + c[7]));
}

// Sums over kept pixels of 1, du, dv, their products, the difference e, and e du, e dv.
template <class Real>
struct SumsOfPlane {
  Real n{}, u{}, v{}, uu{}, uv{}, vv{}, e{}, ue{}, ve{};
};

// Plane of inverse depth relative to the centre's, minus 1: c + a du + b dv. All zero if too few
// pixels remain or they are collinear.
template <class Real>
struct FittedPlane {
  using Mask = decltype(Real() < Real());
  Mask found{};
  Real a{}, b{}, c{};
};
using WindowPlane = FittedPlane<float>;

// Returns 1 / a for floats and vectors of floats; devices have only the former.
template <class Real>
[[gnu::always_inline]] VPM_HD inline Real one_over(const Real& a) {
  if constexpr (std::is_same_v<Real, float>)
    return quotient(1.0F, a);
  else
    return 1.0F / a;
}

template <class Real>
[[gnu::always_inline]] VPM_HD inline FittedPlane<Real> fit_plane(const SumsOfPlane<Real>& s) {
  // Moments about the mean, times n. For collinear pixels both products of the determinant are
  // equal.
  const Real uu = s.n * s.uu - s.u * s.u, uv = s.n * s.uv - s.u * s.v, vv = s.n * s.vv - s.v * s.v;
  const Real determinant = uu * vv - uv * uv;
  const auto found = static_cast<typename FittedPlane<Real>::Mask>(
      (s.n >= float{kMinSupport}) & (determinant >= kMinSpread * s.n * s.n * (uu + vv)));
  const Real ue = s.n * s.ue - s.u * s.e, ve = s.n * s.ve - s.v * s.e;
  // One division serves 1 / determinant and 1 / n.
  const Real both = one_over<Real>(determinant * s.n);
  const Real unit = both * s.n, per_n = both * determinant;
  const Real a = (ue * vv - ve * uv) * unit;
  const Real b = (ve * uu - ue * uv) * unit;
  const Real c = (s.e - a * s.u - b * s.v) * per_n;
  return {found, found ? a : Real{}, found ? b : Real{}, found ? c : Real{}};
}

// Returns the normal of a gated window. Zero if no plane was found, or if the extrapolated plane
// passes behind the sensor at the centre.
[[gnu::always_inline]] VPM_HD inline Vec3f normal_of_window(const WindowPlane& plane, float fx,
                                                            float fy, float du_axis,
                                                            float dv_axis) {
  const float height = 1 + plane.c;
  const bool found = plane.found & (height > 0);
  const Vec3f n = normal_of_plane({plane.a, plane.b, height}, fx, fy, du_axis, dv_axis);
  return {found ? n.x : 0, found ? n.y : 0, found ? n.z : 0};
}

}  // namespace vpm
