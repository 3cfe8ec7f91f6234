// Spheres against spheres: what two packed solids share by the measure as printed (Weller and
// Zachmann, "Inner Sphere Trees for Proximity and Penetration Queries", RSS 2009).
#pragma once

#include <vpm/query_types.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/model/tool_model.h"
#include "libvpm/solid/solid_pair.h"

namespace vpm {

// A packing's first spheres, and the spheres that enclose them. Refers to its model.
struct InnerSphereTree {
  const ToolModel& model;
  const Level& level;
};

// Scratch of one thread.
class SpherePair {
 public:
  // Returns what two packings share at poses that map their meshes to the world: summed over all
  // pairs of a sphere of a and one of b, which a walk down both hierarchies finds, the shared
  // volume and, as force, that volume along the line of centres. Tells neither area nor turn,
  // closure or contacts. Swapping a and b gives the same bits, with opposite force and torque.
  // `states` receives the state of each of a's spheres, if it has room: inside where a sphere of b
  // holds it, boundary where it shares volume with any.
  SharedSolid measure(const InnerSphereTree& a, const Pose& pose_a, const InnerSphereTree& b,
                      const Pose& pose_b, std::span<SphereState> states = {});

  // Returns the number of pairs of spheres that share volume at the last poses.
  std::size_t contacts() const { return contacts_; }

 private:
  // Nodes that may share volume, and the bound of the second's in the first's frame.
  struct Place {
    std::uint32_t first, second;
    Sphere bound;
  };
  template <class Visit>
  void for_pairs(const InnerSphereTree& first, const InnerSphereTree& second, const Pose& to_first,
                 const Visit& visit);

  std::vector<Place> open_;
  std::size_t contacts_ = 0;
};

}  // namespace vpm
