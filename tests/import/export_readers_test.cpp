// What other programs' libraries read of exported points.
#include <gtest/gtest.h>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <sstream>
#include <vector>
#ifdef VPM_TESTS_ASSIMP
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#endif

#include "libvpm/cloud/normals.h"
#include "libvpm/import/cloud_export.h"
#include "tests/import/test_files.h"

namespace vpm {
namespace {

// Returns what a camera at (3, -2, 1.5) sees of a tilted wall, without the camera.
Cloud seen_points() {
  DepthImage depth{20, 16, std::vector<float>(320, 1.25F)};
  for (std::size_t i = 0; i < depth.depth.size(); ++i)
    depth.depth[i] += 0.01F * static_cast<float>(i % 20);
  const Pose pose{rotation_from_quaternion({0.5, 0.5, -0.5, 0.5}), {3, -2, 1.5}};
  return without_camera(make_cloud(depth, {{100, 110, 9.5, 7.5}, 20, 16, pose}, {}));
}

struct ReadPoints {
  std::vector<Vec3> positions, normals;
};

void expect_same(const ReadPoints& read, const Cloud& cloud) {
  ASSERT_EQ(read.positions.size(), cloud.size());
  ASSERT_EQ(read.normals.size(), cloud.size());
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    EXPECT_LT(norm(read.positions[k] - cloud.origin - widen(cloud.positions[k])), 1e-6) << k;
    EXPECT_LT(norm(read.normals[k] - widen(cloud.normals[k])), 1e-6) << k;
  }
}

TEST(ExportReaders, OpenMeshReadsPly) {
  using Mesh = OpenMesh::TriMesh_ArrayKernelT<>;
  const Cloud cloud = seen_points();
  Mesh mesh;
  mesh.request_vertex_normals();
  OpenMesh::IO::Options options = OpenMesh::IO::Options::VertexNormal;
  options += OpenMesh::IO::Options::Binary;
  std::istringstream stream(to_ply(cloud));
  ASSERT_TRUE(OpenMesh::IO::read_mesh(mesh, stream, ".ply", options));
  ReadPoints read;
  for (const auto vertex : mesh.vertices()) {
    const Mesh::Point p = mesh.point(vertex);
    const Mesh::Normal n = mesh.normal(vertex);
    read.positions.push_back({p[0], p[1], p[2]});
    read.normals.push_back({n[0], n[1], n[2]});
  }
  expect_same(read, cloud);
}

#ifdef VPM_TESTS_ASSIMP
TEST(ExportReaders, AssimpReadsPly) {
  const Cloud cloud = seen_points();
  const std::string file = to_ply(cloud);
  Assimp::Importer importer;
  const aiScene* const scene = importer.ReadFileFromMemory(file.data(), file.size(), 0, "ply");
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();
  ASSERT_EQ(scene->mNumMeshes, 1U);
  const aiMesh& mesh = *scene->mMeshes[0];
  ASSERT_TRUE(mesh.HasNormals());
  ReadPoints read;
  for (unsigned k = 0; k < mesh.mNumVertices; ++k) {
    const aiVector3D p = mesh.mVertices[k], n = mesh.mNormals[k];
    read.positions.push_back({p.x, p.y, p.z});
    read.normals.push_back({n.x, n.y, n.z});
  }
  expect_same(read, cloud);
}
#endif

}  // namespace
}  // namespace vpm
