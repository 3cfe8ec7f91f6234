// Windows of a depth image, and the pixels in them that lie on the surface of the centre.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "libvpm/cloud/normal_rows.h"
#include "libvpm/cloud/normals.h"
#include "libvpm/cloud/padded_image.h"
#include "libvpm/cloud/plane_fit.h"
#include "libvpm/core/lanes.h"

namespace vpm {

// Calls body(radius). Passes the radius of default windows as a constant, so that loops unroll.
template <class Body>
[[gnu::always_inline]] inline void with_radius(int radius, const Body& body) {
  constexpr int kUsual = NormalOptions{}.window / 2;
  if (radius == kUsual)
    body(std::integral_constant<int, kUsual>{});
  else
    body(radius);
}

// Bounds on inverse depth from the options' edge gate and from the range of floats. Windows within
// them are smooth; pca computes others, which are gated, in doubles.
struct EdgeGate {
  float lowest, highest;  // bounds of a smooth window, relative to its centre
  float least, greatest;  // absolute bounds of a smooth window
  // Bounds of a gated window: the difference from a plane and, while the plane is unknown, an
  // allowance per pixel of distance from the centre.
  float gate, slope;
  EdgeGate(const NormalOptions& options, const Intrinsics& k);
};

// Finds the smooth windows of a row: those without a hole or an edge inside the image. Plain sums
// over all their pixels suffice, and they are most of a usual image.
class SmoothWindows {
 public:
  SmoothWindows(const PaddedImage& inverse, const NormalOptions& options, const EdgeGate& edges);
  void scan(int v);
  // Returns the first pixel at or after u whose window is not smooth, or the width.
  int next_rough(int u) const;
  bool smooth(int u) const { return smooth_[static_cast<std::size_t>(u)] != 0; }

 private:
  template <class Radius>
  void scan(int v, Radius radius);
  void leave_out_what_tells_no_plane(int v);

  const PaddedImage& inverse_;
  int radius_;
  EdgeGate edges_;
  // Bits of floats, see scan().
  std::vector<std::uint32_t> column_min_;
  std::vector<std::int32_t> column_max_;
  std::vector<std::uint8_t> smooth_;
};

// Calls body(u) for the pixels of a row whose windows the image's border cuts.
template <class Body>
[[gnu::always_inline]] inline void for_ends(int width, int radius, const Body& body) {
  for (int u = 0; u < std::min(radius, width); ++u) body(u);
  for (int u = std::max(radius, width - radius); u < width; ++u) body(u);
}

// Stores those of kLanes normals from pixel `first` on whose windows are not smooth.
inline void take_rough(const SmoothWindows& windows, int first, const float* x, const float* y,
                       const float* z, NormalRow& row) {
  const int count = std::min(kLanes, static_cast<int>(row.width) - first);
  for (int i = 0; i < count; ++i)
    if (!windows.smooth(first + i)) row.take(first + i, x + i, y + i, z + i, 1);
}

// Finds the pixels that belong to the surface of their window's centre, and their plane, for kLanes
// windows with neighbouring centres at once.
//
// The first choice admits what the steepest plausible surface through the centre could reach. If
// something in the window is beyond the edge gate of its centre, a second choice keeps what is
// within the edge gate of the plane fitted to the first. Windows without an edge (with holes, or
// cut by the image's border) keep all measured pixels.
class GatedWindows {
 public:
  GatedWindows(const PaddedImage& inverse, const NormalOptions& options, const EdgeGate& edges);

  // Planes of inverse depth relative to the centre's, minus 1: c + a du + b dv. `found` is -1, or 0
  // where too few pixels remain, they are collinear, or the centre is unmeasured.
  struct Planes {
    float a[kLanes], b[kLanes], c[kLanes];
    std::int32_t found[kLanes];
  };
  // Fits the windows about (u, v), (u + 1, v), ...
  const Planes& fit(int u, int v);
  // Returns one number per lane, valid after fit(): 1 if the lane has a plane and pixel (u + lane +
  // du, v + dv) belongs to it, else 0.
  const float* weights(int du, int dv) const {
    return weights_.data() + ((du + radius_) * (2 * radius_ + 1) + dv + radius_) * kLanes;
  }

 private:
  static constexpr int kColumns = kFoldedColumns;
  static constexpr int kMaxColumns = (kMaxWindow + kColumns - 1) / kColumns * kColumns;
  // Sums over the admitted pixels: those of integers are exact in any order; others are kept by
  // column.
  struct Sums {
    Floats n{}, u{}, v{}, uu{}, uv{}, vv{};
    Ints has_edge{};  // -1 where the first choice found an edge
    Floats column_e[kMaxColumns], column_ue[kMaxColumns], column_ve[kMaxColumns];
  };
  template <bool kFirst, class Radius>
  Sums sum_admitted(const float* centre, Radius radius);
  template <bool kFirst, class Radius>
  void fit_admitted(const float* centre, Radius radius);
  void fit_first(const float* centre);
  void fit_second(const float* centre);

  const PaddedImage& inverse_;
  int radius_;
  float gate_;
  // Largest difference from the centre at which the first choice admits a pixel, for each offset
  // (du, dv).
  std::vector<float> wide_gates_;
  // Largest distance from the plane of the first choice at which the second one keeps a pixel, for
  // each lane; infinite where the window has no edge.
  float gates_[kLanes];
  Planes planes_;
  std::vector<float> weights_;
};

}  // namespace vpm
