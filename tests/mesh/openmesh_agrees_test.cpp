// What OpenMesh thinks of our input and output. Its readers round to floats and give up on some of
// the real files, so only what it reads soundly is compared.
#include <gtest/gtest.h>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <sstream>

#include "libvpm/synthetic/shapes.h"
#include "tests/mesh/mesh_files.h"

namespace vpm::test {
namespace {

using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<>;

// Every accepted solid must be a closed manifold of half-edges to somebody else too.
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

}  // namespace
}  // namespace vpm::test
