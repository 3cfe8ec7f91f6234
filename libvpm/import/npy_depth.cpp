// Arrays of NumPy (numpy.org/doc/stable/reference/generated/numpy.lib.format.html).
#include <algorithm>
#include <charconv>

#include "libvpm/core/error.h"
#include "libvpm/file/scalar_type.h"
#include "libvpm/file/text.h"
#include "libvpm/import/depth_files.h"

namespace vpm {
namespace {

struct NpyHeader {
  file::ScalarType type;
  bool big_endian = false, by_columns = false;
  std::vector<std::uint64_t> shape;
  std::size_t data = 0;  // offset of the first value
};

[[noreturn]] void fail(const std::string& defect, const std::string& name,
                       const std::string& hint = {}) {
  refuse("not a depth image in NPY: " + defect, name, hint);
}

// Refuses points, one a row, of which an image would be a few pixels wide.
void refuse_table(const std::vector<std::uint64_t>& shape, const std::string& name) {
  constexpr std::uint64_t kMostColumns = 8, kRowsPerColumn = 16;
  if (shape[1] < 3 || shape[1] > kMostColumns || shape[0] < kRowsPerColumn * shape[1]) return;
  fail("its " + std::to_string(shape[0]) + " rows of " + std::to_string(shape[1]) +
           " numbers are a table of points",
       name, "save them as PLY or PCD, with their normals");
}

// Returns what follows "'key':" in the header's dictionary.
std::string_view value_of(std::string_view header, std::string_view key, const std::string& name) {
  const std::size_t at = header.find("'" + std::string(key) + "'");
  const std::size_t colon = at == header.npos ? at : header.find(':', at);
  if (colon == header.npos) fail("its header has no " + std::string(key), name);
  const std::size_t begin = std::min(header.find_first_not_of(' ', colon + 1), header.size());
  return header.substr(begin);
}

file::ScalarType type_of(std::string_view text, bool& big_endian, const std::string& name) {
  const bool is_quoted = text.starts_with('\'') && text.find('\'', 1) != text.npos;
  const std::string_view word = is_quoted ? text.substr(1, text.find('\'', 1) - 1) : text;  // <f4
  const auto refuse_type = [&] {
    fail("values of type " + file::shown(word, 12) +
             "; depth is a float or an integer of 16 bits or more",
         name);
  };
  if (!is_quoted || word.size() != 3) refuse_type();
  big_endian = word[0] == '>';
  const char kind = word[1] == 'f' ? 'F' : word[1] == 'i' ? 'I' : word[1] == 'u' ? 'U' : '?';
  const file::ScalarType type{kind, static_cast<std::uint8_t>(word[2] - '0')};
  const bool is_half = type.kind == 'F' && type.size == 2;
  if (!(file::is_known(type) || is_half) || type.size == 1) refuse_type();
  return type;
}

std::vector<std::uint64_t> shape_of(std::string_view text, const std::string& name) {
  if (!text.starts_with('(')) fail("its shape cannot be read", name);
  std::vector<std::uint64_t> shape;
  const char* at = text.data() + 1;
  const char* const end = text.data() + std::min(text.find(')'), text.size());
  while (at < end) {
    std::uint64_t size = 0;
    const auto [stop, fault] = std::from_chars(at, end, size);
    if (fault != std::errc()) fail("its shape cannot be read", name);
    if (size != 1 || shape.empty()) shape.push_back(size);
    at = std::find_if(stop, end, [](char c) { return c >= '0' && c <= '9'; });
  }
  if (shape.size() == 3 && shape.front() == 1) shape.erase(shape.begin());
  if (shape.size() != 2) {
    fail(
        "its shape has " + std::to_string(shape.size()) +
            " dimensions that are not 1; depth has two, rows and columns",
        name,
        shape.size() == 3 && shape.back() <= 4 ? "save only the z of the point at each pixel" : "");
  }
  return shape;
}

NpyHeader read_header(std::string_view text, const std::string& name) {
  constexpr std::size_t kBeforeLength = 8;  // magic and version
  const std::size_t length_bytes = text.size() > 6 && text[6] >= 2 ? 4 : 2;
  if (text.size() < kBeforeLength + length_bytes) fail("the file is truncated", name);
  const auto length = static_cast<std::size_t>(
      file::read_scalar(reinterpret_cast<const std::byte*>(text.data()) + kBeforeLength,
                        {'U', static_cast<std::uint8_t>(length_bytes)}, false));
  NpyHeader header;
  header.data = kBeforeLength + length_bytes + length;
  if (header.data > text.size()) fail("the file is truncated", name);
  const std::string_view dictionary = text.substr(kBeforeLength + length_bytes, length);
  header.type = type_of(value_of(dictionary, "descr", name), header.big_endian, name);
  header.by_columns = value_of(dictionary, "fortran_order", name).starts_with("True");
  header.shape = shape_of(value_of(dictionary, "shape", name), name);
  return header;
}

}  // namespace

RawDepth parse_npy_depth(std::span<const std::byte> bytes, const std::string& name) {
  const NpyHeader header = read_header(file::as_text(bytes), name);
  if (header.type.kind == 'F') refuse_table(header.shape, name);
  check_image_size(header.shape[1], header.shape[0], name);
  RawDepth image;
  image.height = static_cast<std::uint32_t>(header.shape[0]);
  image.width = static_cast<std::uint32_t>(header.shape[1]);
  image.are_integers = header.type.kind != 'F';
  image.are_16_bit = header.type.kind == 'U' && header.type.size == 2;
  const std::size_t count = std::size_t{image.width} * image.height;
  if (count * header.type.size > bytes.size() - header.data) {
    fail("the file is truncated: " + std::to_string(count * header.type.size) +
             " bytes of values promised, " + std::to_string(bytes.size() - header.data) + " there",
         name);
  }
  image.values.resize(count);
  for (std::size_t v = 0; v < image.height; ++v) {
    for (std::size_t u = 0; u < image.width; ++u) {
      const std::size_t k = header.by_columns ? u * image.height + v : v * image.width + u;
      image.values[v * image.width + u] = static_cast<float>(file::read_scalar(
          bytes.data() + header.data + k * header.type.size, header.type, header.big_endian));
    }
  }
  return image;
}

}  // namespace vpm
