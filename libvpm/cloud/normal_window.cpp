#include "libvpm/cloud/normal_window.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libvpm/core/parallel.h"
#include "libvpm/core/vector_clones.h"

namespace vpm {
namespace {

// Tangent of the steepest surface (80 degrees off the image plane) whose pixels the first choice
// of a gated window admits; beyond it a sensor returns next to nothing.
constexpr double kSteepest = 5.7;

// The sum of the lanes, pairwise.
[[gnu::always_inline]] inline float fold(const float (&lanes)[kLanes]) {
  float half[kLanes / 2];
  for (int i = 0; i < kLanes / 2; ++i) half[i] = lanes[i] + lanes[i + kLanes / 2];
  static_assert(kLanes == 8);
  return (half[0] + half[2]) + (half[1] + half[3]);
}

[[gnu::always_inline]] inline float fold_product(const float (&a)[kLanes],
                                                 const float (&b)[kLanes]) {
  float product[kLanes];
  for (int i = 0; i < kLanes; ++i) product[i] = a[i] * b[i];
  return fold(product);
}

}  // namespace

PaddedImage::PaddedImage(const DepthImage& image, int frame)
    : width(static_cast<int>(image.width)),
      height(static_cast<int>(image.height)),
      margin(frame),
      stride(std::size_t{image.width} + 2 * static_cast<std::size_t>(frame) + kLanes),
      values(stride * (std::size_t{image.height} + 2 * static_cast<std::size_t>(frame))) {}

PaddedImage padded_depth(const DepthImage& depth, int margin) {
  PaddedImage padded(depth, margin);
  parallel_for(depth.height, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const float* from = depth.depth.data() + v * depth.width;
      float* to = padded.at(0, static_cast<int>(v));
      for (int u = 0; u < padded.width; ++u) to[u] = usable_depth(from[u]);
    }
  });
  return padded;
}

PaddedImage inverse_of(const PaddedImage& depth) {
  PaddedImage inverse = depth;
  parallel_for(static_cast<std::size_t>(depth.height), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      float* row = inverse.at(0, static_cast<int>(v));
      for (int u = 0; u < inverse.width; ++u) row[u] = inverse_of_usable(row[u]);
    }
  });
  return inverse;
}

EdgeGate::EdgeGate(const NormalOptions& options, const Intrinsics& k) {
  constexpr float kOpen = std::numeric_limits<float>::infinity();
  const double width = options.edge_gate;
  // Without a gate every measured pixel passes; 0 stands for what was not measured.
  lowest = width > 0 ? static_cast<float>(1 - width) : 0.0F;
  highest = width > 0 ? static_cast<float>(1 + width) : kOpen;
  gate = width > 0 ? static_cast<float>(width) : kOpen;
  slope = static_cast<float>(kSteepest / std::min(k.fx, k.fy));
}

SmoothWindows::SmoothWindows(const PaddedImage& inverse, const NormalOptions& options,
                             const EdgeGate& edges)
    : inverse_(inverse), radius_(options.window / 2), edges_(edges) {
  column_min_.resize(inverse.stride);
  column_max_.resize(inverse.stride);
  window_min_.resize(inverse.stride);
  window_max_.resize(inverse.stride);
  smooth_.resize(static_cast<std::size_t>(inverse.width));
}

VPM_VECTOR_CLONES
void SmoothWindows::scan(int v) {
  const int columns = inverse_.width + 2 * radius_;
  const auto least = [](float a, float b) { return b < a ? b : a; };
  const auto most = [](float a, float b) { return b > a ? b : a; };
  float* column_min = column_min_.data();
  float* column_max = column_max_.data();
  const float* first = inverse_.at(-radius_, v - radius_);
  std::copy(first, first + columns, column_min);
  std::copy(first, first + columns, column_max);
  for (int dv = 1 - radius_; dv <= radius_; ++dv) {
    const float* row = inverse_.at(-radius_, v + dv);
    for (int i = 0; i < columns; ++i) {
      column_min[i] = least(column_min[i], row[i]);
      column_max[i] = most(column_max[i], row[i]);
    }
  }
  const int width = inverse_.width;
  float *low = window_min_.data(), *high = window_max_.data();
  std::copy(column_min, column_min + width, low);
  std::copy(column_max, column_max + width, high);
  for (int i = 1; i <= 2 * radius_; ++i) {
    for (int u = 0; u < width; ++u) {
      low[u] = least(low[u], column_min[u + i]);
      high[u] = most(high[u], column_max[u + i]);
    }
  }
  const float* centre = inverse_.at(0, v);
  std::uint8_t* smooth = smooth_.data();
  for (int u = 0; u < width; ++u) {
    smooth[u] = (low[u] > 0) & (low[u] >= edges_.lowest * centre[u]) &
                (high[u] <= edges_.highest * centre[u]);
  }
}

GatedWindow::GatedWindow(const PaddedImage& inverse, const NormalOptions& options,
                         const EdgeGate& edges)
    : inverse_(inverse), radius_(options.window / 2), edges_(edges) {
  for (int i = 0; i < kStride; ++i) {
    offset_[i] = static_cast<float>(i - radius_);
    exists_[i] = i < options.window ? 1.0F : 0.0F;
  }
}

GatedWindow::Plane GatedWindow::fit(int u, int v) {
  const float* centre = inverse_.at(u, v);
  const Plane first = fit_admitted(centre, {}, edges_.gate, edges_.slope);
  return first.found ? fit_admitted(centre, first, edges_.gate, 0) : first;
}

// Lanes are columns, handled in groups of constant size so that compilers make vectors of them.
VPM_VECTOR_CLONES
GatedWindow::Plane GatedWindow::fit_admitted(const float* centre, const Plane& near, float gate,
                                             float slope) {
  const float middle = *centre, unit = 1.0F / middle;
  PlaneSums sums;
  for (int group = 0; group <= 2 * radius_; group += kLanes) {
    float predicted[kLanes], along[kLanes], exists[kLanes];
    float count[kLanes] = {}, y1[kLanes] = {}, y2[kLanes] = {}, e1[kLanes] = {}, ye[kLanes] = {};
    for (int i = 0; i < kLanes; ++i) {
      predicted[i] = near.c + near.a * offset_[group + i];
      along[i] = std::abs(offset_[group + i]);
      exists[i] = exists_[group + i];
    }
    for (int dv = -radius_; dv <= radius_; ++dv) {
      const float* row =
          centre + dv * static_cast<std::ptrdiff_t>(inverse_.stride) - radius_ + group;
      float* weights = weight_ + (dv + radius_) * kStride + group;
      const float y = static_cast<float>(dv), away = std::abs(y), shift = near.b * y;
      float weight[kLanes];
      for (int i = 0; i < kLanes; ++i) {
        const float value = row[i];
        const float reach = along[i] > away ? along[i] : away;
        const float difference = (value - middle) * unit;
        weight[i] = weight_in_gate(value, difference, predicted[i] + shift, gate + slope * reach,
                                   exists[i]);
        const float e = weight[i] > 0 ? difference : 0.0F;
        count[i] += weight[i];
        y1[i] += y * weight[i];
        y2[i] += y * y * weight[i];
        e1[i] += e;
        ye[i] += y * e;
      }
      for (int i = 0; i < kLanes; ++i) weights[i] = weight[i];
    }
    float x[kLanes], xx[kLanes];
    for (int i = 0; i < kLanes; ++i) x[i] = offset_[group + i], xx[i] = x[i] * x[i];
    sums.n += fold(count), sums.u += fold_product(x, count), sums.uu += fold_product(xx, count);
    sums.v += fold(y1), sums.uv += fold_product(x, y1), sums.vv += fold(y2);
    sums.e += fold(e1), sums.ue += fold_product(x, e1), sums.ve += fold(ye);
  }
  return plane_of_sums(sums);
}

}  // namespace vpm
