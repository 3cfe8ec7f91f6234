// Signed distances of a scene on a dense grid of floats: the voxmap of voxmap-pointshell as it is
// made today (Barbic and James 2008), trilinear between samples.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include "libvpm/cloud/cloud.h"
#include "libvpm/core/box.h"

namespace vpm::bench {

class DistanceField {
 public:
  // Samples a signed distance, m, negative inside the scene, from several threads.
  DistanceField(const Box& box, double voxel, const std::function<double(Vec3)>& distance);

  // Makes the field of measured points with normals. The points of a voxel are averaged, which
  // takes out some noise; each sample takes the nearest of these averages, found by sweeps over the
  // grid, and its distance from the plane of that one where it lies beside it by less than two
  // voxels. The normal tells the side, also where nothing was measured behind a surface; but what a
  // camera sees clearly before the surface is free.
  static DistanceField of_points(const Cloud& cloud, const Box& box, double voxel);

  // A distance, m, and its gradient.
  struct Sample {
    float distance;
    Vec3f gradient;
  };

  // Return what the field says at a place, in voxels from the first sample (place()). The place
  // must be within the grid, but for distance(), which beyond it returns how far it is from the
  // grid, m: nothing counts as inside there.
  float distance(Vec3f at) const;
  Sample sample(Vec3f at) const;

  // Returns the pose that maps what `pose` maps to world coordinates, m, to voxels instead: rows of
  // floats and where the origin comes to.
  struct ToVoxels {
    Vec3f row0, row1, row2, origin;
    Vec3f operator()(Vec3f p) const {
      return {row0.x * p.x + row0.y * p.y + row0.z * p.z + origin.x,
              row1.x * p.x + row1.y * p.y + row1.z * p.z + origin.y,
              row2.x * p.x + row2.y * p.y + row2.z * p.z + origin.z};
    }
  };
  ToVoxels to_voxels(const Pose& pose) const;

  double voxel() const { return voxel_; }
  std::size_t bytes() const { return samples_.size() * sizeof samples_[0]; }
  // Returns the bytes() of a field over a box.
  static std::size_t bytes_of(const Box& box, double voxel);
  // Returns the places of the samples inside, m, as a solid's voxels.
  std::vector<Vec3f> places_inside() const;

 private:
  DistanceField(const Box& box, double voxel);
  static std::array<int, 3> count_of(const Box& box, double voxel);
  struct Nearest;
  Nearest surfels_of(const Cloud& cloud) const;
  void sweep(int si, int sj, int sk, Nearest& nearest) const;
  struct Cell {
    const float* first;
    Vec3f part;
  };
  Cell cell_of(Vec3f at) const;
  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(count_[1]) +
            static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(count_[0]) +
           static_cast<std::size_t>(i);
  }
  Vec3 place(int i, int j, int k) const {
    return low_ +
           voxel_ * Vec3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
  }

  Vec3 low_;
  double voxel_;
  std::array<int, 3> count_{};
  std::ptrdiff_t row_ = 0, layer_ = 0;  // samples
  std::vector<float> samples_;          // x runs fastest
};

inline DistanceField::Cell DistanceField::cell_of(Vec3f at) const {
  const int i = static_cast<int>(at.x), j = static_cast<int>(at.y), k = static_cast<int>(at.z);
  return {
      samples_.data() + index(i, j, k),
      {at.x - static_cast<float>(i), at.y - static_cast<float>(j), at.z - static_cast<float>(k)}};
}

inline float DistanceField::distance(Vec3f at) const {
  const float last[3] = {static_cast<float>(count_[0] - 1), static_cast<float>(count_[1] - 1),
                         static_cast<float>(count_[2] - 1)};
  if (!(at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < last[0] && at.y < last[1] &&
        at.z < last[2])) {
    const float beyond =
        std::max({-at.x, -at.y, -at.z, at.x - last[0], at.y - last[1], at.z - last[2]});
    return static_cast<float>(voxel_) * std::max(beyond, 0.0F);
  }
  const auto [d, f] = cell_of(at);
  const auto along_x = [&](const float* p) { return p[0] + f.x * (p[1] - p[0]); };
  const auto plane = [&](const float* p) {
    const float low = along_x(p);
    return low + f.y * (along_x(p + row_) - low);
  };
  const float low = plane(d);
  return low + f.z * (plane(d + layer_) - low);
}

inline DistanceField::Sample DistanceField::sample(Vec3f at) const {
  const auto [d, f] = cell_of(at);
  const float* const e = d + layer_;
  const float x00 = d[1] - d[0], x10 = d[row_ + 1] - d[row_], x01 = e[1] - e[0],
              x11 = e[row_ + 1] - e[row_];
  const float v00 = d[0] + f.x * x00, v10 = d[row_] + f.x * x10, v01 = e[0] + f.x * x01,
              v11 = e[row_] + f.x * x11;
  const float y0 = v10 - v00, y1 = v11 - v01, v0 = v00 + f.y * y0, v1 = v01 + f.y * y1;
  const float x0 = x00 + f.y * (x10 - x00), x1 = x01 + f.y * (x11 - x01);
  const auto per_metre = static_cast<float>(1 / voxel_);
  return {v0 + f.z * (v1 - v0),
          {per_metre * (x0 + f.z * (x1 - x0)), per_metre * (y0 + f.z * (y1 - y0)),
           per_metre * (v1 - v0)}};
}

}  // namespace vpm::bench
