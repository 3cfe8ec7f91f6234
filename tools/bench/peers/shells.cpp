#include "tools/bench/peers/shells.h"

#include "libvpm/solid/solid_surface.h"

namespace vpm::bench {

Shells::Shells(const Solid& solid, double radius, bool quick) : field_parts_(quick ? 12 : 50) {
  for (const int parts : quick ? std::vector{12, 25} : std::vector{12, 25, 50, 100, 200})
    shells_.push_back({parts, std::make_shared<const PointShell>(solid, radius / parts)});
}

void Shells::add_walk(const std::string& peer, ShellWalk walk,
                      const std::shared_ptr<const DistanceField>& field,
                      const std::vector<PeerTruth>& truth, std::vector<Contender>& all) const {
  for (const Shell& shell : shells_)
    all.push_back({peer, "radius/" + std::to_string(shell.parts),
                   std::make_unique<ShellPeer>(shell.points, field, walk), false, &truth});
}

void Shells::add_tree(const std::string& peer, const std::shared_ptr<const DistanceField>& field,
                      const std::vector<PeerTruth>& truth, std::vector<Contender>& all) const {
  add_walk(peer, ShellWalk::tree, field, truth, all);
}

void Shells::add_contenders(const std::shared_ptr<const DistanceField>& field,
                            const std::vector<PeerTruth>& truth,
                            std::vector<Contender>& all) const {
  add_walk("pointshell, flat", ShellWalk::flat, field, truth, all);
  add_walk("pointshell, tree", ShellWalk::tree, field, truth, all);
  constexpr double kMicrosecond = 1e-6;
  for (const int deadline : {50, 90, 500, 900})
    all.push_back({"pointshell, nested levels",
                   "radius/" + std::to_string(shells_.back().parts) + " by " +
                       std::to_string(deadline) + " us",
                   std::make_unique<ShellPeer>(shells_.back().points, field, ShellWalk::nested,
                                               deadline * kMicrosecond),
                   false, &truth});
}

DistanceField voxels_of(const Solid& solid, int voxels) {
  Box box;
  for (const Vec3& v : solid.vertices) box.add(v);
  const SolidSurface surface(solid, false);
  const Vec3 side = box.size();
  const double voxel = std::max({side.x, side.y, side.z}) / voxels;
  box.low += 0.5 * voxel * Vec3{1, 1, 1};  // the first voxel's centre
  return {box, voxel,
          [&](Vec3 x) { return surface.holds(x - surface.center_of_mass()) ? -1.0 : 1.0; }};
}

}  // namespace vpm::bench
