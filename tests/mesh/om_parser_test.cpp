// Tests OM files as OpenMesh writes them with every attribute and scalar, and damaged chunks.
#include <gtest/gtest.h>

#if defined(__GNUC__) && !defined(__clang__)
// GCC takes what OpenMesh fills new attributes with for uninitialised.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <sstream>

#include "libvpm/mesh/mesh_check.h"
#include "libvpm/mesh/mesh_reader.h"
#include "tests/refusal.h"

namespace vpm::test {
namespace {

using OpenMesh::IO::Options;

struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};

RawMesh mesh_of_om(const std::string& content) {
  return parse_mesh(std::as_bytes(std::span(content)), "a.om");
}

// Returns a tetrahedron as OpenMesh writes it with these attributes.
template <class Traits>
std::string tetrahedron(Options::value_type attributes) {
  OpenMesh::PolyMesh_ArrayKernelT<Traits> mesh;
  mesh.request_vertex_normals();
  mesh.request_face_normals();
  mesh.request_vertex_colors();
  mesh.request_face_colors();
  mesh.request_vertex_texcoords2D();
  mesh.request_halfedge_texcoords2D();
  mesh.request_vertex_status();
  mesh.request_halfedge_status();
  mesh.request_edge_status();
  mesh.request_face_status();
  using Point = typename Traits::Point;
  std::vector<OpenMesh::VertexHandle> v;
  for (const Point& p : {Point(0, 0, 0), Point(1, 0, 0), Point(0, 1, 0), Point(0.1, 0.2, 1)})
    v.push_back(mesh.add_vertex(p));
  for (const auto& [a, b, c] : {std::array{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}})
    mesh.add_face(v[static_cast<std::size_t>(a)], v[static_cast<std::size_t>(b)],
                  v[static_cast<std::size_t>(c)]);
  mesh.update_normals();
  std::ostringstream stream;
  EXPECT_TRUE(OpenMesh::IO::write_mesh(mesh, stream, ".om", Options(Options::Binary | attributes)));
  return stream.str();
}

constexpr Options::value_type kAttributes[] = {0,
                                               Options::VertexNormal,
                                               Options::FaceNormal,
                                               Options::VertexColor,
                                               Options::FaceColor,
                                               Options::VertexTexCoord,
                                               Options::FaceTexCoord,
                                               Options::Status};

TEST(OmParser, ReadsFloatsAndDoublesWithEveryAttribute) {
  for (const Options::value_type attributes : kAttributes) {
    const RawMesh single = mesh_of_om(tetrahedron<OpenMesh::DefaultTraits>(attributes));
    EXPECT_NEAR(make_solid(single).facts.volume, 1.0 / 6, 1e-8) << attributes;
    const RawMesh precise = mesh_of_om(tetrahedron<DoubleTraits>(attributes));
    EXPECT_NEAR(make_solid(precise).facts.volume, 1.0 / 6, 1e-15) << attributes;
    EXPECT_EQ(precise.vertices.at(3), (Vec3{0.1, 0.2, 1})) << attributes;
  }
}

// Tries every header of a chunk. OpenMesh aborts on some, and throws std::logic_error on others.
TEST(OmParser, RefusesChunksThatMakeNoSense) {
  const std::string sound = tetrahedron<OpenMesh::DefaultTraits>(Options::VertexNormal);
  constexpr std::size_t kFirstChunk = 16;
  std::vector<std::size_t> chunks{kFirstChunk};
  chunks.push_back(kFirstChunk + 2 + 4 * 12);        // positions or normals are first
  chunks.push_back(kFirstChunk + 2 * (2 + 4 * 12));  // the half-edges
  for (const std::size_t chunk : chunks) {
    for (unsigned word = 0; word < 65536; ++word) {
      std::string damaged = sound;
      damaged[chunk] = static_cast<char>(word % 256);
      damaged[chunk + 1] = static_cast<char>(word / 256);
      try {
        for (const RawMesh mesh = mesh_of_om(damaged); const std::uint32_t corner : mesh.corners)
          ASSERT_LT(corner, mesh.vertices.size());
      } catch (const Error& fault) {
        ASSERT_EQ(fault.kind(), ErrorKind::refused);
      }
    }
  }
}

TEST(OmParser, RefusesAMeshGivenTwice) {
  std::string twice = tetrahedron<OpenMesh::DefaultTraits>(0);
  const std::string positions = twice.substr(16, 2 + 4 * 12);
  twice.insert(16, positions);
  EXPECT_NE(refusal([&] { mesh_of_om(twice); }).find("a second time"), std::string::npos);
}

}  // namespace
}  // namespace vpm::test
