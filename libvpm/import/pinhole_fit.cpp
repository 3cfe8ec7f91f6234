#include "libvpm/import/pinhole_fit.h"

#include <algorithm>
#include <cstdio>

namespace vpm {
namespace {

bool is_seen(Vec3 p) {
  return is_finite(p) && p.z > 0;
}

// Fits pixel = focal * slope + centre by least squares, where slope is x/z or y/z of a point.
class LineFit {
 public:
  void add(double slope, double pixel) {
    n_ += 1, s_ += slope, p_ += pixel, ss_ += slope * slope, sp_ += slope * pixel;
    pp_ += pixel * pixel;
  }
  // Returns n^2 times the variance of the slopes. It is 0 but for rounding if all are equal.
  double spread() const { return n_ * ss_ - s_ * s_; }
  bool solvable() const { return n_ >= 2 && spread() > 1e-12 * n_ * ss_; }
  double focal() const { return covariance() / spread(); }
  double centre() const { return (p_ - focal() * s_) / n_; }
  // True if a line tells nearly all of the pixels.
  bool is_line() const {
    constexpr double kTold = 0.999;
    const double pixels = n_ * pp_ - p_ * p_;
    return solvable() && covariance() * covariance() > kTold * spread() * pixels;
  }

 private:
  double covariance() const { return n_ * sp_ - s_ * p_; }

  double n_ = 0, s_ = 0, p_ = 0, ss_ = 0, sp_ = 0, pp_ = 0;
};

// Fits a pinhole camera to points (x, y, z) whose pixels are known: column = fx x/z + cx and row =
// fy y/z + cy.
struct GridLines {
  LineFit column_of_x, row_of_y, column_of_y, row_of_x;
  std::size_t seen = 0;
};

GridLines lines_of(const PointSet& points) {
  GridLines lines;
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    const Vec3 p = points.positions[i];
    if (!is_seen(p)) continue;
    ++lines.seen;
    const std::size_t u = i % points.width, v = i / points.width;
    const auto column = static_cast<double>(u), row = static_cast<double>(v);
    lines.column_of_x.add(p.x / p.z, column);
    lines.column_of_y.add(p.y / p.z, column);
    lines.row_of_x.add(p.x / p.z, row);
    lines.row_of_y.add(p.y / p.z, row);
  }
  return lines;
}

// Tells how the grid of a pinhole camera is turned or mirrored, and what may be done.
struct Arrangement {
  std::string words;  // "" if it is neither, or no such grid
  bool is_mirrored = false;
};

Arrangement arrangement_of(const GridLines& lines) {
  if (lines.column_of_y.is_line() && lines.row_of_x.is_line()) {
    const std::string words = "its columns go along y and its rows along x: the grid is ";
    const bool is_mirrored = lines.column_of_y.focal() * lines.row_of_x.focal() > 0;
    return {words + (is_mirrored ? "transposed, and so mirrored" : "turned by 90 degrees"),
            is_mirrored};
  }
  if (!lines.column_of_x.is_line() || !lines.row_of_y.is_line()) return {};
  const bool is_left = lines.column_of_x.focal() < 0, is_up = lines.row_of_y.focal() < 0;
  if (is_left && is_up)
    return {"its columns go against x and its rows against y: the grid is turned by 180 degrees",
            false};
  if (is_left) return {"its columns go against x: the grid is mirrored left to right", true};
  if (is_up) return {"its rows go against y: the grid is upside down, and so mirrored", true};
  return {};
}

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
  const GridLines lines = lines_of(points);
  const LineFit &across = lines.column_of_x, &down = lines.row_of_y;
  if (!across.solvable() || !down.solvable()) return {};
  const Intrinsics k{across.focal(), down.focal(), across.centre(), down.centre()};
  return k.fx > 0 && k.fy > 0 ? fit_of(points, k) : PinholeFit{k, HUGE_VAL, 0};
}

std::string cure_of(const PointSet& points, bool is_placed) {
  const Arrangement arrangement = arrangement_of(lines_of(points));
  if (arrangement.words.empty()) {
    return is_placed ? "points of a lidar need normals"
                     : "points in the world's frame need their camera's `camera_pose`, and those "
                       "of a lidar normals";
  }
  if (arrangement.is_mirrored) return "mirror the grid back, or give its depth image";
  return is_placed ? "turn the grid back, or give its depth image"
                   : "turn the grid back, or give its depth image, or for points in the world's "
                     "frame their camera's `camera_pose`";
}

std::string words_of(const PinholeFit& fit, const PointSet& points) {
  const Intrinsics& k = fit.intrinsics;
  const GridLines lines = lines_of(points);
  if (std::string words = arrangement_of(lines).words; !words.empty()) return words;
  if (!lines.column_of_x.solvable() || !lines.row_of_y.solvable()) {
    return std::to_string(lines.seen) + " of its " + std::to_string(points.positions.size()) +
           " points have z > 0, and their directions are too few to tell the camera";
  }
  char text[256];
  if (fit.residual == HUGE_VAL) {
    std::snprintf(text, sizeof text,
                  "its points tell the focal lengths %.4g and %.4g, which are not positive", k.fx,
                  k.fy);
  } else {
    std::snprintf(text, sizeof text,
                  "point (%zu, %zu) is %.3g pixels from where fx %.6g fy %.6g cx %.6g cy %.6g see "
                  "it, more than %.3g",
                  fit.point % points.width, fit.point / points.width, fit.residual, k.fx, k.fy,
                  k.cx, k.cy, kPinholeTolerance);
  }
  return text;
}

}  // namespace vpm
