#include "libvpm/file/scalar_type.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace vpm::file {
namespace {

static_assert(std::endian::native == std::endian::little);

template <class Value>
double as_double(const std::array<std::byte, 8>& bytes) {
  Value value;
  std::memcpy(&value, bytes.data(), sizeof value);
  return static_cast<double>(value);
}

double half_as_double(const std::array<std::byte, 8>& bytes) {
  std::uint16_t bits;
  std::memcpy(&bits, bytes.data(), sizeof bits);
  const double sign = bits & 0x8000 ? -1 : 1;
  const int exponent = (bits >> 10) & 31, fraction = bits & 1023;
  if (exponent == 0) return sign * std::ldexp(fraction, -24);
  if (exponent < 31) return sign * std::ldexp(1024 + fraction, exponent - 25);
  return fraction == 0 ? sign * HUGE_VAL : std::numeric_limits<double>::quiet_NaN();
}

double float_as_double(const std::array<std::byte, 8>& bytes, int size) {
  if (size == 2) return half_as_double(bytes);
  return size == 4 ? as_double<float>(bytes) : as_double<double>(bytes);
}

}  // namespace

bool is_known(ScalarType type) {
  const int size = type.size;
  if (type.kind == 'F') return size == 4 || size == 8;
  return (type.kind == 'I' || type.kind == 'U') &&
         (size == 1 || size == 2 || size == 4 || size == 8);
}

double read_scalar(const std::byte* from, ScalarType type, bool big_endian) {
  std::array<std::byte, 8> bytes{};
  std::copy_n(from, type.size, bytes.begin());
  if (big_endian) std::reverse(bytes.begin(), bytes.begin() + type.size);
  if (type.kind == 'F') return float_as_double(bytes, type.size);
  const bool is_signed = type.kind == 'I';
  switch (type.size) {
    case 1:
      return is_signed ? as_double<std::int8_t>(bytes) : as_double<std::uint8_t>(bytes);
    case 2:
      return is_signed ? as_double<std::int16_t>(bytes) : as_double<std::uint16_t>(bytes);
    case 4:
      return is_signed ? as_double<std::int32_t>(bytes) : as_double<std::uint32_t>(bytes);
    default:
      return is_signed ? as_double<std::int64_t>(bytes) : as_double<std::uint64_t>(bytes);
  }
}

std::uint32_t unsigned_at(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t k = size; k-- > 0;)
    value = value << 8 | (at + k < bytes.size() ? static_cast<unsigned char>(bytes[at + k]) : 0U);
  return value;
}

}  // namespace vpm::file
