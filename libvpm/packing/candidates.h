// Spheres of one band of radii that were found and may be placed.
#pragma once

#include <cstdint>
#include <vector>

#include "libvpm/model/sphere.h"
#include "libvpm/packing/space.h"

namespace vpm {

class Candidates {
 public:
  // Collects spheres of at least `radius`, cut to `cap`. Keeps a reference to `space`.
  Candidates(Space& space, double radius, double cap) : space_(space), radius_(radius), cap_(cap) {}

  // Adds the spheres that fit above these blocks.
  void search(const std::vector<std::uint32_t>& blocks);

  bool empty() const { return candidates_.empty(); }

  // Places all candidates, largest first, until there are `most` spheres; drops those whose room is
  // taken by then. Appends the blocks around them to `touched`.
  void place_all(std::size_t most, std::vector<std::uint32_t>& touched);

  // Places the candidate with the smallest gap to a sphere, and moves it into contact if that costs
  // no more than the width of the band. In a tube the largest sphere fits anywhere, and the room
  // between two that do not touch would hold no third.
  void place_closest(std::vector<std::uint32_t>& touched);

 private:
  struct Candidate {
    Sphere sphere;
    double gap;           // distance to the nearest of the first `compared` spheres
    std::size_t nearest;  // its index
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
