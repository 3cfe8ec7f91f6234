#include <algorithm>
#include <vector>

#include "libvpm/cloud/covariance_fit.h"
#include "libvpm/cloud/normal_rows.h"
#include "libvpm/cloud/normal_window.h"
#include "libvpm/core/lanes.h"

namespace vpm {
namespace {

// Sums of windows along a row: first down each column, then across. The second step and its
// successors work on tiles of constant size on the stack, so that they vectorise.
class DepthOffsets {
 public:
  struct Tile {
    float w[kTile], uw[kTile], vw[kTile], uuw[kTile], uvw[kTile];
    float w2[kTile], uw2[kTile], vw2[kTile], uuw2[kTile], uvw2[kTile], vvz2[kTile];

    [[gnu::always_inline]] WindowOffsets<float> at(int i) const {
      return {w[i], uw[i], vw[i], uuw[i], uvw[i], w2[i], uw2[i], vw2[i], uuw2[i], uvw2[i], vvz2[i]};
    }
  };

  DepthOffsets(const PaddedImage& depth, int radius) : depth_(depth), radius_(radius) {
    for (auto* column : {&w_, &vw_, &w2_, &vw2_, &vvz2_, &references_})
      column->resize(depth.stride + std::size_t{kTile});
  }

  // Sums all columns about row v; `down` is the windows' vertical extent inside the image.
  template <class Down, class Radius>
  void sum_columns(int v, const Down& down, Radius radius);
  // Sums a tile of windows from pixel `first` on, as if whole across. Call sum_columns() before.
  template <class Down, class Radius>
  void sum_across(int first, int v, const Down& down, Radius radius, Tile& tile) const;
  // Returns the sums of one window, which the image's border may cut. Call sum_columns() before.
  WindowOffsets<float> window(int u, int v, Span across, Span down) const;

 private:
  [[gnu::always_inline]] ColumnOffsets<WideFloats> columns(std::ptrdiff_t i) const {
    return {load<WideFloats>(w_.data() + i), load<WideFloats>(vw_.data() + i),
            load<WideFloats>(w2_.data() + i), load<WideFloats>(vw2_.data() + i),
            load<WideFloats>(vvz2_.data() + i)};
  }

  const PaddedImage& depth_;
  int radius_;
  std::vector<float> w_, vw_, w2_, vw2_, vvz2_;
  std::vector<float> references_;  // depth of each pixel's reference
};

// Copies the depth of each pixel's reference column.
void take_references(const float* row, int width, float* references) {
  for (int u = 0; u < width; ++u) references[u] = row[reference_of(u)];
}

template <class Down, class Radius>
[[gnu::always_inline]] inline void DepthOffsets::sum_columns(int v, const Down& down,
                                                             Radius radius) {
  const int columns = depth_.width + 2 * radius_;
  const auto stride = static_cast<std::ptrdiff_t>(depth_.stride);
  for (int i = 0; i < columns; i += kWideLanes) {
    const float* const middle = depth_.at(i - radius_, v);
    const ColumnOffsets<WideFloats> c = sum_offset_rows<WideFloats>(
        down, radius, [&](int dv) __attribute__((always_inline)) {
          return load<WideFloats>(middle + dv * stride);
        });
    store(c.w, w_.data() + i), store(c.vw, vw_.data() + i), store(c.w2, w2_.data() + i);
    store(c.vw2, vw2_.data() + i), store(c.vvz2, vvz2_.data() + i);
  }
  take_references(depth_.at(0, v), depth_.width, references_.data());
}

template <class Down, class Radius>
[[gnu::always_inline]] inline void DepthOffsets::sum_across(int first, int v, const Down& down,
                                                            Radius radius, Tile& t) const {
  for (int i = 0; i < kTile; i += kWideLanes) {
    const float* middles = depth_.at(first + i, v);
    const std::ptrdiff_t centre = first + radius + i;
    const WideFloats reference = load<WideFloats>(references_.data() + first + i);
    const WindowOffsets<WideFloats> sums = sum_offset_columns<WideFloats>(
        WholeSpan{radius}, radius, [&](int du) __attribute__((always_inline)) {
          return about_reference(columns(centre + du), load<WideFloats>(middles + du) - reference,
                                 down);
        });
    store(sums.w, t.w + i), store(sums.uw, t.uw + i), store(sums.vw, t.vw + i);
    store(sums.uuw, t.uuw + i), store(sums.uvw, t.uvw + i), store(sums.w2, t.w2 + i);
    store(sums.uw2, t.uw2 + i), store(sums.vw2, t.vw2 + i), store(sums.uuw2, t.uuw2 + i);
    store(sums.uvw2, t.uvw2 + i), store(sums.vvz2, t.vvz2 + i);
  }
}

WindowOffsets<float> DepthOffsets::window(int u, int v, Span across, Span down) const {
  const float *const middle = depth_.at(u, v), reference = *depth_.at(reference_of(u), v);
  return sum_offset_columns<float>(across, radius_, [&](int du) {
    const auto i = static_cast<std::size_t>(u + du + radius_);
    return about_reference<float>({w_[i], vw_[i], w2_[i], vw2_[i], vvz2_[i]},
                                  middle[du] - reference, down);
  });
}

// Covariances of neighbouring windows.
template <int Count>
struct CovarianceLanes {
  float xx[Count], xy[Count], xz[Count], yy[Count], yz[Count], zz[Count];

  [[gnu::always_inline]] void set(int i, const Symmetric3<float>& c) {
    xx[i] = c.xx, xy[i] = c.xy, xz[i] = c.xz, yy[i] = c.yy, yz[i] = c.yz, zz[i] = c.zz;
  }
  [[gnu::always_inline]] Symmetric3<float> at(int i) const {
    return {xx[i], xy[i], xz[i], yy[i], yz[i], zz[i]};
  }
};

// Finds the normals of windows with central rays (rx[0], ry, 1), (rx[1], ry, 1), ...
template <int Count>
[[gnu::always_inline]] inline void find_normals(const CovarianceLanes<Count>& covariances,
                                                const float* rx, float ry, float* x, float* y,
                                                float* z) {
  find_normals_of<Count>(
      [&](int i) __attribute__((always_inline)) { return covariances.at(i); }, rx, ry,
      [&](int i, const Vec3f& n)
          __attribute__((always_inline)) { x[i] = n.x, y[i] = n.y, z[i] = n.z; });
}

// Moments of kLanes neighbouring gated windows.
struct MomentLanes {
  double n[kLanes], x[kLanes], y[kLanes], z[kLanes];
  double xx[kLanes], xy[kLanes], xz[kLanes], yy[kLanes], yz[kLanes], zz[kLanes];

  [[gnu::always_inline]] Moments at(int i) const {
    return {n[i], x[i], y[i], z[i], xx[i], xy[i], xz[i], yy[i], yz[i], zz[i]};
  }
};

void gated_moments(const PaddedImage& depth, const GatedWindows& windows, int radius, int u, int v,
                   MomentLanes& moments) {
  constexpr int kHalf = kLanes / 2;  // doubles per vector
  for (int half = 0; half < kLanes; half += kHalf) {
    const auto column = [&](int du) {
      KeptDepths<Doubles> kept;
      if (du > radius) return moments_of_column(kept, du);
      for (int dv = -radius; dv <= radius; ++dv) {
        const Doubles weights = doubles(load<Floats>(windows.weights(du, dv)), half),
                      depths = doubles(load<Floats>(depth.at(u + du, v + dv)), half);
        kept.n += weights;
        add_depth(kept, weights * depths, dv);
      }
      return moments_of_column(kept, du);
    };
    MomentsOf<Doubles> m;
    for (int du = -radius; du <= radius; du += kFoldedColumns) {
      MomentsOf<Doubles> columns[kFoldedColumns];
      for (int k = 0; k < kFoldedColumns; ++k) columns[k] = column(du + k);
      m = m + fold(columns);
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
        offsets_(images.depth, options.window / 2) {
    rays_.resize(inverse_.stride + kTile);
    inverse_references_.resize(inverse_.stride + kTile);
    for (int u = 0; u < inverse_.width; ++u)
      rays_[static_cast<std::size_t>(u)] = static_cast<float>((u - k.cx) / k.fx);
  }

  void estimate(int v, NormalRow& row) override {
    windows_.scan(v);
    fit_smooth_windows(v, row);
    fit_gated_windows(v, row);
  }

 private:
  template <class Down, class Radius>
  void fit_smooth_windows(int v, const Down& down, Radius radius, NormalRow& row);
  void fit_smooth_windows(int v, NormalRow& row);
  void fit_cut_window(int u, int v, NormalRow& row);
  void fit_gated_windows(int v, NormalRow& row);
  float ray_of_row(int v) const { return static_cast<float>((v - k_.cy) / k_.fy); }

  const PaddedImage &depth_, &inverse_;
  Intrinsics k_;
  int radius_;
  SmoothWindows windows_;
  GatedWindows gated_;
  DepthOffsets offsets_;
  std::vector<float> rays_;  // x of each column's ray
  std::vector<float> inverse_references_;
};

template <class Down, class Radius>
[[gnu::always_inline]] inline void PcaRows::fit_smooth_windows(int v, const Down& down,
                                                               Radius radius, NormalRow& row) {
  const int width = inverse_.width;
  const float ry = ray_of_row(v);
  const PixelScale<float> scale = pixel_scale_in_floats(k_);
  const WindowShape shape({radius, radius}, span_of(v, inverse_.height, radius));
  offsets_.sum_columns(v, down, radius);
  take_references(inverse_.at(0, v), width, inverse_references_.data());
  for (int first = 0; first < width; first += kTile) {
    DepthOffsets::Tile t;
    offsets_.sum_across(first, v, down, radius, t);
    const float *rx = rays_.data() + first, *inverse = inverse_references_.data() + first;
    CovarianceLanes<kTile> covariances;
    for (int i = 0; i < kTile; ++i)
      covariances.set(i, covariance_of_offsets(t.at(i), inverse[i], shape, scale, rx[i], ry));
    float x[kTile], y[kTile], z[kTile];
    find_normals(covariances, rx, ry, x, y, z);
    row.take(first, x, y, z, std::min(kTile, width - first));
  }
  for_ends(width, radius, [&](int u) {
    if (windows_.smooth(u)) fit_cut_window(u, v, row);
  });
}

void PcaRows::fit_cut_window(int u, int v, NormalRow& row) {
  const Span across = span_of(u, inverse_.width, radius_),
             down = span_of(v, inverse_.height, radius_);
  const WindowOffsets<float> sums = offsets_.window(u, v, across, down);
  const float rx = rays_[static_cast<std::size_t>(u)], ry = ray_of_row(v);
  const Vec3f n =
      normal_of_covariance(covariance_of_offsets(sums, *inverse_.at(reference_of(u), v),
                                                 {across, down}, pixel_scale_in_floats(k_), rx, ry),
                           rx, ry);
  row.take(u, &n.x, &n.y, &n.z, 1);
}

VPM_VECTOR_CLONES
void PcaRows::fit_smooth_windows(int v, NormalRow& row) {
  const Span down = span_of(v, inverse_.height, radius_);
  with_radius(
      radius_, [&](auto radius) __attribute__((always_inline)) {
        if (down.is_whole(radius))
          fit_smooth_windows(v, WholeSpan{radius}, radius, row);
        else
          fit_smooth_windows(v, down, radius, row);
      });
}

VPM_VECTOR_CLONES
void PcaRows::fit_gated_windows(int v, NormalRow& row) {
  const int width = inverse_.width;
  const float ry = ray_of_row(v);
  const PixelScale<double> scale = pixel_scale(k_);
  for (int first = windows_.next_rough(0); first < width;
       first = windows_.next_rough(std::min(first + kLanes, width))) {
    const GatedWindows::Planes planes = gated_.fit(first, v);
    MomentLanes moments;
    gated_moments(depth_, gated_, radius_, first, v, moments);
    const float* rx = rays_.data() + first;
    CovarianceLanes<kLanes> covariances;
    for (int i = 0; i < kLanes; ++i)
      covariances.set(i, covariance_of_moments(moments.at(i), scale, rx[i], ry));
    float x[kLanes], y[kLanes], z[kLanes];
    find_normals(covariances, rx, ry, x, y, z);
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
