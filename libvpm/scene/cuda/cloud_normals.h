// Estimates the normals of a tile of a depth image, with the sums of libvpm/cloud/normal_rows_*.cpp
// and normal_window.cpp in the same order: a thread for each column, then for each pixel.
#pragma once

#include "libvpm/scene/cuda/cloud_tile.h"
#include "libvpm/scene/cuda/gated_window.h"

namespace vpm::cuda {

// Describes a block's tile while normals are estimated.
template <class Frame>
struct TileImage {
  Frame frame;
  const float *inverse, *depth;  // with the margin (tile_around.h); depth only if kNeedsDepth
  const double *ray_x, *ray_y;   // per column and per row of the tile

  __device__ TileAround inverse_around(int x, int y) const {
    return {inverse + frame.index(x, y), frame.pitch()};
  }
  __device__ TileAround depth_around(int x, int y) const {
    return {depth + frame.index(x, y), frame.pitch()};
  }
  // Return the part of the windows about a column, and about a row, that lies in the image.
  template <bool kMayBeCut>
  __device__ auto across(int x) const {
    return span<kMayBeCut>(frame.u0 + x, frame.width);
  }
  template <bool kMayBeCut>
  __device__ auto down(int y) const {
    return span<kMayBeCut>(frame.v0 + y, frame.height);
  }
  // True if a pixel's window determines a plane, should it be smooth. `shape` is that of a whole
  // window and becomes that of this one.
  template <bool kMayBeCut>
  __device__ __forceinline__ bool tells_plane(int x, int y, WindowShape& shape) const {
    if constexpr (kMayBeCut) {
      const Span along = across<true>(x), upright = down<true>(y);
      if (!vpm::tells_plane(along, upright)) return false;
      shape = WindowShape(along, upright);
    }
    return true;
  }

 private:
  template <bool kMayBeCut>
  __device__ auto span(int at, int size) const {
    if constexpr (kMayBeCut)
      return span_of(at, size, frame.radius());
    else
      return WholeSpan{frame.radius()};
  }
};

// Return the extent of inverse depth in a column, and in a window, about the middle.
__device__ __forceinline__ Extent extent_of_column(const TileAround& inverse, int radius) {
  Extent extent(inverse.at(0, 0));
#pragma unroll
  for (int d = 1; d <= radius; ++d)
    extent.take(Extent(inverse.at(0, d)), Extent(inverse.at(0, -d)));
  return extent;
}
template <class Column>
__device__ __forceinline__ Extent extent_of_window(const Column* column, int radius) {
  Extent extent = column->extent;
#pragma unroll
  for (int d = 1; d <= radius; ++d) extent.take(column[d].extent, column[-d].extent);
  return extent;
}

// Estimates normals from inverse depth. Like PcaNormals it provides what is kept of a column, the
// sums down a column, and the normals of smooth windows and of gated ones.
template <class Tile>
class InverseDepthNormals {
 public:
  using Frame = Tile;
  static constexpr bool kNeedsDepth = false;
  static constexpr int kMostBlocks = 5;  // per multiprocessor
  struct alignas(16) Column {
    PlaneColumn<float> sums;
    Extent extent;
  };

  __device__ __forceinline__ InverseDepthNormals(const CloudRecipe& recipe,
                                                 const TileImage<Frame>& image)
      : recipe_(recipe), image_(image) {}

  // Sums down column x (from -radius on) about row y.
  template <bool kMayBeCut>
  __device__ __forceinline__ Column sum_column(int x, int y) const {
    const TileAround inverse = image_.inverse_around(x, y);
    return {sum_rows<float>(image_.template down<kMayBeCut>(y), radius(),
                            [&](int dv) { return inverse.at(0, dv); }),
            extent_of_column(inverse, radius())};
  }

  // Computes the normal of a pixel from its `column` and those beside it. False if its window is
  // not smooth.
  template <bool kMayBeCut>
  __device__ __forceinline__ bool smooth_normal(const Column* column, int x, int y,
                                                Vec3f& normal) const {
    const float centre = image_.inverse_around(x, y).at(0, 0);
    if (!extent_of_window(column, radius()).is_smooth(centre, recipe_.edges)) return false;
    WindowShape shape = recipe_.whole;
    if (!image_.template tells_plane<kMayBeCut>(x, y, shape)) return false;
    const PlaneWindow<float> sums = sum_columns<float>(
        image_.template across<kMayBeCut>(x), radius(), [&](int du) { return column[du].sums; });
    normal = normal_of_smooth_window(shape, plane_of_sums(shape, sums, centre), fx(), fy(),
                                     du_axis(x), dv_axis(y));
    return true;
  }

  __device__ __forceinline__ Vec3f gated_normal(int x, int y) const {
    const GatedWindow<Frame::kRadius> window(image_.inverse_around(x, y), radius(), recipe_.edges);
    LastChoice last;
    return normal_of_window(window.fit(last), fx(), fy(), du_axis(x), dv_axis(y));
  }

 private:
  __device__ int radius() const { return image_.frame.radius(); }
  __device__ __forceinline__ float fx() const {
    return static_cast<float>(recipe_.camera.intrinsics.fx);
  }
  __device__ __forceinline__ float fy() const {
    return static_cast<float>(recipe_.camera.intrinsics.fy);
  }
  __device__ __forceinline__ float du_axis(int x) const {
    return static_cast<float>(recipe_.camera.intrinsics.cx - (image_.frame.u0 + x));
  }
  __device__ __forceinline__ float dv_axis(int y) const {
    return static_cast<float>(recipe_.camera.intrinsics.cy - (image_.frame.v0 + y));
  }

  const CloudRecipe& recipe_;
  TileImage<Frame> image_;
};

template <class Tile>
class PcaNormals {
 public:
  using Frame = Tile;
  static constexpr bool kNeedsDepth = true;
  static constexpr int kMostBlocks = 4;
  struct Column {
    ColumnOffsets<float> sums;
    Extent extent;
  };

  __device__ __forceinline__ PcaNormals(const CloudRecipe& recipe, const TileImage<Frame>& image)
      : recipe_(recipe), image_(image) {}

  template <bool kMayBeCut>
  __device__ __forceinline__ Column sum_column(int x, int y) const {
    const TileAround depth = image_.depth_around(x, y);
    return {sum_offset_rows<float>(image_.template down<kMayBeCut>(y), radius(),
                                   [&](int dv) { return depth.at(0, dv); }),
            extent_of_column(image_.inverse_around(x, y), radius())};
  }

  template <bool kMayBeCut>
  __device__ __forceinline__ bool smooth_normal(const Column* column, int x, int y,
                                                Vec3f& normal) const {
    const float inverse = image_.inverse_around(x, y).at(0, 0);
    const Extent extent = extent_of_window(column, radius());
    if (!extent.is_smooth(inverse, recipe_.edges) || !extent.is_in_floats(recipe_.edges))
      return false;
    WindowShape shape = recipe_.whole;
    if (!image_.template tells_plane<kMayBeCut>(x, y, shape)) return false;
    const TileAround depth = image_.depth_around(x, y);
    const int u = image_.frame.u0 + x, side = reference_of(u) - u;
    const float reference = depth.at(side, 0);
    const auto down = image_.template down<kMayBeCut>(y);
    const WindowOffsets<float> sums =
        sum_offset_columns<float>(image_.template across<kMayBeCut>(x), radius(), [&](int du) {
          return about_reference(column[du].sums, depth.at(du, 0) - reference, down);
        });
    const float rx = ray_x(x), ry = ray_y(y);
    normal =
        normal_of_covariance(covariance_of_offsets(sums, image_.inverse_around(x, y).at(side, 0),
                                                   shape, recipe_.scale, rx, ry),
                             rx, ry);
    return true;
  }

  __device__ __forceinline__ Vec3f gated_normal(int x, int y) const {
    const GatedWindow<Frame::kRadius> window(image_.inverse_around(x, y), radius(), recipe_.edges);
    LastChoice last;
    if (!window.fit(last).found) return {};
    const Moments m = window.moments(last, image_.depth_around(x, y));
    const float rx = ray_x(x), ry = ray_y(y);
    return normal_of_covariance(covariance_of_moments(m, recipe_.exact_scale, rx, ry), rx, ry);
  }

 private:
  __device__ int radius() const { return image_.frame.radius(); }
  __device__ __forceinline__ float ray_x(int x) const {
    return static_cast<float>(image_.ray_x[x]);
  }
  __device__ __forceinline__ float ray_y(int y) const {
    return static_cast<float>(image_.ray_y[y]);
  }

  const CloudRecipe& recipe_;
  TileImage<Frame> image_;
};

}  // namespace vpm::cuda
