#include "libvpm/file/container.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string_view>

#include "libvpm/core/error.h"
#include "libvpm/core/vec3.h"
#include "libvpm/file/checksum.h"
#include "libvpm/file/container_layout.h"
#include "tests/refusal.h"

namespace vpm::file {
namespace {

template <class Action>
std::string refusal_of(const Action& action) {
  const auto fault = test::fault_of(action);
  if (!fault) return "";
  EXPECT_EQ(fault->kind(), ErrorKind::refused);
  return fault->what();
}

std::vector<std::byte> example() {
  Writer writer(Kind::cloud, {{"unit", "m"}, {"note", "caf\xc3\xa9"}});
  const std::vector<double> numbers{1, -0.0, 1e-300};
  const std::vector<Vec3f> points{{1, 2, 3}};
  writer.add(ChunkId("NUMB"), 0, std::span(numbers));
  writer.add(ChunkId("NONE"), 0, std::span<const float>());
  writer.add(ChunkId("NUMB"), 1, std::span(points));
  return writer.bytes();
}

TEST(Container, GivesBackWhatWasWritten) {
  const Reader reader(example(), "example", Kind::cloud);
  EXPECT_EQ(reader.header().at("note"), "caf\xc3\xa9");
  const std::vector<double> numbers = reader.read<double>(ChunkId("NUMB"), 0);
  ASSERT_EQ(numbers.size(), 3U);
  EXPECT_TRUE(std::signbit(numbers[1]));
  EXPECT_EQ(numbers[2], 1e-300);
  EXPECT_EQ(reader.read<Vec3f>(ChunkId("NUMB"), 1), (std::vector<Vec3f>{{1, 2, 3}}));
  EXPECT_TRUE(reader.has(ChunkId("NONE"), 0));
  EXPECT_TRUE(reader.read<float>(ChunkId("NONE"), 0).empty());
  EXPECT_FALSE(reader.has(ChunkId("NUMB"), 2));
}

TEST(Container, IdenticalInputGivesIdenticalBytes) {
  EXPECT_EQ(example(), example());
}

TEST(Container, ChunksAreAligned) {
  const std::vector<std::byte> bytes = example();
  Preamble preamble;
  std::memcpy(&preamble, bytes.data(), sizeof(preamble));
  ASSERT_EQ(preamble.chunk_count, 3U);
  for (std::size_t k = 0; k < preamble.chunk_count; ++k) {
    ChunkEntry entry;
    std::memcpy(&entry, bytes.data() + sizeof(preamble) + k * sizeof(entry), sizeof(entry));
    EXPECT_EQ(entry.offset % kAlignment, 0U);
  }
}

TEST(Container, NamesOfFilesNeedNotBeUtf8) {
  Writer writer(Kind::packing, {{"unit", "m"}, {"input", "\xff\xfe.off"}});
  const Reader reader(writer.bytes(), "example", Kind::packing);
  EXPECT_EQ(reader.header().at("input"), "\xef\xbf\xbd\xef\xbf\xbd.off");
}

TEST(Container, AnotherKindIsRefusedByName) {
  const std::string said = refusal_of([] { Reader(example(), "wall.vpmc", Kind::tool_model); });
  EXPECT_EQ(
      said,
      "wall.vpmc: this is a cloud (.vpmc); needed is a tool model (.vpmg), which `build_tool` "
      "writes");
}

TEST(Container, MissingChunksAndOtherElementsAreRefused) {
  const Reader reader(example(), "wall.vpmc", Kind::cloud);
  EXPECT_NE(refusal_of([&] { reader.read<double>(ChunkId("NUMB"), 7); }).find("NUMB 7 is missing"),
            std::string::npos);
  EXPECT_NE(refusal_of([&] {
              reader.read<Vec3>(ChunkId("NUMB"), 0);
            }).find("elements of 8 bytes instead of 24"),
            std::string::npos);
}

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
