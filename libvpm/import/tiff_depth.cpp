#include <tiffio.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>

#include "libvpm/core/error.h"
#include "libvpm/file/scalar_type.h"
#include "libvpm/import/depth_files.h"

namespace vpm {
namespace {

// A file in memory that libtiff reads, and the first error that libtiff reported.
struct TiffSource {
  std::span<const std::byte> bytes;
  std::uint64_t at = 0;
  char fault[160] = {};
};

TiffSource& source_of(thandle_t handle) {
  return *static_cast<TiffSource*>(handle);
}

tmsize_t read_bytes(thandle_t handle, void* to, tmsize_t count) {
  TiffSource& source = source_of(handle);
  const std::uint64_t left =
      source.bytes.size() - std::min<std::uint64_t>(source.at, source.bytes.size());
  const auto taken = std::min(left, static_cast<std::uint64_t>(std::max<tmsize_t>(count, 0)));
  if (taken > 0) std::memcpy(to, source.bytes.data() + source.at, taken);
  source.at += taken;
  return static_cast<tmsize_t>(taken);
}

tmsize_t write_no_bytes(thandle_t, void*, tmsize_t) {
  return 0;
}

toff_t seek_to(thandle_t handle, toff_t offset, int whence) {
  TiffSource& source = source_of(handle);
  const std::uint64_t from = whence == SEEK_CUR   ? source.at
                             : whence == SEEK_END ? source.bytes.size()
                                                  : 0;
  return source.at = from + offset;
}

int close_nothing(thandle_t) {
  return 0;
}

toff_t size_of(thandle_t handle) {
  return source_of(handle).bytes.size();
}

int keep_first_fault(TIFF*, void* source, const char*, const char* format, va_list values) {
  auto& fault = static_cast<TiffSource*>(source)->fault;
  if (fault[0] == 0) std::vsnprintf(fault, sizeof fault, format, values);
  return 1;
}
int pass_over(TIFF*, void*, const char*, const char*, va_list) {
  return 1;
}

struct CloseTiff {
  void operator()(TIFF* file) const { TIFFClose(file); }
};
using TiffFile = std::unique_ptr<TIFF, CloseTiff>;

TiffFile open_tiff(TiffSource& source, const std::string& name) {
  TIFFOpenOptions* const options = TIFFOpenOptionsAlloc();
  TIFFOpenOptionsSetMaxSingleMemAlloc(
      options, static_cast<tmsize_t>(file::most_memory(source.bytes.size())));
  TIFFOpenOptionsSetErrorHandlerExtR(options, keep_first_fault, &source);
  TIFFOpenOptionsSetWarningHandlerExtR(options, pass_over, nullptr);
  TIFF* const file = TIFFClientOpenExt(name.c_str(), "rm", &source, read_bytes, write_no_bytes,
                                       seek_to, close_nothing, size_of, nullptr, nullptr, options);
  TIFFOpenOptionsFree(options);
  return TiffFile(file);
}

class TiffReader {
 public:
  TiffReader(std::span<const std::byte> bytes, const std::string& name)
      : name_(name), source_{bytes}, file_(open_tiff(source_, name)) {
    if (!file_) fail(source_.fault);
  }

  RawDepth read() {
    read_layout();
    image_.values.resize(std::size_t{image_.width} * image_.height);
    TIFFIsTiled(file_.get()) ? read_tiles() : read_rows();
    if (TIFFNumberOfDirectories(file_.get()) > 1) image_.remarks.push_back({true, kSeveralImages});
    return std::move(image_);
  }

 private:
  [[noreturn]] void fail(const std::string& defect) const {
    refuse("not a depth image in TIFF: " + (defect.empty() ? "the file is damaged" : defect),
           name_);
  }

  std::uint32_t field(std::uint32_t tag) const {
    std::uint32_t value = 0;
    TIFFGetFieldDefaulted(file_.get(), tag, &value);
    return value;
  }
  std::uint16_t short_field(std::uint32_t tag) const {
    std::uint16_t value = 0;
    TIFFGetFieldDefaulted(file_.get(), tag, &value);
    return value;
  }

  void read_layout() {
    image_.width = field(TIFFTAG_IMAGEWIDTH);
    image_.height = field(TIFFTAG_IMAGELENGTH);
    check_image_size(image_.width, image_.height, name_);
    check_image_memory(image_.width, image_.height, source_.bytes.size(), name_);
    const int samples = short_field(TIFFTAG_SAMPLESPERPIXEL),
              bits = short_field(TIFFTAG_BITSPERSAMPLE), format = short_field(TIFFTAG_SAMPLEFORMAT);
    const bool is_float = format == SAMPLEFORMAT_IEEEFP;
    type_ = {is_float                     ? 'F'
             : format == SAMPLEFORMAT_INT ? 'I'
                                          : 'U',
             static_cast<std::uint8_t>(bits / 8)};
    const bool is_depth = bits == 16 || bits == 32 || (bits == 64 && is_float);
    if (samples != 1 || !is_depth) {
      fail(std::to_string(samples) + " channels of " + std::to_string(bits) +
           " bits; depth needs one of 16 or more");
    }
    if (short_field(TIFFTAG_ORIENTATION) > ORIENTATION_TOPLEFT)
      image_.remarks.push_back(
          {true, "it says that its rows or columns are turned; they are read as they are"});
    image_.are_integers = !is_float;
    image_.are_16_bit = type_.kind == 'U' && bits == 16;
  }

  // Stores values of a row from column `u` on.
  void store(const std::byte* from, std::uint32_t u, std::uint32_t v, std::uint32_t count) {
    for (std::uint32_t k = 0; k < count; ++k)
      image_.values[std::size_t{v} * image_.width + u + k] =
          static_cast<float>(file::read_scalar(from + std::size_t{k} * type_.size, type_, false));
  }

  void read_rows() {
    std::vector<std::byte> row(buffer_size(TIFFScanlineSize(file_.get()), image_.width));
    for (std::uint32_t v = 0; v < image_.height; ++v) {
      if (TIFFReadScanline(file_.get(), row.data(), v, 0) < 0) fail(source_.fault);
      store(row.data(), 0, v, image_.width);
    }
  }

  void read_tiles() {
    const std::uint32_t width = field(TIFFTAG_TILEWIDTH), height = field(TIFFTAG_TILELENGTH);
    if (width == 0 || height == 0) fail("its tiles have no size");
    std::vector<std::byte> tile(
        buffer_size(TIFFTileSize(file_.get()), std::uint64_t{width} * height));
    for (std::uint64_t top = 0; top < image_.height; top += height) {
      for (std::uint64_t left = 0; left < image_.width; left += width) {
        const auto u = static_cast<std::uint32_t>(left), v = static_cast<std::uint32_t>(top);
        if (TIFFReadTile(file_.get(), tile.data(), u, v, 0, 0) < 0) fail(source_.fault);
        for (std::uint32_t k = 0; k < std::min(height, image_.height - v); ++k)
          store(tile.data() + std::size_t{k} * width * type_.size, u, v + k,
                std::min(width, image_.width - u));
      }
    }
  }

  // Returns the size, in bytes, that libtiff asks of a buffer. Throws if it does not hold `values`
  // values, or if there is no memory for it beside the image.
  std::size_t buffer_size(tmsize_t size, std::uint64_t values) const {
    const auto bytes = static_cast<std::uint64_t>(std::max<tmsize_t>(size, 0));
    const std::uint64_t of_image = sizeof(float) * image_.values.size();
    if (bytes == 0 || of_image + bytes > file::most_memory(source_.bytes.size()) ||
        bytes < values * type_.size)
      fail(source_.fault);
    return bytes;
  }

  const std::string& name_;
  TiffSource source_;
  TiffFile file_;
  file::ScalarType type_;
  RawDepth image_;
};

}  // namespace

RawDepth parse_tiff_depth(std::span<const std::byte> bytes, const std::string& name) {
  return TiffReader(bytes, name).read();
}

}  // namespace vpm
