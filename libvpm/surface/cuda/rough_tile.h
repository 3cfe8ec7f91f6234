// Normals of those windows of a block's tile that are not smooth.
#pragma once

#include "libvpm/surface/cuda/gated_window.h"
#include "libvpm/surface/cuda/smooth_tile.h"

namespace vpm::cuda {

// What is known of them, in a block's shared memory: windows with an edge in front, the others at
// the end, and the planes that their last choices are made by.
struct RoughFits {
  std::uint16_t pixel[SmoothShape::kPixels];
  bool found[SmoothShape::kPixels];
  float a[SmoothShape::kPixels], b[SmoothShape::kPixels], c[SmoothShape::kPixels];
};
struct RoughCounts {
  unsigned with_edge, without;
};

// Few windows by eight lanes each, so that they take no longer than they must: everybody waits for
// the slowest block. Many by two, so that a block has use for all of its own: all of the first
// choices, then the last choices of windows that have an edge.
template <class Smooth, NormalMethod kMethod>
class RoughTile {
 public:
  static constexpr int kThreads = Smooth::kThreads;

  static_assert(sizeof(RoughFits) <= SmoothTile<Smooth>::kColumnBytes);

  __device__ RoughTile(const CloudRecipe& recipe, const SmoothTile<Smooth>& tile,
                       RoughCounts& counts, RoughFits& fits, Vec3f* normals)
      : recipe_(recipe), tile_(tile), counts_(counts), fits_(fits), normals_(normals) {}

  // By all threads of the block.
  __device__ void find(const RoughPixels& rough) const {
    if (rough.count <= kThreads / kFoldedColumns)
      find_few(rough);
    else
      find_many(rough);
  }

 private:
  using Window = GatedWindow<Smooth::kRadius>;
  static constexpr unsigned kLast = SmoothShape::kPixels - 1;

  __device__ Window window(unsigned pixel) const {
    return Window(tile_.inverse_around(x(pixel), y(pixel)), tile_.radius(), recipe_.edges);
  }
  __device__ static int x(unsigned pixel) { return static_cast<int>(pixel % SmoothShape::kWidth); }
  __device__ static int y(unsigned pixel) { return static_cast<int>(pixel / SmoothShape::kWidth); }

  __device__ __forceinline__ void find_few(const RoughPixels& rough) const {
    const Lanes<kFoldedColumns> lanes;
    for_windows(rough.count, lanes, [&](unsigned i, bool is_there) {
      const unsigned pixel = rough.of[i];
      LastChoice last;
      const WindowPlane plane = window(pixel).fit(lanes, last);
      if constexpr (kMethod == NormalMethod::pca) {
        const Moments m = window(pixel).moments(lanes, last, depth_around(pixel));
        if (is_there && plane.found) write(pixel, m);
      } else {
        if (is_there) write(pixel, plane);
      }
    });
  }
  __device__ __forceinline__ void find_many(const RoughPixels& rough) const {
    choose_first(rough);
    __syncthreads();
    choose_last();
    if constexpr (kMethod == NormalMethod::pca) {
      __syncthreads();
      find_moments();
    }
  }

  // Calls body(i, is_there) for each window, in whole warps; is_there: in one of its lanes, if
  // there is such a window.
  template <class Lanes, class Body>
  __device__ __forceinline__ static void for_windows(unsigned count, const Lanes& lanes,
                                                     const Body& body) {
    constexpr unsigned kLanes = lanes.kCount;
#pragma unroll 1
    for (unsigned begin = threadIdx.x / 32 * 32 / kLanes; begin < count;
         begin += kThreads / kLanes) {
      const unsigned i = begin + threadIdx.x % 32 / kLanes;
      body(i < count ? i : count - 1, i < count && threadIdx.x % kLanes == 0);
    }
  }

  __device__ __forceinline__ void choose_first(const RoughPixels& rough) const {
    const Lanes<2> lanes;
    for_windows(rough.count, lanes, [&](unsigned i, bool is_there) {
      const unsigned pixel = rough.of[i];
      bool has_edge;
      const WindowPlane plane = window(pixel).choose_first(lanes, has_edge);
      if (!is_there || !plane.found) return;
      if (has_edge)
        note(atomicAdd(&counts_.with_edge, 1U), pixel, plane);
      else if constexpr (kMethod == NormalMethod::pca)
        note(kLast - atomicAdd(&counts_.without, 1U), pixel, {});
      else
        write(pixel, plane);
    });
  }
  __device__ __forceinline__ void choose_last() const {
    const Lanes<2> lanes;
    for_windows(counts_.with_edge, lanes, [&](unsigned i, bool is_there) {
      const unsigned pixel = fits_.pixel[i];
      const WindowPlane plane = window(pixel).choose_last(lanes, near(i));
      if (!is_there) return;
      if constexpr (kMethod == NormalMethod::pca) {
        fits_.found[i] = plane.found;
      } else {
        write(pixel, plane);
      }
    });
  }
  __device__ __forceinline__ void find_moments() const {
    const unsigned with_edge = counts_.with_edge, count = with_edge + counts_.without;
#pragma unroll 1
    for (unsigned k = threadIdx.x; k < count; k += kThreads) {
      const unsigned i = k < with_edge ? k : kLast - (k - with_edge), pixel = fits_.pixel[i];
      if (!fits_.found[i]) continue;
      const LastChoice last{near(i), k < with_edge ? recipe_.edges.gate : HUGE_VALF};
      write(pixel, window(pixel).moments(Lanes<1>(), last, depth_around(pixel)));
    }
  }

  __device__ void note(unsigned i, unsigned pixel, const WindowPlane& plane) const {
    fits_.pixel[i] = static_cast<std::uint16_t>(pixel), fits_.found[i] = true;
    fits_.a[i] = plane.a, fits_.b[i] = plane.b, fits_.c[i] = plane.c;
  }
  __device__ WindowPlane near(unsigned i) const {
    return {true, fits_.a[i], fits_.b[i], fits_.c[i]};
  }
  __device__ void write(unsigned pixel, const WindowPlane& plane) const {
    const Intrinsics& k = recipe_.camera.intrinsics;
    normals_[tile_.pixel_of(x(pixel), y(pixel))] =
        normal_of_window(plane, static_cast<float>(k.fx), static_cast<float>(k.fy),
                         tile_.rays().x(x(pixel)), tile_.rays().y(y(pixel)));
  }

  __device__ TileAround depth_around(unsigned pixel) const {
    return tile_.depth_around(x(pixel), y(pixel));
  }
  __device__ void write(unsigned pixel, const Moments& m) const {
    const float rx = tile_.rays().x(x(pixel)), ry = tile_.rays().y(y(pixel));
    normals_[tile_.pixel_of(x(pixel), y(pixel))] =
        normal_of_covariance(covariance_of_moments(m, recipe_.exact_scale, rx, ry), rx, ry);
  }

  const CloudRecipe& recipe_;
  const SmoothTile<Smooth>& tile_;
  RoughCounts& counts_;
  RoughFits& fits_;
  Vec3f* normals_;
};

}  // namespace vpm::cuda
