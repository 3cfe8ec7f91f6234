// Zip archives made for tests.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <string>
#include <vector>

namespace vpm::test {

inline void append_little_endian(std::string& bytes, std::uint64_t number, int size = 4) {
  for (int k = 0; k < size; ++k) bytes += static_cast<char>(number >> 8 * k & 0xFF);
}

struct ZippedFile {
  std::string path, content;
};

// Returns a zip archive of files that are not packed; with zip64's sizes in 64 bits if `large`.
inline std::string zip(const std::vector<ZippedFile>& files, bool large = false) {
  std::string bytes, directory;
  for (const auto& [path, content] : files) {
    std::string head, sizes;
    for (const unsigned number : {20U, 0U, 0U, 0U, 0U}) append_little_endian(head, number, 2);
    append_little_endian(
        head, crc32_z(0, reinterpret_cast<const Bytef*>(content.data()), content.size()));
    for (int k = 0; k < 2; ++k) append_little_endian(sizes, large ? 0xFFFFFFFF : content.size());
    append_little_endian(sizes, path.size(), 2);
    std::string extra;
    if (large) {
      append_little_endian(extra, 1, 2);
      append_little_endian(extra, 24, 2);
      for (const std::size_t number : {content.size(), content.size(), bytes.size()})
        append_little_endian(extra, number, 8);
    }
    std::string extra_size;
    append_little_endian(extra_size, extra.size(), 2);
    directory +=
        std::string("PK\x01\x02\x14\0", 6) + head + sizes + extra_size + std::string(10, '\0');
    append_little_endian(directory, large ? 0xFFFFFFFF : bytes.size());
    directory += path + extra;
    bytes += "PK\x03\x04" + head + sizes + std::string(2, '\0') + path + content;
  }
  std::string end("PK\x05\x06\0\0\0\0", 8);
  for (int k = 0; k < 2; ++k) append_little_endian(end, files.size(), 2);
  append_little_endian(end, directory.size());
  append_little_endian(end, bytes.size());
  append_little_endian(end, 0, 2);
  return bytes + directory + end;
}

}  // namespace vpm::test
