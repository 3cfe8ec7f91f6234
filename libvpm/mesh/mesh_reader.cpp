#include "libvpm/mesh/mesh_reader.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

#include "libvpm/core/box.h"
#include "libvpm/core/error.h"
#include "libvpm/core/rounding.h"
#include "libvpm/file/ply_header.h"
#include "libvpm/file/sniff.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"
#include "libvpm/file/text_lines.h"
#include "libvpm/mesh/mesh_parsers.h"

namespace vpm {
namespace {

std::string extension_of(const std::string& name) {
  const std::size_t dot = name.rfind('.');
  if (dot == std::string::npos || name.find('/', dot) != std::string::npos) return "";
  std::string extension = name.substr(dot + 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

// True if the first statement is one with which OBJ files begin; OBJ has no magic.
bool looks_like_obj(std::string_view text) {
  file::TextLines lines(text.substr(0, 65536), "", '#');
  if (!lines.next_line()) return false;
  const std::string_view first = lines.word();
  const auto known = {"v", "vn", "vt", "f", "o", "g", "s", "mtllib", "usemtl"};
  return std::find(known.begin(), known.end(), first) != known.end();
}

}  // namespace

const char* name_of(MeshFormat format) {
  switch (format) {
    case MeshFormat::obj:
      return "OBJ";
    case MeshFormat::off:
      return "OFF";
    case MeshFormat::ply:
      return "PLY";
    case MeshFormat::stl:
      return "STL";
    case MeshFormat::om:
      return "OM";
    case MeshFormat::dae:
      return "COLLADA";
    case MeshFormat::gltf:
      return "glTF";
    case MeshFormat::threemf:
      return "3MF";
    case MeshFormat::fbx:
      return "FBX";
  }
  return "";
}

bool lists_corners(MeshFormat format) {
  return format == MeshFormat::stl || format >= MeshFormat::dae;
}

bool has_unit(MeshFormat format) {
  return format >= MeshFormat::dae;
}

void note_division(std::size_t vertices, RawMesh& mesh) {
  if (vertices == 0) return;
  mesh.notes.push_back(std::to_string(vertices) +
                       (vertices == 1 ? " vertex has" : " vertices have") +
                       " a fourth coordinate w other than 1, by which the others were divided");
}

void RawMesh::add_triangle(const Triangle& triangle) {
  corners.insert(corners.end(), triangle.begin(), triangle.end());
  polygon_end.push_back(corners.size());
}

void RawMesh::end_polygon() {
  const std::size_t begin = polygon_end.empty() ? 0 : polygon_end.back();
  if (corners.size() - begin >= 3) {
    polygon_end.push_back(corners.size());
  } else {
    corners.resize(begin);
    ++dropped_polygons;
  }
}

namespace {

// True for the JSON of glTF, whose members may stand in any order; other descriptions of scenes
// have an asset, too.
bool looks_like_gltf_text(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == text.npos || text[first] != '{') return false;
  const auto has = [&](const char* key) { return text.find(key) != text.npos; };
  return has("\"asset\"") && has("\"version\"") &&
         (has("\"meshes\"") || has("\"accessors\"") || has("\"buffers\"") || has("\"nodes\""));
}

// True for a zip archive whose names are those of a 3MF file, however the model is called.
bool looks_like_threemf(std::string_view bytes) {
  if (!bytes.starts_with("PK\x03\x04")) return false;
  for (const char* name : {"3D/3dmodel.model", "3D/3DModel.model"})  // as programs spell it
    if (bytes.find(name) != bytes.npos) return true;
  return bytes.find("_rels/.rels") != bytes.npos && bytes.find(".model") != bytes.npos;
}

}  // namespace

std::optional<MeshFormat> scene_by_content(std::string_view text) {
  text = file::without_byte_order_mark(text);
  const std::string_view start = text.substr(0, 4096);
  if (start.starts_with("glTF")) return MeshFormat::gltf;
  if (start.starts_with("Kaydara FBX Binary") || start.starts_with("; FBX") ||
      start.find("FBXHeaderExtension") != start.npos)
    return MeshFormat::fbx;
  if (start.find("<COLLADA") != start.npos) return MeshFormat::dae;
  if (looks_like_threemf(text)) return MeshFormat::threemf;
  if (looks_like_gltf_text(text)) return MeshFormat::gltf;
  return std::nullopt;
}

namespace {

std::optional<MeshFormat> scene_by_extension(const std::string& extension) {
  if (extension == "dae") return MeshFormat::dae;
  if (extension == "gltf" || extension == "glb") return MeshFormat::gltf;
  if (extension == "3mf") return MeshFormat::threemf;
  if (extension == "fbx") return MeshFormat::fbx;
  return std::nullopt;
}

// Refuses what is known to be something else than a mesh, by name.
void refuse_foreign(std::span<const std::byte> bytes, const std::string& name) {
  const auto other = file::sniff(bytes);
  if (!other || other->is_mesh) return;
  refuse("this is " + other->what, name,
         other->holds == file::Holds::scan ? "give the mesh, or a cloud and images to vpm-normals"
                                           : other->next);
}

RawMesh parse_nodes(std::string_view text, const std::string& name, MeshFormat format,
                    const std::string& node) {
  return format == MeshFormat::threemf ? parse_threemf(text, name, node)
                                       : parse_scene(text, name, format, node);
}

RawMesh parse(std::span<const std::byte> bytes, const std::string& name, const std::string& node) {
  if (bytes.empty()) refuse("the file is empty", name);
  const std::string_view text = file::without_byte_order_mark(file::as_text(bytes));
  const std::string extension = extension_of(name);
  if (file::looks_like_ply(text)) return parse_ply(text, name);
  if (looks_like_off(text)) return parse_off(text, name);
  if (looks_like_stl(text)) return parse_stl(text, name);
  if (looks_like_om(text)) return parse_om(text, name);
  if (const auto scene = scene_by_content(text)) return parse_nodes(text, name, *scene, node);
  const bool is_named_threemf = extension == "3mf" && text.starts_with("PK\x03\x04");
  if (!is_named_threemf) refuse_foreign(bytes, name);
  if (const auto scene = scene_by_extension(extension))
    return parse_nodes(text, name, *scene, node);
  if (extension == "obj") return parse_obj(text, name);
  if (extension == "off") return parse_off(text, name);
  if (extension == "ply") return parse_ply(text, name);
  if (extension == "stl") return parse_stl(text, name);
  if (extension == "om") return parse_om(text, name);
  if (looks_like_obj(text)) return parse_obj(text, name);
  if (file::is_table_of_numbers(text)) {
    refuse("this is a table of points, without faces", name,
           "give a mesh, as OBJ, PLY or STL; a cloud is for vpm-normals, as PLY with normals");
  }
  refuse(
      "this is no mesh in a format that is read here: OBJ, OFF, PLY, STL, OM, COLLADA, glTF, 3MF "
      "or FBX",
      name, "save it as OBJ, PLY or STL in the program that wrote it");
}

}  // namespace

RawMesh parse_mesh(std::span<const std::byte> bytes, const std::string& name,
                   const std::string& node) {
  RawMesh mesh = parse(bytes, name, node);
  if (!node.empty() && mesh.format < MeshFormat::dae) {
    throw Error(ErrorKind::invalid_argument,
                std::string(name_of(mesh.format)) + " has no nodes; leave `node` out", name);
  }
  const std::size_t dropped = mesh.dropped_polygons;
  if (dropped > 0) {
    mesh.notes.push_back(std::to_string(dropped) + (dropped == 1 ? " face" : " faces") +
                         " of fewer than three corners dropped");
  }
  return mesh;
}

RawMesh read_mesh(const std::string& path) {
  return parse_mesh(file::read_all(path), path == "-" ? "standard input" : path);
}

std::string coarse_coordinates(const RawMesh& mesh) {
  constexpr double kCoarse = 1e-4;
  Box box;
  for (const Vec3& p : mesh.vertices) box.add(p);
  if (mesh.vertices.empty()) return "";
  const double diagonal = norm(box.size());
  const auto coarse = coarseness_of(mesh.vertices, kCoarse * diagonal);
  if (!coarse) return "";
  char text[200];
  std::snprintf(text, sizeof text,
                "its coordinates lie up to %.3g from the origin, where %s are %.2g apart, coarse "
                "for a mesh of %.3g",
                coarse->farthest, coarse->numbers(), coarse->step, diagonal);
  return text;
}

}  // namespace vpm
