#include "libvpm/mesh/scene_archive.h"

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <new>

#include "libvpm/file/scalar_type.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"

namespace vpm {
namespace {

constexpr std::string_view kRecord{"PK\x01\x02", 4}, kEnd{"PK\x05\x06", 4};
constexpr std::size_t kRecordSize = 46;

// Returns the place of the directory's first record. Where the archive's end does not tell it, as
// of large archives (zip64), the first bytes that look like one are taken.
std::size_t directory_of(std::string_view zip) {
  const std::size_t end = zip.rfind(kEnd);
  const std::size_t told = end == zip.npos ? zip.size() : file::unsigned_at(zip, end + 16, 4);
  return told < zip.size() && zip.substr(told).starts_with(kRecord) ? told : zip.find(kRecord);
}

std::string inflated(std::string_view packed, std::size_t most) {
  constexpr std::size_t kStep = 1 << 20;
  z_stream stream{};
  if (::inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(std::min<std::size_t>(packed.size(), UINT32_MAX));
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
  return text;
}

}  // namespace

std::vector<ZipEntry> zip_entries(std::string_view zip) {
  std::vector<ZipEntry> entries;
  for (std::size_t at = directory_of(zip);
       at < zip.size() && zip.substr(at).starts_with(kRecord) && at + kRecordSize <= zip.size();) {
    const std::size_t name_size = file::unsigned_at(zip, at + 28, 2);
    entries.push_back({file::in_lower_case(zip.substr(at + kRecordSize, name_size)), at});
    at += kRecordSize + name_size + file::unsigned_at(zip, at + 30, 2) +
          file::unsigned_at(zip, at + 32, 2);
  }
  return entries;
}

std::string unpacked(std::string_view zip, const ZipEntry& entry) {
  constexpr std::size_t kLocalSize = 30;
  const std::uint32_t method = file::unsigned_at(zip, entry.record + 10, 2),
                      size = file::unsigned_at(zip, entry.record + 20, 4);
  const std::size_t local = file::unsigned_at(zip, entry.record + 42, 4);
  const std::size_t begin = local + kLocalSize + file::unsigned_at(zip, local + 26, 2) +
                            file::unsigned_at(zip, local + 28, 2);
  if (begin >= zip.size()) return "";
  const std::string_view packed = zip.substr(begin, size);
  return method == 0 ? std::string(packed) : inflated(packed, file::most_memory(zip.size()));
}

}  // namespace vpm
