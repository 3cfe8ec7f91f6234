#include "libvpm/import/pinhole_fit.h"

#include <algorithm>
#include <cstdio>

#include "libvpm/core/error.h"
#include "libvpm/import/depth_files.h"

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

struct Residual {
  double largest = 0;
  std::size_t point = 0;
};

Residual largest_residual(const PointSet& points, const Intrinsics& k) {
  Residual worst;
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    const Vec3 p = points.positions[i];
    if (!is_seen(p)) continue;
    const std::size_t column = i % points.width, row = i / points.width;
    const double u = k.fx * p.x / p.z + k.cx - static_cast<double>(column);
    const double v = k.fy * p.y / p.z + k.cy - static_cast<double>(row);
    const double off = std::max(std::abs(u), std::abs(v));
    if (off > worst.largest) worst = {off, i};
  }
  return worst;
}

std::string describe(const Residual& residual, const PointSet& points, const Intrinsics& k) {
  char text[256];
  std::snprintf(text, sizeof text,
                "point (%zu, %zu) is %.3g pixels away from where the pinhole camera "
                "fx %.6g fy %.6g cx %.6g cy %.6g sees it (at most %.3g is accepted)",
                residual.point % points.width, residual.point / points.width, residual.largest,
                k.fx, k.fy, k.cx, k.cy, kPinholeTolerance);
  return text;
}

}  // namespace

Intrinsics fit_pinhole(const PointSet& points, const std::string& name) {
  LineFit across, down;
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    const Vec3 p = points.positions[i];
    if (!is_seen(p)) continue;
    const std::size_t column = i % points.width, row = i / points.width;
    across.add(p.x / p.z, static_cast<double>(column));
    down.add(p.y / p.z, static_cast<double>(row));
  }
  if (!across.solvable() || !down.solvable()) {
    refuse("too few points with z > 0 to tell the camera", name, "give `intrinsics` fx,fy,cx,cy");
  }
  const Intrinsics k{across.focal(), down.focal(), across.centre(), down.centre()};
  const Residual residual = largest_residual(points, k);
  if (!(k.fx > 0 && k.fy > 0 && residual.largest <= kPinholeTolerance)) {
    refuse("the organised cloud fits no pinhole camera with x right, y down, z forward: " +
               describe(residual, points, k),
           name);
  }
  return k;
}

void check_pinhole(const PointSet& points, const Intrinsics& k, const std::string& name) {
  const Residual residual = largest_residual(points, k);
  if (!(residual.largest <= kPinholeTolerance)) {
    refuse(
        "the organised cloud does not fit the intrinsics given: " + describe(residual, points, k),
        name, "leave `intrinsics` out to have them recovered");
  }
}

DepthImage depth_of(const PointSet& points, double units_per_metre) {
  DepthImage image{points.width, points.height, std::vector<float>(points.positions.size())};
  for (std::size_t i = 0; i < image.depth.size(); ++i) {
    const Vec3 p = points.positions[i];
    image.depth[i] = is_seen(p) ? depth_in_metres(p.z, units_per_metre) : 0.0F;
  }
  return image;
}

}  // namespace vpm
