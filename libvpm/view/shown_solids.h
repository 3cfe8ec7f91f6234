// Solids of a scene on a page of poses.
#pragma once

#include <vpm/pose.h>
#include <vpm/scene.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "libvpm/view/page.h"

namespace vpm::view {

class ShownSolids {
 public:
  // Adds a solid. `name` is that of its file; `body` is a solid.
  void add(const std::string& name, const Body& body);

  bool empty() const { return solids_.empty(); }
  // Returns the names as a page shows them.
  std::vector<std::string> names() const;
  // Adds a layer for each solid. `poses` has those of all solids at each step, mesh to world; none
  // at a step where the solids are where they were made. Throws Error(invalid_argument) for another
  // number of them.
  void add_to(Page& page, const std::vector<std::vector<Pose>>& poses) const;

 private:
  struct Named {
    std::string name;
    Body body;
  };

  std::vector<Named> solids_;
};

}  // namespace vpm::view
