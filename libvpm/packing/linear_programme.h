// Small and medium linear programmes.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "libvpm/core/vec3.h"

namespace vpm {

// Programme over blocks of four unknowns, such as the steps of several spheres at once.
struct LinearProgramme {
  static constexpr std::uint32_t kNone = 0xffffffffu;
  using Four = std::array<double, 4>;
  // Constraint a . x_i + b . x_j <= limit, where x_i are the four unknowns of block i; j may be
  // kNone. limit must be >= 0, so that x = 0 is feasible.
  struct Row {
    std::uint32_t i = 0, j = kNone;
    Four a{}, b{};
    double limit = 0;
  };
  // Objective: the sum over blocks of gain_i . x_i, to be maximised.
  std::vector<Four> gain;
  // Constraints in addition to -1 <= x <= 1 for every unknown.
  std::vector<Row> rows;
};

// Returns the maximiser to 1e-3 of the gain, or to 1e-6 of what the bounds on unknowns alone allow,
// by an interior point method. Rows may be violated by rounding. Deterministic. Unknowns are
// eliminated in the order of blocks, so put blocks first that share rows with few others. Memory
// grows with the square of the number of blocks.
std::vector<LinearProgramme::Four> solve(const LinearProgramme& programme);

// Value and gradient of a linear function, in a programme that raises the minimum of a few.
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
