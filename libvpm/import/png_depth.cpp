#include <png.h>

#include <csetjmp>
#include <cstring>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/file/scalar_type.h"
#include "libvpm/import/depth_files.h"
#include "libvpm/import/point_files.h"

namespace vpm {
namespace {

// Reads by libpng, which reports errors by longjmp. Only `run` is jumped out of, and it has nothing
// to destroy; results of the steps live in PngReader.
class PngReader {
 public:
  explicit PngReader(std::span<const std::byte> bytes) : bytes_(bytes) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, on_warning);
    info_ = png_ != nullptr ? png_create_info_struct(png_) : nullptr;
  }
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  bool read_header() {
    return info_ != nullptr && run([](PngReader& self) {
             png_set_read_fn(self.png_, &self, on_read);
             png_read_info(self.png_, self.info_);
           });
  }
  bool read_rows(std::vector<png_bytep>& rows) {
    rows_ = rows.data();
    return run([](PngReader& self) {
      png_set_swap(self.png_);  // PNG is big-endian
      png_set_interlace_handling(self.png_);
      png_read_image(self.png_, self.rows_);
      png_read_end(self.png_, nullptr);
    });
  }

  std::uint32_t width() const { return png_get_image_width(png_, info_); }
  std::uint32_t height() const { return png_get_image_height(png_, info_); }
  bool is_gray16() const {
    return png_get_bit_depth(png_, info_) == 16 &&
           png_get_color_type(png_, info_) == PNG_COLOR_TYPE_GRAY;
  }
  int bit_depth() const { return png_get_bit_depth(png_, info_); }
  int channels() const { return png_get_channels(png_, info_); }
  const char* fault() const { return fault_; }

 private:
  bool run(void (*step)(PngReader&)) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    step(*this);
    return true;
  }
  static void on_error(png_structp png, png_const_charp message) {
    auto* self = static_cast<PngReader*>(png_get_error_ptr(png));
    std::strncpy(self->fault_, message, sizeof self->fault_ - 1);
    png_longjmp(png, 1);
  }
  static void on_warning(png_structp, png_const_charp) {}
  static void on_read(png_structp png, png_bytep to, std::size_t count) {
    auto* self = static_cast<PngReader*>(png_get_io_ptr(png));
    if (count > self->bytes_.size() - self->at_) png_error(png, "the file is truncated");
    std::memcpy(to, self->bytes_.data() + self->at_, count);
    self->at_ += count;
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  png_bytepp rows_ = nullptr;
  char fault_[128] = {};
};

// Upper bound on the expansion by deflate.
constexpr std::uint64_t kMaxDeflateRatio = 1100;

}  // namespace

void check_image_size(std::uint64_t width, std::uint64_t height, const std::string& name) {
  if (width == 0 || height == 0 || width > kMaxPoints || height > kMaxPoints ||
      width * height > kMaxPoints) {
    refuse("an image of " + std::to_string(width) + " x " + std::to_string(height) +
               " pixels is not read",
           name, "at most " + std::to_string(kMaxPoints) + " pixels are");
  }
}

void check_image_memory(std::uint64_t width, std::uint64_t height, std::uint64_t file_bytes,
                        const std::string& name) {
  if (sizeof(float) * width * height <= file::most_memory(file_bytes)) return;
  refuse("an image of " + std::to_string(width) + " x " + std::to_string(height) +
             " pixels does not come from a file of " + std::to_string(file_bytes) +
             " bytes; it is truncated or damaged",
         name, "store it with less compression if it is sound");
}

RawDepth parse_png_depth(std::span<const std::byte> bytes, const std::string& name) {
  PngReader png(bytes);
  if (!png.read_header()) refuse(std::string("not a sound PNG: ") + png.fault(), name);
  if (!png.is_gray16()) {
    refuse("a PNG with " + std::to_string(png.channels()) +
               (png.channels() == 1 ? " channel of " : " channels of ") +
               std::to_string(png.bit_depth()) + " bits is no depth image",
           name, "depth needs one gray channel of 16 bits");
  }
  check_image_size(png.width(), png.height(), name);
  check_image_memory(png.width(), png.height(), bytes.size(), name);
  RawDepth image;
  image.width = png.width();
  image.height = png.height();
  image.are_integers = image.are_16_bit = true;
  const std::size_t count = std::size_t{image.width} * image.height;
  if (2 * count > bytes.size() * kMaxDeflateRatio) refuse("the PNG is truncated", name);
  std::vector<std::uint16_t> values(count);
  std::vector<png_bytep> rows(image.height);
  for (std::size_t v = 0; v < image.height; ++v)
    rows[v] = reinterpret_cast<png_bytep>(values.data() + v * image.width);
  if (!png.read_rows(rows)) refuse(std::string("not a sound PNG: ") + png.fault(), name);
  image.values.assign(values.begin(), values.end());
  return image;
}

RawDepth parse_compressed_depth(std::span<const std::byte> bytes, const std::string& name) {
  // An integer, the format, and two floats. Images of floats are stored as a / depth + b there,
  // with b = 1 - a / farthest; images of millimetres leave the floats 0 or unset.
  constexpr std::size_t kConfiguration = 12;
  const auto number = [&](std::size_t at) {
    return file::read_scalar(bytes.data() + at, {'F', 4}, false);
  };
  constexpr double kLeast = 1e-3, kMost = 1e9, kNearest = 0.1, kFarthest = 1000;
  const double a = number(4), b = number(8), farthest = a / (1 - b);  // m
  if (a > kLeast && a < kMost && farthest > kNearest && farthest < kFarthest)
    refuse("a message of ROS' compressedDepth of float depths, which it codes as inverse depths",
           name, "decode it by compressed_depth_image_transport, and save it as 16-bit PNG");
  return parse_png_depth(bytes.subspan(kConfiguration), name);
}

}  // namespace vpm
