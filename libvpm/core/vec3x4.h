// Four numbers or three-vectors at once, in the SIMD extension that GCC and Clang share. Each lane
// computes by IEEE 754 in the order of core/vec3.h and core/pose.h, hence with their bits. Pass
// them between inlined functions only (core/lanes.h says why). Not for device code.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <type_traits>

#include "libvpm/core/pose.h"
#include "libvpm/core/vector_width.h"

// GCC warns that the ABI of vector arguments changes with AVX. That is of no matter here: all these
// functions are inlined.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"

namespace vpm {

inline constexpr int kFour = 4;
using Double4 = double __attribute__((vector_size(4 * sizeof(double))));
using FourNumbers = Double4;  // of text that devices share
using Float4 = float __attribute__((vector_size(4 * sizeof(float))));
using Int4 = std::int32_t __attribute__((vector_size(4 * sizeof(std::int32_t))));
using Mask4 = decltype(Double4() < Double4());  // all bits where it holds, else none
using Bits4 = std::uint64_t __attribute__((vector_size(4 * sizeof(std::uint64_t))));

// Returns a bit per lane that is set, the first lane's lowest. Lanes have all bits set, or none.
[[gnu::always_inline]] inline unsigned mask_of(Int4 lanes) {
#ifdef __SSE__
  return static_cast<unsigned>(__builtin_ia32_movmskps(reinterpret_cast<Float4>(lanes)));
#else
  const Int4 bits = lanes & Int4{1, 2, 4, 8};
  return static_cast<unsigned>(bits[0] | bits[1] | bits[2] | bits[3]);
#endif
}
[[gnu::always_inline]] inline Float4 absolute(Float4 a) {
  return reinterpret_cast<Float4>(reinterpret_cast<Int4>(a) & 0x7fffffff);
}

// Converts lanes to those of another vector of four, between which no number loses its value. Lanes
// are written out: GCC 12 makes one or two instructions of that, and four or five of
// __builtin_convertvector.
template <class To, class From>
[[gnu::always_inline]] inline To converted(const From& a) {
  using Lane = std::remove_cvref_t<decltype(To{}[0])>;
  return To{static_cast<Lane>(a[0]), static_cast<Lane>(a[1]), static_cast<Lane>(a[2]),
            static_cast<Lane>(a[3])};
}
[[gnu::always_inline]] inline bool any(const Mask4& mask) {
  return mask_of(converted<Int4>(mask)) != 0;
}
[[gnu::always_inline]] inline bool all(const Mask4& mask) {
  return mask_of(converted<Int4>(mask)) == 0xF;
}
[[gnu::always_inline]] inline Mask4 negated(const Mask4& mask) {
  return ~mask;
}
[[gnu::always_inline]] inline Bits4 bits_where(const Mask4& mask, std::uint32_t bits) {
  return reinterpret_cast<Bits4>(mask) & std::uint64_t{bits};
}
[[gnu::always_inline]] inline Double4 quotient(const Double4& a, const Double4& b) {
  return a / b;
}
[[gnu::always_inline]] inline Double4 quotient(double a, const Double4& b) {
  return a / b;
}
[[gnu::always_inline]] inline Double4 quotient(const Double4& a, double b) {
  return a / b;
}
[[gnu::always_inline]] inline Double4 square_root(const Double4& a) {
  return Double4{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
}
[[gnu::always_inline]] inline Double4 absolute(const Double4& a) {
  return Double4{std::fabs(a[0]), std::fabs(a[1]), std::fabs(a[2]), std::fabs(a[3])};
}
[[gnu::always_inline]] inline Int4 truncated(const Double4& a) {
  return __builtin_convertvector(a, Int4);
}
[[gnu::always_inline]] inline Double4 widen(const Int4& a) {
  return converted<Double4>(a);
}
[[gnu::always_inline]] inline Double4 widen(const Float4& a) {
  return converted<Double4>(a);
}
[[gnu::always_inline]] inline Mask4 widen_mask(const Int4& mask) {
  return converted<Mask4>(mask);
}

// Four three-vectors of float32, one in each lane, as they are loaded.
struct Vec3fx4 {
  Float4 x, y, z;
};

// Four three-vectors, one in each lane.
struct Vec3x4 {
  Double4 x, y, z;

  Vec3x4() = default;
  [[gnu::always_inline]] Vec3x4(const Double4& xs, const Double4& ys, const Double4& zs)
      : x(xs), y(ys), z(zs) {}
  [[gnu::always_inline]] Vec3x4(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d)
      : x{a.x, b.x, c.x, d.x}, y{a.y, b.y, c.y, d.y}, z{a.z, b.z, c.z, d.z} {}
  [[gnu::always_inline]] Vec3x4(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d)
      : x(widen(Float4{a.x, b.x, c.x, d.x})),
        y(widen(Float4{a.y, b.y, c.y, d.y})),
        z(widen(Float4{a.z, b.z, c.z, d.z})) {}

  [[gnu::always_inline]] Vec3 of(int lane) const { return {x[lane], y[lane], z[lane]}; }
};

template <>
struct WidthOf<Double4> {
  using Mask = Mask4;
  using Int = Int4;
  using Index = Int4;
  using Place = Vec3x4;
  using Stored = Vec3fx4;
};

[[gnu::always_inline]] inline Vec3x4 widen(const Vec3fx4& a) {
  return {widen(a.x), widen(a.y), widen(a.z)};
}
template <class Get>
[[gnu::always_inline]] inline Double4 gather(const Int4& i, const Get& get) {
  return widen(Float4{get(i[0]), get(i[1]), get(i[2]), get(i[3])});
}
[[gnu::always_inline]] inline Vec3fx4 gather(const Vec3f* row, const Int4& i) {
  const Vec3f &a = row[i[0]], &b = row[i[1]], &c = row[i[2]], &d = row[i[3]];
  return {Float4{a.x, b.x, c.x, d.x}, Float4{a.y, b.y, c.y, d.y}, Float4{a.z, b.z, c.z, d.z}};
}

[[gnu::always_inline]] inline Int4 gather(const std::uint32_t* row, const Int4& i) {
  return Int4{static_cast<std::int32_t>(row[i[0]]), static_cast<std::int32_t>(row[i[1]]),
              static_cast<std::int32_t>(row[i[2]]), static_cast<std::int32_t>(row[i[3]])};
}

[[gnu::always_inline]] inline Vec3x4 operator+(const Vec3x4& a, const Vec3x4& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
[[gnu::always_inline]] inline Vec3x4 operator-(const Vec3x4& a, const Vec3x4& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
[[gnu::always_inline]] inline Vec3x4 operator*(const Double4& s, const Vec3x4& a) {
  return {s * a.x, s * a.y, s * a.z};
}
[[gnu::always_inline]] inline Vec3x4 operator*(double s, const Vec3x4& a) {
  return {s * a.x, s * a.y, s * a.z};
}
[[gnu::always_inline]] inline Double4 dot(const Vec3x4& a, const Vec3x4& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[gnu::always_inline]] inline Double4 dot(const Vec3& a, const Vec3x4& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[gnu::always_inline]] inline Double4 squared_norm(const Vec3x4& a) {
  return dot(a, a);
}
[[gnu::always_inline]] inline Vec3x4 cross(const Vec3x4& a, const Vec3x4& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
[[gnu::always_inline]] inline Vec3x4 operator*(const Rotation& r, const Vec3x4& a) {
  return {dot(r.row0, a), dot(r.row1, a), dot(r.row2, a)};
}
[[gnu::always_inline]] inline Vec3x4 operator*(const Pose& p, const Vec3x4& a) {
  return {dot(p.rotation.row0, a) + p.translation.x, dot(p.rotation.row1, a) + p.translation.y,
          dot(p.rotation.row2, a) + p.translation.z};
}
[[gnu::always_inline]] inline Vec3x4 choose(const Mask4& mask, const Vec3x4& a, const Vec3x4& b) {
  return {mask ? a.x : b.x, mask ? a.y : b.y, mask ? a.z : b.z};
}
[[gnu::always_inline]] inline Vec3x4 normalized_or_zero(const Vec3x4& a) {
  const Double4 length = square_root(squared_norm(a)), zero{};
  const Mask4 has_direction = (length > 0) & (length < HUGE_VAL);
  return choose(has_direction, {a.x / length, a.y / length, a.z / length}, {zero, zero, zero});
}

// References to four consecutive elements of a row, starting at `first`; the row's last element
// stands in for those past the end.
template <class T>
struct FourOf {
  const T &a, &b, &c, &d;
};
template <class T>
[[gnu::always_inline]] inline FourOf<T> four_of(std::span<const T> row, std::size_t first) {
  const std::size_t last = row.size() - 1;
  return {row[first], row[std::min(first + 1, last)], row[std::min(first + 2, last)],
          row[std::min(first + 3, last)]};
}

}  // namespace vpm

#pragma GCC diagnostic pop
