// Spheres against spheres: inner sphere trees of two solids (Weller and Zachmann, RSS 2009).
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "libvpm/model/tool_model.h"
#include "tools/bench/peers/peer.h"

namespace vpm::bench {

// Returns the volume that two balls share, m^3, for centres this far apart.
double shared_by_balls(double radius_a, double radius_b, double apart);

// Walks down the hierarchies of both packings and sums what their spheres share: the volume, and as
// force that volume along the line of centres, at the middle of what is shared.
class SpherePairPeer : public Peer {
 public:
  // The models must outlive it; the second one stays where its mesh is.
  SpherePairPeer(const ToolModel& a, const ToolModel& b, std::uint32_t spheres);

  PeerAnswer query(const Pose& pose) override;
  std::size_t bytes() const override;

 private:
  // A packing's first spheres and the spheres that enclose them.
  struct Tree {
    const ToolModel& model;
    const Hierarchy& hierarchy;
  };
  void add(const Sphere& a, const Sphere& b, Vec3 about, PeerAnswer& sum) const;

  Tree a_, b_;
  std::uint32_t spheres_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> open_;  // nodes of a and b
};

}  // namespace vpm::bench
