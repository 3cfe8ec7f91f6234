// The surface of a camera at four places at once: DepthSurface by vectors (core/lanes.h), with its
// bits. Where it decides by branches, lanes here compute both sides and choose. Not for device
// code.
#pragma once

#include "libvpm/core/lane_vec3.h"
#include "libvpm/query/depth_surface.h"

namespace vpm {

// A reading in each lane; what is not known is of no meaning.
struct LaneReading {
  LaneMask known;
  Doubles distance;
  LaneVec3 normal, foot;
  HalfInts u, v;  // nearest pixel

  [[gnu::always_inline]] Reading of(int lane, std::int32_t width) const {
    if (known[lane] == 0) return {};
    return {true, distance[lane], normal.of(lane), foot.of(lane),
            static_cast<std::uint32_t>(v[lane] * width + u[lane])};
  }
};

class DepthLanes {
 public:
  [[gnu::always_inline]] explicit DepthLanes(const DepthSurface& surface) : surface_(surface) {}

  // What DepthSurface::look_up finds, but for the normal.
  struct Depth {
    LaneMask known;
    Doubles inverse_depth;
    HalfInts u, v;  // nearest pixel
  };
  [[gnu::always_inline]] Depth look_up(const LaneVec3& x) const {
    const Intrinsics& k = surface_.k;
    const std::int32_t width = surface_.width, height = surface_.height;
    const Doubles zero{}, per_depth = 1 / x.z;
    const Doubles at_u = k.fx * (x.x * per_depth) + k.cx, at_v = k.fy * (x.y * per_depth) + k.cy;
    const LaneMask seen = (x.z >= kSmallestLength) & (at_u >= -0.5) & (at_v >= -0.5) &
                          (at_u < width - 0.5) & (at_v < height - 0.5);
    const Doubles u = seen ? at_u : zero, v = seen ? at_v : zero;
    const HalfInts un = truncated(u + 0.5), vn = truncated(v + 0.5);
    const Doubles from_u = u < 0 ? zero : u, from_v = v < 0 ? zero : v;
    const HalfInts u0 = truncated(from_u), v0 = truncated(from_v);
    const HalfInts u1 = u0 + 1 < width ? u0 + 1 : u0, v1 = v0 + 1 < height ? v0 + 1 : v0;
    const HalfInts row0 = v0 * width, row1 = v1 * width;
    const Doubles a = inverse_depths(row0 + u0), b = inverse_depths(row0 + u1);
    const Doubles c = inverse_depths(row1 + u0), d = inverse_depths(row1 + u1);
    const LaneMask left = widen_mask(un == u0), upper = widen_mask(vn == v0);
    const Doubles nearest = upper ? (left ? a : b) : (left ? c : d);
    const Doubles inverse_depth =
        DepthSurface::is_one_surface(a, b, c, d)
            ? DepthSurface::bilinear(a, b, c, d, Doubles(from_u - widen(u0)),
                                     Doubles(from_v - widen(v0)))
            : nearest;
    return {seen & (inverse_depth > 0), inverse_depth, un, vn};
  }

  [[gnu::always_inline]] LaneReading read(const LaneVec3& x) const {
    const Depth depth = look_up(x);
    LaneReading reading;
    reading.known = depth.known;
    reading.u = depth.u, reading.v = depth.v;
    const LaneVec3 normal = normals(depth.v * surface_.width + depth.u);
    const Doubles to_foot = 1 / (x.z * depth.inverse_depth);
    reading.foot = to_foot * x;
    const Doubles along = dot(normal, x), squared_length = squared_norm(x);
    const LaneMask is_trusted =
        (along < 0) &
        (along * along >= (DepthSurface::kGrazing * DepthSurface::kGrazing) * squared_length);
    reading.normal = normal;
    reading.distance = along * (1 - to_foot);
    if (any(reading.known & ~is_trusted)) {
      const Doubles length = square_root(squared_length);
      reading.normal = choose(is_trusted, normal, -1.0 / length * x);
      reading.distance = is_trusted ? reading.distance : length * (to_foot - 1);
    }
    return reading;
  }

  [[gnu::always_inline]] LaneVec3 closest_normal(const LaneVec3& x, LaneReading reading) const {
    take_one_side(x, reading);
    LaneVec3 foot = reading.foot, normal = reading.normal;
    Doubles squared = squared_norm(x - foot);
    LaneVec3 target = x - reading.distance * normal;
    const Doubles pixel = foot.z / surface_.k.fx, near = DepthSurface::kFootPixels * pixel;
    LaneMask searches = LaneMask{} - 1, has_met_noise{};
    LaneVec3 mean{};  // of the normals, where noise was met
    for (int step = 0; step < DepthSurface::kFootSteps; ++step) {
      searches &= squared_norm(target - foot) > near * near;
      if (!any(searches)) break;
      LaneReading next = read(target);
      searches &= next.known;
      take_one_side(x, next);
      const Doubles next_squared = squared_norm(x - next.foot);
      const LaneMask is_closer = searches & (next_squared < squared);
      const LaneMask is_noise =
          searches & ~is_closer & (dot(normal, next.normal) > DepthSurface::kSmoothCosine);
      mean = choose(is_noise, normal + next.normal, mean);
      has_met_noise |= is_noise;
      searches &= ~is_noise;
      target = (Doubles{} + 0.5) * (foot + next.foot);
      foot = choose(is_closer, next.foot, foot);
      normal = choose(is_closer, next.normal, normal);
      squared = is_closer ? next_squared : squared;
      target = choose(is_closer, x - dot(normal, x - foot) * normal, target);
    }
    const LaneVec3 towards = foot - x;
    const Doubles above = dot(normal, towards);
    const Doubles aside = squared_norm(towards - above * normal);
    const Doubles crease = DepthSurface::kCreasePixels * pixel;
    const LaneMask is_foot = (above > 0) & (aside <= crease * crease) & ~has_met_noise;
    return choose(is_foot, normal, normalized_or_zero(choose(has_met_noise, mean, towards)));
  }

 private:
  [[gnu::always_inline]] Doubles inverse_depths(const HalfInts& pixels) const {
    const InverseDepthRange* all = surface_.tiles[0];
    return widen(HalfFloats{all[pixels[0]].high, all[pixels[1]].high, all[pixels[2]].high,
                            all[pixels[3]].high});
  }
  [[gnu::always_inline]] LaneVec3 normals(const HalfInts& pixels) const {
    const Vec3f* all = surface_.normals;
    return lanes(all[pixels[0]], all[pixels[1]], all[pixels[2]], all[pixels[3]]);
  }

  // The pixels at kAcross on either side of the nearest one, along one axis; `at` and `size` of it.
  struct Aside {
    LaneMask in_image;       // on both sides
    LaneVec3 before, after;  // normals
  };
  [[gnu::always_inline]] Aside aside(const HalfInts& nearest, const HalfInts& at, std::int32_t size,
                                     std::int32_t step) const {
    constexpr std::int32_t kAcross = DepthSurface::kAcross;
    const HalfInts in_image = (at >= kAcross) & (at + kAcross < size);
    const HalfInts across = in_image & (kAcross * step);
    return {widen_mask(in_image), normals(nearest - across), normals(nearest + across)};
  }
  [[gnu::always_inline]] static LaneMask holds_crease(const Aside& aside, const LaneVec3& normal) {
    return aside.in_image & (dot(aside.before, aside.after) < DepthSurface::kSmoothCosine) &
           (dot(aside.before, normal) < DepthSurface::kSameCosine) &
           (dot(aside.after, normal) < DepthSurface::kSameCosine);
  }

  [[gnu::always_inline]] void take_one_side(const LaneVec3& x, LaneReading& reading) const {
    const HalfInts here = reading.v * surface_.width + reading.u;
    const Aside row = aside(here, reading.u, surface_.width, 1);
    const Aside column = aside(here, reading.v, surface_.height, surface_.width);
    const LaneMask in_row = reading.known & holds_crease(row, reading.normal),
                   in_column = reading.known & holds_crease(column, reading.normal);
    if (!any(in_row | in_column)) return;
    Doubles least = Doubles{} + HUGE_VAL;
    const auto consider = [&](const LaneMask& is_one, const HalfInts& u, const HalfInts& v,
                              const LaneVec3& normal) __attribute__((always_inline)) {
      const Doubles off = off_plane(reading.foot, u, v, normal);
      const LaneMask is_better = is_one & (off < least);
      least = is_better ? off : least;
      reading.normal = choose(is_better, normal, reading.normal);
    };
    constexpr std::int32_t kAcross = DepthSurface::kAcross;
    const HalfInts u = reading.u, v = reading.v;
    consider(in_row, u - kAcross, v, row.before);
    consider(in_column, u, v - kAcross, column.before);
    consider(in_row, u + kAcross, v, row.after);
    consider(in_column, u, v + kAcross, column.after);
    reading.distance = least < HUGE_VAL ? dot(reading.normal, x - reading.foot) : reading.distance;
  }
  // HUGE_VAL too of pixels outside of the image, which do not count.
  [[gnu::always_inline]] Doubles off_plane(const LaneVec3& place, const HalfInts& u,
                                           const HalfInts& v, const LaneVec3& normal) const {
    const Intrinsics& k = surface_.k;
    const HalfInts in_image = (u >= 0) & (v >= 0) & (u < surface_.width) & (v < surface_.height);
    const Doubles per_depth = inverse_depths((v * surface_.width + u) & in_image);
    const LaneMask is_same =
        (dot(normal, place) < 0) & (absolute(per_depth * place.z - 1) <= DepthSurface::kJump);
    const Doubles z = 1 / per_depth;
    const LaneVec3 point{(widen(u) - k.cx) / k.fx * z, (widen(v) - k.cy) / k.fy * z, z};
    return is_same ? absolute(dot(normal, place - point)) : Doubles{} + HUGE_VAL;
  }

  const DepthSurface& surface_;
};

}  // namespace vpm
