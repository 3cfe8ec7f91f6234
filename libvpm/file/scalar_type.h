// Binary numbers of the formats that name their types.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace vpm::file {

// Type of a binary number: kind 'F' (float), 'I' (signed), 'U' (unsigned); size in bytes.
struct ScalarType {
  char kind = 0;
  std::uint8_t size = 0;  // 0 stands for an unknown type
};

// True for integers of 1, 2, 4 and 8 bytes and floats of 4 and 8.
bool is_known(ScalarType type);
// Returns the number at `from`; also a half float, which is no known type of clouds.
double read_scalar(const std::byte* from, ScalarType type, bool big_endian);
// Returns the unsigned integer of `size` little-endian bytes, 4 at most; those beyond the end are
// 0.
std::uint32_t unsigned_at(std::string_view bytes, std::size_t at, std::size_t size = 4);

}  // namespace vpm::file
