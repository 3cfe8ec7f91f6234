#include "libvpm/file/npy.h"

#include <algorithm>
#include <charconv>
#include <string_view>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"

namespace vpm::file {
namespace {

[[noreturn]] void fail(const std::string& defect, const std::string& name) {
  refuse("not a sound NPY: " + defect, name);
}

// Returns what follows "'key':" in the header's dictionary.
std::string_view value_of(std::string_view header, std::string_view key, const std::string& name) {
  const std::size_t at = header.find("'" + std::string(key) + "'");
  const std::size_t colon = at == header.npos ? at : header.find(':', at);
  if (colon == header.npos) fail("its header has no " + std::string(key), name);
  const std::size_t begin = std::min(header.find_first_not_of(' ', colon + 1), header.size());
  return header.substr(begin);
}

// Returns the type that a text such as "'<f4'" tells.
ScalarType type_of(std::string_view text, bool& big_endian, const std::string& name) {
  const bool is_quoted = text.starts_with('\'') && text.find('\'', 1) != text.npos;
  const std::string_view word = is_quoted ? text.substr(1, text.find('\'', 1) - 1) : text;
  ScalarType type;
  if (is_quoted && word.size() == 3) {
    big_endian = word[0] == '>';
    type.kind = word[1] == 'f' ? 'F' : word[1] == 'i' ? 'I' : word[1] == 'u' ? 'U' : '?';
    type.size = static_cast<std::uint8_t>(word[2] - '0');
  }
  const bool is_half = type.kind == 'F' && type.size == 2;
  if (!is_known(type) && !is_half)
    refuse("its values are of type " + shown(word, 12) + ", not floats or integers", name,
           "save them by astype(numpy.float64)");
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
    shape.push_back(size);
    at = std::find_if(stop, end, [](char c) { return c >= '0' && c <= '9'; });
  }
  return shape;
}

// Sets the number of values; refuses more than the file holds.
void check_size(NpyArray& array, const std::string& name) {
  const std::uint64_t most = array.values.size() / array.type.size;
  array.size = 1;
  for (const std::uint64_t size : array.shape) {
    if (size > 0 && array.size > most / size)
      fail("the file is truncated: " + shape_text(array.shape) + " values promised, " +
               std::to_string(most) + " there",
           name);
    array.size *= size;
  }
}

}  // namespace

NpyArray parse_npy(std::span<const std::byte> bytes, const std::string& name) {
  constexpr std::size_t kBeforeLength = 8;  // magic and version
  const std::string_view text = as_text(bytes);
  const std::size_t length_bytes = text.size() > 6 && text[6] >= 2 ? 4 : 2;
  if (text.size() < kBeforeLength + length_bytes) fail("the file is truncated", name);
  const std::uint32_t length = unsigned_at(text, kBeforeLength, length_bytes);
  const std::size_t header = kBeforeLength + length_bytes;
  if (header + length > text.size()) fail("the file is truncated", name);
  const std::string_view dictionary = text.substr(header, length);
  NpyArray array;
  array.type = type_of(value_of(dictionary, "descr", name), array.big_endian, name);
  array.by_columns = value_of(dictionary, "fortran_order", name).starts_with("True");
  array.shape = shape_of(value_of(dictionary, "shape", name), name);
  array.values = bytes.subspan(header + length);
  check_size(array, name);
  return array;
}

double NpyArray::at(std::uint64_t k) const {
  std::uint64_t place = k;
  if (by_columns) {
    std::uint64_t stride = size;
    place = 0;
    for (std::size_t d = shape.size(); d-- > 0; k /= shape[d]) {
      stride /= shape[d];
      place += k % shape[d] * stride;
    }
  }
  return read_scalar(values.data() + place * type.size, type, big_endian);
}

std::string shape_text(const std::vector<std::uint64_t>& shape) {
  std::string text;
  for (const std::uint64_t size : shape) text += (text.empty() ? "" : " x ") + std::to_string(size);
  return text;
}

}  // namespace vpm::file
