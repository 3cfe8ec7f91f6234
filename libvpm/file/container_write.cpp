#include <cstring>
#include <limits>

#include "libvpm/core/error.h"
#include "libvpm/file/checksum.h"
#include "libvpm/file/container.h"
#include "libvpm/file/container_layout.h"
#include "libvpm/file/stream.h"

namespace vpm::file {
namespace {

std::size_t place(std::vector<std::byte>& bytes, std::size_t at, const void* from,
                  std::size_t size) {
  if (size > 0) std::memcpy(bytes.data() + at, from, size);
  return at + size;
}

}  // namespace

Writer::Writer(Kind kind, nlohmann::json header) : kind_(kind), header_(std::move(header)) {}

void Writer::add_bytes(ChunkId id, std::uint32_t index, std::size_t element_size,
                       std::span<const std::byte> bytes) {
  chunks_.push_back(
      {id, index, static_cast<std::uint32_t>(element_size), {bytes.begin(), bytes.end()}});
}

std::vector<std::byte> Writer::bytes() const {
  // Replaces bytes that are not UTF-8: file names may hold them, JSON may not.
  const std::string json = header_.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  if (json.size() > std::numeric_limits<std::uint32_t>::max())
    refuse("the header to be written exceeds 4 GiB");
  const std::size_t directory = chunks_.size() * sizeof(ChunkEntry) + json.size();

  std::vector<ChunkEntry> table;
  std::size_t end = sizeof(Preamble) + directory;
  for (const Chunk& chunk : chunks_) {
    ChunkEntry entry{{},           chunk.index,       chunk.element_size,  0,
                     aligned(end), chunk.data.size(), checksum(chunk.data)};
    std::memcpy(entry.id, chunk.id.name, sizeof(entry.id));
    end = entry.offset + entry.size;
    table.push_back(entry);
  }

  std::vector<std::byte> bytes(end);  // gaps between chunks stay zero
  const std::size_t json_at =
      place(bytes, sizeof(Preamble), table.data(), table.size() * sizeof(ChunkEntry));
  place(bytes, json_at, json.data(), json.size());
  for (std::size_t k = 0; k < table.size(); ++k)
    place(bytes, table[k].offset, chunks_[k].data.data(), chunks_[k].data.size());

  Preamble preamble{};
  std::memcpy(preamble.magic, kMagic, sizeof(kMagic));
  preamble.layout_version = kLayoutVersion;
  preamble.kind = static_cast<std::uint32_t>(kind_);
  preamble.file_size = end;
  preamble.chunk_count = static_cast<std::uint32_t>(table.size());
  preamble.header_size = static_cast<std::uint32_t>(json.size());
  preamble.directory_checksum = checksum(std::span(bytes).subspan(sizeof(Preamble), directory));
  preamble.preamble_checksum =
      checksum(std::as_bytes(std::span(&preamble, 1)).first(offsetof(Preamble, preamble_checksum)));
  place(bytes, 0, &preamble, sizeof(preamble));
  return bytes;
}

void Writer::write(const std::string& path) const {
  write_all(path, std::span<const std::byte>(bytes()));
}

}  // namespace vpm::file
