#include "tests/import/test_files.h"

#include <gtest/gtest.h>
#include <png.h>

#include "tests/refusal.h"

namespace vpm {

std::string make_png(std::uint32_t width, std::uint32_t height, int bits,
                     const std::vector<std::uint16_t>& values, bool interlaced) {
  std::string file;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &file,
      [](png_structp p, png_bytep data, std::size_t size) {
        static_cast<std::string*>(png_get_io_ptr(p))
            ->append(reinterpret_cast<const char*>(data), size);
      },
      nullptr);
  png_set_IHDR(png, info, width, height, bits, PNG_COLOR_TYPE_GRAY,
               interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  std::vector<std::string> rows(height);
  std::vector<png_bytep> pointers;
  for (std::uint32_t v = 0; v < height; ++v) {
    for (std::uint32_t u = 0; u < width; ++u) {
      const std::uint16_t value = values[v * width + u];
      if (bits == 16) rows[v].push_back(static_cast<char>(value >> 8));
      rows[v].push_back(static_cast<char>(value & 255));
    }
    pointers.push_back(reinterpret_cast<png_bytep>(rows[v].data()));
  }
  png_write_image(png, pointers.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return file;
}

::testing::AssertionResult says(const std::string& message, const std::string& text) {
  if (message.find(text) != std::string::npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "'" << message << "' does not say '" << text << "'";
}

void expect_damage_is_refused(const std::string& file, std::size_t samples,
                              const std::function<void(std::span<const std::byte>)>& parse) {
  const std::size_t step = 1 + file.size() / samples;
  for (std::size_t size = 0; size < file.size(); size += step) {
    // Copies to a buffer of exactly this size, so that the sanitizer notices reads past the end.
    const std::string cut(file, 0, size);
    const std::string message = test::refusal([&] { parse(bytes_of(cut)); });
    ASSERT_EQ(message.substr(0, 4), "file") << "cut to " << size << " bytes: " << message;
  }
  for (std::size_t i = 0; i < file.size(); i += step) {
    for (const int flip : {0x01, 0x80, 0xFF}) {
      std::string damaged = file;
      damaged[i] = static_cast<char>(damaged[i] ^ flip);
      test::refusal([&] { parse(bytes_of(damaged)); });
    }
  }
}

}  // namespace vpm
