// Parsers of the formats, between which parse_mesh chooses and whose contract they share.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "libvpm/mesh/mesh_reader.h"

namespace vpm {

RawMesh parse_obj(std::string_view text, const std::string& name);
RawMesh parse_off(std::string_view text, const std::string& name);
RawMesh parse_om(std::string_view bytes, const std::string& name);
RawMesh parse_ply(std::string_view bytes, const std::string& name);
// Reads COLLADA, glTF and FBX.
RawMesh parse_scene(std::string_view bytes, const std::string& name, MeshFormat format,
                    const std::string& node);
RawMesh parse_threemf(std::string_view bytes, const std::string& name, const std::string& node);
RawMesh parse_stl(std::string_view bytes, const std::string& name);

// Returns the format of a file of a scene, which holds meshes in nodes, if its content tells.
std::optional<MeshFormat> scene_by_content(std::string_view text);
bool looks_like_off(std::string_view text);
bool looks_like_om(std::string_view bytes);
bool looks_like_stl(std::string_view bytes);

// Hints in errors: what to do in the program that wrote a file which cannot be read as it is.
inline constexpr const char* kExport = "export it as STL or OBJ";
inline constexpr const char* kSaveAgain = "save it again, or as OBJ, PLY or STL";

// Indices have 32 bits; the largest stands for "none".
inline constexpr std::size_t kMaxVertices = 0xfffffffe;

// Notes, if there are such vertices, that they were divided by a w other than 1.
void note_division(std::size_t vertices, RawMesh& mesh);

}  // namespace vpm
