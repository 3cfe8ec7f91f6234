// Unpacks entries of zip archives, which 3MF files are.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace vpm {

// Keeps a view of the archive's bytes. Paths are compared in lower case, as 3MF does, and without
// the slash that begins them within an archive.
class ZipArchive {
 public:
  explicit ZipArchive(std::string_view zip);

  bool has(const std::string& path) const { return records_.contains(key_of(path)); }
  // Returns the first path with this ending, or an empty one.
  std::string path_ending_in(std::string_view ending) const;
  // Returns the bytes of an entry; nothing if there is none, or if it is damaged, encrypted or
  // packed by other ways than deflate. Throws std::bad_alloc where all that was unpacked is more
  // than an archive of this size may take.
  std::optional<std::string> unpacked(const std::string& path);
  // Returns the path as the archive's paths are compared.
  static std::string key_of(std::string_view path);

 private:
  std::string_view zip_;
  std::map<std::string, std::size_t> records_;  // place of an entry's record in the directory
  std::uint64_t left_;                          // bytes that may still be unpacked
};

}  // namespace vpm
