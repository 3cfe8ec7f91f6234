#include "libvpm/surface/cuda/cloud_normals.h"
#include "libvpm/surface/cuda/image_normals.h"
#include "libvpm/surface/cuda/smooth_windows.h"

namespace vpm::cuda {
namespace {

// Of the default window: kernels know it beforehand.
constexpr int kUsualRadius = NormalOptions{}.window / 2;

// A block's pixels, cut where four lie together. Wide enough that the windows that the image's
// border cuts, which are the last to be done, are shared by many blocks; low enough that a device
// holds all blocks of a usual image at once.
constexpr int kWidth = 32, kHeight = 16, kPixels = kWidth * kHeight, kPack = 4;
constexpr int kBlocks = 5;  // of a multiprocessor

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

// The tile of a block with its margin, in shared memory.
template <class Smooth>
class Tile {
 public:
  static constexpr int kAtOnce = Smooth::kAtOnce, kThreads = Smooth::kThreads;

  __device__ Tile(const CloudRecipe& recipe, void* shared)
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

template <class Smooth>
__global__ void __launch_bounds__(Smooth::kThreads, kBlocks)
    find_smooth(const __grid_constant__ CloudRecipe recipe, const GatedList gated, Vec3f* normals) {
  extern __shared__ double2 shared_memory[];
  const Tile<Smooth> tile(recipe, shared_memory);
  let_next_begin();
  tile.find_rays();
  wait_for_last();
  tile.load();
  __syncthreads();
  tile.sum_columns();
  __syncthreads();
  tile.find_smooth(gated, normals);
}

// An image about one of its pixels, as far as windows go.
class ImageAround {
 public:
  __device__ ImageAround(const CloudRecipe& recipe, const float* image, std::uint32_t pixel)
      : pitch_(static_cast<int>(recipe.camera.width)),
        u_(static_cast<int>(pixel % recipe.camera.width)),
        centre_(image + pixel) {
    const auto v = static_cast<int>(pixel / recipe.camera.width),
               height = static_cast<int>(recipe.camera.height);
    const int above = v < kMost ? v : kMost,
              below = height - 1 - v < kMost ? height - 1 - v : kMost;
    rows_ = ~0U << (kMost - above) & ~0U >> (31 - kMost - below);
  }
  class Column {
   public:
    __device__ Column(const float* middle, int pitch, unsigned rows)
        : middle_(middle), pitch_(pitch), rows_(rows) {}
    __device__ __forceinline__ float value(int dv) const {
      return (rows_ >> (kMost + dv) & 1) != 0 ? middle_[dv * pitch_] : 0.0F;
    }

   private:
    const float* middle_;
    int pitch_;
    unsigned rows_;
  };
  __device__ __forceinline__ Column column(int du) const {
    const int u = u_ + du;
    return {centre_ + du, pitch_, u >= 0 && u < pitch_ ? rows_ : 0U};
  }

 private:
  static constexpr int kMost = kMaxWindow / 2;
  static_assert(2 * kMost + 1 <= 32);
  int pitch_, u_;
  const float* centre_;
  unsigned rows_;  // those of the window that the image has, a bit for each
};

// The normal of a window from its planes, the second of which is fitted to what lies near the
// first.
template <NormalMethod kMethod, class Window>
__device__ Vec3f gated_normal(const CloudRecipe& recipe, const Window& window, std::uint32_t pixel,
                              const WindowPlane& first, const WindowPlane& plane) {
  const Intrinsics& k = recipe.camera.intrinsics;
  const auto u = static_cast<int>(pixel % recipe.camera.width),
             v = static_cast<int>(pixel / recipe.camera.width);
  if constexpr (kMethod == NormalMethod::inverse_depth) {
    return normal_of_window(plane, static_cast<float>(k.fx), static_cast<float>(k.fy),
                            static_cast<float>(k.cx - u), static_cast<float>(k.cy - v));
  } else {
    if (!plane.found) return {};
    const Moments m = window.moments(first, ImageAround(recipe, recipe.depth, pixel));
    return normal_of_moments(m, quotient(1, m.n), recipe.per_fx, recipe.per_fy,
                             quotient(u - k.cx, k.fx), quotient(v - k.cy, k.fy));
  }
}

constexpr unsigned kGatedThreads = 128, kGatedBlocks = 5;  // blocks of a multiprocessor

// All blocks have read how many there are when the last one comes here: it makes that 0.
__device__ __forceinline__ unsigned take_count(const GatedList& gated) {
  const unsigned count = *static_cast<const volatile unsigned*>(gated.count);
  __syncthreads();
  if (threadIdx.x == 0 && atomicAdd(gated.done, 1U) == gridDim.x - 1)
    *gated.count = *gated.done = 0;
  return count;
}

// Two lanes take a window. Where there are more windows than pairs, they take two, one after the
// other, and each finds the planes and the normal of one.
template <NormalMethod kMethod, int Radius>
__global__ void __launch_bounds__(kGatedThreads, kGatedBlocks)
    fit_gated(const __grid_constant__ CloudRecipe recipe, const GatedList gated, Vec3f* normals) {
  constexpr unsigned kPairs = 32 / 2;  // of a warp
  const unsigned warp = threadIdx.x / 32 * gridDim.x + blockIdx.x;
  const unsigned pairs = gridDim.x * kGatedThreads / 2, lane = threadIdx.x % 2;
  let_next_begin();
  wait_for_last();
  const unsigned count = take_count(gated), at_once = count > pairs ? 2 : 1;
  for (unsigned begin = warp * kPairs * at_once; begin < count; begin += pairs * at_once) {
    const unsigned of_pair = begin + threadIdx.x % 32 / 2 * at_once;
    const auto pixel = [&](unsigned i) {
      return gated.pixels[of_pair + i < count ? of_pair + i : count - 1];
    };
    const auto window = [&](unsigned i) {
      return GatedWindow<ImageAround, Radius>(ImageAround(recipe, recipe.inverse, pixel(i)),
                                              recipe.window / 2, recipe.edges);
    };
    WindowPlane first, plane;
#pragma unroll 1
    for (int choice = 0; choice < 2; ++choice) {
      PlaneSums sums;
      first = plane;
#pragma unroll 1
      for (unsigned i = 0; i < at_once; ++i) {
        const auto of_lane = [&](float value) {
          return __shfl_sync(~0U, value, static_cast<int>(i), 2);
        };
        const WindowPlane near{true, of_lane(first.a), of_lane(first.b), of_lane(first.c)};
        const PlaneSums of_window = window(i).choose_by_two(near, choice == 0);
        if (lane == i) sums = of_window;
      }
      plane = plane_of_sums(sums);
      plane.found = plane.found && (choice == 0 || first.found);
    }
    if (lane < at_once && of_pair + lane < count)
      normals[pixel(lane)] = gated_normal<kMethod>(recipe, window(lane), pixel(lane), first, plane);
  }
}

struct Kernels {
  void (*smooth)(CloudRecipe, GatedList, Vec3f*);
  void (*gated)(CloudRecipe, GatedList, Vec3f*);
  unsigned threads;
  std::size_t bytes;
};

template <class Smooth, NormalMethod kMethod>
Kernels kernels_of(int radius) {
  return {find_smooth<Smooth>, fit_gated<kMethod, Smooth::kRadius>, Smooth::kThreads,
          Tile<Smooth>::bytes(radius)};
}

Kernels choose(NormalMethod method, int radius) {
  constexpr NormalMethod kInverseDepth = NormalMethod::inverse_depth, kPca = NormalMethod::pca;
  if (method == kPca)
    return radius == kUsualRadius ? kernels_of<SmoothPca<2, kUsualRadius>, kPca>(radius)
                                  : kernels_of<SmoothPca<1, 0>, kPca>(radius);
  return radius == kUsualRadius
             ? kernels_of<SmoothInverseDepth<2, kUsualRadius>, kInverseDepth>(radius)
             : kernels_of<SmoothInverseDepth<1, 0>, kInverseDepth>(radius);
}

// Whether a kernel waits itself for what comes before it, so that it may be launched before that is
// done. Machine code made from older PTX does not.
bool waits_for_last(const void* kernel) {
  cudaFuncAttributes attributes;
  check(cudaFuncGetAttributes(&attributes, kernel));
  return attributes.ptxVersion >= 90 && attributes.binaryVersion >= 90;
}

int attribute(cudaDeviceAttr which) {
  int value = 0;
  check(cudaDeviceGetAttribute(&value, which, current_device()));
  return value;
}

// What every kernel may take without asking.
constexpr std::size_t kSharedBytes = 48 * 1024;

}  // namespace

NormalsPlan plan_normals(const NormalOptions& options) {
  const Kernels kernels = choose(options.method, options.window / 2);
  const auto* const smooth = reinterpret_cast<const void*>(kernels.smooth);
  if (kernels.bytes > static_cast<std::size_t>(attribute(cudaDevAttrMaxSharedMemoryPerBlockOptin)))
    return {};
  if (kernels.bytes > kSharedBytes)
    check(cudaFuncSetAttribute(smooth, cudaFuncAttributeMaxDynamicSharedMemorySize,
                               static_cast<int>(kernels.bytes)));
  return {true, waits_for_last(smooth),
          kGatedBlocks * static_cast<unsigned>(attribute(cudaDevAttrMultiProcessorCount))};
}

void estimate_on_device(const CloudRecipe& recipe, NormalMethod method, const NormalsPlan& plan,
                        const GatedList& gated, Vec3f* normals, cudaStream_t stream) {
  const Kernels kernels = choose(method, recipe.window / 2);
  const auto tiles = [](std::uint32_t pixels, unsigned of_tile) {
    return (pixels + of_tile - 1) / of_tile;
  };
  const dim3 grid(tiles(recipe.camera.width, kWidth), tiles(recipe.camera.height, kHeight));
  launch_kernel(kernels.smooth, grid, kernels.threads, kernels.bytes, plan.overlaps, stream, recipe,
                gated, normals);
  launch_kernel(kernels.gated, plan.gated_blocks, kGatedThreads, 0, plan.overlaps, stream, recipe,
                gated, normals);
}

}  // namespace vpm::cuda
