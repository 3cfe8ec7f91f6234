// Numbers as a page holds them: little-endian arrays in base64, positions and normals quantised.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "libvpm/core/vec3.h"

namespace vpm::view {

using Json = nlohmann::ordered_json;

std::string base64(std::span<const std::byte> bytes);

// Return {"type": "u8" | "u16" | "u32" | "f32", "data": base64}.
Json packed(std::span<const std::uint8_t> values);
Json packed(std::span<const std::uint16_t> values);
Json packed(std::span<const std::uint32_t> values);
Json packed(std::span<const float> values);

// Returns {"low", "size", "steps"}: each coordinate in 65536 steps of the box of the positions.
Json packed_positions(std::span<const Vec3> positions);

// Returns two bytes per unit vector, its octahedral map; 0, 0 for the zero vector.
Json packed_normals(std::span<const Vec3f> normals);

// Appends numbers below four, two bits each, the first in the lowest bits; begins with a whole
// byte.
void append_bits(std::span<const std::uint8_t> values, std::vector<std::uint8_t>& bits);

}  // namespace vpm::view
