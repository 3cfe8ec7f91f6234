// Normals of a block's tile of an image, where windows are smooth; the others are listed.
#pragma once

#include "libvpm/surface/cuda/image_normals.h"
#include "libvpm/surface/cuda/smooth_windows.h"

namespace vpm::cuda {

// Pixels are read four at a time. So small that a device holds all blocks of a usual image at once.
struct SmoothShape {
  static constexpr int kWidth = 32, kHeight = 16, kPixels = kWidth * kHeight, kPack = 4;
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

  __device__ SmoothTile(const CloudRecipe& recipe, void* shared)
      : recipe_(recipe),
        radius_(Smooth::kRadius > 0 ? Smooth::kRadius : recipe.window / 2),
        u0_(static_cast<int>(blockIdx.x) * kWidth),
        v0_(static_cast<int>(blockIdx.y) * kHeight),
        width_(static_cast<int>(recipe.camera.width)),
        height_(static_cast<int>(recipe.camera.height)),
        arrays_(shared),
        inverse_(arrays_.take<float>(rows() * pitch())),
        depth_(arrays_.take<float>(Smooth::kNeedsDepth ? rows() * pitch() : 0)),
        smooth_(arrays_, kHeight * pitch(), inverse_, depth_),
        rays_(arrays_, kWidth, kHeight) {}

  static constexpr std::size_t bytes(int radius) {
    const int pitch = kWidth + 2 * whole_packs(radius);
    const auto size = [](std::size_t of_one, int count) {
      return of_one * static_cast<std::size_t>(count);
    };
    return size(sizeof(float) * (Smooth::kNeedsDepth ? 2 : 1), (kHeight + 2 * radius) * pitch) +
           size(Smooth::kBytes, kHeight * pitch) + size(Smooth::Rays::kBytes, kWidth + kHeight);
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
        inverse[i] = is_there ? read(recipe_.inverse, u, v) : Pack<float, kPack>{};
        if constexpr (Smooth::kNeedsDepth)
          depth[i] = is_there ? read(recipe_.depth, u, v) : Pack<float, kPack>{};
      }
#pragma unroll
      for (int i = 0; i < kInFlight; ++i) {
        const int k = begin + i * kThreads;
        if (k >= count) break;
        put(inverse[i], inverse_, k);
        if constexpr (Smooth::kNeedsDepth) put(depth[i], depth_, k);
      }
    }
  }
  __device__ __forceinline__ void sum_columns() const {
    for_each_of<kThreads, kHeight*(kWidth + 2 * whole_packs(Smooth::kRadius)) / kAtOnce>(
        [&](int k) { sum_columns(k); });
    if constexpr (Smooth::kRadius == 0) {
      for (int k = kPixels + static_cast<int>(threadIdx.x); k < kHeight * pitch(); k += kThreads)
        sum_columns(k);
    }
  }
  // Writes those of smooth windows, and lists the others.
  __device__ __forceinline__ void find_smooth(const GatedList& gated, Vec3f* normals) const {
    constexpr int kGroups = kWidth / kAtOnce;  // of a row
    static_assert(kHeight * kGroups % 32 == 0, "whole warps list windows");
    for_each_of<kThreads, kHeight * kGroups>([&](int k) {
      const int x = k % kGroups * kAtOnce, y = k / kGroups;
      list(find_smooth(x, y, normals), u0_ + x, v0_ + y, gated);
    });
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
  __device__ std::ptrdiff_t pixel(int u, int v) const {
    return static_cast<std::ptrdiff_t>(v) * width_ + u;
  }

  __device__ __forceinline__ Pack<float, kPack> read(const float* image, int u, int v) const {
    const float* const from = image + pixel(u, v);
    if (width_ % kPack == 0) return pack_at<kPack>(from);
    Pack<float, kPack> pack{};
#pragma unroll
    for (int p = 0; p < kPack; ++p)
      if (u + p < width_) pack.of[p] = from[p];
    return pack;
  }
  __device__ static void put(const Pack<float, kPack>& pack, float* image, int k) {
    reinterpret_cast<Pack<float, kPack>*>(image)[k] = pack;
  }

  __device__ __forceinline__ void sum_columns(int group) const {
    smooth_.sum_columns(group * kAtOnce + radius_ * pitch(), pitch(), radius_, group * kAtOnce);
  }
  // Returns which windows of kAtOnce pixels are to be gated, a bit for each.
  __device__ __forceinline__ unsigned find_smooth(int x, int y, Vec3f* normals) const {
    const int u = u0_ + x, v = v0_ + y, at = y * pitch() + side() + x;
    if (v >= height_ || u >= width_) return 0;
    const Pack<float, kAtOnce> centres = pack_at<kAtOnce>(inverse_ + at + radius_ * pitch());
    const unsigned smooth = smooth_.smooth(at, radius_, centres, recipe_.edges);
    Vec3f found[kAtOnce];
    if (smooth != 0) smooth_.normals(recipe_, at, radius_, centres, rays_, x, y, found);
    unsigned measured = 0;  // none beyond the image
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p) {
      measured |= (centres.of[p] > 0 ? 1U : 0U) << p;
      if ((smooth >> p & 1) == 0) found[p] = {};
    }
    write(found, u, normals + pixel(u, v));
    return measured & ~smooth;
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

  // By whole warps: the windows of kAtOnce pixels from (u, v) on that have a bit.
  __device__ __forceinline__ void list(unsigned rough, int u, int v, const GatedList& gated) const {
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
    if (lane == 0) begin = atomicAdd(gated.count, count);
    begin = __shfl_sync(~0U, begin, 0);
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p)
      if ((rough >> p & 1) != 0)
        gated.pixels[begin + place[p]] = static_cast<std::uint32_t>(pixel(u + p, v));
  }

  const CloudRecipe& recipe_;
  int radius_, u0_, v0_, width_, height_;
  SharedArrays arrays_;
  float *inverse_, *depth_;
  Smooth smooth_;
  typename Smooth::Rays rays_;
};

}  // namespace vpm::cuda
