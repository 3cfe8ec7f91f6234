#include "tests/fuzz/container_mutator.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <limits>
#include <optional>
#include <random>

#include "libvpm/file/checksum.h"
#include "libvpm/file/container_layout.h"
#include "tests/fuzz/targets.h"

// The fuzzer's own changes; without the fuzzer (corpus_main.cpp) there is none.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace vpm::fuzz {
namespace {

using file::ChunkEntry;
using file::Preamble;
using Data = std::vector<std::uint8_t>;

struct Chunk {
  ChunkEntry entry;
  Data data;
};

struct Container {
  Preamble preamble;
  Data header;  // JSON
  std::vector<Chunk> chunks;
};

// Returns the parts of a container; empty if it is damaged too much.
std::optional<Container> taken_apart(const Data& bytes) {
  constexpr std::size_t kMostChunks = 200;
  Container parts;
  if (bytes.size() < sizeof(Preamble)) return std::nullopt;
  std::memcpy(&parts.preamble, bytes.data(), sizeof(Preamble));
  const std::size_t count = parts.preamble.chunk_count, header = parts.preamble.header_size;
  const std::size_t directory = count * sizeof(ChunkEntry) + header;
  if (count > kMostChunks || directory > bytes.size() - sizeof(Preamble)) return std::nullopt;
  const auto at = [&](std::size_t offset) {
    return bytes.begin() + static_cast<std::ptrdiff_t>(offset);
  };
  const std::size_t json = sizeof(Preamble) + count * sizeof(ChunkEntry);
  parts.header.assign(at(json), at(json + header));
  for (std::size_t k = 0; k < count; ++k) {
    Chunk chunk;
    std::memcpy(&chunk.entry, bytes.data() + sizeof(Preamble) + k * sizeof(ChunkEntry),
                sizeof(ChunkEntry));
    const ChunkEntry& entry = chunk.entry;
    if (entry.offset > bytes.size() || entry.size > bytes.size() - entry.offset)
      return std::nullopt;
    chunk.data.assign(at(entry.offset), at(entry.offset + entry.size));
    parts.chunks.push_back(std::move(chunk));
  }
  return parts;
}

Data put_together(Container parts) {
  parts.preamble.chunk_count = static_cast<std::uint32_t>(parts.chunks.size());
  parts.preamble.header_size = static_cast<std::uint32_t>(parts.header.size());
  Data bytes(sizeof(Preamble) + parts.chunks.size() * sizeof(ChunkEntry));
  bytes.insert(bytes.end(), parts.header.begin(), parts.header.end());
  for (std::size_t k = 0; k < parts.chunks.size(); ++k) {
    Chunk& chunk = parts.chunks[k];
    bytes.resize(file::aligned(bytes.size()));
    chunk.entry.offset = bytes.size();
    chunk.entry.size = chunk.data.size();
    bytes.insert(bytes.end(), chunk.data.begin(), chunk.data.end());
    std::memcpy(bytes.data() + sizeof(Preamble) + k * sizeof(ChunkEntry), &chunk.entry,
                sizeof(ChunkEntry));
  }
  std::memcpy(bytes.data(), &parts.preamble, sizeof(Preamble));
  return bytes;
}

// Numbers at which arithmetic changes its ways.
constexpr double kReals[] = {0,
                             -0.0,
                             1,
                             -1,
                             0.5,
                             1e-300,
                             1e300,
                             1e30,
                             1e38,
                             1e15,
                             1e-40,
                             std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::denorm_min()};
constexpr std::uint32_t kWholes[] = {0,     1,          2,          255,        65535,
                                     65536, 0x7fffffff, 0x80000000, 0xfffffffe, 0xffffffff};

class Changes {
 public:
  explicit Changes(unsigned seed) : random_(seed) {}

  std::size_t below(std::size_t count) { return random_() % count; }

  void change(Container& parts) {
    const std::size_t way = below(16);
    if (way == 0 || parts.chunks.empty()) return change_blindly(parts.header, 64);
    Chunk& chunk = parts.chunks[below(parts.chunks.size())];
    const std::size_t element = std::clamp<std::size_t>(chunk.entry.element_size, 1, 256);
    if (way == 1) {
      parts.chunks.erase(parts.chunks.begin() +
                         static_cast<std::ptrdiff_t>(below(parts.chunks.size())));
    } else if (way == 2) {
      constexpr std::size_t kNameIndexAndElement = 12;
      LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(&chunk.entry), kNameIndexAndElement,
                       kNameIndexAndElement);
    } else if (way == 3) {
      chunk.data.resize(
          chunk.data.size() -
          std::min(chunk.data.size(), element * (1 + below(chunk.data.size() / element + 1))));
    } else if (way == 4) {
      Data last(
          chunk.data.end() - static_cast<std::ptrdiff_t>(std::min(element, chunk.data.size())),
          chunk.data.end());
      chunk.data.insert(chunk.data.end(), last.begin(), last.end());
    } else if (way < 10) {
      put_number(chunk.data);
    } else {
      change_blindly(chunk.data, 0);
    }
  }

 private:
  void change_blindly(Data& data, std::size_t more) {
    const std::size_t size = data.size();
    if (size + more == 0) return;
    data.resize(size + more);
    data.resize(LLVMFuzzerMutate(data.data(), size, size + more));
  }

  template <class Number>
  void put(Data& data, Number number) {
    if (data.size() < sizeof number) return;
    const std::size_t at = below(data.size() / sizeof number) * sizeof number;
    std::memcpy(data.data() + at, &number, sizeof number);
  }

  void put_number(Data& data) {
    const std::size_t kind = below(3);
    const double real = kReals[below(std::size(kReals))];
    if (kind == 0) put(data, real);
    if (kind == 1) put(data, static_cast<float>(std::clamp(real, -3e38, 3e38)));
    if (kind == 2) put(data, kWholes[below(std::size(kWholes))]);
  }

  std::minstd_rand random_;
};

}  // namespace

std::vector<std::byte> with_mended_checksums(Bytes input) {
  std::vector<std::byte> bytes(input.begin(), input.end());
  Preamble preamble;
  if (bytes.size() < sizeof preamble) return bytes;
  std::memcpy(&preamble, bytes.data(), sizeof preamble);
  preamble.file_size = bytes.size();
  const std::uint64_t table = std::uint64_t{preamble.chunk_count} * sizeof(ChunkEntry);
  if (table + preamble.header_size <= bytes.size() - sizeof preamble) {
    for (std::uint64_t k = 0; k < preamble.chunk_count; ++k) {
      std::byte* const place = bytes.data() + sizeof preamble + k * sizeof(ChunkEntry);
      ChunkEntry entry;
      std::memcpy(&entry, place, sizeof entry);
      if (entry.offset > bytes.size() || entry.size > bytes.size() - entry.offset) continue;
      entry.checksum = file::checksum(std::span(bytes).subspan(entry.offset, entry.size));
      std::memcpy(place, &entry, sizeof entry);
    }
    preamble.directory_checksum =
        file::checksum(std::span(bytes).subspan(sizeof preamble, table + preamble.header_size));
  }
  std::memcpy(bytes.data(), &preamble, sizeof preamble);
  preamble.preamble_checksum =
      file::checksum(std::span(bytes).first(offsetof(Preamble, preamble_checksum)));
  std::memcpy(bytes.data(), &preamble, sizeof preamble);
  return bytes;
}

std::size_t mutate_container(std::uint8_t* data, std::size_t size, std::size_t most,
                             unsigned seed) {
  Changes changes(seed);
  std::optional<Container> parts = taken_apart(Data(data, data + size));
  if (!parts || changes.below(8) == 0) return LLVMFuzzerMutate(data, size, most);
  for (std::size_t rounds = 1 + changes.below(2); rounds > 0; --rounds) changes.change(*parts);
  const Data bytes = put_together(std::move(*parts));
  if (bytes.size() > most) return LLVMFuzzerMutate(data, size, most);
  std::copy(bytes.begin(), bytes.end(), data);
  return bytes.size();
}

}  // namespace vpm::fuzz
