// Reads of files of scenes what assimp does not tell: units, and what a file needs to be read.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace vpm {

// Returns the factor to metres of the unit that a COLLADA file names; nothing where it names none.
std::optional<double> collada_unit(std::string_view text);

struct NamedUnit {
  std::string name;
  double metres;
};

// Returns the unit of the model in a 3MF file: what it names, or nothing where it names none.
// Throws Error(refused) if the archive holds no model that can be unpacked, or an unknown unit.
std::optional<NamedUnit> threemf_unit(std::string_view bytes, const std::string& name);

// Throws Error(refused) if a glTF file, binary or text, requires an extension that changes the
// mesh.
void check_gltf_extensions(std::string_view bytes, const std::string& name);

// Returns the glTF file, of the same size, with the keys of its skins renamed, so that they are
// passed over: they move no vertex here, and assimp crashes on those without matrices.
std::string without_skins(std::string_view gltf);

}  // namespace vpm
