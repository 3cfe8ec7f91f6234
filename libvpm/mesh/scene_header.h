// Reads of files of scenes what assimp does not tell: units, what a file needs to be read, and what
// of it is not applied.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vpm {

struct ColladaHeader {
  std::optional<double> metres;  // length of the unit, where the file names one
  std::string unit_name;         // names a unit without a length
  char up = 'y';
  bool has_morph = false;
};

// Reads the asset of a COLLADA file's root. Throws Error(refused) if its unit's length is no
// positive number, or cannot be read: a file in millimetres would be taken for one in metres.
ColladaHeader collada_header(std::string_view text, const std::string& name);

struct GltfHeader {
  std::vector<std::string> notes;
  bool has_skin = false;
  bool keeps_skin = false;           // assimp can read the skins; it crashes on others
  std::optional<std::string> plain;  // the file for assimp, where that must be another one
};

// Reads the JSON of a glTF file, binary or text, of which the given node is wanted, or all without
// a name. Throws Error(refused) if it requires an extension that changes the mesh, or a file that
// is not there, or if what is wanted is hidden.
GltfHeader gltf_header(std::string_view bytes, const std::string& name, const std::string& node);

// Returns the glTF file, of the same size, with the keys of its skins renamed, so that they are
// passed over.
std::string without_skins(std::string_view gltf);

// Returns the text with each %NN replaced by the byte that it stands for.
std::string percent_decoded(std::string_view text);

}  // namespace vpm
