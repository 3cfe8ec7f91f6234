// Step that raises the minimum of a few linear functions most, by a small linear programme.
#pragma once

#include <vector>

#include "libvpm/core/vec3.h"

namespace vpm {

struct LinearBound {
  Vec3 gradient;  // unit length
  double value = 0;
};

struct MaxMinStep {
  Vec3 delta;
  double value = 0;  // minimum of the bounds at delta
};

// Maximises min_j (value_j + gradient_j . delta) over |delta_x|, |delta_y|, |delta_z| <= box. Needs
// at least one bound and box > 0. Deterministic; the order of bounds only breaks ties.
MaxMinStep max_min_step(const std::vector<LinearBound>& bounds, double box);

}  // namespace vpm
