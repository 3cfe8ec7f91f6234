// OpenMesh's own format, read by OpenMesh. Polygons are taken from its reader before they reach a
// half-edge structure, so that none is lost, and every index is checked.
#include <OpenMesh/Core/IO/importer/ImporterT.hh>
#include <OpenMesh/Core/IO/reader/OMReader.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <algorithm>
#include <cstring>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/file/text_lines.h"
#include "libvpm/mesh/mesh_parsers.h"

namespace vpm {
namespace {

using OpenMesh::IO::OMFormat::Chunk;
using Mesh = OpenMesh::PolyMesh_ArrayKernelT<>;

// Receives the reader's elements. The mesh behind it stays empty, so attributes are skipped.
class Collector : public OpenMesh::IO::ImporterT<Mesh> {
 public:
  explicit Collector(Mesh& empty) : ImporterT(empty) {}

  OpenMesh::VertexHandle add_vertex(const OpenMesh::Vec3f& p) override {
    vertices.push_back({double{p[0]}, double{p[1]}, double{p[2]}});
    return OpenMesh::VertexHandle(static_cast<int>(vertices.size()) - 1);
  }
  OpenMesh::VertexHandle add_vertex(const OpenMesh::Vec3d& p) override {
    vertices.push_back({p[0], p[1], p[2]});
    return OpenMesh::VertexHandle(static_cast<int>(vertices.size()) - 1);
  }
  // A face is given by one of its half-edges, after all half-edges.
  OpenMesh::FaceHandle add_face(OpenMesh::HalfedgeHandle first) override {
    faces.push_back(first.idx());
    return OpenMesh::FaceHandle();
  }
  OpenMesh::HalfedgeHandle add_edge(OpenMesh::VertexHandle from,
                                    OpenMesh::VertexHandle to) override {
    const auto first = static_cast<int>(to_vertex.size());
    for (const int end : {to.idx(), from.idx()}) {
      to_vertex.push_back(end);
      next.push_back(-1);
    }
    return OpenMesh::HalfedgeHandle(first);
  }
  void set_next(OpenMesh::HalfedgeHandle halfedge, OpenMesh::HalfedgeHandle follower) override {
    next[static_cast<std::size_t>(halfedge.idx())] = follower.idx();
  }
  void set_face(OpenMesh::HalfedgeHandle, OpenMesh::FaceHandle) override {}
  void set_halfedge(OpenMesh::VertexHandle, OpenMesh::HalfedgeHandle) override {}

  std::vector<Vec3> vertices;
  std::vector<std::vector<int>> polygons;
  std::vector<int> faces, to_vertex, next;
};

// Follows the half-edges of each face; each may belong to one face only.
void walk_faces(Collector& found, const std::string& name) {
  std::vector<char> used(found.next.size(), 0);
  for (const int first : found.faces) {
    found.polygons.emplace_back();
    int at = first;
    do {
      const auto k = static_cast<std::size_t>(at);
      if (at < 0 || k >= used.size() || used[k] != 0)
        refuse("the half-edges of face " + std::to_string(found.polygons.size() - 1) +
                   " do not close; the file is damaged",
               name);
      used[k] = 1;
      found.polygons.back().push_back(found.to_vertex[k]);
      at = found.next[k];
    } while (at != first);
  }
}

struct Header {
  char magic[3] = {};  // "OM" and one of T(riangles), Q(uads), P(olygons)
  std::uint8_t version = 0;
  std::uint32_t vertices = 0, faces = 0, edges = 0;
};

Header header_of(std::string_view bytes) {
  Header header;
  if (bytes.size() >= sizeof header) std::memcpy(&header, bytes.data(), sizeof header);
  return header;
}

// True if the chunk is one that a mesh is made of: positions of vertices, or indices that connect.
bool makes_the_mesh(const Chunk::Header& chunk) {
  return chunk.type_ == Chunk::Type_Topology || chunk.type_ == Chunk::Type_Pos;
}

// Returns the bytes of one element of a chunk; 0 for a chunk whose header makes no sense. OpenMesh
// aborts, or throws what is no Error, on sizes of scalars that it does not expect.
std::size_t element_bytes(const Chunk::Header& chunk) {
  const std::size_t dimensions = OpenMesh::IO::OMFormat::dimensions(chunk);
  const std::size_t integer = std::size_t{1} << chunk.bits_;
  const std::size_t real = std::size_t{4} << chunk.bits_;
  const bool is_float_or_double = chunk.float_ != 0 && chunk.bits_ <= Chunk::Float_64;
  switch (chunk.type_) {
    case Chunk::Type_Topology:  // its header leaves other fields as they were
      if (chunk.bits_ > Chunk::Integer_32) return 0;
      if (chunk.entity_ == Chunk::Entity_Halfedge) return 3 * integer;  // next, to, face
      return chunk.entity_ == Chunk::Entity_Vertex || chunk.entity_ == Chunk::Entity_Face ? integer
                                                                                          : 0;
    case Chunk::Type_Pos:
      return chunk.entity_ == Chunk::Entity_Vertex && dimensions == 3 && is_float_or_double
                 ? 3 * real
                 : 0;
    case Chunk::Type_Normal:
      return dimensions == 3 && is_float_or_double ? 3 * real : 0;
    case Chunk::Type_Status:  // its header says 8 bits
      return sizeof(std::uint32_t);
    case Chunk::Type_Color:
      return dimensions * (chunk.float_ != 0 ? real : integer);
    case Chunk::Type_Texcoord:
      return is_float_or_double ? dimensions * real : 0;
    default:
      return 0;
  }
}

// Returns how many elements the header gives a chunk; empty for an entity that there is not.
std::optional<std::size_t> elements(const Chunk::Header& chunk, const Header& header) {
  switch (chunk.entity_) {
    case Chunk::Entity_Vertex:
      return header.vertices;
    case Chunk::Entity_Mesh:
      return 1;
    case Chunk::Entity_Face:
      return header.faces;
    case Chunk::Entity_Edge:
      return header.edges;
    case Chunk::Entity_Halfedge:
      return 2 * std::size_t{header.edges};
    default:
      return std::nullopt;
  }
}

// Returns the header, the chunks that make the mesh and the last one, which end within the file and
// are there once each. OpenMesh's reader gets nothing else: it trusts a file, and aborts on a
// damaged one.
std::string checked_chunks(std::string_view bytes, const Header& header, const std::string& name) {
  std::string checked(bytes.substr(0, sizeof header));
  std::set<std::pair<unsigned, unsigned>> seen;  // types and entities of chunks that make the mesh
  std::size_t at = sizeof header;
  while (true) {
    std::uint16_t word = 0;
    const std::size_t begin = at;
    if (bytes.size() < at + sizeof word)
      refuse("the file ends without its last chunk; it is truncated", name);
    std::memcpy(&word, bytes.data() + at, sizeof word);
    Chunk::Header chunk{};
    chunk << word;
    at += sizeof word;
    if (chunk.entity_ == Chunk::Entity_Sentinel)
      return checked.append(bytes.substr(begin, sizeof word));
    const std::size_t element = element_bytes(chunk);
    const std::optional<std::size_t> count = elements(chunk, header);
    if (chunk.name_ != 0 || element == 0 || !count) {
      refuse("the chunk at byte " + std::to_string(begin) +
                 " is none of positions, connectivity, normals, colours, texture coordinates and "
                 "status",
             name, "save the mesh without other properties");
    }
    if ((bytes.size() - at) / element < *count)
      refuse("the chunk at byte " + std::to_string(begin) +
                 " is longer than the file; it is truncated or damaged",
             name);
    at += element * *count;
    if (!makes_the_mesh(chunk)) continue;
    if (!seen.emplace(unsigned{chunk.type_}, unsigned{chunk.entity_}).second)
      refuse("the chunk at byte " + std::to_string(begin) +
                 " gives the mesh a second time; the file is damaged",
             name);
    checked.append(bytes.substr(begin, at - begin));
  }
}

}  // namespace

bool looks_like_om(std::string_view bytes) {
  const Header header = header_of(bytes);
  return header.magic[0] == 'O' && header.magic[1] == 'M' &&
         std::string_view("TQP").find(header.magic[2]) != std::string_view::npos;
}

RawMesh parse_om(std::string_view bytes, const std::string& name) {
  RawMesh mesh;
  mesh.format = MeshFormat::om;
  mesh.name = name;
  if (!looks_like_om(bytes)) refuse("an OM file must begin with OMT, OMQ or OMP", name);
  const Header header = header_of(bytes);
  // A vertex takes three floats, a face at least one byte, an edge six indices.
  file::check_header_counts(
      name,
      std::to_string(header.vertices) + " vertices, " + std::to_string(header.faces) +
          " faces and " + std::to_string(header.edges) + " edges",
      12.0 * header.vertices + header.faces + 6.0 * header.edges, bytes.size());
  if (header.version < OpenMesh::IO::OMFormat::mk_version(2, 0))
    refuse("an OM file of a version before 2.0", name, "save it again with a newer OpenMesh");
  constexpr std::uint32_t kMostElements = 0x3fffffff;  // half-edges are numbered by int
  if (std::max({header.vertices, header.faces, header.edges}) > kMostElements)
    refuse("an OM file of more than 1073741823 vertices, faces or edges", name);
  Mesh empty;
  Collector found(empty);
  OpenMesh::IO::Options options;
  std::istringstream stream(checked_chunks(bytes, header, name));
  omerr().disable();  // it would print to standard error what the refusal says
  const bool is_read = OpenMesh::IO::OMReader().read(stream, found, options);
  omerr().enable();
  if (!is_read || found.vertices.size() != header.vertices)
    refuse("OpenMesh cannot read this OM file; it is damaged, or of a newer version", name);
  walk_faces(found, name);
  if (found.polygons.size() != header.faces)
    refuse("the file has fewer faces than its header says; it is truncated or damaged", name);
  for (const Vec3& p : found.vertices) {
    if (!is_finite(p)) refuse("a coordinate is not finite", name);
  }
  for (const std::vector<int>& polygon : found.polygons) {
    if (polygon.size() < 3) refuse("a face has fewer than 3 corners", name);
    for (const int corner : polygon) {
      if (corner < 0 || static_cast<std::size_t>(corner) >= found.vertices.size())
        refuse("vertex index " + std::to_string(corner) + " is out of range", name);
      mesh.corners.push_back(static_cast<std::uint32_t>(corner));
    }
    mesh.polygon_end.push_back(mesh.corners.size());
  }
  mesh.vertices = std::move(found.vertices);
  return mesh;
}

}  // namespace vpm
