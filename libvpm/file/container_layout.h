// The bytes of a container, as formats/container.md specifies them.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>

#include "libvpm/file/container.h"

namespace vpm::file {

static_assert(std::endian::native == std::endian::little,
              "vpm files are little-endian and are copied to memory as they are");

// Like PNG's signature: a byte that is no text, and line ends that a transfer as text would change.
inline constexpr unsigned char kMagic[8] = {0x89, 'V', 'P', 'M', '\r', '\n', 0x1a, '\n'};
inline constexpr std::uint32_t kLayoutVersion = 1;
inline constexpr std::uint32_t kKnownRequiredFlags = 0;
// A cache line, and enough for any vector load from a mapped file.
inline constexpr std::size_t kAlignment = 64;

struct Preamble {
  unsigned char magic[8];
  std::uint32_t layout_version;
  std::uint32_t kind;
  std::uint32_t required_flags;  // a reader that does not know one of them must refuse the file
  std::uint32_t optional_flags;  // a reader may pass over these
  std::uint64_t file_size;
  std::uint32_t chunk_count;
  std::uint32_t header_size;         // bytes of JSON
  std::uint64_t reserved;            // 0
  std::uint64_t directory_checksum;  // of the chunk table and the JSON header
  std::uint64_t preamble_checksum;   // of the bytes before this field
};
static_assert(sizeof(Preamble) == 64);

struct ChunkEntry {
  char id[4];
  std::uint32_t index;
  std::uint32_t element_size;
  std::uint32_t reserved;  // 0
  std::uint64_t offset;
  std::uint64_t size;  // bytes
  std::uint64_t checksum;
};
static_assert(sizeof(ChunkEntry) == 40);

constexpr std::size_t aligned(std::size_t size) {
  return (size + kAlignment - 1) / kAlignment * kAlignment;
}

// "a packing (.vpmp)", and the tool that makes it.
struct KindNames {
  const char* what;
  const char* made_by;
};
KindNames names_of(Kind kind);

}  // namespace vpm::file
