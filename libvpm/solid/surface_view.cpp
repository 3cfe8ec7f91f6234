#include "libvpm/solid/surface_view.h"

#include "libvpm/solid/solid_surface.h"

namespace vpm {

SurfaceLists::SurfaceLists(const SolidSurface& surface) : surface_(surface) {
  const SurfaceTree& tree = surface.tree();
  for (std::uint32_t t = 0; t < tree.triangles().size(); ++t) {
    longest_edge_.push_back(static_cast<float>(tree.longest_edge(t)));
    parent_of_.push_back(tree.parent_of(t));
  }
  for (std::uint32_t node = 0; node < tree.nodes().size(); ++node) {
    node_above_.push_back(tree.node_above(node));
    for (std::uint32_t k = 0; k < 4; ++k) {
      bounds_.push_back(tree.bounds(node, k));
      child_.push_back(tree.nodes()[node].child[k]);
    }
    const SurfaceTree::Summary& below = tree.summaries()[node];
    probe_.push_back(below.is_connected ? tree.triangles()[below.first][0] : SurfaceView::kNone);
    moments_.push_back(tree.moments(node));
  }
}

SurfaceView SurfaceLists::view() const {
  static_assert(SurfaceView::kLeaf == SurfaceTree::kLeaf &&
                SurfaceView::kNone == SurfaceTree::kNone);
  const SurfaceTree& tree = surface_.tree();
  const InsideIndex& inside = surface_.inside();
  const auto count = [](const auto& list) { return static_cast<std::uint32_t>(list.size()); };
  return {surface_.reach(),     count(tree.vertices()), count(tree.triangles()),
          count(tree.nodes()),  tree.vertices().data(), tree.triangles().data(),
          longest_edge_.data(), parent_of_.data(),      node_above_.data(),
          bounds_.data(),       child_.data(),          probe_.data(),
          moments_.data(),      surface_.inside_view(), inside.states(),
          inside.columns(),     inside.entries()};
}

}  // namespace vpm
