// Stereolithography: each triangle has its own three corners. Facet normals are ignored; the order
// of corners tells the outside.
#include <bit>
#include <cstring>

#include "libvpm/core/error.h"
#include "libvpm/mesh/mesh_parsers.h"
#include "libvpm/mesh/text_lines.h"

namespace vpm {
namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is copied as it is stored");

constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kFacetsAt = 84;    // after the header and the count
constexpr std::size_t kFacetBytes = 50;  // normal, three corners, attribute
constexpr std::size_t kCornersAt = 12;   // within a facet, after the normal

std::uint32_t binary_count(std::string_view bytes) {
  std::uint32_t count = 0;
  if (bytes.size() >= kFacetsAt) std::memcpy(&count, bytes.data() + kHeaderBytes, sizeof count);
  return count;
}

bool has_binary_size(std::string_view bytes) {
  return bytes.size() >= kFacetsAt &&
         bytes.size() == kFacetsAt + kFacetBytes * std::size_t{binary_count(bytes)};
}

bool looks_like_ascii(std::string_view bytes) {
  constexpr std::size_t kLooked = 4096;  // a "solid" line, then "facet" or at once "endsolid"
  const std::string_view start = bytes.substr(0, kLooked);
  const std::size_t word = start.find_first_not_of(" \t\r\n");
  return word != std::string_view::npos && start.substr(word).starts_with("solid") &&
         start.find('\0') == std::string_view::npos;
}

void add_corner(RawMesh& mesh, Vec3 p) {
  mesh.corners.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
  mesh.vertices.push_back(p);
}

void parse_ascii(std::string_view text, RawMesh& mesh) {
  TextLines lines(text, mesh.name, 0);
  std::size_t corners = 0;  // number read of the facet
  bool open = false, ended = false;
  while (lines.next_line()) {
    const std::string_view keyword = lines.word();
    if (keyword == "facet") {
      if (open) lines.refuse_here("a facet begins within a facet");
      open = true;
      corners = 0;
    } else if (keyword == "vertex") {
      if (!open) lines.refuse_here("a vertex outside of a facet");
      if (mesh.vertices.size() >= kMaxVertices) lines.refuse_here("more than 2^32 - 2 vertices");
      add_corner(mesh, lines.point());
      ++corners;
    } else if (keyword == "endfacet") {
      if (!open || corners != 3) lines.refuse_here("a facet must have 3 vertices");
      open = false;
      mesh.polygon_end.push_back(mesh.corners.size());
    } else if (keyword == "endsolid") {
      ended = true;
    } else if (keyword != "solid" && keyword != "outer" && keyword != "endloop") {
      lines.refuse_here("not a statement of an STL file");
    }
  }
  if (open || !ended) refuse("the file ends without 'endsolid'; it is truncated", mesh.name);
}

void parse_binary(std::string_view bytes, RawMesh& mesh) {
  const std::size_t count = binary_count(bytes);
  check_header_counts(mesh.name, std::to_string(count) + " triangles",
                      static_cast<double>(kFacetsAt) +
                          static_cast<double>(kFacetBytes) * static_cast<double>(count),
                      bytes.size());
  if (3 * count > kMaxVertices) refuse("more than 2^32 - 2 corners", mesh.name);
  mesh.vertices.reserve(3 * count);
  mesh.corners.reserve(3 * count);
  mesh.polygon_end.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = kFacetsAt + kFacetBytes * k;
    Vec3f corner[3];
    std::memcpy(corner, bytes.data() + at + kCornersAt, sizeof corner);
    for (const Vec3f& p : corner) {
      if (!is_finite(p)) {
        refuse("triangle " + std::to_string(k) + " (at byte " + std::to_string(at) +
                   "): a coordinate is not finite",
               mesh.name);
      }
      add_corner(mesh, widen(p));
    }
    mesh.polygon_end.push_back(mesh.corners.size());
  }
}

}  // namespace

bool looks_like_stl(std::string_view bytes) {
  return has_binary_size(bytes) || (looks_like_ascii(bytes) &&
                                    bytes.substr(0, 65536).find("facet") != std::string_view::npos);
}

RawMesh parse_stl(std::string_view bytes, const std::string& name) {
  RawMesh mesh;
  mesh.format = MeshFormat::stl;
  mesh.name = name;
  // The size decides first, since exporters of binary files write "solid" into the header too.
  if (!has_binary_size(bytes) && looks_like_ascii(bytes)) {
    parse_ascii(bytes, mesh);
  } else if (bytes.size() < kFacetsAt) {
    refuse(
        std::to_string(bytes.size()) + " bytes are too few for a binary STL file; it is truncated",
        name);
  } else {
    parse_binary(bytes, mesh);
  }
  return mesh;
}

}  // namespace vpm
