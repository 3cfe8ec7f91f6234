#include "libvpm/file/overwrite.h"

#include <cstring>
#include <filesystem>
#include <fstream>

#include "libvpm/core/error.h"
#include "libvpm/file/container_layout.h"

namespace vpm::file {
namespace {

namespace fs = std::filesystem;

enum class Content { nothing, container, other };

struct Existing {
  Content content = Content::nothing;
  std::uint32_t kind = 0;  // file::Kind, if content is a container
};

Existing content_of(const std::string& path) {
  std::error_code fault;
  if (!fs::is_regular_file(path, fault) || fs::file_size(path, fault) == 0) return {};
  char start[sizeof(Preamble)] = {};
  std::ifstream(path, std::ios::binary).read(start, sizeof(start));
  Preamble preamble;
  std::memcpy(&preamble, start, sizeof(preamble));
  if (std::memcmp(preamble.magic, kMagic, sizeof(kMagic)) != 0) return {Content::other, 0};
  return {Content::container, preamble.kind};
}

[[noreturn]] void refuse_to_overwrite(const std::string& path, const std::string& what) {
  throw Error(ErrorKind::invalid_argument, path + " exists and is " + what, {},
              "name another output, or give `force` to overwrite it");
}

}  // namespace

void check_folder_of(const std::string& path) {
  if (path.empty() || path == "-") return;
  std::error_code fault;
  if (fs::is_directory(path, fault))
    throw Error(ErrorKind::cannot_write, path + " is a folder", {}, "name a file");
  const fs::path folder = fs::path(path).parent_path();
  if (!folder.empty() && !fs::is_directory(folder, fault)) {
    throw Error(ErrorKind::cannot_write,
                "cannot write " + path + ": there is no folder " + folder.string());
  }
}

bool is_same_file(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty() || a == "-" || b == "-") return false;
  std::error_code fault;
  const bool a_exists = fs::exists(a, fault), b_exists = fs::exists(b, fault);
  if (a_exists != b_exists) return false;
  if (a_exists) return fs::is_regular_file(a, fault) && fs::equivalent(a, b, fault);
  const fs::path first = fs::weakly_canonical(fs::absolute(a, fault), fault);
  return !fault && first == fs::weakly_canonical(fs::absolute(b, fault), fault);
}

void check_container_output(const std::string& path, Kind kind) {
  check_folder_of(path);
  if (path.empty() || path == "-") return;
  const Existing existing = content_of(path);
  if (existing.content == Content::other) refuse_to_overwrite(path, "not a vpm file");
  if (existing.content == Content::container && existing.kind != static_cast<std::uint32_t>(kind))
    refuse_to_overwrite(path, names_of(static_cast<Kind>(existing.kind)).what);
}

void check_text_output(const std::string& path) {
  check_folder_of(path);
  if (path.empty() || path == "-") return;
  const Existing existing = content_of(path);
  if (existing.content == Content::container)
    refuse_to_overwrite(path, names_of(static_cast<Kind>(existing.kind)).what);
}

}  // namespace vpm::file
