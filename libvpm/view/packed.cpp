#include "libvpm/view/packed.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "libvpm/core/box.h"

namespace vpm::view {
namespace {

static_assert(std::endian::native == std::endian::little,
              "pages hold arrays as they lie in memory");

constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr double kSteps = 65535;

template <class T>
Json packed_as(const char* type, std::span<const T> values) {
  return {{"type", type}, {"data", base64(std::as_bytes(values))}};
}

std::uint8_t signed_byte(double value) {
  return static_cast<std::uint8_t>(std::lround(128 + 127 * std::clamp(value, -1.0, 1.0)));
}

}  // namespace

std::string base64(std::span<const std::byte> bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    std::uint32_t group = 0;
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - k);
    for (std::size_t i = 0; i < 3; ++i)
      group = group << 8 | (i < count ? std::to_integer<std::uint32_t>(bytes[k + i]) : 0);
    for (std::size_t i = 0; i < 4; ++i)
      text += i <= count ? kDigits[group >> (18 - 6 * i) & 63] : '=';
  }
  return text;
}

Json packed(std::span<const std::uint8_t> values) {
  return packed_as("u8", values);
}
Json packed(std::span<const std::uint16_t> values) {
  return packed_as("u16", values);
}
Json packed(std::span<const std::uint32_t> values) {
  return packed_as("u32", values);
}
Json packed(std::span<const float> values) {
  return packed_as("f32", values);
}

Json packed_positions(std::span<const Vec3> positions) {
  Box box;
  for (const Vec3& p : positions) box.add(p);
  if (positions.empty()) box.add({});
  const Vec3 size = box.size();
  std::vector<std::uint16_t> steps;
  steps.reserve(3 * positions.size());
  for (const Vec3& p : positions) {
    for (int axis = 0; axis < 3; ++axis) {
      const double side = coordinate(size, axis);
      const double fraction = side > 0 ? coordinate(p - box.low, axis) / side : 0;
      steps.push_back(static_cast<std::uint16_t>(std::lround(kSteps * fraction)));
    }
  }
  return {{"low", {box.low.x, box.low.y, box.low.z}},
          {"size", {size.x, size.y, size.z}},
          {"steps", packed(std::span<const std::uint16_t>(steps))}};
}

Json packed_normals(std::span<const Vec3f> normals) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(2 * normals.size());
  for (const Vec3f& n : normals) {
    const double sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
    if (!(sum > 0)) {
      bytes.insert(bytes.end(), {0, 0});
      continue;
    }
    double x = n.x / sum, y = n.y / sum;
    if (n.z < 0) {
      const double folded = (1 - std::abs(y)) * (x < 0 ? -1 : 1);
      y = (1 - std::abs(x)) * (y < 0 ? -1 : 1);
      x = folded;
    }
    bytes.insert(bytes.end(), {signed_byte(x), signed_byte(y)});
  }
  return packed(std::span<const std::uint8_t>(bytes));
}

void append_bits(std::span<const std::uint8_t> values, std::vector<std::uint8_t>& bits) {
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (k % 4 == 0) bits.push_back(0);
    bits.back() |= static_cast<std::uint8_t>(values[k] << 2 * (k % 4));
  }
}

}  // namespace vpm::view
