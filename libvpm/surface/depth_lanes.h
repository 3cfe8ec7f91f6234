// The surface of a camera at four places at once: DepthSurface by vectors, with its bits. Where it
// decides by branches, lanes here compute both sides and choose. Not for device code.
#pragma once

#include "libvpm/core/vec3x4.h"
#include "libvpm/surface/depth_surface.h"

namespace vpm {

// A reading in each lane; what is not known is of no meaning.
struct LaneReading {
  Mask4 known;
  Double4 distance;
  Vec3x4 normal, foot;
  Int4 u, v;  // nearest pixel

  LaneReading() = default;
  // Of known ones, in an image of that width.
  [[gnu::always_inline]] LaneReading(const Reading& a, const Reading& b, const Reading& c,
                                     const Reading& d, std::int32_t width)
      : known(~Mask4{}),
        distance{a.distance, b.distance, c.distance, d.distance},
        normal(a.normal, b.normal, c.normal, d.normal),
        foot(a.foot, b.foot, c.foot, d.foot) {
    const Int4 pixel{static_cast<std::int32_t>(a.point), static_cast<std::int32_t>(b.point),
                     static_cast<std::int32_t>(c.point), static_cast<std::int32_t>(d.point)};
    v = pixel / width;
    u = pixel - v * width;
  }

  [[gnu::always_inline]] Reading of(int lane, std::int32_t width) const {
    if (known[lane] == 0) return {};
    return {true, distance[lane], normal.of(lane), foot.of(lane),
            static_cast<std::uint32_t>(v[lane] * width + u[lane])};
  }
};

class DepthLanes {
 public:
  [[gnu::always_inline]] explicit DepthLanes(const DepthSurface& surface) : surface_(surface) {}

  [[gnu::always_inline]] LaneReading read(const Vec3x4& x) const {
    const Depth depth = look_up(x);
    LaneReading reading;
    reading.known = depth.known;
    reading.u = depth.u, reading.v = depth.v;
    const Vec3x4 normal = normals(pixels(depth.u, depth.v));
    const Double4 to_foot = 1 / (x.z * depth.inverse_depth);
    reading.foot = to_foot * x;
    const Double4 along = dot(normal, x), squared_length = squared_norm(x);
    const Mask4 is_trusted =
        (along < 0) &
        (along * along >= (DepthSurface::kGrazing * DepthSurface::kGrazing) * squared_length);
    reading.normal = normal;
    reading.distance = along * (1 - to_foot);
    if (any(reading.known & ~is_trusted)) {
      const Double4 length = square_root(squared_length);
      reading.normal = choose(is_trusted, normal, -1.0 / length * x);
      reading.distance = is_trusted ? reading.distance : length * (to_foot - 1);
    }
    return reading;
  }

  [[gnu::always_inline]] Vec3x4 closest_normal(const Vec3x4& x, LaneReading reading) const {
    take_one_side(x, reading);
    Vec3x4 foot = reading.foot, normal = reading.normal;
    Double4 squared = squared_norm(x - foot);
    Vec3x4 target = x - reading.distance * normal;
    const Double4 pixel = foot.z / surface_.k.fx, near = DepthSurface::kFootPixels * pixel;
    Mask4 searches = ~Mask4{}, has_met_noise{}, has_met_groove{};
    Vec3x4 mean = normal;      // of the normals, where noise was met
    Vec3x4 below_it = normal;  // where a groove was
    for (int step = 0; step < DepthSurface::kFootSteps; ++step) {
      searches &= squared_norm(target - foot) > near * near;
      if (!any(searches)) break;
      LaneReading next = read(target);
      searches &= next.known;
      take_one_side(x, next);
      const Double4 next_squared = squared_norm(x - next.foot);
      const Mask4 is_closer = searches & (next_squared < squared);
      const Mask4 is_noise =
          searches & ~is_closer & (dot(normal, next.normal) > DepthSurface::kSmoothCosine);
      mean = choose(is_noise, normal + next.normal, mean);
      has_met_noise |= is_noise;
      searches &= ~is_noise;
      const Mask4 is_groove = searches & ~is_closer & meet_above(x, normal, foot, next);
      if (any(is_groove)) {
        below_it = choose(is_groove, below_groove(x, normal, foot, next), below_it);
        has_met_groove |= is_groove;
        searches &= ~is_groove;
      }
      target = (Double4{} + 0.5) * (foot + next.foot);
      foot = choose(is_closer, next.foot, foot);
      normal = choose(is_closer, next.normal, normal);
      squared = is_closer ? next_squared : squared;
      target = choose(is_closer, x - dot(normal, x - foot) * normal, target);
    }
    const Vec3x4 towards = foot - x;
    const Double4 above = dot(normal, towards);
    const Double4 squared_aside = squared_norm(towards - above * normal);
    const Double4 crease = DepthSurface::kCreasePixels * pixel;
    const Mask4 is_foot = (above > 0) & (squared_aside <= crease * crease) & ~has_met_noise;
    const Vec3x4 direction =
        choose(is_foot, normal, normalized_or_zero(choose(has_met_noise, mean, towards)));
    return choose(has_met_groove, below_it, direction);
  }

 private:
  static constexpr std::int32_t kAcross = DepthSurface::kAcross;

  // What DepthSurface::look_up finds, but for the normal.
  struct Depth {
    Mask4 known;
    Double4 inverse_depth;
    Int4 u, v;  // nearest pixel
  };
  [[gnu::always_inline]] Depth look_up(const Vec3x4& x) const {
    const Intrinsics& k = surface_.k;
    const std::int32_t width = surface_.width, height = surface_.height;
    const double u_end = width, v_end = height;
    const Double4 zero{}, per_depth = 1 / x.z;
    const Double4 at_u = k.fx * (x.x * per_depth) + k.cx, at_v = k.fy * (x.y * per_depth) + k.cy;
    const Mask4 seen = (x.z >= kSmallestLength) & (at_u >= -0.5) & (at_v >= -0.5) &
                       (at_u + 0.5 < u_end) & (at_v + 0.5 < v_end);
    const Double4 u = seen ? at_u : zero, v = seen ? at_v : zero;
    const Int4 un = truncated(u + 0.5), vn = truncated(v + 0.5);
    const Double4 from_u = u < 0 ? zero : u, from_v = v < 0 ? zero : v;
    const Int4 u0 = truncated(from_u), v0 = truncated(from_v);
    const Int4 u1 = u0 + 1 < width ? u0 + 1 : u0, v1 = v0 + 1 < height ? v0 + 1 : v0;
    const Double4 a = inverse_depths(pixels(u0, v0)), b = inverse_depths(pixels(u1, v0));
    const Double4 c = inverse_depths(pixels(u0, v1)), d = inverse_depths(pixels(u1, v1));
    const Mask4 left = widen_mask(un == u0), upper = widen_mask(vn == v0);
    const Double4 nearest = upper ? (left ? a : b) : (left ? c : d);
    const Double4 inverse_depth =
        DepthSurface::is_one_surface(a, b, c, d)
            ? DepthSurface::bilinear(a, b, c, d, from_u - widen(u0), from_v - widen(v0))
            : nearest;
    return {seen & (inverse_depth > 0), inverse_depth, un, vn};
  }

  [[gnu::always_inline]] Int4 pixels(const Int4& u, const Int4& v) const {
    return v * surface_.width + u;
  }
  [[gnu::always_inline]] Double4 inverse_depths(const Int4& pixels) const {
    const InverseDepthRange* all = surface_.tiles[0];
    return widen(
        Float4{all[pixels[0]].high, all[pixels[1]].high, all[pixels[2]].high, all[pixels[3]].high});
  }
  [[gnu::always_inline]] Vec3x4 normals(const Int4& pixels) const {
    const Vec3f* all = surface_.normals;
    return {all[pixels[0]], all[pixels[1]], all[pixels[2]], all[pixels[3]]};
  }

  // The pixels on either side of the nearest one, DepthSurface::kAcross away along one axis. Where
  // one lies outside of the image, both are the nearest itself.
  struct Neighbors {
    Mask4 exist;
    Int4 u[2], v[2];
    Vec3x4 normals[2];
  };
  [[gnu::always_inline]] Neighbors neighbors_in_row(const Int4& u, const Int4& v) const {
    const Int4 exist = (u >= kAcross) & (u < surface_.width - kAcross), step = exist & kAcross;
    return neighbors(exist, u - step, v, u + step, v);
  }
  [[gnu::always_inline]] Neighbors neighbors_in_column(const Int4& u, const Int4& v) const {
    const Int4 exist = (v >= kAcross) & (v < surface_.height - kAcross), step = exist & kAcross;
    return neighbors(exist, u, v - step, u, v + step);
  }
  [[gnu::always_inline]] Neighbors neighbors(const Int4& exist, const Int4& u0, const Int4& v0,
                                             const Int4& u1, const Int4& v1) const {
    return {
        widen_mask(exist), {u0, u1}, {v0, v1}, {normals(pixels(u0, v0)), normals(pixels(u1, v1))}};
  }
  [[gnu::always_inline]] static Mask4 hold_crease(const Neighbors& n, const Vec3x4& normal) {
    return n.exist & (dot(n.normals[0], n.normals[1]) < DepthSurface::kSmoothCosine) &
           (dot(n.normals[0], normal) < DepthSurface::kSameCosine) &
           (dot(n.normals[1], normal) < DepthSurface::kSameCosine);
  }

  // DepthSurface::meet_above and normal_below_groove, of the plane of a foot and that of a reading.
  [[gnu::always_inline]] static Mask4 meet_above(const Vec3x4& x, const Vec3x4& normal,
                                                 const Vec3x4& foot, const LaneReading& other) {
    return (dot(normal, other.foot - foot) > 0) & (dot(other.normal, foot - other.foot) > 0) &
           (dot(normal, x - foot) < 0) & (dot(other.normal, x - other.foot) < 0);
  }
  [[gnu::always_inline]] static Vec3x4 below_groove(const Vec3x4& x, const Vec3x4& normal,
                                                    const Vec3x4& foot, const LaneReading& other) {
    const Double4 a = dot(normal, x - foot), b = dot(other.normal, x - other.foot),
                  cosine = dot(normal, other.normal);
    const Double4 along_one = b * cosine - a, along_other = a * cosine - b;
    const Vec3x4 to_crease = normalized_or_zero(along_one * normal + along_other * other.normal);
    return choose(along_one <= 0, other.normal, choose(along_other <= 0, normal, to_crease));
  }

  [[gnu::always_inline]] void take_one_side(const Vec3x4& x, LaneReading& reading) const {
    const Neighbors row = neighbors_in_row(reading.u, reading.v);
    const Neighbors column = neighbors_in_column(reading.u, reading.v);
    const Mask4 in_row = reading.known & hold_crease(row, reading.normal),
                in_column = reading.known & hold_crease(column, reading.normal);
    if (!any(in_row | in_column)) return;
    Double4 least = Double4{} + HUGE_VAL;
    for (int side = 0; side < 2; ++side) {
      consider(in_row, row, side, least, reading);
      consider(in_column, column, side, least, reading);
    }
    reading.distance = least < HUGE_VAL ? dot(reading.normal, x - reading.foot) : reading.distance;
  }
  [[gnu::always_inline]] void consider(const Mask4& which, const Neighbors& neighbors, int side,
                                       Double4& least, LaneReading& reading) const {
    const Vec3x4& normal = neighbors.normals[side];
    const Double4 off = off_plane(reading.foot, neighbors.u[side], neighbors.v[side], normal);
    const Mask4 is_better = which & (off < least);
    least = is_better ? off : least;
    reading.normal = choose(is_better, normal, reading.normal);
  }
  [[gnu::always_inline]] Double4 off_plane(const Vec3x4& place, const Int4& u, const Int4& v,
                                           const Vec3x4& normal) const {
    const Intrinsics& k = surface_.k;
    const Double4 per_depth = inverse_depths(pixels(u, v));
    const Mask4 is_same =
        (dot(normal, place) < 0) & (absolute(per_depth * place.z - 1) <= DepthSurface::kJump);
    const Double4 z = 1 / per_depth;
    const Vec3x4 point{(widen(u) - k.cx) / k.fx * z, (widen(v) - k.cy) / k.fy * z, z};
    return is_same ? absolute(dot(normal, place - point)) : Double4{} + HUGE_VAL;
  }

  const DepthSurface& surface_;
};

}  // namespace vpm
