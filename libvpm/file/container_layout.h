// Byte layout of a container, as in formats/container.md.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>

#include "libvpm/file/kind.h"

namespace vpm::file {

static_assert(std::endian::native == std::endian::little,
              "vpm files are little-endian and are copied to memory as they are");

// Signature, built like PNG's: a byte that is not ASCII, and line ends that a transfer as text
// would change.
inline constexpr unsigned char kMagic[8] = {0x89, 'V', 'P', 'M', '\r', '\n', 0x1a, '\n'};
inline constexpr std::uint32_t kLayoutVersion = 1;
inline constexpr std::uint32_t kKnownRequiredFlags = 0;
// Alignment of chunks in bytes: a cache line, and enough for vector loads from a mapped file.
inline constexpr std::size_t kAlignment = 64;

struct Preamble {
  unsigned char magic[8];
  std::uint32_t layout_version;
  std::uint32_t kind;
  std::uint32_t required_flags;  // a reader that does not know one of them must refuse the file
  std::uint32_t optional_flags;  // a reader may ignore these
  std::uint64_t file_size;
  std::uint32_t chunk_count;
  std::uint32_t header_size;         // size of the JSON header in bytes
  std::uint64_t reserved;            // 0
  std::uint64_t directory_checksum;  // XXH3-64 of chunk table and JSON header
  std::uint64_t preamble_checksum;   // XXH3-64 of the bytes before this field
};
static_assert(sizeof(Preamble) == 64);

struct ChunkEntry {
  char id[4];
  std::uint32_t index;
  std::uint32_t element_size;
  std::uint32_t reserved;  // 0
  std::uint64_t offset;
  std::uint64_t size;  // in bytes
  std::uint64_t checksum;
};
static_assert(sizeof(ChunkEntry) == 40);

constexpr std::size_t aligned(std::size_t size) {
  return (size + kAlignment - 1) / kAlignment * kAlignment;
}

// Names of a kind for messages: e.g. "a packing (.vpmp)" and `pack`, the function that makes it.
struct KindNames {
  const char* what;
  const char* made_by;
};
KindNames names_of(Kind kind);

}  // namespace vpm::file
