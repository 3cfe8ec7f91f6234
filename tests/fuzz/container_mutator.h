// Takes containers apart and puts them together, so that the fuzzer gets past their checksums.
#pragma once

#include <cstddef>
#include <vector>

#include "tests/fuzz/fuzz_target.h"

namespace vpm::fuzz {

// Returns the container with its size and every checksum mended, as far as it can be read.
std::vector<std::byte> with_mended_checksums(Bytes input);

}  // namespace vpm::fuzz
