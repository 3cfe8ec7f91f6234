#include <algorithm>
#include <vector>

#include "libvpm/cloud/normal_fit.h"
#include "libvpm/cloud/normal_rows.h"
#include "libvpm/core/vector_clones.h"

namespace vpm {
namespace {

// Sums of whole windows along a row: first down each column, then across. Differences of opposite
// pixels carry the slopes, so float keeps their digits.
class WindowSums {
 public:
  WindowSums(const PaddedImage& inverse, int radius)
      : inverse_(inverse),
        radius_(radius),
        column_(inverse.stride),
        column_v_(inverse.stride),
        sum_(inverse.stride),
        sum_u_(inverse.stride),
        sum_v_(inverse.stride) {}

  void scan(int v) {
    sum_columns(v);
    const int width = inverse_.width;
    const float* column = column_.data() + radius_;
    const float* column_v = column_v_.data() + radius_;
    float *s = sum_.data(), *su = sum_u_.data(), *sv = sum_v_.data();
    std::copy(column, column + width, s);
    std::copy(column_v, column_v + width, sv);
    std::fill(su, su + width, 0.0F);
    for (int d = 1; d <= radius_; ++d) {
      const float distance = static_cast<float>(d);
      for (int u = 0; u < width; ++u) {
        add_columns(column[u + d], column[u - d], column_v[u + d], column_v[u - d], distance, s[u],
                    su[u], sv[u]);
      }
    }
  }

  const float* sum() const { return sum_.data(); }
  const float* sum_u() const { return sum_u_.data(); }
  const float* sum_v() const { return sum_v_.data(); }

 private:
  void sum_columns(int v) {
    const int columns = inverse_.width + 2 * radius_;
    const float* middle = inverse_.at(-radius_, v);
    std::copy(middle, middle + columns, column_.data());
    std::fill(column_v_.begin(), column_v_.end(), 0.0F);
    float *column = column_.data(), *column_v = column_v_.data();
    for (int d = 1; d <= radius_; ++d) {
      const float* below = inverse_.at(-radius_, v + d);
      const float* above = inverse_.at(-radius_, v - d);
      const float distance = static_cast<float>(d);
      for (int i = 0; i < columns; ++i)
        add_rows(below[i], above[i], distance, column[i], column_v[i]);
    }
  }

  const PaddedImage& inverse_;
  int radius_;
  std::vector<float> column_, column_v_, sum_, sum_u_, sum_v_;
};

}  // namespace

VPM_VECTOR_CLONES
void inverse_depth_rows(const PaddedImage& inverse, const Intrinsics& k,
                        const NormalOptions& options, int begin, int end, Vec3f* normals) {
  const int radius = options.window / 2, width = inverse.width;
  const float fx = static_cast<float>(k.fx), fy = static_cast<float>(k.fy);
  const WholeWindow whole(options.window);
  const EdgeGate edges(options, k);
  SmoothWindows windows(inverse, options, edges);
  GatedWindow gated(inverse, options, edges);
  WindowSums sums(inverse, radius);
  std::vector<float> to_axis(static_cast<std::size_t>(width));
  for (int u = 0; u < width; ++u)
    to_axis[static_cast<std::size_t>(u)] = static_cast<float>(k.cx - u);
  for (int v = begin; v < end; ++v) {
    const float dv_axis = static_cast<float>(k.cy - v);
    const float* centre = inverse.at(0, v);
    Vec3f* row = normals + static_cast<std::size_t>(v) * static_cast<std::size_t>(width);
    windows.scan(v);
    sums.scan(v);
    const float *s = sums.sum(), *su = sums.sum_u(), *sv = sums.sum_v(), *du = to_axis.data();
    for (int u = 0; u < width; ++u) {
      row[u] = normal_of_plane<float>(whole.plane(s[u], su[u], sv[u], centre[u]), fx, fy, du[u],
                                      dv_axis);
    }
    for (int u = 0; u < width; ++u) {
      if (windows.smooth(u)) continue;
      const GatedWindow::Plane plane = centre[u] > 0 ? gated.fit(u, v) : GatedWindow::Plane{};
      row[u] = normal_of_window(plane, fx, fy, du[u], dv_axis);
    }
  }
}

}  // namespace vpm
