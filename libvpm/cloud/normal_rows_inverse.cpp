#include <algorithm>
#include <vector>

#include "libvpm/cloud/normal_rows.h"
#include "libvpm/cloud/normal_window.h"
#include "libvpm/core/lanes.h"

namespace vpm {
namespace {

// Sums of windows along a row: first down each column, then across. Differences of opposite pixels
// carry the slopes, so that floats keep their digits.
class WindowSums {
 public:
  struct Tile {
    float s[kTile], us[kTile], vs[kTile];

    [[gnu::always_inline]] PlaneWindow<float> at(int i) const { return {s[i], us[i], vs[i]}; }
  };

  explicit WindowSums(const PaddedImage& inverse, int radius)
      : inverse_(inverse),
        radius_(radius),
        s_(inverse.stride + kTile),
        vs_(inverse.stride + kTile) {}

  // Sums all columns about row v; `down` is the windows' vertical extent inside the image.
  template <class Down, class Radius>
  void sum_columns(int v, const Down& down, Radius radius);
  // Sums a tile of windows from pixel `first` on, as if whole across.
  template <class Radius>
  void sum_across(int first, Radius radius, Tile& tile) const;
  // Returns the sums of column u.
  PlaneColumn<float> column(int u) const {
    const auto i = static_cast<std::size_t>(u + radius_);
    return {s_[i], vs_[i]};
  }

 private:
  const PaddedImage& inverse_;
  int radius_;
  std::vector<float> s_, vs_;
};

template <class Down, class Radius>
[[gnu::always_inline]] inline void WindowSums::sum_columns(int v, const Down& down, Radius radius) {
  const int columns = inverse_.width + 2 * radius_;
  const auto stride = static_cast<std::ptrdiff_t>(inverse_.stride);
  for (int i = 0; i < columns; i += kWideLanes) {
    const float* const middle = inverse_.at(i - radius_, v);
    const PlaneColumn<WideFloats> column = sum_rows<WideFloats>(
        down, radius, [&](int dv) __attribute__((always_inline)) {
          return load<WideFloats>(middle + dv * stride);
        });
    store(column.s, s_.data() + i);
    store(column.vs, vs_.data() + i);
  }
}

template <class Radius>
[[gnu::always_inline]] inline void WindowSums::sum_across(int first, Radius radius,
                                                          Tile& tile) const {
  for (int i = 0; i < kTile; i += kWideLanes) {
    const float *s = s_.data() + radius + first + i, *vs = vs_.data() + radius + first + i;
    const PlaneWindow<WideFloats> sums = vpm::sum_columns<WideFloats>(
        WholeSpan{radius}, radius, [&](int du) __attribute__((always_inline)) {
          return PlaneColumn<WideFloats>{load<WideFloats>(s + du), load<WideFloats>(vs + du)};
        });
    store(sums.s, tile.s + i);
    store(sums.us, tile.us + i);
    store(sums.vs, tile.vs + i);
  }
}

class InverseDepthRows final : public NormalRows {
 public:
  InverseDepthRows(const PaddedImage& inverse, const Intrinsics& k, const NormalOptions& options)
      : inverse_(inverse),
        fx_(static_cast<float>(k.fx)),
        fy_(static_cast<float>(k.fy)),
        cy_(k.cy),
        windows_(inverse, options, EdgeGate(options, k)),
        gated_(inverse, options, EdgeGate(options, k)),
        sums_(inverse, options.window / 2),
        radius_(options.window / 2) {
    to_axis_.resize(inverse.stride + kTile);
    for (int u = 0; u < inverse.width; ++u)
      to_axis_[static_cast<std::size_t>(u)] = static_cast<float>(k.cx - u);
  }

  void estimate(int v, NormalRow& row) override {
    windows_.scan(v);
    fit_smooth_windows(v, row);
    fit_gated_windows(v, row);
  }

 private:
  template <class Radius>
  void fit_smooth_windows(int v, Radius radius, NormalRow& row);
  void fit_smooth_windows(int v, NormalRow& row);
  void fit_cut_window(int u, int v, NormalRow& row);
  void fit_gated_windows(int v, NormalRow& row);

  const PaddedImage& inverse_;
  float fx_, fy_;
  double cy_;
  SmoothWindows windows_;
  GatedWindows gated_;
  WindowSums sums_;
  int radius_;
  std::vector<float> to_axis_;
};

template <class Radius>
[[gnu::always_inline]] inline void InverseDepthRows::fit_smooth_windows(int v, Radius radius,
                                                                        NormalRow& row) {
  const int width = inverse_.width;
  const float dv_axis = static_cast<float>(cy_ - v), fx = fx_, fy = fy_;
  const Span down = span_of(v, inverse_.height, radius);
  const WindowShape shape({radius, radius}, down);
  if (down.is_whole(radius))
    sums_.sum_columns(v, WholeSpan{radius}, radius);
  else
    sums_.sum_columns(v, down, radius);
  for (int first = 0; first < width; first += kTile) {
    WindowSums::Tile t;
    sums_.sum_across(first, radius, t);
    const float *centre = inverse_.at(first, v), *du = to_axis_.data() + first;
    float x[kTile], y[kTile], z[kTile];
    for (int i = 0; i < kTile; ++i) {
      const Vec3f n = normal_of_smooth_window(shape, plane_of_sums(shape, t.at(i), centre[i]), fx,
                                              fy, du[i], dv_axis);
      x[i] = n.x, y[i] = n.y, z[i] = n.z;
    }
    row.take(first, x, y, z, std::min(kTile, width - first));
  }
  for_ends(width, radius, [&](int u) {
    if (windows_.smooth(u)) fit_cut_window(u, v, row);
  });
}

void InverseDepthRows::fit_cut_window(int u, int v, NormalRow& row) {
  const Span across = span_of(u, inverse_.width, radius_);
  const WindowShape shape(across, span_of(v, inverse_.height, radius_));
  const PlaneWindow<float> sums =
      sum_columns<float>(across, radius_, [&](int du) { return sums_.column(u + du); });
  const Vec3f n =
      normal_of_smooth_window(shape, plane_of_sums(shape, sums, *inverse_.at(u, v)), fx_, fy_,
                              to_axis_[static_cast<std::size_t>(u)], static_cast<float>(cy_ - v));
  row.take(u, &n.x, &n.y, &n.z, 1);
}

VPM_VECTOR_CLONES
void InverseDepthRows::fit_smooth_windows(int v, NormalRow& row) {
  with_radius(
      radius_, [&](auto radius)
                   __attribute__((always_inline)) { fit_smooth_windows(v, radius, row); });
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
