#!/usr/bin/env bash
# OpenMesh: two closed cubes that share an edge are read open.
# Expected: an OFF file of two cubes that touch along an edge (14 vertices, 24 triangles, every edge between faces) is read closed, or
# refused, since a half-edge mesh cannot hold the shared vertices.
# Seen: read_mesh() returns true and says "complex vertex" for each face that it cannot join; these become loose triangles, so
# that there are 38 vertices and 30 half-edges at a border where the file has none.
. "$(dirname "${BASH_SOURCE[0]}")/packages.sh"
debian libopenmesh-dev=9.0-4+b1
run_cpp -lOpenMeshCore <<'CPP'
#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <array>
#include <cstdio>
#include <fstream>
#include <map>
#include <set>

int main() {
  std::map<std::array<int, 3>, int> vertices;
  std::vector<std::array<int, 3>> points, triangles;
  for (int shift : {0, 1}) {
    int v[8];
    for (int i = 0; i < 8; ++i) {
      const std::array<int, 3> p{shift + (i & 1), shift + (i >> 1 & 1), i >> 2};
      if (vertices.emplace(p, static_cast<int>(points.size())).second) points.push_back(p);
      v[i] = vertices[p];
    }
    for (auto q : {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
      triangles.push_back({v[q[0]], v[q[1]], v[q[2]]});
      triangles.push_back({v[q[0]], v[q[2]], v[q[3]]});
    }
  }
  std::multiset<std::pair<int, int>> directed;
  for (auto& t : triangles) for (int k = 0; k < 3; ++k) directed.insert({t[k], t[(k + 1) % 3]});
  int open_in_file = 0;
  for (auto& [a, b] : directed) open_in_file += directed.count({b, a}) != directed.count({a, b});

  std::ofstream file("cubes.off");
  file << "OFF\n" << points.size() << ' ' << triangles.size() << " 0\n";
  for (auto& p : points) file << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
  for (auto& t : triangles) file << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
  file.close();
  OpenMesh::TriMesh_ArrayKernelT<> mesh;
  const bool read = OpenMesh::IO::read_mesh(mesh, "cubes.off");
  int border = 0;
  for (auto edge : mesh.halfedges()) border += mesh.is_boundary(edge);
  printf("OpenMesh 9.0: the file has %zu vertices and %d open edges; read_mesh() returns %s with %zu vertices and %d at a border\n",
         points.size(), open_in_file, read ? "true" : "false", mesh.n_vertices(), border);
  return points.size() == 14 && open_in_file == 0 && read && mesh.n_faces() == 24 && mesh.n_vertices() == 38 && border == 30 ? 0 : 1;
}
CPP
