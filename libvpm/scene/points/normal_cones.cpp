#include "libvpm/scene/points/normal_cones.h"

#include <algorithm>

#include "libvpm/core/lanes.h"
#include "libvpm/core/parallel.h"
#include "libvpm/scene/points/disk_surface.h"
#include "libvpm/scene/points/point_tree_vectors.h"

namespace vpm {
namespace {

// Sets cone k of a quad to that of the disks [begin, end).
void set_cone(const DiskSurface& disks, std::uint32_t begin, std::uint32_t end, ConeQuad& quad,
              std::uint32_t k) {
  Vec3 sum;
  for (std::uint32_t i = begin; i < end; ++i)
    disks.for_normals_of(i, [&](Vec3 normal) { sum += normal; });
  const Vec3f axis = narrow(normalized_or_zero(sum));
  double cosine = 1;
  for (std::uint32_t i = begin; i < end; ++i)
    disks.for_normals_of(i,
                         [&](Vec3 normal) { cosine = std::min(cosine, dot(widen(axis), normal)); });
  quad.set(k, axis, static_cast<float>(cosine));
}

}  // namespace

VPM_VECTOR_CLONES
bool DiskSurface::face_one_way_by_vectors(Vec3 center, double radius, Vec3 n, double least) const {
  return face_one_way_by<PointTree::ByVectors>(center, radius, n, least);
}

std::vector<ConeQuad> cones_of(const DiskSurface& disks) {
  const PointTree& tree = disks.feet;
  std::vector<ConeQuad> quads(tree.quads());
  for (std::uint32_t nodes = tree.leaves, size = PointTree::kLeafSize; nodes > 0;
       nodes /= 4, size *= 4) {
    constexpr std::size_t kGrain = 8192;  // disks
    const std::size_t used = (std::size_t{tree.count} + size - 1) / size;
    parallel_for(used, std::max<std::size_t>(kGrain / size, 4),
                 [&](std::size_t first, std::size_t last) {
                   for (auto k = static_cast<std::uint32_t>(first); k < last; ++k) {
                     const std::uint32_t node = nodes + k;
                     set_cone(disks, k * size, std::min((k + 1) * size, tree.count),
                              quads[node / 4], node % 4);
                   }
                 });
  }
  return quads;
}

}  // namespace vpm
