#include "libvpm/mesh/mesh_defects.h"

#include "libvpm/core/box.h"
#include "libvpm/mesh/holes.h"
#include "libvpm/mesh/self_intersection.h"
#include "libvpm/mesh/topology.h"
#include "libvpm/mesh/weld.h"

namespace vpm {

Solid triangles_of(const RawMesh& mesh, const SolidOptions& options) {
  Solid result{mesh.vertices, triangulate(mesh)};
  drop_collapsed(result.triangles);
  const bool is_soup = lists_corners(mesh.format) || options.repair != Repair::none;
  if (is_soup || options.weld) {
    Box box;
    for (const Vec3& p : result.vertices) box.add(p);
    const double tolerance = options.weld.value_or(kDefaultWeld) * norm(box.size());
    weld(result.vertices, tolerance, result.triangles);
  }
  drop_unused(result.vertices, result.triangles);
  for (Vec3& p : result.vertices) p = options.scale.value_or(1) * p;
  return result;
}

namespace {

// Returns no pairs if there are too many to look for.
std::vector<TrianglePair> crossing_pairs(const Solid& solid) {
  try {
    return find_self_intersections(solid.vertices, solid.triangles);
  } catch (const TooMuchWork&) {
    return {};
  }
}

}  // namespace

MeshDefects find_defects(const Solid& solid) {
  MeshDefects defects;
  const Topology topology = topology_of(solid.vertices.size(), solid.triangles);
  const auto segment = [&](std::uint32_t a, std::uint32_t b) {
    return Segment{solid.vertices[a], solid.vertices[b]};
  };
  for (const BoundaryLoop& loop : boundary_loops(topology, solid.triangles)) {
    std::vector<Segment>& rim = defects.holes.emplace_back();
    const std::size_t count = loop.vertices.size();
    for (std::size_t k = 0; k + (loop.closed ? 0 : 1) < count; ++k)
      rim.push_back(segment(loop.vertices[k], loop.vertices[(k + 1) % count]));
  }
  for (const Edge& edge : topology.non_manifold)
    defects.non_manifold.push_back(segment(edge.a, edge.b));
  for (const Edge& edge : topology.conflicting)
    defects.conflicting.push_back(segment(edge.a, edge.b));
  if (topology.boundary.empty())
    for (const std::uint32_t v : topology.pinched) defects.pinched.push_back(solid.vertices[v]);
  std::vector<char> crosses(solid.triangles.size(), 0);
  for (const auto& [a, b] : crossing_pairs(solid)) crosses[a] = crosses[b] = 1;
  for (std::size_t k = 0; k < crosses.size(); ++k) {
    const Triangle& t = solid.triangles[k];
    if (crosses[k] != 0)
      defects.crossing.push_back(
          {solid.vertices[t[0]], solid.vertices[t[1]], solid.vertices[t[2]]});
  }
  return defects;
}

}  // namespace vpm
