// PGM and PFM (netpbm.sourceforge.net/doc/pgm.html, pauldebevec.com/Research/HDR/PFM).
#include <cmath>

#include "libvpm/core/error.h"
#include "libvpm/file/scalar_type.h"
#include "libvpm/file/text.h"
#include "libvpm/import/depth_files.h"

namespace vpm {
namespace {

class NetpbmReader {
 public:
  NetpbmReader(std::span<const std::byte> bytes, const std::string& name)
      : bytes_(bytes), name_(name), cursor_(file::as_text(bytes)) {}

  RawDepth read() {
    const std::string magic(cursor_.word());
    if (magic != "P2" && magic != "P5" && magic != "Pf")
      fail("a colour or black-and-white picture (" + magic + "); depth is P2, P5 or Pf");
    image_.width = static_cast<std::uint32_t>(size());
    image_.height = static_cast<std::uint32_t>(size());
    check_image_size(image_.width, image_.height, name_);
    const double range = number();
    if (magic == "Pf") {
      read_floats(range);
    } else {
      if (!(range > 255 && range <= 65535))
        fail("its largest value is " + number_text(range) + ": depth needs 16 bits");
      image_.are_integers = image_.are_16_bit = true;
      magic == "P2" ? read_text() : read_binary();
    }
    return std::move(image_);
  }

 private:
  // Warns if something follows the pixels' `bytes`.
  void look_behind(std::size_t bytes) {
    const std::string_view rest = file::as_text(bytes_).substr(bytes);
    const std::size_t first = rest.find_first_not_of(" \t\r\n");
    if (first == rest.npos) return;
    if (rest.substr(first).starts_with('P'))
      image_.remarks.push_back({true, kSeveralImages});
    else
      image_.remarks.push_back(
          {true, "the " + std::to_string(rest.size()) + " bytes after its pixels are not read"});
  }

  [[noreturn]] void fail(const std::string& defect) const {
    refuse("not a depth image in PGM or PFM: " + defect, name_);
  }

  // Returns the next word outside comments; empty at the end.
  std::string_view next_word() {
    std::string_view word = cursor_.word();
    while (word.starts_with('#')) {
      cursor_.line();
      word = cursor_.word();
    }
    return word;
  }
  double number() {
    const std::string_view word = next_word();
    if (word.empty()) fail("the header is truncated");
    const std::optional<double> value = file::to_number(word);
    if (!value || !std::isfinite(*value)) fail("'" + file::shown(word) + "' is not a number");
    return *value;
  }
  std::uint64_t size() {
    const double value = number();
    if (!(value >= 1 && value <= 1e9)) fail("its size is no whole number above 0");
    return static_cast<std::uint64_t>(value);
  }

  // Returns the bytes of the pixels, `bytes_each` for each, which begin after the header's last
  // line end.
  const std::byte* data(std::size_t bytes_each) {
    const std::size_t needed = std::size_t{image_.width} * image_.height * bytes_each;
    cursor_.skip();
    if (cursor_.remaining() == needed + 1) cursor_.skip();  // CRLF
    if (needed > cursor_.remaining()) {
      fail("the file is truncated: " + std::to_string(needed) + " bytes of pixels promised, " +
           std::to_string(cursor_.remaining()) + " there");
    }
    look_behind(cursor_.offset() + needed);
    return bytes_.data() + cursor_.offset();
  }

  void read_binary() {
    const std::byte* from = data(2);
    image_.values.resize(std::size_t{image_.width} * image_.height);
    for (std::size_t i = 0; i < image_.values.size(); ++i)
      image_.values[i] = static_cast<float>(file::read_scalar(from + 2 * i, {'U', 2}, true));
    image_.may_be_swapped = true;
  }

  void read_text() {
    const std::size_t count = std::size_t{image_.width} * image_.height;
    if (count > (cursor_.remaining() + 1) / 2) fail("the file is truncated");
    image_.values.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::string_view word = next_word();
      const std::optional<std::uint64_t> value = file::to_count(word);
      if (!value || *value > 65535)
        fail("pixel " + std::to_string(i) + ": '" + file::shown(word) + "' is no value");
      image_.values.push_back(static_cast<float>(*value));
    }
    look_behind(cursor_.offset());
  }

  // Reads rows from the bottom; the sign of `scale` tells the order of bytes.
  void read_floats(double scale) {
    if (scale == 0) fail("its scale is 0; it must be -1 (little-endian) or 1 (big-endian)");
    const std::byte* from = data(4);
    image_.values.resize(std::size_t{image_.width} * image_.height);
    for (std::size_t v = 0; v < image_.height; ++v) {
      for (std::size_t u = 0; u < image_.width; ++u) {
        const std::size_t row = image_.height - 1 - v;
        image_.values[v * image_.width + u] = static_cast<float>(
            file::read_scalar(from + 4 * (row * image_.width + u), {'F', 4}, scale > 0));
      }
    }
    if (std::abs(scale) != 1) {
      image_.unit_remarks.push_back(
          {true,
           "the scale of " + number_text(std::abs(scale)) +
               " in its header multiplies nothing; give `depth_scale` if depths are not metres"});
    }
  }

  std::span<const std::byte> bytes_;
  const std::string& name_;
  file::TextCursor cursor_;
  RawDepth image_;
};

}  // namespace

RawDepth parse_netpbm_depth(std::span<const std::byte> bytes, const std::string& name) {
  return NetpbmReader(bytes, name).read();
}

}  // namespace vpm
