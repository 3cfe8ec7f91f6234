// Makes a mesh of the vertices and faces of a PLY file.
#include <algorithm>
#include <cmath>

#include "libvpm/core/error.h"
#include "libvpm/file/ply_body.h"
#include "libvpm/file/ply_header.h"
#include "libvpm/file/text.h"
#include "libvpm/mesh/mesh_parsers.h"

namespace vpm {
namespace {

using file::PlyBody;
using file::PlyElement;
using file::PlyHeader;
using file::PlyProperty;

bool is_value(const PlyProperty& property, std::string_view name) {
  return !property.is_list() && file::is_word(property.name, name);
}

void read_vertex(PlyBody& body, const PlyElement& element, RawMesh& mesh) {
  Vec3 p;
  for (const PlyProperty& property : element.properties) {
    double* const coordinate = is_value(property, "x")   ? &p.x
                               : is_value(property, "y") ? &p.y
                               : is_value(property, "z") ? &p.z
                                                         : nullptr;
    if (coordinate == nullptr) {
      body.skip(property);
    } else {
      *coordinate = body.value(property.type);
    }
  }
  if (!is_finite(p)) {
    body.refuse_here("vertex " + std::to_string(mesh.vertices.size()) +
                     ": a coordinate is not finite");
  }
  mesh.vertices.push_back(p);
}

bool is_corner_list(const PlyProperty& property) {
  return property.is_list() && (file::is_word(property.name, "vertex_indices") ||
                                file::is_word(property.name, "vertex_index"));
}

void read_face(PlyBody& body, const PlyElement& element, std::uint64_t vertices, RawMesh& mesh) {
  const std::string face = "face " + std::to_string(mesh.polygon_end.size());
  for (const PlyProperty& property : element.properties) {
    if (!is_corner_list(property)) {
      body.skip(property);
      continue;
    }
    const std::uint64_t count = body.length(property);
    for (std::uint64_t k = 0; k < count; ++k) {
      const double index = body.value(property.type);
      if (!(index >= 0 && index < static_cast<double>(vertices) && index == std::floor(index))) {
        body.refuse_here(face + ": a vertex index is out of range; the header says " +
                         std::to_string(vertices) + " vertices, counted from 0");
      }
      mesh.corners.push_back(static_cast<std::uint32_t>(index));
    }
    mesh.end_polygon();
  }
}

// Checks that there are the properties of a mesh.
void check_elements(const PlyElement* vertices, const PlyElement* faces, const std::string& name) {
  if (vertices == nullptr || faces == nullptr) {
    refuse(
        std::string("the header must have one element 'vertex' and one element 'face'") +
            (faces == nullptr ? "; this is a cloud of points or strips, not a mesh of faces" : ""),
        name);
  }
  for (const char* const axis : {"x", "y", "z"}) {
    const auto is_axis = [&](const PlyProperty& p) { return is_value(p, axis); };
    if (std::ranges::count_if(vertices->properties, is_axis) != 1)
      refuse(std::string("the header must give the vertices one property '") + axis + "'", name);
  }
  if (std::ranges::count_if(faces->properties, is_corner_list) != 1)
    refuse("the header must give the faces one list 'vertex_indices'", name);
  if (vertices->count > kMaxVertices) refuse("more than 2^32 - 2 vertices", name);
}

}  // namespace

RawMesh parse_ply(std::string_view bytes, const std::string& name) {
  RawMesh mesh;
  mesh.format = MeshFormat::ply;
  mesh.name = name;
  const PlyHeader header = file::parse_ply_header(bytes, name);
  const PlyElement* const vertices = file::find_element(header, "vertex", name);
  const PlyElement* const faces = file::find_element(header, "face", name);
  check_elements(vertices, faces, name);
  mesh.vertices.reserve(vertices->count);
  mesh.polygon_end.reserve(faces->count);
  PlyBody body(bytes, header, name);
  for (const PlyElement& element : header.elements) {
    for (std::uint64_t k = 0; k < element.count; ++k) {
      body.begin_record();
      if (&element == vertices) {
        read_vertex(body, element, mesh);
      } else if (&element == faces) {
        read_face(body, element, vertices->count, mesh);
      } else {
        for (const PlyProperty& property : element.properties) body.skip(property);
      }
      body.end_record();
    }
  }
  mesh.notes = body.unread();
  if (!mesh.notes.empty()) mesh.doubt = mesh.notes.front();
  return mesh;
}

}  // namespace vpm
