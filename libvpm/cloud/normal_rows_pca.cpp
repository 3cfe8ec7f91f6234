#include <algorithm>
#include <vector>

#include "libvpm/cloud/normal_fit.h"
#include "libvpm/cloud/normal_rows.h"

namespace vpm {
namespace {

// Moments of a window's points in the affine frame of its centre, p = z (du, dv, 1): there they
// are plain weighted sums of z and z^2.
struct Moments {
  double n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
};

// The unit normal towards the sensor, seen from the pixel whose ray is (rx, ry, 1).
inline Vec3f normal_of_moments(const Moments& m, double per_fx, double per_fy, double rx,
                               double ry) {
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
// column, then across.
class WindowMoments {
 public:
  WindowMoments(const PaddedImage& depth, int radius) : depth_(depth), radius_(radius) {
    for (auto& column : columns_) column.resize(depth.stride);
    for (auto& moment : moments_) moment.resize(depth.stride);
  }

  void scan(int v) {
    sum_columns(v);
    const int width = depth_.width;
    const double* c[5];
    double* m[9];
    for (int i = 0; i < 5; ++i) c[i] = columns_[i].data() + radius_;
    for (int i = 0; i < 9; ++i) m[i] = moments_[i].data();
    for (int i = 0; i < 9; ++i) {
      if (kColumnOf[i] < 0)
        std::fill(m[i], m[i] + width, 0.0);
      else
        std::copy(c[kColumnOf[i]], c[kColumnOf[i]] + width, m[i]);
    }
    for (int d = 1; d <= radius_; ++d) {
      const double distance = d, square = distance * distance;
      for (int u = 0; u < width; ++u) {
        m[kX][u] += distance * (c[kZ1][u + d] - c[kZ1][u - d]);
        m[kY][u] += c[kVZ1][u + d] + c[kVZ1][u - d];
        m[kZ][u] += c[kZ1][u + d] + c[kZ1][u - d];
        m[kXX][u] += square * (c[kZ2][u + d] + c[kZ2][u - d]);
        m[kXY][u] += distance * (c[kVZ2][u + d] - c[kVZ2][u - d]);
        m[kXZ][u] += distance * (c[kZ2][u + d] - c[kZ2][u - d]);
        m[kYY][u] += c[kVVZ2][u + d] + c[kVVZ2][u - d];
        m[kYZ][u] += c[kVZ2][u + d] + c[kVZ2][u - d];
        m[kZZ][u] += c[kZ2][u + d] + c[kZ2][u - d];
      }
    }
  }

  Moments at(int u) const {
    const auto i = static_cast<std::size_t>(u);
    const double window = 2 * radius_ + 1;
    return {window * window,  moments_[kX][i],  moments_[kY][i],  moments_[kZ][i],
            moments_[kXX][i], moments_[kXY][i], moments_[kXZ][i], moments_[kYY][i],
            moments_[kYZ][i], moments_[kZZ][i]};
  }

 private:
  enum Column { kZ1, kVZ1, kZ2, kVZ2, kVVZ2 };  // sums of z, dv z, z^2, dv z^2, dv^2 z^2
  enum Moment { kX, kY, kZ, kXX, kXY, kXZ, kYY, kYZ, kZZ };
  // The column sums a moment begins with at du = 0; those weighted with du begin with nothing.
  static constexpr int kColumnOf[9] = {-1, kVZ1, kZ1, -1, -1, -1, kVVZ2, kVZ2, kZ2};

  void sum_columns(int v) {
    const int columns = depth_.width + 2 * radius_;
    double* c[5];
    for (int i = 0; i < 5; ++i) {
      std::fill(columns_[i].begin(), columns_[i].end(), 0.0);
      c[i] = columns_[i].data();
    }
    const float* middle = depth_.at(-radius_, v);
    for (int i = 0; i < columns; ++i) {
      const double z = middle[i];
      c[kZ1][i] = z;
      c[kZ2][i] = z * z;
    }
    for (int d = 1; d <= radius_; ++d) {
      const float* below = depth_.at(-radius_, v + d);
      const float* above = depth_.at(-radius_, v - d);
      const double distance = d, square = distance * distance;
      for (int i = 0; i < columns; ++i) {
        const double b = below[i], a = above[i], bb = b * b, aa = a * a;
        c[kZ1][i] += b + a;
        c[kVZ1][i] += distance * (b - a);
        c[kZ2][i] += bb + aa;
        c[kVZ2][i] += distance * (bb - aa);
        c[kVVZ2][i] += square * (bb + aa);
      }
    }
  }

  const PaddedImage& depth_;
  int radius_;
  std::vector<double> columns_[5], moments_[9];
};

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

void pca_rows(const PaddedImage& depth, const PaddedImage& inverse, const Intrinsics& k,
              const NormalOptions& options, int begin, int end, Vec3f* normals) {
  const int radius = options.window / 2, width = inverse.width;
  const double per_fx = 1 / k.fx, per_fy = 1 / k.fy;
  SmoothWindows windows(inverse, options);
  GatedWindow gated(inverse, options, k);
  WindowMoments moments(depth, radius);
  std::vector<double> ray_x(static_cast<std::size_t>(width));
  for (int u = 0; u < width; ++u) ray_x[static_cast<std::size_t>(u)] = (u - k.cx) / k.fx;
  for (int v = begin; v < end; ++v) {
    const double ry = (v - k.cy) / k.fy;
    const float* centre = inverse.at(0, v);
    Vec3f* row = normals + static_cast<std::size_t>(v) * static_cast<std::size_t>(width);
    windows.scan(v);
    moments.scan(v);
    const double* rx = ray_x.data();
    for (int u = 0; u < width; ++u)
      row[u] = normal_of_moments(moments.at(u), per_fx, per_fy, rx[u], ry);
    for (int u = 0; u < width; ++u) {
      if (windows.smooth(u)) continue;
      const bool found = centre[u] > 0 && gated.fit(u, v).found;
      row[u] = found ? normal_of_moments(gated_moments(depth, gated, radius, u, v), per_fx, per_fy,
                                         rx[u], ry)
                     : Vec3f{};
    }
  }
}

}  // namespace vpm
