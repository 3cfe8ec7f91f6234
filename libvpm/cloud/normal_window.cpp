#include "libvpm/cloud/normal_window.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "libvpm/core/lanes.h"

namespace vpm {
namespace {

// Tangent of the steepest surface, 80 degrees off the image plane, whose pixels the first choice of
// a gated window admits. A sensor returns next to nothing from steeper ones.
constexpr double kSteepest = 5.7;

constexpr float kOpen = std::numeric_limits<float>::infinity();

// Limits of smooth windows for pca: squares within them stay far from the ends of the range of
// floats.
constexpr float kMaxRelative = 16, kMinInverse = 0x1p-44F, kMaxInverse = 0x1p42F;

}  // namespace

EdgeGate::EdgeGate(const NormalOptions& options, const Intrinsics& k) {
  const double width = options.edge_gate;
  // Without a gate, every measured pixel passes; unmeasured ones are 0.
  lowest = width > 0 ? static_cast<float>(1 - width) : 0.0F;
  highest = width > 0 ? static_cast<float>(1 + width) : kOpen;
  least = std::numeric_limits<float>::min(), greatest = kOpen;
  if (options.method == NormalMethod::pca) {
    lowest = std::max(lowest, 1 / kMaxRelative), highest = std::min(highest, kMaxRelative);
    least = kMinInverse, greatest = kMaxInverse;
  }
  gate = width > 0 ? static_cast<float>(width) : kOpen;
  slope = static_cast<float>(kSteepest / std::min(k.fx, k.fy));
}

SmoothWindows::SmoothWindows(const PaddedImage& inverse, const NormalOptions& options,
                             const EdgeGate& edges)
    : inverse_(inverse), radius_(options.window / 2), edges_(edges) {
  column_min_.resize(inverse.stride + kTile);
  column_max_.resize(inverse.stride + kTile);
  smooth_.resize(static_cast<std::size_t>(inverse.width) + kTile);
}

// Compares floats by their bits, since integers have a minimum of one instruction; floats that are
// not negative are in the order of their bits. Unsigned for minima and signed for maxima, so that
// kBeyondImage is neither.
template <class Radius>
[[gnu::always_inline]] inline void SmoothWindows::scan(int v, Radius radius) {
  const int columns = inverse_.width + 2 * radius, rows = 2 * radius;
  const auto stride = static_cast<std::ptrdiff_t>(inverse_.stride);
  for (int i = 0; i < columns; i += kWideLanes) {
    const float* row = inverse_.at(i - radius, v - radius);
    WideUnsigned low = load<WideUnsigned>(row);
    WideInts high = load<WideInts>(row);
    for (int k = 1; k <= rows; ++k) {
      const WideUnsigned least = load<WideUnsigned>(row + k * stride);
      const WideInts most = load<WideInts>(row + k * stride);
      low = least < low ? least : low;
      high = most > high ? most : high;
    }
    store(low, column_min_.data() + i);
    store(high, column_max_.data() + i);
  }
  const float* centre = inverse_.at(0, v);
  for (int first = 0; first < inverse_.width; first += kTile) {
    float window_min[kTile], window_max[kTile];
    for (int i = 0; i < kTile; i += kWideLanes) {
      const std::uint32_t* mins = column_min_.data() + first + i;
      const std::int32_t* maxs = column_max_.data() + first + i;
      WideUnsigned low = load<WideUnsigned>(mins);
      WideInts high = load<WideInts>(maxs);
      for (int k = 1; k <= rows; ++k) {
        const WideUnsigned least = load<WideUnsigned>(mins + k);
        const WideInts most = load<WideInts>(maxs + k);
        low = least < low ? least : low;
        high = most > high ? most : high;
      }
      store(low, window_min + i);
      store(high, window_max + i);
    }
    std::uint8_t* smooth = smooth_.data() + first;
    for (int i = 0; i < kTile; ++i) {
      const float at = centre[first + i];
      smooth[i] = (window_min[i] >= edges_.least) & (window_max[i] <= edges_.greatest) &
                  (window_min[i] >= edges_.lowest * at) & (window_max[i] <= edges_.highest * at);
    }
  }
}

VPM_VECTOR_CLONES
void SmoothWindows::scan(int v) {
  with_radius(
      radius_, [&](auto radius) __attribute__((always_inline)) { scan(v, radius); });
  leave_out_what_tells_no_plane(v);
}

void SmoothWindows::leave_out_what_tells_no_plane(int v) {
  const Span down = span_of(v, inverse_.height, radius_);
  if (down.is_whole(radius_) && inverse_.width > radius_) return;
  for (int u = 0; u < inverse_.width; ++u)
    if (!tells_plane(span_of(u, inverse_.width, radius_), down))
      smooth_[static_cast<std::size_t>(u)] = 0;
}

int SmoothWindows::next_rough(int u) const {
  const void* const found =
      std::memchr(smooth_.data() + u, 0, static_cast<std::size_t>(inverse_.width - u));
  return found == nullptr
             ? inverse_.width
             : static_cast<int>(static_cast<const std::uint8_t*>(found) - smooth_.data());
}

GatedWindows::GatedWindows(const PaddedImage& inverse, const NormalOptions& options,
                           const EdgeGate& edges)
    : inverse_(inverse), radius_(options.window / 2), gate_(edges.gate) {
  for (int du = -radius_; du <= radius_; ++du) {
    for (int dv = -radius_; dv <= radius_; ++dv) {
      const float distance = static_cast<float>(std::max(std::abs(du), std::abs(dv)));
      wide_gates_.push_back(edges.gate + edges.slope * distance);
    }
  }
  weights_.resize(wide_gates_.size() * kLanes);
}

// Sums the pixels that lie within the gates of the planes. The first choice has no planes yet.
template <bool kFirst, class Radius>
[[gnu::always_inline]] inline GatedWindows::Sums GatedWindows::sum_admitted(const float* centre,
                                                                            Radius radius) {
  const float* wide_gate = wide_gates_.data();
  const Floats gate = kFirst ? Floats{} + gate_ : load<Floats>(gates_);
  float* weights = weights_.data();
  const auto stride = static_cast<std::ptrdiff_t>(inverse_.stride);
  const Floats middle = load<Floats>(centre), unit = 1.0F / middle;
  const Floats near_a = load<Floats>(planes_.a), near_b = load<Floats>(planes_.b),
               near_c = load<Floats>(planes_.c);
  Sums sums;
  for (int k = 2 * radius + 1; k % kColumns != 0; ++k)
    sums.column_e[k] = sums.column_ue[k] = sums.column_ve[k] = Floats{};
  for (int du = -radius; du <= radius; ++du) {
    const float x = static_cast<float>(du);
    const float* at = centre - radius * stride + du;
    const Floats predicted = near_c + near_a * x;
    Floats y = Floats{} - static_cast<float>(radius), count{}, y1{}, y2{}, e1{}, ye{};
    for (int row = 0; row <= 2 * radius; ++row) {
      const Floats value = load<Floats>(at), difference = (value - middle) * unit;
      const Floats expected = kFirst ? Floats{} : predicted + near_b * y;
      const Floats allowed = kFirst ? Floats{} + *wide_gate : gate;
      const Ints kept = is_in_gate(value, difference, expected, allowed);
      if constexpr (kFirst) sums.has_edge |= is_beyond_gate(value, difference, gate);
      const Floats weight = kept ? Floats{} + 1.0F : Floats{}, e = kept ? difference : Floats{};
      store(weight, weights);
      const Floats wy = y * weight;
      count += weight, y1 += wy, y2 += y * wy;
      e1 += e, ye += y * e;
      y += 1.0F;
      at += stride, weights += kLanes, ++wide_gate;
    }
    const int k = du + radius;
    sums.column_e[k] = e1, sums.column_ue[k] = x * e1, sums.column_ve[k] = ye;
    sums.n += count, sums.u += x * count, sums.uu += x * x * count;
    sums.v += y1, sums.uv += x * y1, sums.vv += y2;
  }
  return sums;
}

template <bool kFirst, class Radius>
[[gnu::always_inline]] inline void GatedWindows::fit_admitted(const float* centre, Radius radius) {
  const Sums s = sum_admitted<kFirst>(centre, radius);
  if constexpr (kFirst) store(s.has_edge ? Floats{} + gate_ : Floats{} + kOpen, gates_);
  Floats e{}, ue{}, ve{};
  for (int k = 0; k <= 2 * radius; k += kColumns)
    e += fold(s.column_e + k), ue += fold(s.column_ue + k), ve += fold(s.column_ve + k);
  const FittedPlane<Floats> plane = fit_plane<Floats>({s.n, s.u, s.v, s.uu, s.uv, s.vv, e, ue, ve});
  store(plane.a, planes_.a), store(plane.b, planes_.b), store(plane.c, planes_.c);
  store(plane.found, planes_.found);
}

VPM_VECTOR_CLONES
void GatedWindows::fit_first(const float* centre) {
  with_radius(
      radius_, [&](auto radius)
                   __attribute__((always_inline)) { fit_admitted<true>(centre, radius); });
}

VPM_VECTOR_CLONES
void GatedWindows::fit_second(const float* centre) {
  with_radius(
      radius_, [&](auto radius)
                   __attribute__((always_inline)) { fit_admitted<false>(centre, radius); });
}

const GatedWindows::Planes& GatedWindows::fit(int u, int v) {
  const float* centre = inverse_.at(u, v);
  planes_ = {};
  if (std::none_of(centre, centre + kLanes, [](float c) { return c > 0; })) return planes_;
  fit_first(centre);
  std::int32_t found[kLanes];
  for (int i = 0; i < kLanes; ++i) found[i] = centre[i] > 0 ? planes_.found[i] : 0;
  if (std::any_of(gates_, gates_ + kLanes, [](float gate) { return gate < kOpen; }))
    fit_second(centre);
  for (int i = 0; i < kLanes; ++i) planes_.found[i] &= found[i];
  return planes_;
}

}  // namespace vpm
