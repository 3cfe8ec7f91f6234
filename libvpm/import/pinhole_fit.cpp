#include "libvpm/import/pinhole_fit.h"

#include <algorithm>
#include <cstdio>

namespace vpm {
namespace {

bool is_seen(Vec3 p) {
  return is_finite(p) && p.z > 0;
}

// Least squares of pixel = focal * slope + centre.
class LineFit {
 public:
  void add(double slope, double pixel) {
    n_ += 1, s_ += slope, p_ += pixel, ss_ += slope * slope, sp_ += slope * pixel;
  }
  // Returns the variance of slopes times n^2, which is mere rounding if all are equal.
  double spread() const { return n_ * ss_ - s_ * s_; }
  bool solvable() const { return n_ >= 2 && spread() > 1e-12 * n_ * ss_; }
  double focal() const { return (n_ * sp_ - s_ * p_) / spread(); }
  double centre() const { return (p_ - focal() * s_) / n_; }

 private:
  double n_ = 0, s_ = 0, p_ = 0, ss_ = 0, sp_ = 0;
};

}  // namespace

PinholeFit fit_of(const PointSet& points, const Intrinsics& k) {
  PinholeFit fit{k, 0, 0};
  bool sees_any = false;
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    const Vec3 p = points.positions[i];
    if (!is_seen(p)) continue;
    sees_any = true;
    const std::size_t column = i % points.width, row = i / points.width;
    const double u = k.fx * p.x / p.z + k.cx - static_cast<double>(column);
    const double v = k.fy * p.y / p.z + k.cy - static_cast<double>(row);
    const double off = std::max(std::abs(u), std::abs(v));
    if (off > fit.residual) {
      fit.residual = off;
      fit.point = i;
    }
  }
  if (!sees_any) fit.residual = HUGE_VAL;
  return fit;
}

PinholeFit fit_pinhole(const PointSet& points) {
  LineFit across, down;
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    const Vec3 p = points.positions[i];
    if (!is_seen(p)) continue;
    const std::size_t column = i % points.width, row = i / points.width;
    across.add(p.x / p.z, static_cast<double>(column));
    down.add(p.y / p.z, static_cast<double>(row));
  }
  if (!across.solvable() || !down.solvable()) return {};
  const Intrinsics k{across.focal(), down.focal(), across.centre(), down.centre()};
  return k.fx > 0 && k.fy > 0 ? fit_of(points, k) : PinholeFit{k, HUGE_VAL, 0};
}

std::string words_of(const PinholeFit& fit, const PointSet& points) {
  const Intrinsics& k = fit.intrinsics;
  if (k.fx == 0) return "too few of its points have z > 0 to tell the camera";
  char text[256];
  if (fit.residual == HUGE_VAL) {
    std::snprintf(text, sizeof text,
                  "its points tell the focal lengths %.4g and %.4g, which are not positive", k.fx,
                  k.fy);
  } else {
    std::snprintf(text, sizeof text,
                  "point (%zu, %zu) is %.3g pixels away from where the pinhole camera "
                  "fx %.6g fy %.6g cx %.6g cy %.6g sees it (at most %.3g is accepted)",
                  fit.point % points.width, fit.point / points.width, fit.residual, k.fx, k.fy,
                  k.cx, k.cy, kPinholeTolerance);
  }
  return text;
}

}  // namespace vpm
