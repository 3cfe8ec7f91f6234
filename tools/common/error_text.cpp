#include "tools/common/error_text.h"

#include <algorithm>
#include <array>
#include <utility>

namespace vpm::tools {
namespace {

// What to write for names of the API for which the running program has no option of the same name.
constexpr std::array<std::pair<const char*, const char*>, 22> kWords = {{
    {"repair_voxels", "--repair voxel=N"},
    {"pack", "vpm-pack"},
    {"build_tool", "vpm-graph"},
    {"import_cloud", "vpm-normals"},
    {"frames", "the folder"},
    {"calibrate", "vpm-graph --calibrate"},
    {"levels", "vpm-graph --levels"},
    {"intrinsics", "vpm-normals --intrinsics"},
    {"axes", "vpm-normals --axes"},
    {"depth_scale", "vpm-normals --depth-scale"},
    {"unit", "vpm-normals --unit"},
    {"decode", "vpm-normals --decode"},
    {"invalid", "vpm-normals --invalid"},
    {"range", "vpm-normals --range"},
    {"along_ray", "vpm-normals --along-ray"},
    {"channel", "vpm-normals --channel"},
    {"flip", "vpm-normals --flip"},
    {"camera_pose", "vpm-normals --camera-pose"},
    {"scale", "vpm-pack --scale"},
    {"weld", "vpm-pack --weld"},
    {"repair", "vpm-pack --repair"},
    {"max_hole", "vpm-pack --max-hole"},
}};

bool is_name(const std::string& word) {
  return !word.empty() && word.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") == word.npos;
}

}  // namespace

int exit_code(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::refused:
      return 1;
    case ErrorKind::invalid_argument:
      return 2;
    case ErrorKind::unavailable:
      return 3;
    case ErrorKind::cannot_write:
      return 4;
  }
  return 1;
}

std::string in_words_of_tools(const std::string& text,
                              const std::function<bool(const std::string&)>& has_option) {
  std::string said = text;
  for (std::size_t at = said.find('`'); at != said.npos; at = said.find('`', at)) {
    const std::size_t end = said.find('`', at + 1);
    if (end == said.npos) break;
    const std::string name = said.substr(at + 1, end - at - 1);
    std::string option = "--" + name;
    std::replace(option.begin(), option.end(), '_', '-');
    const auto word = std::find_if(kWords.begin(), kWords.end(),
                                   [&](const auto& entry) { return entry.first == name; });
    const bool is_option = is_name(name) && has_option(option);
    if (is_option || word != kWords.end()) {
      std::string replacement = is_option ? option : word->second;
      // Of options that follow each other, the first names the program.
      const std::string first_word = replacement.substr(0, replacement.find(' ') + 1);
      if (said.substr(0, at).ends_with(first_word)) replacement.erase(0, first_word.size());
      said.replace(at, end + 1 - at, replacement);
      at += replacement.size();
    } else {
      at = end + 1;
    }
  }
  return said;
}

}  // namespace vpm::tools
