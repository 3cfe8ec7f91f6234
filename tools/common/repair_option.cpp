#include "tools/common/repair_option.h"

#include <charconv>

namespace vpm::tools {

bool parse_repair(std::string_view word, SolidOptions& options) {
  const std::string_view mode = word.substr(0, word.find('='));
  if (word == "holes") {
    options.repair = Repair::holes;
    return true;
  }
  if (mode != "voxel" && mode != "flood") return false;
  options.repair = mode == "voxel" ? Repair::voxel : Repair::flood;
  if (word == mode) return true;
  const char* const end = word.data() + word.size();
  const auto [last, fault] =
      std::from_chars(word.data() + mode.size() + 1, end, options.repair_voxels);
  return fault == std::errc() && last == end;
}

}  // namespace vpm::tools
