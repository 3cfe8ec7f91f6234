// Compares our reading and writing with OpenMesh's. Its readers round to floats and give up on some
// real files, so only meshes that it reads soundly are compared.
#include <gtest/gtest.h>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <algorithm>
#include <cstring>
#include <random>
#include <sstream>

#include "libvpm/core/error.h"
#include "libvpm/synthetic/shapes.h"
#include "libvpm/view/sphere_files.h"
#include "tests/mesh/mesh_files.h"

namespace vpm::test {
namespace {

using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<>;

// Expects an accepted solid to be a closed manifold of half-edges to OpenMesh too.
void expect_closed_manifold(const Solid& solid) {
  HalfEdgeMesh mesh;
  std::vector<HalfEdgeMesh::VertexHandle> handles;
  for (const Vec3& p : solid.vertices) {
    const Vec3f f = narrow(p);
    handles.push_back(mesh.add_vertex({f.x, f.y, f.z}));
  }
  for (const Triangle& t : solid.triangles)
    ASSERT_TRUE(mesh.add_face(handles[t[0]], handles[t[1]], handles[t[2]]).is_valid());
  for (const auto edge : mesh.edges()) ASSERT_FALSE(mesh.is_boundary(edge));
  for (const auto vertex : mesh.vertices()) ASSERT_TRUE(mesh.is_manifold(vertex));
}

TEST(OpenMeshAgrees, OnWhatIsAClosedManifold) {
  for (const char* const name :
       {"bunny.off", "spot.obj", "knot.ply", "fuze_bottle.ply", "plate_holes.STL",
        "featuretype.STL", "bad_blobby_misoriented.off", "cow.off"}) {
    const std::string path = shared_mesh(name);
    if (path.empty()) GTEST_SKIP() << "the shared data is not here";
    expect_closed_manifold(make_solid(read_mesh(path)).solid);
  }
  expect_closed_manifold(solid_of(synthetic::make_torus(1, 0.3, 24, 12)).solid);
}

void expect_same_mesh(const std::string& content, const std::string& extension) {
  HalfEdgeMesh theirs;
  std::istringstream stream(content);
  OpenMesh::IO::Options options;
  ASSERT_TRUE(OpenMesh::IO::read_mesh(theirs, stream, extension, options));
  const RawMesh ours = parse(content, "a." + extension);
  const std::vector<Triangle> triangles = triangulate(ours);
  ASSERT_EQ(theirs.n_vertices(), ours.vertices.size());
  ASSERT_EQ(theirs.n_faces(), triangles.size());
  for (const auto vertex : theirs.vertices()) {
    const auto p = theirs.point(vertex);
    const Vec3f mine = narrow(ours.vertices[static_cast<std::size_t>(vertex.idx())]);
    EXPECT_EQ((Vec3f{p[0], p[1], p[2]}), mine);
  }
  for (const auto face : theirs.faces()) {
    Triangle corners;
    std::size_t k = 0;
    for (const auto vertex : theirs.fv_range(face))
      corners[k++] = static_cast<std::uint32_t>(vertex.idx());
    const Triangle& mine = triangles[static_cast<std::size_t>(face.idx())];
    std::rotate(corners.begin(), std::find(corners.begin(), corners.end(), mine[0]), corners.end());
    EXPECT_EQ(corners, mine);
  }
}

TEST(OpenMeshAgrees, OnWhatTheFilesSay) {
  const Solid ball = moved(synthetic::make_icosphere(0.7, 2), {0.1, 0.2, 0.3});
  expect_same_mesh(as_obj(ball), "obj");
  expect_same_mesh(as_off(ball), "off");
  expect_same_mesh(as_ascii_ply(ball), "ply");
  expect_same_mesh(as_binary_ply(ball, false), "ply");
  expect_same_mesh(as_binary_ply(ball, true), "ply");
}

// Returns a mesh of triangles and quadrilaterals as OpenMesh writes it.
std::string written_by_openmesh(const std::string& extension) {
  OpenMesh::PolyMesh_ArrayKernelT<> mesh;
  std::vector<OpenMesh::VertexHandle> v;
  for (const auto& p : {OpenMesh::Vec3f{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5F, 0.3F, 1}})
    v.push_back(mesh.add_vertex(p));
  mesh.add_face({v[3], v[2], v[1], v[0]});
  for (std::size_t k = 0; k < 4; ++k) mesh.add_face({v[k], v[(k + 1) % 4], v[4]});
  OpenMesh::IO::Options options(OpenMesh::IO::Options::Binary);
  std::ostringstream stream;
  EXPECT_TRUE(OpenMesh::IO::write_mesh(mesh, stream, extension, options));
  return stream.str();
}

void expect_the_pyramid(const RawMesh& mesh) {
  ASSERT_EQ(mesh.vertices.size(), 5U);
  EXPECT_EQ(mesh.vertices[4], widen({0.5F, 0.3F, 1}));
  ASSERT_EQ(mesh.polygon_count(), 5U);
  EXPECT_NEAR(make_solid(mesh).facts.volume, 1.0 / 3, 1e-15);
}

TEST(OpenMeshWrites, WhatIsReadHere) {
  for (const std::string name : {"a.om", "standard input"})
    expect_the_pyramid(parse(written_by_openmesh(".om"), name));
  EXPECT_EQ(parse(written_by_openmesh(".om"), "a.om").format, MeshFormat::om);
  expect_the_pyramid(parse(written_by_openmesh(".off"), "a.off"));
}

TEST(BinaryOff, OfEitherByteOrderWithAndWithoutColours) {
  const Solid cube = synthetic::make_cube(0.5);
  for (const bool big_endian : {false, true}) {
    for (const bool has_colors : {false, true}) {
      std::string content = "OFF BINARY\n";
      const auto add = [&](auto value) {
        char bytes[4];
        std::memcpy(bytes, &value, 4);
        if (big_endian) std::reverse(bytes, bytes + 4);
        content.append(bytes, 4);
      };
      for (const std::uint32_t count : {8U, 12U, 18U}) add(count);
      for (const Vec3& p : cube.vertices) {
        for (const double c : {p.x, p.y, p.z}) add(static_cast<float>(c));
      }
      for (const Triangle& t : cube.triangles) {
        for (const std::uint32_t word : {3U, t[0], t[1], t[2]}) add(word);
        if (!has_colors) continue;
        add(3U);
        for (int k = 0; k < 3; ++k) add(0.5F);
      }
      const RawMesh mesh = parse(content, "a.off");
      EXPECT_EQ(mesh.vertices, cube.vertices);
      EXPECT_EQ(triangulate(mesh), cube.triangles);
      for (std::size_t size = 0; size < content.size(); ++size)
        EXPECT_NE(refusal_of(content.substr(0, size), "a.off"), "") << size;
    }
  }
}

TEST(DamagedOm, NeverDoesMoreThanRefuse) {
  const std::string sound = written_by_openmesh(".om");
  for (std::size_t size = 0; size < sound.size() - 2; ++size)
    EXPECT_NE(refusal_of(sound.substr(0, size), "a.om"), "") << size;
  std::mt19937 random(5);
  for (int round = 0; round < 20000; ++round) {
    std::string damaged = sound;
    for (int flips = 0; flips < 1 + round % 4; ++flips)
      damaged[random() % damaged.size()] = static_cast<char>(random() % 256);
    try {
      const RawMesh mesh = parse(damaged, "a.om");
      for (const std::uint32_t corner : mesh.corners) ASSERT_LT(corner, mesh.vertices.size());
    } catch (const Error& error) {
      ASSERT_EQ(error.kind(), ErrorKind::refused);
    }
  }
}

TEST(OpenMeshReads, TheBallsOfAPacking) {
  const std::vector<Sphere> spheres = {{{.1, -.2, 3}, .5}, {{10, 20, 30}, 1.0 / 64}};
  expect_same_mesh(view::spheres_as(view::SphereFormat::ply, spheres), "ply");
}

TEST(AssimpReads, TheBallsOfAPacking) {
  const std::vector<Sphere> spheres = {{{.1, -.2, 3}, .5}, {{10, 20, 30}, 1.0 / 64}};
  try {
    const auto facts = [&](view::SphereFormat format, const char* name) {
      return solid_of(view::spheres_as(format, spheres), name).facts;
    };
    const MeshFacts glb = facts(view::SphereFormat::glb, "a.glb");
    const MeshFacts ply = facts(view::SphereFormat::ply, "a.ply");
    EXPECT_EQ(glb.shells, spheres.size());
    EXPECT_EQ(glb.triangles, ply.triangles);
    EXPECT_NEAR(glb.volume, ply.volume, 1e-5);
    EXPECT_LT(norm(glb.low - ply.low) + norm(glb.high - ply.high), 1e-5);
  } catch (const Error& fault) {
    if (fault.kind() != ErrorKind::unavailable) throw;
    GTEST_SKIP() << "no assimp";
  }
}

}  // namespace
}  // namespace vpm::test
