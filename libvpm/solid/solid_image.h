// What a camera sees of a solid at a pose: the nearest and the farthest surface in each pixel.
//
// Drawn, not traced: vertices are projected once, and each triangle widens the range of the pixels
// whose squares it meets. A square that an edge only touches counts, so no pixel that sees a part
// of the solid is missed. The order of triangles changes no bit.
#pragma once

#include <vpm/camera.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "libvpm/core/pose.h"
#include "libvpm/solid/solid_surface.h"

namespace vpm {

// A solid's triangles, ready to be drawn; immutable.
class DrawnSolid {
 public:
  explicit DrawnSolid(const SolidSurface& surface);

  std::size_t vertices() const { return x_.size(); }
  const std::vector<Triangle>& triangles() const { return triangles_; }
  // Return the vertices' coordinates about center(), m.
  const float* x() const { return x_.data(); }
  const float* y() const { return y_.data(); }
  const float* z() const { return z_.data(); }
  Vec3 center() const { return center_; }  // of mass, in the mesh's frame
  double reach() const { return reach_; }  // largest distance of a vertex from it, m

 private:
  std::vector<float> x_, y_, z_;
  std::vector<Triangle> triangles_;
  Vec3 center_;
  double reach_;
};

// Rectangle of pixels: columns from u0 to before u1 and rows from v0 to before v1. It may reach
// beyond the image.
struct PixelWindow {
  int u0 = 0, v0 = 0, u1 = 0, v1 = 0;

  int width() const { return u1 - u0; }
  int height() const { return v1 - v0; }
  bool is_empty() const { return u1 <= u0 || v1 <= v0; }
  // Returns the window with this many pixels more at each side.
  PixelWindow grown(int across, int down) const {
    return {u0 - across, v0 - down, u1 + across, v1 + down};
  }
};
PixelWindow common(const PixelWindow& a, const PixelWindow& b);

// Range of inverse depth, 1/m, that a solid has in a pixel. `nearest` is negative, so that both
// widen by a minimum; both are infinite where the solid is not.
struct DrawnRange {
  float farthest = std::numeric_limits<float>::infinity();  // least inverse depth
  float nearest = std::numeric_limits<float>::infinity();   // greatest inverse depth, negated
};

// Draws solids, one after the other, and keeps its memory. Belongs to one thread.
class SolidImage {
 public:
  // Projects a solid whose mesh `to_camera` maps to the camera's coordinates. Returns the pixels
  // that may see it, within `most`.
  PixelWindow project(const DrawnSolid& solid, const Pose& to_camera, const Intrinsics& k,
                      const PixelWindow& most);
  // Draws what was projected last into `window`, which is not empty.
  void draw(const PixelWindow& window);
  // Widens each pixel's range by those of the pixels at most `across` and `down` away. Ranges
  // within as many pixels of the window's sides are undefined then. To be called once after draw().
  void widen(int across, int down);
  // Empties the pixels whose greatest inverse depth is not in (low, high]. Returns false if all are
  // empty then.
  bool keep(float low, float high);

  const PixelWindow& window() const { return window_; }
  // Returns the ranges of a row of the window, from its column u0 on.
  const DrawnRange* row(int v) const { return ranges_.data() + (first_of(v) - moved_); }
  // Return the greatest and the least inverse depth of vertices before the camera; 0 if there are
  // none.
  float greatest_inverse() const { return greatest_inverse_; }
  float least_inverse() const { return least_inverse_; }
  // True if a triangle that was projected last may be nearer to the camera's plane than `depth`, m,
  // and within `margin`, m, of a place that the image shows.
  bool is_near(double depth, double margin, const PixelWindow& image) const;

 private:
  // A vertex in the image; `inverse` is negative where the vertex is not before the camera.
  struct Vertex {
    float u, v, inverse, negated;
  };

  // Returns the place of a row's first range.
  std::size_t first_of(int v) const {
    return static_cast<std::size_t>(v - window_.v0) * static_cast<std::size_t>(window_.width());
  }
  Vec3 vertex(std::uint32_t number) const;  // about the solid's centre of mass, m
  struct Batch;
  void draw_mapped(Batch& batch, Batch& rest);
  void draw_clipped(const Vec3 (&whole)[3], Batch& batch);
  void draw_batch(Batch& batch);

  const DrawnSolid* solid_ = nullptr;
  Pose to_camera_;  // from about the solid's centre of mass
  Intrinsics k_;
  double nearest_depth_ = 0;  // m; what is nearer to the camera's plane is cut off
  std::vector<Vertex> vertices_;
  std::vector<std::uint32_t> others_;  // triangles that are not small
  PixelWindow window_;
  std::vector<DrawnRange> ranges_;
  std::size_t moved_ = 0;  // places by which ranges lie before their pixels
  float greatest_inverse_ = 0, least_inverse_ = 0;
  bool has_behind_ = false;  // a vertex that is not before the camera
};

}  // namespace vpm
