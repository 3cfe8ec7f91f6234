#include "libvpm/file/overwrite.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <initializer_list>

#include "libvpm/core/error.h"
#include "libvpm/file/container_layout.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"

namespace vpm::file {
namespace {

namespace fs = std::filesystem;

enum class PathContent { nothing, container, other };

struct Existing {
  PathContent content = PathContent::nothing;
  std::uint32_t kind = 0;  // file::Kind, if content is a container
};

Existing content_of(const std::string& path) {
  std::error_code fault;
  if (!fs::is_regular_file(path, fault) || fs::file_size(path, fault) == 0) return {};
  char start[sizeof(Preamble)] = {};
  std::ifstream(path, std::ios::binary).read(start, sizeof(start));
  Preamble preamble;
  std::memcpy(&preamble, start, sizeof(preamble));
  if (std::memcmp(preamble.magic, kMagic, sizeof(kMagic)) != 0) return {PathContent::other, 0};
  return {PathContent::container, preamble.kind};
}

// Returns the ending of the path's name in lower case, such as ".vpmp".
std::string ending_of(const std::string& path) {
  return in_lower_case(fs::path(path).extension().string());
}

bool is_one_of(const std::string& ending, std::initializer_list<const char*> endings) {
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

const char* ending_of(Kind kind) {
  return kind == Kind::packing ? ".vpmp" : kind == Kind::tool_model ? ".vpmg" : ".vpmc";
}

void refuse_existing(const std::string& path) {
  const Existing existing = content_of(path);
  if (existing.content == PathContent::nothing) return;
  const std::string what =
      existing.content == PathContent::container
          ? std::string(" and is ") + names_of(static_cast<Kind>(existing.kind)).what
          : "";
  throw Error(ErrorKind::invalid_argument, path + " exists" + what, {},
              "name another output, or give `force` to overwrite it");
}

[[noreturn]] void refuse_ending(const std::string& path, const std::string& what,
                                const std::string& cure) {
  throw Error(ErrorKind::invalid_argument,
              path + ": this output is " + what + ", and " + ending_of(path) +
                  " is the ending of another kind of file",
              {}, cure + ", or give `force`");
}

bool is_ending_of_container(const std::string& ending) {
  return is_one_of(ending, {".vpmp", ".vpmg", ".vpmc"});
}

// True for the endings of kinds of files that are read or written here.
bool is_known(const std::string& ending) {
  return is_ending_of_container(ending) ||
         is_one_of(ending,
                   {".stl", ".obj", ".off", ".ply", ".om", ".pcd", ".png", ".exr", ".tif", ".npy",
                    ".json", ".jsonl", ".csv", ".html", ".urdf", ".yml", ".glb", ".txt", ".pdf"});
}

// Throws if the name ends like that of another kind of file. Unknown endings, and none, pass.
void refuse_other_ending(const std::string& path, Kind kind) {
  const std::string ending = ending_of(path);
  if (is_known(ending) && ending != ending_of(kind))
    refuse_ending(path, names_of(kind).what, std::string("let its name end in ") + ending_of(kind));
}

// Throws unless a file may be written to `path` that is nothing yet. Returns false for streams and
// devices, whose names tell nothing.
bool check_place(const std::string& path) {
  check_folder_of(path);
  if (path.empty() || descriptor_of(path)) return false;
  std::error_code fault;
  if (fs::exists(path, fault) && !fs::is_regular_file(path, fault)) return false;
  refuse_existing(path);
  return true;
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

bool is_container(const std::string& path) {
  return content_of(path).content == PathContent::container;
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

void check_output(const std::string& path, std::optional<Kind> kind) {
  if (check_place(path) && kind) refuse_other_ending(path, *kind);
}

void check_json(const std::string& path) {
  if (!check_place(path)) return;
  const std::string ending = ending_of(path);
  if (is_known(ending) && !is_one_of(ending, {".json", ".jsonl", ".txt"}))
    refuse_ending(path, "JSON", "name it .json or .jsonl");
}

void check_results(const std::string& path) {
  if (ending_of(path) == ".csv") {
    check_place(path);
  } else {
    check_json(path);
  }
}

void check_page(const std::string& path) {
  if (!check_place(path)) return;
  const std::string ending = ending_of(path);
  if (is_known(ending) && ending != ".html")
    refuse_ending(path, "a page", "let its name end in .html");
}

}  // namespace vpm::file
