// Normals of a block's tile of an image, where windows are smooth; the others are listed.
#pragma once

#include "libvpm/surface/cuda/smooth_windows.h"

namespace vpm::cuda {

// Pixels are read four at a time. Windows that are not smooth lie together: the more blocks share
// them, the shorter the longest takes.
struct SmoothShape {
  static constexpr int kWidth = 32, kHeight = 8, kPixels = kWidth * kHeight, kPack = 4;
};

// Pixels of a tile whose windows are not smooth, in a block's shared memory: y * kWidth + x.
struct RoughPixels {
  unsigned count;
  std::uint16_t of[SmoothShape::kPixels];
};

// Calls body(k) of 0 to `Count` - 1, by all of a block's threads.
template <int kThreads, int Count, class Body>
__device__ __forceinline__ void for_each_of(const Body& body) {
  int k = static_cast<int>(threadIdx.x);
  if constexpr (Count <= kThreads) {
    if (k < Count) body(k);
  } else {
#pragma unroll 1
    for (; k < Count; k += kThreads) body(k);
  }
}

// The tile of a block with its margin, in shared memory: the normals of smooth windows. `Smooth`
// tells how they are estimated (smooth_windows.h).
template <class Smooth>
class SmoothTile : private SmoothShape {
 public:
  static constexpr int kAtOnce = Smooth::kAtOnce, kThreads = Smooth::kThreads;
  using Extents = WindowExtents<kAtOnce, Smooth::kRadius>;
  static constexpr std::size_t kColumn = Extents::kBytes + Smooth::kBytes;

  __device__ SmoothTile(const CloudRecipe& recipe, void* shared)
      : recipe_(recipe),
        radius_(Smooth::kRadius > 0 ? Smooth::kRadius : recipe.window / 2),
        u0_(last_first(blockIdx.x, gridDim.x) * kWidth),
        v0_(last_first(blockIdx.y, gridDim.y) * kHeight),
        width_(static_cast<int>(recipe.camera.width)),
        height_(static_cast<int>(recipe.camera.height)),
        arrays_(shared),
        inverse_(arrays_.take<float>(rows() * pitch())),
        depth_(arrays_.take<float>(Smooth::kNeedsDepth ? rows() * pitch() : 0)),
        columns_(arrays_),
        extents_(arrays_, kHeight * pitch()),
        smooth_(arrays_, kHeight * pitch(), inverse_, depth_),
        rays_(arrays_, kWidth, kHeight) {}

  static constexpr std::size_t bytes(int radius) {
    const int pitch = kWidth + 2 * whole_packs(radius);
    const auto size = [](std::size_t of_one, int count) {
      return of_one * static_cast<std::size_t>(count);
    };
    return size(sizeof(float) * (Smooth::kNeedsDepth ? 2 : 1), (kHeight + 2 * radius) * pitch) +
           size(kColumn, kHeight * pitch) + size(Smooth::Rays::kBytes, kWidth + kHeight);
  }

  // Does not need the image.
  __device__ void find_rays() const {
    for_each_of<kThreads, kWidth>(
        [&](int i) { rays_.set_column(i, u0_ + i, recipe_.camera.intrinsics); });
    for_each_of<kThreads, kHeight>(
        [&](int i) { rays_.set_row(i, v0_ + i, recipe_.camera.intrinsics); });
  }
  __device__ __forceinline__ void load() const {
    const int packs = pitch() / kPack, count = rows() * packs;
    constexpr int kInFlight = 2;  // of each thread, before what they bring is stored
    for (int begin = static_cast<int>(threadIdx.x); begin < count; begin += kInFlight * kThreads) {
      Pack<float, kPack> inverse[kInFlight], depth[kInFlight];
#pragma unroll
      for (int i = 0; i < kInFlight; ++i) {
        const int k = begin + i * kThreads;
        const int u = u0_ - side() + k % packs * kPack, v = v0_ - radius_ + k / packs;
        const bool is_there = k < count && v >= 0 && v < height_ && u >= 0 && u < width_;
        inverse[i] = is_there ? read(recipe_.inverse, u, v, beyond_image()) : beyond();
        if constexpr (Smooth::kNeedsDepth)
          depth[i] = is_there ? read(recipe_.depth, u, v, 0) : Pack<float, kPack>{};
      }
#pragma unroll
      for (int i = 0; i < kInFlight; ++i) {
        const int k = begin + i * kThreads;
        if (k >= count) break;
#pragma unroll
        for (float& value : inverse[i].of) value = measured_or_none(value);
        put(inverse[i], inverse_, k);
        if constexpr (Smooth::kNeedsDepth) put(depth[i], depth_, k);
      }
    }
  }
  __device__ __forceinline__ void sum_columns() const {
    if constexpr (Smooth::kRadius == 0) {
      for (int k = static_cast<int>(threadIdx.x); k < kHeight * pitch(); k += kThreads)
        sum_columns(k % pitch(), k / pitch());
    } else {
      constexpr int kGroups = (kWidth + 2 * whole_packs(Smooth::kRadius)) / kAtOnce;  // of a row
      for_each_of<kThreads, kHeight * kGroups>(
          [&](int k) { sum_columns(k % kGroups * kAtOnce, k / kGroups); });
    }
  }
  // Writes those of smooth windows, and lists the others.
  __device__ __forceinline__ void find_smooth(RoughPixels& rough, Vec3f* normals) const {
    constexpr int kGroups = kWidth / kAtOnce;  // of a row
    static_assert(kHeight * kGroups % 32 == 0, "whole warps list windows");
    for_each_of<kThreads, kHeight * kGroups>([&](int k) {
      const int x = k % kGroups * kAtOnce, y = k / kGroups;
      list(find_smooth(x, y, normals), x, y, rough);
    });
  }

  // Memory that is free once all normals of smooth windows are found.
  __device__ SharedArrays columns() const {
    return columns_;
  }
  static constexpr std::size_t kColumnBytes = kColumn * kHeight * kWidth;  // of it, at least

  __device__ TileAround inverse_around(int x, int y) const {
    return {inverse_ + index(x, y), pitch()};
  }
  __device__ TileAround depth_around(int x, int y) const {
    return {depth_ + index(x, y), pitch()};
  }
  __device__ const typename Smooth::Rays& rays() const {
    return rays_;
  }
  __device__ int radius() const {
    return radius_;
  }
  // Of a pixel of the tile, in the image.
  __device__ std::ptrdiff_t pixel_of(int x, int y) const {
    return pixel(u0_ + x, v0_ + y);
  }

 private:
  __host__ __device__ static constexpr int whole_packs(int count) {
    return (count + kPack - 1) / kPack * kPack;
  }
  __device__ int side() const {
    return whole_packs(radius_);
  }
  __device__ int pitch() const {
    return kWidth + 2 * side();
  }
  __device__ int rows() const {
    return kHeight + 2 * radius_;
  }
  __device__ int index(int x, int y) const {
    return (y + radius_) * pitch() + side() + x;
  }
  __device__ std::ptrdiff_t pixel(int u, int v) const {
    return static_cast<std::ptrdiff_t>(v) * width_ + u;
  }

  // Blocks begin in their order: so, tiles at the image's border, which take longest, are not last.
  __device__ static int last_first(unsigned block, unsigned blocks) {
    return static_cast<int>(block == 0 ? blocks - 1 : block - 1);
  }
  // Whether the image's border cuts windows of the tile.
  __device__ bool may_be_cut() const {
    return cuts_windows(u0_, kWidth, width_, radius_) ||
           cuts_windows(v0_, kHeight, height_, radius_);
  }
  __device__ Span down(int y) const {
    return span_of(v0_ + y, height_, radius_);
  }

  // `beyond`: what is read beyond the image.
  __device__ __forceinline__ Pack<float, kPack> read(const float* image, int u, int v,
                                                     float beyond) const {
    const float* const from = image + pixel(u, v);
    if (width_ % kPack == 0) return pack_at<kPack>(from);
    Pack<float, kPack> pack;
#pragma unroll
    for (int p = 0; p < kPack; ++p) pack.of[p] = u + p < width_ ? from[p] : beyond;
    return pack;
  }
  __device__ static Pack<float, kPack> beyond() {
    return {beyond_image(), beyond_image(), beyond_image(), beyond_image()};
  }
  __device__ static void put(const Pack<float, kPack>& pack, float* image, int k) {
    reinterpret_cast<Pack<float, kPack>*>(image)[k] = pack;
  }

  // Of kAtOnce columns, from the tile's first with its margin on, about a row.
  __device__ __forceinline__ void sum_columns(int column, int y) const {
    const int at = y * pitch() + column, from = at + radius_ * pitch();
    const auto extents = Extents::of_columns(inverse_ + from, pitch(), radius_);
    if (may_be_cut())
      smooth_.sum_columns(from, pitch(), down(y), radius_, at);
    else
      smooth_.sum_columns(from, pitch(), WholeSpan{radius_}, radius_, at);
    extents_.put(extents, at);
  }
  // Returns which windows of kAtOnce pixels are to be gated, a bit for each.
  __device__ __forceinline__ unsigned find_smooth(int x, int y, Vec3f* normals) const {
    const int u = u0_ + x, v = v0_ + y, at = y * pitch() + side() + x;
    if (v >= height_ || u >= width_) return 0;
    const Pack<float, kAtOnce> centres = pack_at<kAtOnce>(inverse_ + at + radius_ * pitch());
    unsigned smooth =
        extents_.template smooth<Smooth::kInFloats>(at, radius_, centres, recipe_.edges);
    Vec3f found[kAtOnce];
    const auto find = [&](const auto& windows) {
      if (smooth != 0)
        smooth_.normals(recipe_, at, pitch(), radius_, centres, rays_, x, y, windows, found);
    };
    if (may_be_cut()) {
      const CutWindows<kAtOnce> windows = cut_windows(x, y);
      smooth &= windows.that_tell_planes();
      find(windows);
    } else {
      find(WholeWindows{radius_});
    }
    unsigned measured = 0;  // none beyond the image
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p) {
      measured |= (centres.of[p] > 0 ? 1U : 0U) << p;
      if ((smooth >> p & 1) == 0) found[p] = {};
    }
    write(found, u, normals + pixel(u, v));
    return measured & ~smooth;
  }
  __device__ __forceinline__ CutWindows<kAtOnce> cut_windows(int x, int y) const {
    CutWindows<kAtOnce> windows;
    windows.upright = down(y);
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p) windows.spans[p] = span_of(u0_ + x + p, width_, radius_);
    return windows;
  }
  // kAtOnce normals, as far as the image goes.
  __device__ __forceinline__ void write(const Vec3f (&found)[kAtOnce], int u, Vec3f* to) const {
    if (width_ % kPack == 0) {
      using Words = Pack<float, kAtOnce>;
      auto* const words = reinterpret_cast<Words*>(to);
#pragma unroll
      for (int i = 0; i < 3; ++i) {
        Words word;
#pragma unroll
        for (int j = 0; j < kAtOnce; ++j) {
          const int k = i * kAtOnce + j;
          const Vec3f& n = found[k / 3];
          word.of[j] = k % 3 == 0 ? n.x : k % 3 == 1 ? n.y : n.z;
        }
        words[i] = word;
      }
      return;
    }
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p)
      if (u + p < width_) to[p] = found[p];
  }

  // By whole warps: the windows of kAtOnce pixels from (x, y) on that have a bit.
  __device__ __forceinline__ void list(unsigned rough, int x, int y, RoughPixels& pixels) const {
    if (__ballot_sync(~0U, rough != 0) == 0) return;
    const unsigned lane = threadIdx.x % 32;
    unsigned count = 0, place[kAtOnce];
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p) {
      const unsigned lanes = __ballot_sync(~0U, (rough >> p & 1) != 0);
      place[p] = count + static_cast<unsigned>(__popc(lanes & ((1U << lane) - 1)));
      count += static_cast<unsigned>(__popc(lanes));
    }
    unsigned begin = 0;
    if (lane == 0) begin = atomicAdd(&pixels.count, count);
    begin = __shfl_sync(~0U, begin, 0);
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p)
      if ((rough >> p & 1) != 0)
        pixels.of[begin + place[p]] = static_cast<std::uint16_t>(y * kWidth + x + p);
  }

  const CloudRecipe& recipe_;
  int radius_, u0_, v0_, width_, height_;
  SharedArrays arrays_;
  float *inverse_, *depth_;
  SharedArrays columns_;  // memory of what is known of columns
  Extents extents_;
  Smooth smooth_;
  typename Smooth::Rays rays_;
};

}  // namespace vpm::cuda
