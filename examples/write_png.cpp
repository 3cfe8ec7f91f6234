#include "examples/write_png.h"

#include <png.h>

#include <cstring>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"

namespace vpm::examples {

void write_depth_png(const std::string& path, const DepthImage& image, double scale) {
  constexpr double kLargest = 65535;
  std::vector<std::uint16_t> units;
  for (const float depth : image.depth) {
    const double value = is_measured(depth) ? depth * scale + 0.5 : 0;
    if (value > kLargest) refuse(path + ": a depth does not fit into 16 bits; use a smaller scale");
    units.push_back(static_cast<std::uint16_t>(value));
  }
  png_image png;
  std::memset(&png, 0, sizeof png);
  png.version = PNG_IMAGE_VERSION;
  png.width = image.width;
  png.height = image.height;
  // Makes libpng write the 16-bit samples unchanged; they are in the machine's byte order.
  png.format = PNG_FORMAT_LINEAR_Y;
  png_alloc_size_t size = 0;
  std::vector<std::byte> bytes;
  bool good = png_image_write_get_memory_size(png, size, 0, units.data(), 0, nullptr) != 0;
  if (good) {
    bytes.resize(size);
    good = png_image_write_to_memory(&png, bytes.data(), &size, 0, units.data(), 0, nullptr) != 0;
  }
  if (!good) throw Error(ErrorKind::cannot_write, path + ": " + png.message);
  bytes.resize(size);
  file::write_all(path, bytes);
}

}  // namespace vpm::examples
