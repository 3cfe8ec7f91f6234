#include "libvpm/cloud/normal_window.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libvpm/core/parallel.h"

namespace vpm {
namespace {

// Tangent of the steepest surface (80 degrees off the image plane) whose pixels the first choice
// of a gated window admits; beyond it a sensor returns next to nothing.
constexpr double kSteepest = 5.7;

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
      for (int u = 0; u < padded.width; ++u)
        to[u] = from[u] >= kMinDepth && from[u] <= kMaxDepth ? from[u] : 0.0F;
    }
  });
  return padded;
}

PaddedImage inverse_of(const PaddedImage& depth) {
  PaddedImage inverse = depth;
  parallel_for(static_cast<std::size_t>(depth.height), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      float* row = inverse.at(0, static_cast<int>(v));
      for (int u = 0; u < inverse.width; ++u) {
        const float reciprocal = 1.0F / (row[u] > 0 ? row[u] : 1.0F);
        row[u] = row[u] > 0 ? reciprocal : 0.0F;
      }
    }
  });
  return inverse;
}

SmoothWindows::SmoothWindows(const PaddedImage& inverse, const NormalOptions& options)
    : inverse_(inverse), radius_(options.window / 2) {
  const double gate = options.edge_gate;
  // Without a gate every measured pixel passes; 0 stands for what was not measured.
  lowest_ = gate > 0 ? static_cast<float>(1 - gate) : 0.0F;
  highest_ = gate > 0 ? static_cast<float>(1 + gate) : std::numeric_limits<float>::infinity();
  column_min_.resize(inverse.stride);
  column_max_.resize(inverse.stride);
  window_min_.resize(inverse.stride);
  window_max_.resize(inverse.stride);
  smooth_.resize(static_cast<std::size_t>(inverse.width));
}

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
    smooth[u] = (low[u] > 0) & (low[u] >= lowest_ * centre[u]) & (high[u] <= highest_ * centre[u]);
  }
}

GatedWindow::GatedWindow(const PaddedImage& inverse, const NormalOptions& options,
                         const Intrinsics& k)
    : inverse_(inverse), radius_(options.window / 2) {
  constexpr float kOpen = std::numeric_limits<float>::infinity();
  lanes_ = (options.window + kLanes - 1) / kLanes * kLanes;
  gate_ = options.edge_gate > 0 ? static_cast<float>(options.edge_gate) : kOpen;
  slope_ = static_cast<float>(kSteepest / std::min(k.fx, k.fy));
  for (int i = 0; i < options.window; ++i) {
    lane_offset_[i] = static_cast<float>(i - radius_);
    lane_exists_[i] = 1;
  }
}

GatedWindow::Plane GatedWindow::fit(int u, int v) {
  const float* centre = inverse_.at(u, v);
  const Plane first = fit_admitted(centre, {}, gate_, slope_);
  return first.found ? fit_admitted(centre, first, gate_, 0) : first;
}

GatedWindow::Plane GatedWindow::fit_admitted(const float* centre, const Plane& near, float gate,
                                             float slope) {
  const float unit = 1.0F / *centre;
  for (int i = 0; i < lanes_; ++i) count_[i] = v_[i] = vv_[i] = e_[i] = ve_[i] = 0;
  for (int dv = -radius_; dv <= radius_; ++dv) {
    const float* row = centre + dv * static_cast<std::ptrdiff_t>(inverse_.stride) - radius_;
    float* weights = weight_ + (dv + radius_) * kStride;
    const float y = static_cast<float>(dv), away = std::abs(y), base = near.c + near.b * y;
    for (int i = 0; i < lanes_; ++i) {
      const float along = std::abs(lane_offset_[i]);
      const float allowed = gate + slope * (along > away ? along : away);
      const float difference = (row[i] - *centre) * unit;
      const float off = std::abs(difference - (base + near.a * lane_offset_[i]));
      const float weight = (row[i] > 0) & (off <= allowed) ? lane_exists_[i] : 0.0F;
      const float e = weight > 0 ? difference : 0.0F;
      weights[i] = weight;
      count_[i] += weight;
      v_[i] += y * weight;
      vv_[i] += y * y * weight;
      e_[i] += e;
      ve_[i] += y * e;
    }
  }
  return solve();
}

GatedWindow::Plane GatedWindow::solve() const {
  double n = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0, e = 0, ue = 0, ve = 0;
  for (int i = 0; i <= 2 * radius_; ++i) {
    const double x = i - radius_;
    n += count_[i], u += x * count_[i], uu += x * x * count_[i];
    v += v_[i], uv += x * v_[i], vv += vv_[i];
    e += e_[i], ue += x * e_[i], ve += ve_[i];
  }
  // Moments about the pixels' mean, times n: integers, exact in double.
  const double cuu = n * uu - u * u, cuv = n * uv - u * v, cvv = n * vv - v * v;
  const double determinant = cuu * cvv - cuv * cuv;
  if (n < kMinSupport || determinant < kMinSpread * n * n * (cuu + cvv)) return {};
  const double cue = n * ue - u * e, cve = n * ve - v * e;
  const double a = (cue * cvv - cve * cuv) / determinant;
  const double b = (cve * cuu - cue * cuv) / determinant;
  const double c = (e - a * u - b * v) / n;
  return {true, static_cast<float>(a), static_cast<float>(b), static_cast<float>(c)};
}

}  // namespace vpm
