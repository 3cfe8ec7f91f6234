// Shells of a tool at all spacings, and the settings at which they contend.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tools/bench/peers/contest.h"
#include "tools/bench/peers/point_shell.h"

namespace vpm::bench {

class Shells {
 public:
  // Makes shells with points `radius` / 12, 25, 50, 100 and 200 apart; `quick`: only the first two.
  Shells(const Solid& solid, double radius, bool quick);

  // Returns the voxels' size of a field for bodies with this radius, m, which all shells read.
  double field_voxel(double radius) const { return radius / field_parts_; }
  // Adds the tree over each shell.
  void add_tree(const std::string& peer, const std::shared_ptr<const DistanceField>& field,
                const std::vector<PeerTruth>& truth, std::vector<Contender>& all) const;
  // Adds the three variants of voxmap-pointshell.
  void add_contenders(const std::shared_ptr<const DistanceField>& field,
                      const std::vector<PeerTruth>& truth, std::vector<Contender>& all) const;

 private:
  void add_walk(const std::string& peer, ShellWalk walk,
                const std::shared_ptr<const DistanceField>& field,
                const std::vector<PeerTruth>& truth, std::vector<Contender>& all) const;

  struct Shell {
    int parts;  // of the radius
    std::shared_ptr<const PointShell> points;
  };
  double field_parts_;  // of a radius
  std::vector<Shell> shells_;
};

// Returns a field of a solid with this many voxels along its longest side: -1 inside, else 1.
DistanceField voxels_of(const Solid& solid, int voxels);

}  // namespace vpm::bench
