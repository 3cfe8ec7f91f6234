#include "libvpm/mesh/mesh_reader.h"

#include <algorithm>
#include <cctype>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "libvpm/mesh/mesh_parsers.h"
#include "libvpm/mesh/text_lines.h"

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
  TextLines lines(text.substr(0, 65536), "", '#');
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
  }
  return "";
}

void check_header_counts(const std::string& name, const std::string& what, double least_bytes,
                         std::size_t file_bytes) {
  if (least_bytes > static_cast<double>(file_bytes)) {
    refuse("the header says " + what + ", but the file has only " + std::to_string(file_bytes) +
               " bytes; it is truncated or damaged",
           name);
  }
}

void note_division(std::size_t vertices, RawMesh& mesh) {
  if (vertices == 0) return;
  mesh.notes.push_back(std::to_string(vertices) +
                       (vertices == 1 ? " vertex has" : " vertices have") +
                       " a fourth coordinate w other than 1, by which the others were divided");
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

RawMesh parse(std::span<const std::byte> bytes, const std::string& name) {
  if (bytes.empty()) refuse("the file is empty", name);
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // UTF-8's, written by some editors
  if (text.substr(0, kByteOrderMark.size()) == kByteOrderMark)
    text.remove_prefix(kByteOrderMark.size());
  const std::string extension = extension_of(name);
  if (looks_like_ply(text)) return parse_ply(text, name);
  if (looks_like_off(text)) return parse_off(text, name);
  if (looks_like_stl(text)) return parse_stl(text, name);
  if (looks_like_om(text)) return parse_om(text, name);
  if (extension == "obj") return parse_obj(text, name);
  if (extension == "off") return parse_off(text, name);
  if (extension == "ply") return parse_ply(text, name);
  if (extension == "stl") return parse_stl(text, name);
  if (extension == "om") return parse_om(text, name);
  if (looks_like_obj(text)) return parse_obj(text, name);
  refuse("this is no mesh in a format that is read here: OBJ, OFF, PLY, STL or OM", name);
}

}  // namespace

RawMesh parse_mesh(std::span<const std::byte> bytes, const std::string& name) {
  RawMesh mesh = parse(bytes, name);
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

}  // namespace vpm
