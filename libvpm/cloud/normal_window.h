// Windows over a depth image, and which of their pixels lie on the surface of the centre.
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

// Calls body(radius), with a constant for windows as wide as they are by default: its loops unroll.
template <class Body>
[[gnu::always_inline]] inline void with_radius(int radius, const Body& body) {
  constexpr int kUsual = NormalOptions{}.window / 2;
  if (radius == kUsual)
    body(std::integral_constant<int, kUsual>{});
  else
    body(radius);
}

// Bounds of inverse depth by the options' edge gate, and by what floats can hold of a smooth
// window: of others, which are gated, PCA is done in doubles.
struct EdgeGate {
  float lowest, highest;  // of a smooth window, relative to its centre's
  float least, greatest;  // of a smooth window
  float gate, slope;      // of a gated one: difference from a plane, and more of it per pixel from
                          // the centre where the plane is not known yet
  EdgeGate(const NormalOptions& options, const Intrinsics& k);
};

// Tells the windows of a row that are measured everywhere, as far as the image goes, and without an
// edge: there, plain sums over all pixels will do. They are most of a usual image.
class SmoothWindows {
 public:
  SmoothWindows(const PaddedImage& inverse, const NormalOptions& options, const EdgeGate& edges);
  void scan(int v);
  // The first pixel from u on whose window is not smooth; the width if there is none.
  int next_rough(int u) const;
  bool smooth(int u) const { return smooth_[static_cast<std::size_t>(u)] != 0; }

 private:
  template <class Radius>
  void scan(int v, Radius radius);
  void leave_out_what_tells_no_plane(int v);

  const PaddedImage& inverse_;
  int radius_;
  EdgeGate edges_;
  std::vector<std::uint32_t> column_min_;  // as integers, see scan()
  std::vector<std::int32_t> column_max_;
  std::vector<std::uint8_t> smooth_;
};

// Calls body(u) for the pixels of a row whose windows its ends cut.
template <class Body>
[[gnu::always_inline]] inline void for_ends(int width, int radius, const Body& body) {
  for (int u = 0; u < std::min(radius, width); ++u) body(u);
  for (int u = std::max(radius, width - radius); u < width; ++u) body(u);
}

// Takes those of kLanes normals from pixel `first` on whose windows are not smooth.
inline void take_rough(const SmoothWindows& windows, int first, const float* x, const float* y,
                       const float* z, NormalRow& row) {
  const int count = std::min(kLanes, static_cast<int>(row.width) - first);
  for (int i = 0; i < count; ++i)
    if (!windows.smooth(first + i)) row.take(first + i, x + i, y + i, z + i, 1);
}

// The pixels that belong to the surface of their window's centre, and their plane: of kLanes
// windows at once, whose centres are neighbours in a row.
//
// A first choice admits what the steepest plausible surface through the centre could reach. Where
// something of the window is beyond the edge gate of its centre, the plane fitted to that choice
// leaves only what lies within the edge gate of that plane. Other windows have no edge, only holes
// or the image's border: all that was measured belongs to them.
class GatedWindows {
 public:
  GatedWindows(const PaddedImage& inverse, const NormalOptions& options, const EdgeGate& edges);

  // Inverse depth relative to the centre's, minus 1: c + a du + b dv. `found` is 0 where too few
  // pixels remain, or they lie on a line, or the centre was not measured; otherwise -1.
  struct Planes {
    float a[kLanes], b[kLanes], c[kLanes];
    std::int32_t found[kLanes];
  };
  // Of the windows about (u, v), (u + 1, v), ...
  const Planes& fit(int u, int v);
  // After fit(), of each lane with a plane: 1 where pixel (u + lane + du, v + dv) belongs to it,
  // otherwise 0.
  const float* weights(int du, int dv) const {
    return weights_.data() + ((du + radius_) * (2 * radius_ + 1) + dv + radius_) * kLanes;
  }

 private:
  static constexpr int kColumns = kFoldedColumns;
  static constexpr int kMostColumns = (kMaxWindow + kColumns - 1) / kColumns * kColumns;
  // Over the admitted pixels: integers, exact in any order, and the sums of each column.
  struct Sums {
    Floats n{}, u{}, v{}, uu{}, uv{}, vv{};
    Ints has_edge{};  // found by the first choice
    Floats column_e[kMostColumns], column_ue[kMostColumns], column_ve[kMostColumns];
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
  std::vector<float> wide_gates_;  // of (du, dv): the first choice's
  float gates_[kLanes];            // of the lanes' windows: the second one's
  Planes planes_;
  std::vector<float> weights_;
};

}  // namespace vpm
