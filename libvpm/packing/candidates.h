// Spheres of one band of radii that have been found and may be placed.
#pragma once

#include <cstdint>
#include <vector>

#include "libvpm/model/sphere.h"
#include "libvpm/packing/space.h"

namespace vpm {

class Candidates {
 public:
  // For spheres of at least `radius`, cut to `cap`. Keeps a reference to `space`.
  Candidates(Space& space, double radius, double cap) : space_(space), radius_(radius), cap_(cap) {}

  // Adds what fits above these blocks.
  void search(const std::vector<std::uint32_t>& blocks);

  bool empty() const { return candidates_.empty(); }

  // Places all until there are `most` spheres, largest first, but for those that others have taken
  // the room of. Appends the blocks around them to `touched`.
  void place_all(std::size_t most, std::vector<std::uint32_t>& touched);

  // Places the one with the least gap to a sphere, and moves it until they touch where that costs
  // no more than the band is wide. A tube has room for its largest sphere anywhere: what is
  // left between two of them that do not touch holds no third.
  void place_closest(std::vector<std::uint32_t>& touched);

 private:
  struct Candidate {
    Sphere sphere;
    double gap;           // to the nearest of the first `compared` spheres
    std::size_t nearest;  // of them
    std::size_t compared;
  };

  void update_gap(Candidate& candidate) const;
  Sphere moved_to_contact(const Candidate& candidate) const;
  bool place(const Sphere& sphere, std::vector<std::uint32_t>& touched);

  Space& space_;
  double radius_, cap_;
  std::vector<Candidate> candidates_;  // largest first
};

}  // namespace vpm
