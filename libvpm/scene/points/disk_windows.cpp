#include "libvpm/scene/points/disk_windows.h"

#include "libvpm/core/box.h"
#include "libvpm/core/lanes.h"
#include "libvpm/core/vec3x4.h"

namespace vpm {
namespace {

[[gnu::always_inline]] inline void add_where(const Mask4& mask, const Double4& a, Double4& sum) {
  sum += mask ? a : Double4{};
}
[[gnu::always_inline]] inline void add_where(const Mask4& mask, const Vec3x4& a, Vec3x4& sum) {
  add_where(mask, a.x, sum.x);
  add_where(mask, a.y, sum.y);
  add_where(mask, a.z, sum.z);
}

}  // namespace

DiskWindows::DiskWindows(MeasuredDisks measured)
    : measured_(std::move(measured)), near_((leaf_count() + kLeavesOfRun - 1) / kLeavesOfRun) {
  parallel_for(near_.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> quads;
    for (std::size_t run = begin; run < end; ++run) {
      const auto first = static_cast<std::uint32_t>(run) * kLeavesOfRun;
      for (std::uint32_t k = first; k < std::min(first + kLeavesOfRun, leaf_count());
           k += kLeavesOfBlock)
        list_near(k, std::min(k + kLeavesOfBlock, leaf_count()), quads, near_[run]);
    }
  });
}

void DiskWindows::list_near(std::uint32_t first, std::uint32_t end,
                            std::vector<std::uint32_t>& quads, NearLeaves& near) const {
  DiskLeaf leaves[kLeavesOfBlock];
  Box centers;
  double widest = 0;
  for (std::uint32_t k = first; k < end; ++k) {
    const DiskLeaf& leaf = leaves[k - first] = leaf_of(k * PointTree::kLeafSize);
    centers.add(leaf.center);
    widest = std::max(widest, reach(leaf));
  }
  const double all = kSlack * (0.5 * norm(centers.size()) + widest);
  measured_.feet.list_quads(0.5 * (centers.low + centers.high), all * all, quads);
  for (std::uint32_t k = first; k < end; ++k) {
    const DiskLeaf& leaf = leaves[k - first];
    const double reach = this->reach(leaf);
    NearLeaves::Range& range = near.ranges[k % kLeavesOfRun];
    range.begin = static_cast<std::uint32_t>(near.leaves.size());
    measured_.feet.list_leaves(leaf.center, reach * reach, quads, near.leaves);
    if (near.leaves.size() - range.begin > kMostNear) near.leaves.resize(range.begin);
    range.size = static_cast<std::uint32_t>(near.leaves.size()) - range.begin;
  }
}

VPM_VECTOR_CLONES
void look_around(std::span<const Disk> near, const DiskInBall (&disks)[4],
                 Neighborhood (&found)[4]) {
  const Double4 zero{};
  const auto& [a, b, c, d] = disks;
  const Vec3x4 place(a.disk.place, b.disk.place, c.disk.place, d.disk.place);
  const Vec3x4 normal(a.disk.normal, b.disk.normal, c.disk.normal, d.disk.normal);
  const Double4 reach{a.reach, b.reach, c.reach, d.reach}, squared_reach = reach * reach;
  Vec3x4 normals(zero, zero, zero), back_normal = normals, back_place = normals;
  Double4 height = zero, back_height = zero;
  Mask4 alike{}, unlike{}, back{};  // counts, negative
  for (const Disk& other : near) {
    const Vec3 n = other.normal, p = other.place;
    const Vec3x4 other_normal(n, n, n, n), other_place(p, p, p, p), away = other_place - place;
    const Mask4 is_near = squared_norm(away) <= squared_reach;
    if (!any(is_near)) continue;
    const Double4 cosine = dot(normal, other_normal);
    // Computes the height at which the other disk's circle, or line, that is normal to both disks,
    // meets this one's axis.
    const Double4 its_height = dot(normal + other_normal, away) / (1 + cosine);
    const Mask4 is_back = is_near & (cosine <= kOpposite),
                faces_alike = is_near & (cosine >= kAlike),
                is_alike = faces_alike & (absolute(its_height) <= kOneSurface * reach);
    add_where(is_alike, its_height, height);
    add_where(is_alike, other_normal, normals);
    alike += is_alike;
    unlike += is_near & ~faces_alike & ~is_back;
    if (!any(is_back)) continue;
    add_where(is_back, other_normal, back_normal);
    add_where(is_back, other_place, back_place);
    add_where(is_back, -dot(other_normal, away), back_height);
    back += is_back;
  }
  const auto count = [](const Mask4& mask, int lane) {
    return static_cast<std::uint32_t>(-mask[lane]);
  };
  for (int k = 0; k < kFour; ++k) {
    found[k] = {normals.of(k),
                height[k],
                count(alike, k),
                count(unlike, k),
                {back_normal.of(k), back_place.of(k), back_height[k], count(back, k)}};
  }
}

}  // namespace vpm
