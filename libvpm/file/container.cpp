#include "libvpm/file/container.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/file/checksum.h"
#include "libvpm/file/container_layout.h"
#include "libvpm/file/stream.h"

namespace vpm::file {
namespace {

constexpr const char* kAgain = "copy or make the file again";

// Limits the nesting of the JSON header: copying a deeper one could overflow a thread's stack.
constexpr int kDeepestHeader = 32;

std::string quoted(ChunkId id, std::uint32_t index) {
  std::string text = "chunk ";
  for (const char letter : id.name)
    text += std::isprint(static_cast<unsigned char>(letter)) != 0 ? letter : '?';
  return text + " " + std::to_string(index);
}

std::string hexadecimal(std::uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof(text), "0x%08x", static_cast<unsigned>(value));
  return text;
}

bool is_zero(std::span<const std::byte> bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](std::byte b) { return b == std::byte{0}; });
}

std::size_t place(std::vector<std::byte>& bytes, std::size_t at, const void* from,
                  std::size_t size) {
  if (size > 0) std::memcpy(bytes.data() + at, from, size);
  return at + size;
}

}  // namespace

KindNames names_of(Kind kind) {
  switch (kind) {
    case Kind::packing:
      return {"a packing (.vpmp)", "`pack`"};
    case Kind::tool_model:
      return {"a tool model (.vpmg)", "`build_tool`"};
    case Kind::cloud:
      return {"a cloud (.vpmc)", "`import_cloud`"};
  }
  return {"a file of a kind that this build does not know", "a newer vpm"};
}

Reader::Reader(const std::string& path, Kind expected)
    : Reader(read_all(path), path == "-" ? "standard input" : path, expected) {}

Reader::Reader(std::vector<std::byte> bytes, std::string name, Kind expected)
    : bytes_(std::move(bytes)), name_(std::move(name)) {
  parse(expected);
}

void Reader::refuse_file(const std::string& defect, const std::string& hint) const {
  refuse(defect, name_, hint);
}

void Reader::parse(Kind expected) {
  const KindNames wanted = names_of(expected);
  const std::string needed =
      std::string("needed is ") + wanted.what + ", which " + wanted.made_by + " writes";
  if (bytes_.empty()) refuse_file("the file is empty", needed);
  const std::size_t compared = std::min(bytes_.size(), sizeof(kMagic));
  if (std::memcmp(bytes_.data(), kMagic, compared) != 0) {
    if (bytes_.size() >= 4 && std::memcmp(bytes_.data(), kMagic, 4) == 0)
      refuse_file("the signature is damaged, as by a transfer as text", "copy the file as binary");
    refuse_file("not a vpm file", needed);
  }
  if (bytes_.size() < sizeof(Preamble)) {
    refuse_file("the file is cut short: it has " + std::to_string(bytes_.size()) +
                    " bytes, fewer than any vpm file",
                kAgain);
  }
  Preamble preamble;
  std::memcpy(&preamble, bytes_.data(), sizeof(preamble));
  // Checks the version before the checksum, since a later layout may store the checksum elsewhere.
  if (preamble.layout_version != kLayoutVersion) {
    refuse_file("layout version " + std::to_string(preamble.layout_version) +
                    ", but this build reads version " + std::to_string(kLayoutVersion),
                "use a newer vpm, or make the file again with this one");
  }
  if (checksum(std::span(bytes_).first(offsetof(Preamble, preamble_checksum))) !=
      preamble.preamble_checksum)
    refuse_file("the first 64 bytes are damaged (checksum)", kAgain);
  const std::uint32_t unknown = preamble.required_flags & ~kKnownRequiredFlags;
  if (unknown != 0) {
    refuse_file("needs features " + hexadecimal(unknown) + " that this build (layout version " +
                    std::to_string(kLayoutVersion) + ") does not know",
                "use a newer vpm");
  }
  if (preamble.kind != static_cast<std::uint32_t>(expected)) {
    refuse_file(std::string("this is ") + names_of(static_cast<Kind>(preamble.kind)).what, needed);
  }
  if (preamble.file_size != bytes_.size()) {
    refuse_file((bytes_.size() < preamble.file_size ? "the file is cut short: it has "
                                                    : "the file has bytes too many: it has ") +
                    std::to_string(bytes_.size()) + " bytes, its preamble says " +
                    std::to_string(preamble.file_size),
                kAgain);
  }
  if (preamble.reserved != 0) refuse_file("a reserved field is not zero", kAgain);
  parse_directory(preamble.chunk_count, preamble.header_size, preamble.directory_checksum);
}

void Reader::parse_directory(std::uint64_t chunk_count, std::uint64_t header_size,
                             std::uint64_t directory_checksum) {
  // Both counts are 32-bit, so these products cannot overflow.
  const std::uint64_t table_size = chunk_count * sizeof(ChunkEntry);
  if (table_size + header_size > bytes_.size() - sizeof(Preamble)) {
    refuse_file("the preamble counts " + std::to_string(chunk_count) + " chunks and " +
                    std::to_string(header_size) + " bytes of header, more than the file holds",
                kAgain);
  }
  const std::span<const std::byte> all(bytes_);
  if (checksum(all.subspan(sizeof(Preamble), table_size + header_size)) != directory_checksum)
    refuse_file("the chunk table or the header is damaged (checksum)", kAgain);

  const char* json = reinterpret_cast<const char*>(bytes_.data()) + sizeof(Preamble) + table_size;
  header_ = nlohmann::json::parse(
      json, json + header_size,
      [&](int depth, nlohmann::json::parse_event_t, const nlohmann::json&) {
        if (depth > kDeepestHeader) refuse_file("the header is nested too deeply", kAgain);
        return true;
      },
      false);
  if (!header_.is_object()) refuse_file("the header is not a JSON object", kAgain);
  if (header_.value("unit", nlohmann::json()) != "m")
    refuse_file("the header's unit is not \"m\"; vpm files are in metres");

  std::size_t end = sizeof(Preamble) + table_size + header_size;
  for (std::uint64_t k = 0; k < chunk_count; ++k) {
    ChunkEntry entry;
    std::memcpy(&entry, bytes_.data() + sizeof(Preamble) + k * sizeof(entry), sizeof(entry));
    const ChunkId id(entry.id, nullptr);
    const std::string chunk = quoted(id, entry.index);
    if (entry.reserved != 0 || entry.element_size == 0 || entry.size % entry.element_size != 0)
      refuse_file(chunk + " has an entry that makes no sense", kAgain);
    // Chunks must follow each other with no gaps except the zeros of the alignment.
    if (entry.offset != aligned(end) || entry.offset > all.size() ||
        entry.size > all.size() - entry.offset)
      refuse_file(chunk + " lies outside of the file or of its order", kAgain);
    const std::span<const std::byte> data = all.subspan(entry.offset, entry.size);
    if (checksum(data) != entry.checksum || !is_zero(all.subspan(end, entry.offset - end)))
      refuse_file(chunk + " is damaged (checksum)", kAgain);
    if (!entries_.try_emplace({id, entry.index}, Entry{entry.element_size, data}).second)
      refuse_file(chunk + " is there twice", kAgain);
    end = entry.offset + entry.size;
  }
  if (end != all.size()) refuse_file("bytes follow the last chunk", kAgain);
}

bool Reader::has(ChunkId id, std::uint32_t index) const {
  return entries_.contains({id, index});
}

std::span<const std::byte> Reader::find(ChunkId id, std::uint32_t index,
                                        std::size_t element_size) const {
  const auto found = entries_.find({id, index});
  if (found == entries_.end()) refuse_file(quoted(id, index) + " is missing", kAgain);
  const Entry& entry = found->second;
  if (entry.element_size != element_size) {
    refuse_file(quoted(id, index) + " has elements of " + std::to_string(entry.element_size) +
                    " bytes instead of " + std::to_string(element_size),
                kAgain);
  }
  return entry.data;
}

void Reader::copy_bytes(void* to, std::span<const std::byte> from) {
  if (!from.empty()) std::memcpy(to, from.data(), from.size());
}

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
