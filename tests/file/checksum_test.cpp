#include "libvpm/file/checksum.h"

#include <gtest/gtest.h>

#include <string_view>

namespace vpm::file {
namespace {

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

// Compares with known answers of XXH3 with seed 0, from the xxHash project's xxhsum.
TEST(Checksum, IsXxh3) {
  EXPECT_EQ(checksum({}), 0x2d06800538d394c2U);
  EXPECT_EQ(content_hash({}), "99aa06d3014798d86001c324468d497f");
}

TEST(Checksum, PartsAreConcatenated) {
  EXPECT_EQ(content_hash({bytes_of("sphere "), bytes_of(""), bytes_of("packing")}),
            content_hash({bytes_of("sphere packing")}));
  EXPECT_NE(content_hash({bytes_of("a")}), content_hash({bytes_of("b")}));
}

}  // namespace
}  // namespace vpm::file
