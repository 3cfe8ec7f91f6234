#include <algorithm>
#include <vector>

#include "libvpm/cloud/normal_fit.h"
#include "libvpm/cloud/normal_rows.h"
#include "libvpm/core/vector_clones.h"

namespace vpm {
namespace {

// Moments of whole windows along a row, with du and dv relative to each centre: first down each
// column, then across. The second step and what follows it go by tiles of constant size on the
// stack, which compilers turn into vector code.
class WindowMoments {
 public:
  static constexpr int kTile = 64;
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

Moments gated_moments(const PaddedImage& depth, const GatedWindow& window, int radius, int u,
                      int v) {
  Moments m;
  for (int dv = -radius; dv <= radius; ++dv) {
    const float* row = depth.at(u, v + dv);
    for (int du = -radius; du <= radius; ++du) add_pixel(m, window.weight(du, dv), row[du], du, dv);
  }
  return m;
}

}  // namespace

VPM_VECTOR_CLONES
void pca_rows(const PaddedImage& depth, const PaddedImage& inverse, const Intrinsics& k,
              const NormalOptions& options, int begin, int end, Vec3f* normals) {
  const int radius = options.window / 2, width = inverse.width;
  const double per_fx = 1 / k.fx, per_fy = 1 / k.fy;
  const EdgeGate edges(options, k);
  SmoothWindows windows(inverse, options, edges);
  GatedWindow gated(inverse, options, edges);
  WindowMoments moments(depth, radius);
  const double count = options.window * options.window;
  for (int v = begin; v < end; ++v) {
    const double ry = (v - k.cy) / k.fy;
    const float* centre = inverse.at(0, v);
    Vec3f* row = normals + static_cast<std::size_t>(v) * static_cast<std::size_t>(width);
    windows.scan(v);
    moments.sum_columns(v);
    for (int first = 0; first < width; first += WindowMoments::kTile) {
      WindowMoments::Tile t;
      moments.sum_across(first, t);
      Vec3f tile[WindowMoments::kTile];
      for (int i = 0; i < WindowMoments::kTile; ++i) {
        const double rx = (first + i - k.cx) / k.fx;
        tile[i] = normal_of_moments(
            {count, t.x[i], t.y[i], t.z[i], t.xx[i], t.xy[i], t.xz[i], t.yy[i], t.yz[i], t.zz[i]},
            per_fx, per_fy, rx, ry);
      }
      std::copy(tile, tile + std::min(WindowMoments::kTile, width - first), row + first);
    }
    for (int u = 0; u < width; ++u) {
      if (windows.smooth(u)) continue;
      const bool found = centre[u] > 0 && gated.fit(u, v).found;
      row[u] = found ? normal_of_moments(gated_moments(depth, gated, radius, u, v), per_fx, per_fy,
                                         (u - k.cx) / k.fx, ry)
                     : Vec3f{};
    }
  }
}

}  // namespace vpm
