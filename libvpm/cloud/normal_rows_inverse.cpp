#include <algorithm>
#include <vector>

#include "libvpm/cloud/normal_fit.h"
#include "libvpm/cloud/normal_rows.h"
#include "libvpm/cloud/normal_window.h"
#include "libvpm/core/vector_clones.h"

namespace vpm {
namespace {

// Sums of whole windows along a row: first down each column, then across. Differences of opposite
// pixels carry the slopes, so float keeps their digits.
class WindowSums {
 public:
  struct Tile {
    float sum[kTile], sum_u[kTile], sum_v[kTile];
  };

  explicit WindowSums(const PaddedImage& inverse)
      : inverse_(inverse), column_(inverse.stride + kTile), column_v_(inverse.stride + kTile) {}

  template <class Radius>
  void sum_columns(int v, Radius radius);
  template <class Radius>
  void sum_across(int first, Radius radius, Tile& tile) const;

 private:
  const PaddedImage& inverse_;
  std::vector<float> column_, column_v_;
};

template <class Radius>
[[gnu::always_inline]] inline void WindowSums::sum_columns(int v, Radius radius) {
  const int columns = inverse_.width + 2 * radius;
  const auto stride = static_cast<std::ptrdiff_t>(inverse_.stride);
  for (int i = 0; i < columns; i += kWideLanes) {
    const float* middle = inverse_.at(i - radius, v);
    WideFloats sum = load<WideFloats>(middle), sum_v{};
    for (int d = 1; d <= radius; ++d) {
      const WideFloats below = load<WideFloats>(middle + d * stride),
                       above = load<WideFloats>(middle - d * stride);
      add_rows(below, above, static_cast<float>(d), sum, sum_v);
    }
    store(sum, column_.data() + i);
    store(sum_v, column_v_.data() + i);
  }
}

template <class Radius>
[[gnu::always_inline]] inline void WindowSums::sum_across(int first, Radius radius,
                                                          Tile& tile) const {
  for (int i = 0; i < kTile; i += kWideLanes) {
    const float *column = column_.data() + radius + first + i,
                *column_v = column_v_.data() + radius + first + i;
    WideFloats sum = load<WideFloats>(column), sum_u{}, sum_v = load<WideFloats>(column_v);
    for (int d = 1; d <= radius; ++d) {
      const WideFloats right = load<WideFloats>(column + d), left = load<WideFloats>(column - d);
      add_columns(right, left, load<WideFloats>(column_v + d), load<WideFloats>(column_v - d),
                  static_cast<float>(d), sum, sum_u, sum_v);
    }
    store(sum, tile.sum + i);
    store(sum_u, tile.sum_u + i);
    store(sum_v, tile.sum_v + i);
  }
}

class InverseDepthRows final : public NormalRows {
 public:
  InverseDepthRows(const PaddedImage& inverse, const Intrinsics& k, const NormalOptions& options)
      : inverse_(inverse),
        fx_(static_cast<float>(k.fx)),
        fy_(static_cast<float>(k.fy)),
        cy_(k.cy),
        whole_(options.window),
        windows_(inverse, options, EdgeGate(options, k)),
        gated_(inverse, options, EdgeGate(options, k)),
        sums_(inverse),
        radius_(options.window / 2) {
    to_axis_.resize(inverse.stride + kTile);
    for (int u = 0; u < inverse.width; ++u)
      to_axis_[static_cast<std::size_t>(u)] = static_cast<float>(k.cx - u);
  }

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

  const PaddedImage& inverse_;
  float fx_, fy_;
  double cy_;
  WholeWindow whole_;
  SmoothWindows windows_;
  GatedWindows gated_;
  WindowSums sums_;
  int radius_;
  std::vector<float> to_axis_;
};

template <class Radius>
[[gnu::always_inline]] inline void InverseDepthRows::fit_whole_windows(int v, Radius radius,
                                                                       NormalRow& row) {
  const float dv_axis = static_cast<float>(cy_ - v), fx = fx_, fy = fy_;
  const WholeWindow whole = whole_;
  sums_.sum_columns(v, radius);
  for (int first = 0; first < inverse_.width; first += kTile) {
    WindowSums::Tile t;
    sums_.sum_across(first, radius, t);
    const float *centre = inverse_.at(first, v), *du = to_axis_.data() + first;
    float x[kTile], y[kTile], z[kTile];
    for (int i = 0; i < kTile; ++i) {
      const Vec3f n = normal_of_plane<float>(
          whole.plane(t.sum[i], t.sum_u[i], t.sum_v[i], centre[i]), fx, fy, du[i], dv_axis);
      x[i] = n.x, y[i] = n.y, z[i] = n.z;
    }
    row.take(first, x, y, z, std::min(kTile, inverse_.width - first));
  }
}

VPM_VECTOR_CLONES
void InverseDepthRows::fit_whole_windows(int v, NormalRow& row) {
  with_radius(
      radius_, [&](auto radius)
                   __attribute__((always_inline)) { fit_whole_windows(v, radius, row); });
}

VPM_VECTOR_CLONES
void InverseDepthRows::fit_gated_windows(int v, NormalRow& row) {
  const float dv_axis = static_cast<float>(cy_ - v), fx = fx_, fy = fy_;
  const int width = inverse_.width;
  for (int first = windows_.next_rough(0); first < width;
       first = windows_.next_rough(std::min(first + kLanes, width))) {
    const GatedWindows::Planes planes = gated_.fit(first, v);
    const float* du = to_axis_.data() + first;
    float x[kLanes], y[kLanes], z[kLanes];
    for (int i = 0; i < kLanes; ++i) {
      const Vec3f n = normal_of_window(
          {planes.found[i] != 0, planes.a[i], planes.b[i], planes.c[i]}, fx, fy, du[i], dv_axis);
      x[i] = n.x, y[i] = n.y, z[i] = n.z;
    }
    take_rough(windows_, first, x, y, z, row);
  }
}

}  // namespace

std::unique_ptr<NormalRows> inverse_depth_rows(const NormalImages& images, const Intrinsics& k,
                                               const NormalOptions& options) {
  return std::make_unique<InverseDepthRows>(images.inverse, k, options);
}

}  // namespace vpm
