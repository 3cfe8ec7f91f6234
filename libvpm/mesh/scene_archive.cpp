#include "libvpm/mesh/scene_archive.h"

#include <zlib.h>

#include <algorithm>
#include <limits>
#include <new>

#include "libvpm/file/scalar_type.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"

namespace vpm {
namespace {

constexpr std::string_view kRecord{"PK\x01\x02", 4}, kEnd{"PK\x05\x06", 4};
constexpr std::size_t kRecordSize = 46;
constexpr std::uint32_t kIsInExtra = 0xFFFFFFFF;  // zip64

// Returns the place of the directory's first record. Where the archive's end does not tell it, as
// of large archives (zip64), the first bytes that look like one are taken.
std::size_t directory_of(std::string_view zip) {
  const std::size_t end = zip.rfind(kEnd);
  const std::size_t told = end == zip.npos ? zip.size() : file::unsigned_at(zip, end + 16, 4);
  return told < zip.size() && zip.substr(told).starts_with(kRecord) ? told : zip.find(kRecord);
}

// Holds what the directory tells of an entry.
struct Entry {
  std::uint32_t flags, method, checksum;
  std::uint64_t size, local;  // bytes packed, and the place of the header before them
};

// Replaces those numbers of an entry that do not fit into 32 bits and therefore stand, with 64
// bits, in its extra field of type 1, in this order: unpacked size, packed size, place in the file.
void take_large(std::string_view extra, bool has_unpacked, Entry& entry) {
  constexpr std::size_t kHead = 4;
  while (extra.size() > kHead) {
    const std::size_t size = file::unsigned_at(extra, 2, 2);
    std::string_view field = extra.substr(kHead, size);
    if (file::unsigned_at(extra, 0, 2) == 1) {
      const auto next = [&](std::uint64_t& number) {
        if (field.size() < 8) return;
        number = file::unsigned_at(field, 0, 4) | std::uint64_t{file::unsigned_at(field, 4, 4)}
                                                      << 32;
        field.remove_prefix(8);
      };
      std::uint64_t unpacked = 0;
      if (has_unpacked) next(unpacked);
      if (entry.size == kIsInExtra) next(entry.size);
      if (entry.local == kIsInExtra) next(entry.local);
      return;
    }
    extra.remove_prefix(std::min(extra.size(), kHead + size));
  }
}

Entry entry_at(std::string_view zip, std::size_t at) {
  const auto number = [&](std::size_t offset, std::size_t size) {
    return file::unsigned_at(zip, at + offset, size);
  };
  Entry entry{number(8, 2), number(10, 2), number(16, 4), number(20, 4), number(42, 4)};
  const std::size_t extra = at + kRecordSize + number(28, 2);
  if (extra < zip.size())
    take_large(zip.substr(extra, number(30, 2)), number(24, 4) == kIsInExtra, entry);
  return entry;
}

std::optional<std::string> inflated(std::string_view packed, std::uint64_t most) {
  constexpr std::size_t kStep = 1 << 20;
  z_stream stream{};
  if (::inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(
      std::min<std::size_t>(packed.size(), std::numeric_limits<std::uint32_t>::max()));
  std::string text, part(kStep, '\0');
  int state = Z_OK;
  while (state == Z_OK && text.size() <= most) {
    stream.next_out = reinterpret_cast<Bytef*>(part.data());
    stream.avail_out = static_cast<uInt>(part.size());
    state = ::inflate(&stream, Z_NO_FLUSH);
    text.append(part, 0, part.size() - stream.avail_out);
  }
  ::inflateEnd(&stream);
  if (text.size() > most) throw std::bad_alloc();
  if (state != Z_STREAM_END) return std::nullopt;
  return text;
}

bool has_checksum(const std::string& text, std::uint32_t checksum) {
  return ::crc32_z(0, reinterpret_cast<const Bytef*>(text.data()), text.size()) == checksum;
}

}  // namespace

std::string ZipArchive::key_of(std::string_view path) {
  if (path.starts_with('/')) path.remove_prefix(1);
  return file::in_lower_case(path);
}

ZipArchive::ZipArchive(std::string_view zip) : zip_(zip), left_(file::most_memory(zip.size())) {
  for (std::size_t at = directory_of(zip);
       at < zip.size() && zip.substr(at).starts_with(kRecord) && at + kRecordSize <= zip.size();) {
    const std::size_t name_size = file::unsigned_at(zip, at + 28, 2);
    records_.emplace(key_of(zip.substr(at + kRecordSize, name_size)), at);
    at += kRecordSize + name_size + file::unsigned_at(zip, at + 30, 2) +
          file::unsigned_at(zip, at + 32, 2);
  }
}

std::string ZipArchive::path_ending_in(std::string_view ending) const {
  for (const auto& [path, record] : records_)
    if (path.ends_with(ending)) return path;
  return "";
}

std::optional<std::string> ZipArchive::unpacked(const std::string& path) {
  constexpr std::size_t kLocalSize = 30;
  constexpr std::uint32_t kStored = 0, kDeflated = 8;
  const auto found = records_.find(key_of(path));
  if (found == records_.end()) return std::nullopt;
  const Entry entry = entry_at(zip_, found->second);
  if (entry.local >= zip_.size() || (entry.flags & 1U) != 0) return std::nullopt;
  const std::size_t begin = entry.local + kLocalSize +
                            file::unsigned_at(zip_, entry.local + 26, 2) +
                            file::unsigned_at(zip_, entry.local + 28, 2);
  if (begin >= zip_.size()) return std::nullopt;
  const std::string_view packed = zip_.substr(begin, entry.size);
  std::optional<std::string> text;
  if (entry.method == kStored) text = std::string(packed);
  if (entry.method == kDeflated) text = inflated(packed, left_);
  if (!text || !has_checksum(*text, entry.checksum)) return std::nullopt;
  if (text->size() > left_) throw std::bad_alloc();
  left_ -= text->size();
  return text;
}

}  // namespace vpm
