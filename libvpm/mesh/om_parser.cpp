// OpenMesh's own format, read by OpenMesh. Polygons are taken from its reader before they reach a
// half-edge structure, so that none is lost, and every index is checked.
#include <OpenMesh/Core/IO/importer/ImporterT.hh>
#include <OpenMesh/Core/IO/reader/OMReader.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <cstring>
#include <sstream>

#include "libvpm/core/error.h"
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

// Returns the bytes of one element of a chunk as OpenMesh's reader takes them; 0 for chunks that it
// cannot read.
std::size_t element_bytes(const Chunk::Header& chunk) {
  const std::size_t dimensions = OpenMesh::IO::OMFormat::dimensions(chunk);
  const std::size_t integer = std::size_t{1} << chunk.bits_;
  const bool is_surface =
      chunk.entity_ == Chunk::Entity_Vertex || chunk.entity_ == Chunk::Entity_Face;
  switch (chunk.type_) {
    case Chunk::Type_Topology:
      if (chunk.entity_ == Chunk::Entity_Halfedge) return 3 * integer;  // next, to, face
      return is_surface ? integer : 0;
    case Chunk::Type_Pos:
      return chunk.entity_ == Chunk::Entity_Vertex && dimensions == 3 && chunk.float_ != 0 &&
                     chunk.bits_ == Chunk::Float_32
                 ? 12
                 : 0;
    case Chunk::Type_Normal:
      return is_surface && dimensions == 3 ? 12 : 0;
    case Chunk::Type_Color:
      return is_surface && dimensions == 3 ? 3 : 0;
    case Chunk::Type_Texcoord:
      return chunk.entity_ == Chunk::Entity_Vertex && dimensions == 2 ? 8 : 0;
    default:
      return 0;
  }
}

std::size_t elements(const Chunk::Header& chunk, const Header& header) {
  if (chunk.entity_ == Chunk::Entity_Vertex) return header.vertices;
  if (chunk.entity_ == Chunk::Entity_Face) return header.faces;
  return chunk.entity_ == Chunk::Entity_Halfedge ? 2 * std::size_t{header.edges} : 0;
}

// Checks chunks before OpenMesh's reader, which trusts a file and aborts on a damaged one.
void check_chunks(std::string_view bytes, const Header& header, const std::string& name) {
  std::size_t at = sizeof header;
  while (true) {
    std::uint16_t word = 0;
    if (bytes.size() < at + sizeof word)
      refuse("the file ends without its last chunk; it is truncated", name);
    std::memcpy(&word, bytes.data() + at, sizeof word);
    Chunk::Header chunk{};
    chunk << word;
    if (chunk.entity_ == Chunk::Entity_Sentinel) return;
    const std::size_t element = element_bytes(chunk);
    if (chunk.name_ != 0 || element == 0) {
      refuse("the chunk at byte " + std::to_string(at) +
                 " is none of positions, connectivity, normals, colours and texture coordinates",
             name, "save the mesh without other properties");
    }
    at += sizeof word;
    if ((bytes.size() - at) / element < elements(chunk, header))
      refuse("the chunk before byte " + std::to_string(at) +
                 " is longer than the file; it is truncated or damaged",
             name);
    at += element * elements(chunk, header);
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
  check_header_counts(name,
                      std::to_string(header.vertices) + " vertices, " +
                          std::to_string(header.faces) + " faces and " +
                          std::to_string(header.edges) + " edges",
                      12.0 * header.vertices + header.faces + 6.0 * header.edges, bytes.size());
  if (header.version < OpenMesh::IO::OMFormat::mk_version(2, 0))
    refuse("an OM file of a version before 2.0", name, "save it again with a newer OpenMesh");
  check_chunks(bytes, header, name);
  Mesh empty;
  Collector found(empty);
  OpenMesh::IO::Options options;
  std::istringstream stream{std::string(bytes)};
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
