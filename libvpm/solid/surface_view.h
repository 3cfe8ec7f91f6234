// A surface as a device asks it: plain lists, by the numbers of SurfaceTree.
#pragma once

#include <cstdint>
#include <vector>

#include "libvpm/solid/inside_index.h"
#include "libvpm/solid/surface_bounds.h"
#include "libvpm/solid/surface_moments.h"

namespace vpm {

class SolidSurface;

struct SurfaceView {
  static constexpr std::uint32_t kNone = 0xffffffffu, kLeaf = 0x80000000u;  // as SurfaceTree's

  double reach = 0;  // m
  std::uint32_t vertex_count = 0, triangle_count = 0, node_count = 0;
  const Vec3* vertices = nullptr;
  const Triangle* triangles = nullptr;
  const float* longest_edge = nullptr;        // of triangles, m, or more
  const std::uint32_t* parent_of = nullptr;   // node, of triangles
  const std::uint32_t* node_above = nullptr;  // of nodes
  const SurfaceBounds* bounds = nullptr;      // of the children of nodes, four of each
  const std::uint32_t* child = nullptr;       // as SurfaceTree::Node::child
  // Vertex that tells for all below a node that nothing crosses; kNone if one cannot.
  const std::uint32_t* probe = nullptr;
  const SurfaceMoments* moments = nullptr;  // of nodes
  InsideView inside;
  std::size_t inside_states = 0, inside_columns = 0, inside_entries = 0;
};

// Holds what SurfaceView names and the surface, which must outlive this, does not hold as a list.
class SurfaceLists {
 public:
  explicit SurfaceLists(const SolidSurface& surface);
  SurfaceView view() const;

 private:
  const SolidSurface& surface_;
  std::vector<float> longest_edge_;
  std::vector<std::uint32_t> parent_of_, node_above_, child_, probe_;
  std::vector<SurfaceBounds> bounds_;
  std::vector<SurfaceMoments> moments_;
};

}  // namespace vpm
