// XXH3 hashes with seed 0: 64 bits guard files against damage, 128 bits identify contents. Neither
// protects against malice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>

namespace vpm::file {

std::uint64_t checksum(std::span<const std::byte> bytes);

// Returns the XXH3-128 of the concatenated parts in canonical form: 32 lower-case hexadecimal
// digits.
std::string content_hash(std::initializer_list<std::span<const std::byte>> parts);

}  // namespace vpm::file
