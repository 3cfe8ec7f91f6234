#include <algorithm>
#include <vector>

#include "libvpm/cloud/normal_fit.h"
#include "libvpm/cloud/normal_rows.h"
#include "libvpm/cloud/normal_window.h"
#include "libvpm/core/vector_clones.h"

namespace vpm {
namespace {

// Moments of whole windows along a row, with du and dv relative to each centre: first down each
// column, then across. The second step and what follows it go by tiles of constant size on the
// stack, which compilers turn into vector code.
class WindowMoments {
 public:
  struct Tile {
    double x[kTile], y[kTile], z[kTile];
    double xx[kTile], xy[kTile], xz[kTile], yy[kTile], yz[kTile], zz[kTile];
  };

  WindowMoments(const PaddedImage& depth, int radius) : depth_(depth), radius_(radius) {
    for (auto* column : {&z_, &vz_, &z2_, &vz2_, &vvz2_})
      column->resize(depth.stride + std::size_t{kTile});
  }

  void sum_columns(int v);
  void sum_across(int first, Tile& tile) const;

 private:
  const PaddedImage& depth_;
  int radius_;
  std::vector<double> z_, vz_, z2_, vz2_, vvz2_;  // sums of z, dv z, z^2, dv z^2, dv^2 z^2
};

void WindowMoments::sum_columns(int v) {
  const int columns = depth_.width + 2 * radius_;
  double *z = z_.data(), *vz = vz_.data(), *z2 = z2_.data(), *vz2 = vz2_.data(),
         *vvz2 = vvz2_.data();
  const float* middle = depth_.at(-radius_, v);
  for (int i = 0; i < columns; ++i) {
    const double depth = middle[i];
    z[i] = depth;
    z2[i] = depth * depth;
  }
  for (std::vector<double>* column : {&vz_, &vz2_, &vvz2_})
    std::fill(column->begin(), column->end(), 0.0);
  for (int d = 1; d <= radius_; ++d) {
    const float* below = depth_.at(-radius_, v + d);
    const float* above = depth_.at(-radius_, v - d);
    const double distance = d;
    for (int i = 0; i < columns; ++i) {
      add_depth_rows(below[i], above[i], distance, z[i], vz[i]);
      add_square_rows(below[i], above[i], distance, z2[i], vz2[i], vvz2[i]);
    }
  }
}

void WindowMoments::sum_across(int first, Tile& t) const {
  const std::ptrdiff_t centre = first + radius_;
  const double *z = z_.data() + centre, *vz = vz_.data() + centre, *z2 = z2_.data() + centre,
               *vz2 = vz2_.data() + centre, *vvz2 = vvz2_.data() + centre;
  for (int i = 0; i < kTile; ++i) {
    t.x[i] = t.xx[i] = t.xy[i] = t.xz[i] = 0;
    t.y[i] = vz[i], t.z[i] = z[i], t.yy[i] = vvz2[i], t.yz[i] = vz2[i], t.zz[i] = z2[i];
  }
  for (int d = 1; d <= radius_; ++d) {
    const double distance = d;
    for (int i = 0; i < kTile; ++i)
      add_depth_columns(z[i + d], z[i - d], vz[i + d], vz[i - d], distance, t.x[i], t.y[i], t.z[i]);
    for (int i = 0; i < kTile; ++i)
      add_square_columns(z2[i + d], z2[i - d], distance, t.xx[i], t.xz[i], t.zz[i]);
    for (int i = 0; i < kTile; ++i)
      add_tilted_columns(vz2[i + d], vz2[i - d], vvz2[i + d], vvz2[i - d], distance, t.xy[i],
                         t.yz[i], t.yy[i]);
  }
}

// Moments of the pixels of gated windows, kLanes side by side.
struct GatedMoments {
  double n[kLanes], x[kLanes], y[kLanes], z[kLanes];
  double xx[kLanes], xy[kLanes], xz[kLanes], yy[kLanes], yz[kLanes], zz[kLanes];
};

void gated_moments(const PaddedImage& depth, const GatedWindows& windows, int radius, int u, int v,
                   GatedMoments& moments) {
  constexpr int kHalf = kLanes / 2;  // as many doubles fill a vector
  for (int half = 0; half < kLanes; half += kHalf) {
    MomentsOf<Doubles> m;
    for (int dv = -radius; dv <= radius; ++dv) {
      const float* row = depth.at(u, v + dv);
      for (int du = -radius; du <= radius; ++du) {
        const Floats weights = load<Floats>(windows.weights(du, dv)),
                     depths = load<Floats>(row + du);
        add_pixel(m, doubles(weights, half), doubles(depths, half), du, dv);
      }
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
        moments_(images.depth, options.window / 2) {}

  void estimate(int v, NormalRow& row) override {
    windows_.scan(v);
    fit_whole_windows(v, row);
    fit_gated_windows(v, row);
  }

 private:
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
  const int width = inverse_.width, window = 2 * radius_ + 1;
  const double per_fx = 1 / k_.fx, per_fy = 1 / k_.fy, cx = k_.cx, fx = k_.fx;
  const double ry = (v - k_.cy) / k_.fy, count = window * window;
  moments_.sum_columns(v);
  for (int first = 0; first < width; first += kTile) {
    WindowMoments::Tile t;
    moments_.sum_across(first, t);
    float x[kTile], y[kTile], z[kTile];
    for (int i = 0; i < kTile; ++i) {
      const double rx = (first + i - cx) / fx;
      const Vec3f n = normal_of_moments(
          {count, t.x[i], t.y[i], t.z[i], t.xx[i], t.xy[i], t.xz[i], t.yy[i], t.yz[i], t.zz[i]},
          per_fx, per_fy, rx, ry);
      x[i] = n.x, y[i] = n.y, z[i] = n.z;
    }
    row.take(first, x, y, z, std::min(kTile, width - first));
  }
}

VPM_VECTOR_CLONES
void PcaRows::fit_gated_windows(int v, NormalRow& row) {
  const double per_fx = 1 / k_.fx, per_fy = 1 / k_.fy, ry = (v - k_.cy) / k_.fy;
  const int width = inverse_.width;
  for (int first = windows_.next_rough(0); first < width;
       first = windows_.next_rough(std::min(first + kLanes, width))) {
    const GatedWindows::Planes planes = gated_.fit(first, v);
    GatedMoments m;
    gated_moments(depth_, gated_, radius_, first, v, m);
    float x[kLanes], y[kLanes], z[kLanes];
    for (int i = 0; i < kLanes; ++i) {
      const Vec3f n = normal_of_moments(
          {m.n[i], m.x[i], m.y[i], m.z[i], m.xx[i], m.xy[i], m.xz[i], m.yy[i], m.yz[i], m.zz[i]},
          per_fx, per_fy, (first + i - k_.cx) / k_.fx, ry);
      const bool found = planes.found[i] != 0;
      x[i] = found ? n.x : 0, y[i] = found ? n.y : 0, z[i] = found ? n.z : 0;
    }
    take_rough(windows_, first, x, y, z, row);
  }
}

}  // namespace

std::unique_ptr<NormalRows> pca_rows(const NormalImages& images, const Intrinsics& k,
                                     const NormalOptions& options) {
  return std::make_unique<PcaRows>(images, k, options);
}

}  // namespace vpm
