#include <algorithm>
#include <vector>

#include "libvpm/cloud/normal_fit.h"
#include "libvpm/cloud/normal_rows.h"
#include "libvpm/core/vector_clones.h"

namespace vpm {
namespace {

// Moments of a window's points in the affine frame of its centre, p = z (du, dv, 1): there they
// are plain weighted sums of z and z^2.
struct Moments {
  double n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
};

// The unit normal towards the sensor, seen from the pixel whose ray is (rx, ry, 1).
[[gnu::always_inline]] inline Vec3f normal_of_moments(const Moments& m, double per_fx,
                                                      double per_fy, double rx, double ry) {
  const double per_n = 1 / m.n;
  // Covariance (times n) in the centre's frame ...
  const double xx = m.xx - m.x * m.x * per_n, xy = m.xy - m.x * m.y * per_n,
               xz = m.xz - m.x * m.z * per_n, yy = m.yy - m.y * m.y * per_n,
               yz = m.yz - m.y * m.z * per_n, zz = m.zz - m.z * m.z * per_n;
  // ... and in the camera's: (x/fx + rx z, y/fy + ry z, z).
  const double ax = per_fx * xz, ay = per_fy * yz;
  const Symmetric3 covariance{per_fx * per_fx * xx + 2 * rx * ax + rx * rx * zz,
                              per_fx * per_fy * xy + ry * ax + rx * ay + rx * ry * zz,
                              ax + rx * zz,
                              per_fy * per_fy * yy + 2 * ry * ay + ry * ry * zz,
                              ay + ry * zz,
                              zz};
  const Vec3 direction = smallest_eigenvector(covariance);
  const double away = direction.x * rx + direction.y * ry + direction.z;
  const double length = std::sqrt(squared_norm(direction));
  const double scale = (away > 0 ? -1.0 : 1.0) / (length > 0 ? length : 1.0);
  return narrow(scale * direction);
}

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
    const double distance = d, square = distance * distance;
    for (int i = 0; i < columns; ++i) {
      const double b = below[i], a = above[i], bb = b * b, aa = a * a;
      z[i] += b + a;
      vz[i] += distance * (b - a);
      z2[i] += bb + aa;
      vz2[i] += distance * (bb - aa);
      vvz2[i] += square * (bb + aa);
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
    const double distance = d, square = distance * distance;
    for (int i = 0; i < kTile; ++i) {
      t.x[i] += distance * (z[i + d] - z[i - d]);
      t.z[i] += z[i + d] + z[i - d];
      t.y[i] += vz[i + d] + vz[i - d];
    }
    for (int i = 0; i < kTile; ++i) {
      const double sum = z2[i + d] + z2[i - d], difference = z2[i + d] - z2[i - d];
      t.xx[i] += square * sum;
      t.xz[i] += distance * difference;
      t.zz[i] += sum;
    }
    for (int i = 0; i < kTile; ++i) {
      t.xy[i] += distance * (vz2[i + d] - vz2[i - d]);
      t.yz[i] += vz2[i + d] + vz2[i - d];
      t.yy[i] += vvz2[i + d] + vvz2[i - d];
    }
  }
}

Moments gated_moments(const PaddedImage& depth, const GatedWindow& window, int radius, int u,
                      int v) {
  Moments m;
  for (int dv = -radius; dv <= radius; ++dv) {
    const float* row = depth.at(u, v + dv);
    for (int du = -radius; du <= radius; ++du) {
      const double w = window.weight(du, dv), z = w * row[du], x = du * z, y = dv * z;
      m.n += w, m.x += x, m.y += y, m.z += z;
      m.xx += x * x, m.xy += x * y, m.xz += x * z, m.yy += y * y, m.yz += y * z, m.zz += z * z;
    }
  }
  return m;
}

}  // namespace

VPM_VECTOR_CLONES
void pca_rows(const PaddedImage& depth, const PaddedImage& inverse, const Intrinsics& k,
              const NormalOptions& options, int begin, int end, Vec3f* normals) {
  const int radius = options.window / 2, width = inverse.width;
  const double per_fx = 1 / k.fx, per_fy = 1 / k.fy;
  SmoothWindows windows(inverse, options);
  GatedWindow gated(inverse, options, k);
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
