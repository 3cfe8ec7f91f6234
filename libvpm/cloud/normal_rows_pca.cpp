#include <algorithm>
#include <vector>

#include "libvpm/cloud/normal_fit.h"
#include "libvpm/cloud/normal_rows.h"
#include "libvpm/cloud/normal_window.h"
#include "libvpm/core/vector_clones.h"

namespace vpm {
namespace {

// Moments of windows side by side.
template <int Count>
struct MomentLanes {
  double n[Count], x[Count], y[Count], z[Count];
  double xx[Count], xy[Count], xz[Count], yy[Count], yz[Count], zz[Count];
};

// Moments of whole windows along a row, with du and dv relative to each centre: first down each
// column, then across. The second step and what follows it go by tiles of constant size on the
// stack, which compilers turn into vector code.
class WindowMoments {
 public:
  using Tile = MomentLanes<kTile>;

  explicit WindowMoments(const PaddedImage& depth) : depth_(depth) {
    for (auto* column : {&z_, &vz_, &z2_, &vz2_, &vvz2_})
      column->resize(depth.stride + std::size_t{kTile});
  }

  template <class Radius>
  void sum_columns(int v, Radius radius);
  template <class Radius>
  void sum_across(int first, Radius radius, Tile& tile) const;

 private:
  const PaddedImage& depth_;
  std::vector<double> z_, vz_, z2_, vz2_, vvz2_;  // sums of z, dv z, z^2, dv z^2, dv^2 z^2
};

template <class Radius>
[[gnu::always_inline]] inline void WindowMoments::sum_columns(int v, Radius radius) {
  constexpr int kStep = kWideLanes / 2;
  const int columns = depth_.width + 2 * radius;
  const auto stride = static_cast<std::ptrdiff_t>(depth_.stride);
  for (int i = 0; i < columns; i += kStep) {
    const float* middle = depth_.at(i - radius, v);
    WideDoubles z = wide_doubles(middle), z2 = z * z, vz{}, vz2{}, vvz2{};
    for (int d = 1; d <= radius; ++d) {
      const WideDoubles below = wide_doubles(middle + d * stride),
                        above = wide_doubles(middle - d * stride);
      const double distance = d;
      add_depth_rows(below, above, distance, z, vz);
      add_square_rows(below, above, distance, z2, vz2, vvz2);
    }
    store(z, z_.data() + i), store(vz, vz_.data() + i), store(z2, z2_.data() + i);
    store(vz2, vz2_.data() + i), store(vvz2, vvz2_.data() + i);
  }
}

template <class Radius>
[[gnu::always_inline]] inline void WindowMoments::sum_across(int first, Radius radius,
                                                             Tile& t) const {
  constexpr int kStep = kWideLanes / 2;
  const double count = (2 * radius + 1) * (2 * radius + 1);
  for (int i = 0; i < kTile; i += kStep) {
    store(WideDoubles{} + count, t.n + i);
    const std::ptrdiff_t centre = first + radius + i;
    const double *z = z_.data() + centre, *vz = vz_.data() + centre;
    WideDoubles sum_x{}, sum_y = load<WideDoubles>(vz), sum_z = load<WideDoubles>(z);
    for (int d = 1; d <= radius; ++d)
      add_depth_columns(load<WideDoubles>(z + d), load<WideDoubles>(z - d),
                        load<WideDoubles>(vz + d), load<WideDoubles>(vz - d), d, sum_x, sum_y,
                        sum_z);
    store(sum_x, t.x + i), store(sum_y, t.y + i), store(sum_z, t.z + i);

    const double* z2 = z2_.data() + centre;
    WideDoubles sum_xx{}, sum_xz{}, sum_zz = load<WideDoubles>(z2);
    for (int d = 1; d <= radius; ++d)
      add_square_columns(load<WideDoubles>(z2 + d), load<WideDoubles>(z2 - d), d, sum_xx, sum_xz,
                         sum_zz);
    store(sum_xx, t.xx + i), store(sum_xz, t.xz + i), store(sum_zz, t.zz + i);

    const double *vz2 = vz2_.data() + centre, *vvz2 = vvz2_.data() + centre;
    WideDoubles sum_xy{}, sum_yz = load<WideDoubles>(vz2), sum_yy = load<WideDoubles>(vvz2);
    for (int d = 1; d <= radius; ++d)
      add_tilted_columns(load<WideDoubles>(vz2 + d), load<WideDoubles>(vz2 - d),
                         load<WideDoubles>(vvz2 + d), load<WideDoubles>(vvz2 - d), d, sum_xy,
                         sum_yz, sum_yy);
    store(sum_xy, t.xy + i), store(sum_yz, t.yz + i), store(sum_yy, t.yy + i);
  }
}

// The camera, for a row of pixels.
struct RowOfRays {
  double per_fx, per_fy, cx, fx, ry;
  RowOfRays(const Intrinsics& k, int v)
      : per_fx(1 / k.fx), per_fy(1 / k.fy), cx(k.cx), fx(k.fx), ry((v - k.cy) / k.fy) {}
};

// Normals of windows whose centres are pixels `first`, `first` + 1, ... of a row. Steps to all
// their roots are taken together until none has one to take: branches of each would keep compilers
// from making vector code.
template <int Count>
[[gnu::always_inline]] inline void fit_normals(const MomentLanes<Count>& m, const RowOfRays& row,
                                               int first, float* x, float* y, float* z) {
  const double per_fx = row.per_fx, per_fy = row.per_fy, cx = row.cx, fx = row.fx, ry = row.ry;
  double rx[Count];
  float minors[Count], determinants[Count], roots[Count];
  float xx[Count], xy[Count], xz[Count], yy[Count], yz[Count], zz[Count];
  for (int i = 0; i < Count; ++i) {
    rx[i] = (first + i - cx) / fx;
    const Symmetric3<float> c = covariance_of_moments(
        {m.n[i], m.x[i], m.y[i], m.z[i], m.xx[i], m.xy[i], m.xz[i], m.yy[i], m.yz[i], m.zz[i]},
        1 / m.n[i], per_fx, per_fy, rx[i], ry);
    const Characteristic polynomial = characteristic_of(c);
    minors[i] = polynomial.minors, determinants[i] = polynomial.determinant, roots[i] = 0;
    xx[i] = c.xx, xy[i] = c.xy, xz[i] = c.xz, yy[i] = c.yy, yz[i] = c.yz, zz[i] = c.zz;
  }
  int moving = 1;
  for (int step = 0; step < kEigenSteps && moving != 0; ++step) {
    moving = 0;
    for (int i = 0; i < Count; ++i) {
      const Characteristic polynomial{minors[i], determinants[i]};
      const float next = polynomial.next(roots[i], polynomial.at(roots[i]));
      moving |= next != roots[i];
      roots[i] = next;
    }
  }
  for (int i = 0; i < Count; ++i) {
    const Vec3f n = normal_of_covariance({xx[i], xy[i], xz[i], yy[i], yz[i], zz[i]}, roots[i],
                                         static_cast<float>(rx[i]), static_cast<float>(ry));
    x[i] = n.x, y[i] = n.y, z[i] = n.z;
  }
}

// Moments of the pixels of gated windows.
void gated_moments(const PaddedImage& depth, const GatedWindows& windows, int radius, int u, int v,
                   MomentLanes<kLanes>& moments) {
  constexpr int kHalf = kLanes / 2;  // as many doubles fill a vector
  for (int half = 0; half < kLanes; half += kHalf) {
    MomentsOf<Doubles> m;
    for (int du = -radius; du <= radius; ++du) {
      KeptDepths<Doubles> column;
      for (int dv = -radius; dv <= radius; ++dv) {
        const Doubles weights = doubles(load<Floats>(windows.weights(du, dv)), half),
                      depths = doubles(load<Floats>(depth.at(u + du, v + dv)), half);
        column.n += weights;
        add_depth(column, weights * depths, dv);
      }
      add_kept(m, column, du);
    }
    store(m.n, moments.n + half), store(m.x, moments.x + half), store(m.y, moments.y + half);
    store(m.z, moments.z + half), store(m.xx, moments.xx + half), store(m.xy, moments.xy + half);
    store(m.xz, moments.xz + half), store(m.yy, moments.yy + half), store(m.yz, moments.yz + half);
    store(m.zz, moments.zz + half);
  }
}

class PcaRows final : public NormalRows {
 public:
  PcaRows(const NormalImages& images, const Intrinsics& k, const NormalOptions& options)
      : depth_(images.depth),
        inverse_(images.inverse),
        k_(k),
        radius_(options.window / 2),
        windows_(images.inverse, options, EdgeGate(options, k)),
        gated_(images.inverse, options, EdgeGate(options, k)),
        moments_(images.depth) {}

  void estimate(int v, NormalRow& row) override {
    windows_.scan(v);
    fit_whole_windows(v, row);
    fit_gated_windows(v, row);
  }

 private:
  template <class Radius>
  void fit_whole_windows(int v, Radius radius, NormalRow& row);
  void fit_whole_windows(int v, NormalRow& row);
  void fit_gated_windows(int v, NormalRow& row);

  const PaddedImage &depth_, &inverse_;
  Intrinsics k_;
  int radius_;
  SmoothWindows windows_;
  GatedWindows gated_;
  WindowMoments moments_;
};

VPM_VECTOR_CLONES
void PcaRows::fit_whole_windows(int v, NormalRow& row) {
  with_radius(
      radius_, [&](auto radius)
                   __attribute__((always_inline)) { fit_whole_windows(v, radius, row); });
}

template <class Radius>
[[gnu::always_inline]] inline void PcaRows::fit_whole_windows(int v, Radius radius,
                                                              NormalRow& row) {
  const int width = inverse_.width;
  const RowOfRays rays(k_, v);
  moments_.sum_columns(v, radius);
  for (int first = 0; first < width; first += kTile) {
    WindowMoments::Tile moments;
    moments_.sum_across(first, radius, moments);
    float x[kTile], y[kTile], z[kTile];
    fit_normals(moments, rays, first, x, y, z);
    row.take(first, x, y, z, std::min(kTile, width - first));
  }
}

VPM_VECTOR_CLONES
void PcaRows::fit_gated_windows(int v, NormalRow& row) {
  const int width = inverse_.width;
  const RowOfRays rays(k_, v);
  for (int first = windows_.next_rough(0); first < width;
       first = windows_.next_rough(std::min(first + kLanes, width))) {
    const GatedWindows::Planes planes = gated_.fit(first, v);
    MomentLanes<kLanes> moments;
    gated_moments(depth_, gated_, radius_, first, v, moments);
    float x[kLanes], y[kLanes], z[kLanes];
    fit_normals(moments, rays, first, x, y, z);
    for (int i = 0; i < kLanes; ++i)
      if (planes.found[i] == 0) x[i] = y[i] = z[i] = 0;
    take_rough(windows_, first, x, y, z, row);
  }
}

}  // namespace

std::unique_ptr<NormalRows> pca_rows(const NormalImages& images, const Intrinsics& k,
                                     const NormalOptions& options) {
  return std::make_unique<PcaRows>(images, k, options);
}

}  // namespace vpm
