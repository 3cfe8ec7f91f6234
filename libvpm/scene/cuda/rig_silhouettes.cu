#include <algorithm>

#include "libvpm/scene/cuda/rig_silhouettes.h"

namespace vpm::cuda {
namespace {

constexpr unsigned kSpreadThreads = 256;
constexpr std::int8_t kNoRow = kSilhouetteReach + 1;

// Each image has as many blocks, and a thread for each of its pixels.
struct PixelOfImage {
  unsigned image, index;
  __device__ explicit PixelOfImage(unsigned images) {
    const unsigned blocks = gridDim.x / images;
    image = blockIdx.x / blocks;
    index = blockIdx.x % blocks * kSpreadThreads + threadIdx.x;
  }
};

__device__ unsigned pixels_of(const SpreadImage& image) {
  return static_cast<unsigned>(image.width * image.height);
}

__global__ void __launch_bounds__(kSpreadThreads)
    clear(const __grid_constant__ SpreadImages images) {
  const PixelOfImage at(images.count);
  const SpreadImage& image = images.of[at.image];
  if (at.index < static_cast<unsigned>(image.columns * image.rows)) image.sums[at.index] = 0;
  if (at.index >= pixels_of(image)) return;
  image.numbers[at.index] = 0;
  if (image.hole_numbers != nullptr) image.hole_numbers[at.index] = 0;
}

__global__ void __launch_bounds__(kSpreadThreads)
    set_numbers(const __grid_constant__ SpreadImages images) {
  const PixelOfImage at(images.count);
  const SpreadImage& image = images.of[at.image];
  if (at.index < image.pixel_count) {
    const SilhouettePixel& pixel = image.pixels[at.index];
    image.numbers[static_cast<int>(pixel.v) * image.width + static_cast<int>(pixel.u)] =
        at.index + 1;
  }
  if (at.index < image.hole_count)
    image.hole_numbers[image.holes[at.index].pixel] = image.holes[at.index].number;
}

// Finds the nearest silhouette pixel of each pixel's column, above before below.
__global__ void __launch_bounds__(kSpreadThreads)
    search_columns(const __grid_constant__ SpreadImages images) {
  const PixelOfImage at(images.count);
  const SpreadImage& image = images.of[at.image];
  if (at.index >= pixels_of(image)) return;
  const auto index = static_cast<int>(at.index);
  const int v = index / image.width;
  const auto is_there = [&](int rows) {
    return v + rows >= 0 && v + rows < image.height &&
           image.numbers[index + rows * image.width] != 0;
  };
  int rows = 0;
  while (rows < kNoRow && !is_there(-rows) && !is_there(rows)) ++rows;
  image.down[index] = static_cast<std::int8_t>(rows < kNoRow && is_there(-rows) ? -rows : rows);
}

// Takes the nearest of those, and marks the tiles that have any.
__global__ void __launch_bounds__(kSpreadThreads)
    search_rows(const __grid_constant__ SpreadImages images) {
  const PixelOfImage at(images.count);
  const SpreadImage& image = images.of[at.image];
  if (at.index >= pixels_of(image)) return;
  const auto index = static_cast<int>(at.index);
  const int u = index % image.width, v = index / image.width;
  std::int32_t key = SilhouetteKeys::kNone;
  const int last = min(u + kSilhouetteReach, image.width - 1);
  for (int column = max(u - kSilhouetteReach, 0); column <= last; ++column) {
    const int down = image.down[index + column - u];
    if (down == kNoRow) continue;
    key = min(key, SilhouetteKeys::key(u - column, image.keys.squared_rows[down < 0 ? -down : down],
                                       column));
  }
  std::uint32_t number = 0;
  if (key != SilhouetteKeys::kNone) {
    const int beside = index + SilhouetteKeys::column_of(key) - u;
    number = image.numbers[beside + image.down[beside] * image.width];
  }
  image.nearest[index] = number;
  if (number == 0 && (image.hole_numbers == nullptr || image.hole_numbers[index] == 0)) return;
  constexpr int kShift = Silhouettes::kTileShift;
  image.sums[((v >> kShift) + 1) * image.columns + (u >> kShift) + 1] = 1;
}

// Adds up the marks of an image along rows, then columns, with one block.
__global__ void __launch_bounds__(kSpreadThreads)
    sum_tiles(const __grid_constant__ SpreadImages images) {
  const SpreadImage& image = images.of[blockIdx.x];
  const auto thread = static_cast<int>(threadIdx.x), threads = static_cast<int>(kSpreadThreads);
  const auto add_up = [](std::uint32_t* first, int count, int step) {
    for (int k = 1; k < count; ++k) first[k * step] += first[(k - 1) * step];
  };
  for (int v = thread; v < image.rows; v += threads)
    add_up(image.sums + v * image.columns, image.columns, 1);
  __syncthreads();
  for (int u = thread; u < image.columns; u += threads)
    add_up(image.sums + u, image.rows, image.columns);
}

}  // namespace

void spread_on_device(const SpreadImages& images, cudaStream_t stream) {
  unsigned most = 0;
  for (unsigned k = 0; k < images.count; ++k) {
    const SpreadImage& image = images.of[k];
    most = std::max({most, static_cast<unsigned>(image.width * image.height),
                     static_cast<unsigned>(image.columns * image.rows)});
  }
  const LaunchSize all{images.count * ((most - 1) / kSpreadThreads + 1), kSpreadThreads};
  const auto launch = [&](auto kernel, const LaunchSize& size) {
    launch_kernel(kernel, size, LaunchKind::independent, stream, images);
  };
  launch(clear, all);
  launch(set_numbers, all);
  launch(search_columns, all);
  launch(search_rows, all);
  launch(sum_tiles, {images.count, kSpreadThreads});
}

}  // namespace vpm::cuda
