// vpm-pack of a packing or a tool model: its spheres for other programs.

#include <vpm/tool.h>

#include <algorithm>
#include <cstring>

#include "libvpm/core/error.h"
#include "libvpm/file/container_layout.h"
#include "libvpm/file/stream.h"
#include "libvpm/model/packing.h"
#include "tools/common/error_text.h"
#include "tools/pack/arguments.h"

namespace vpm::tools {
namespace {

// True if the file, which is one of vpm, says that it is a tool model.
bool is_model(const std::string& path) {
  const std::vector<std::byte> bytes = file::read_all(path);
  file::Preamble preamble{};
  std::memcpy(&preamble, bytes.data(), std::min(sizeof preamble, bytes.size()));
  return preamble.kind == static_cast<std::uint32_t>(file::Kind::tool_model);
}

// Returns the largest spheres of a packing, of which any number is a level.
std::vector<Sphere> spheres_of_packing(const Arguments& a) {
  std::vector<Sphere> spheres = read_packing(a.mesh).spheres;
  if (a.level > spheres.size())
    refuse("--level " + std::to_string(a.level) + ": the packing has " +
               std::to_string(spheres.size()) + " spheres",
           a.mesh, "give a number up to that");
  if (a.level > 0) spheres.resize(a.level);
  return spheres;
}

std::vector<Sphere> spheres_of_model(const Arguments& a) {
  const Tool tool = Tool::read(a.mesh);
  std::vector<Sphere> spheres = tool.spheres();
  if (a.level == 0) return spheres;
  std::string known;
  for (const ToolLevel& level : tool.levels()) {
    known += (known.empty() ? "" : ", ") + std::to_string(level.spheres);
    if (level.spheres == a.level) spheres.resize(level.spheres);
  }
  if (spheres.size() != a.level)
    refuse("--level " + std::to_string(a.level) + " is none of the model's levels", a.mesh,
           "give one of " + known);
  return spheres;
}

}  // namespace

void export_ready(const Program& program, const Arguments& a) {
  // What is neither, the reader of packings refuses by name.
  const std::vector<Sphere> spheres =
      is_model(a.mesh) ? spheres_of_model(a) : spheres_of_packing(a);
  write_exports(a, spheres);
  program.note("wrote " + std::to_string(spheres.size()) + " spheres of " + a.mesh);
}

}  // namespace vpm::tools
