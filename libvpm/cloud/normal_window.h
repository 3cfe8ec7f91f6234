// Windows over a depth image, and which of their pixels lie on the surface of the centre.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libvpm/cloud/normal_fit.h"
#include "libvpm/cloud/normals.h"

namespace vpm {

// Pixels of a window's row that are handled at once.
inline constexpr int kLanes = 8;

// An image with zeros around it, so that windows need no care at the border. (0, 0) is the image's
// own first pixel; coordinates from -margin to size + margin are there, and to the right of them
// enough for a last group of lanes.
struct PaddedImage {
  int width = 0, height = 0, margin = 0;
  std::size_t stride = 0;
  std::vector<float> values;

  PaddedImage(const DepthImage& image, int margin);
  const float* at(int u, int v) const { return values.data() + offset(u, v); }
  float* at(int u, int v) { return values.data() + offset(u, v); }

 private:
  std::size_t offset(int u, int v) const {
    return static_cast<std::size_t>(v + margin) * stride + static_cast<std::size_t>(u + margin);
  }
};

// Depth and its inverse; both 0 where nothing was measured or the depth is out of range.
PaddedImage padded_depth(const DepthImage& depth, int margin);
PaddedImage inverse_of(const PaddedImage& depth);

// Bounds of inverse depth by the options' edge gate.
struct EdgeGate {
  float lowest, highest;  // of a smooth window, relative to its centre's
  float gate, slope;      // of a gated one: difference from a plane, and more of it per pixel from
                          // the centre where the plane is not known yet
  EdgeGate(const NormalOptions& options, const Intrinsics& k);
};

// Tells the windows of a row that are whole, measured everywhere and without an edge: there, plain
// sums over all pixels will do. They are most of a usual image.
class SmoothWindows {
 public:
  SmoothWindows(const PaddedImage& inverse, const NormalOptions& options, const EdgeGate& edges);
  void scan(int v);
  bool smooth(int u) const { return smooth_[static_cast<std::size_t>(u)] != 0; }

 private:
  const PaddedImage& inverse_;
  int radius_;
  EdgeGate edges_;
  std::vector<float> column_min_, column_max_, window_min_, window_max_;
  std::vector<std::uint8_t> smooth_;
};

// The pixels of one window that belong to the surface of its centre, and their plane.
//
// A first choice admits what the steepest plausible surface through the centre could reach; the
// plane fitted to it then leaves only what lies within the edge gate of that plane.
class GatedWindow {
 public:
  GatedWindow(const PaddedImage& inverse, const NormalOptions& options, const EdgeGate& edges);

  using Plane = WindowPlane;
  Plane fit(int u, int v);

  // After fit() found a plane: 1 where pixel (u + du, v + dv) belongs to it, otherwise 0.
  float weight(int du, int dv) const { return weight_[(dv + radius_) * kStride + du + radius_]; }

 private:
  static constexpr int kStride = (kMaxWindow + kLanes - 1) / kLanes * kLanes;
  Plane fit_admitted(const float* centre, const Plane& near, float gate, float slope);

  const PaddedImage& inverse_;
  int radius_;
  EdgeGate edges_;
  float offset_[kStride];  // du of each lane
  float exists_[kStride];  // 1 for the lanes of the window, 0 for those that fill the last group
  float weight_[kMaxWindow * kStride];
};

}  // namespace vpm
