// Container of every vpm file, specified in formats/container.md.
//
// Layout: magic, layout version, feature flags, kind; a JSON header; a table of chunks with a
// checksum each; chunks aligned to 64 bytes. Little-endian. The same input gives the same bytes.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "libvpm/file/kind.h"

namespace vpm::file {

// Name of a chunk: four characters, e.g. "SPHR".
struct ChunkId {
  char name[4];
  consteval ChunkId(const char (&text)[5]) : name{text[0], text[1], text[2], text[3]} {}
  constexpr ChunkId(const char* text, std::nullptr_t) : name{text[0], text[1], text[2], text[3]} {}
  friend constexpr auto operator<=>(const ChunkId&, const ChunkId&) = default;
};

class Writer {
 public:
  // Starts a file of this kind. The header must be an object with "unit": "m".
  Writer(Kind kind, nlohmann::json header);

  // Appends a chunk; chunks are stored in the order of the calls. `index` tells chunks of one name
  // apart, e.g. those of a model's levels.
  template <class T>
  void add(ChunkId id, std::uint32_t index, std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    add_bytes(id, index, sizeof(T), std::as_bytes(values));
  }

  std::vector<std::byte> bytes() const;

  // Writes the file atomically, or to standard output for "-". Overwrites what is there: call
  // check_container_output (overwrite.h) first. Throws Error(cannot_write).
  void write(const std::string& path) const;

 private:
  struct Chunk {
    ChunkId id;
    std::uint32_t index;
    std::uint32_t element_size;
    std::vector<std::byte> data;
  };
  void add_bytes(ChunkId id, std::uint32_t index, std::size_t element_size,
                 std::span<const std::byte> bytes);

  Kind kind_;
  nlohmann::json header_;
  std::vector<Chunk> chunks_;
};

// Reads a whole file and checks magic, version, flags, kind, sizes and checksums. Constructors
// throw Error(refused) with the file's name, the defect and how to mend it.
class Reader {
 public:
  Reader(const std::string& path, Kind expected);  // "-" reads standard input
  Reader(std::vector<std::byte> bytes, std::string name, Kind expected);

  Reader(const Reader&) = delete;  // entries_ point into bytes_
  Reader& operator=(const Reader&) = delete;

  const nlohmann::json& header() const { return header_; }
  const std::string& name() const { return name_; }
  bool has(ChunkId id, std::uint32_t index) const;

  // Returns a chunk's values. Throws Error(refused) if the chunk is missing or its element size is
  // not sizeof(T).
  template <class T>
  std::vector<T> read(ChunkId id, std::uint32_t index) const {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::span<const std::byte> bytes = find(id, index, sizeof(T));
    std::vector<T> values(bytes.size() / sizeof(T));
    copy_bytes(values.data(), bytes);
    return values;
  }

  // Throws Error(refused) with the text "<name>: <defect>; <hint>".
  [[noreturn]] void refuse_file(const std::string& defect, const std::string& hint = {}) const;

 private:
  struct Entry {
    std::uint32_t element_size;
    std::span<const std::byte> data;
  };
  void parse(Kind expected);
  void parse_directory(std::uint64_t chunk_count, std::uint64_t header_size,
                       std::uint64_t directory_checksum);
  std::span<const std::byte> find(ChunkId id, std::uint32_t index, std::size_t element_size) const;
  static void copy_bytes(void* to, std::span<const std::byte> from);

  std::vector<std::byte> bytes_;
  std::string name_;
  nlohmann::json header_;
  std::map<std::pair<ChunkId, std::uint32_t>, Entry> entries_;
};

}  // namespace vpm::file
