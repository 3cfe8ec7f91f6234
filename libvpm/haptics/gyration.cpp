#include "libvpm/haptics/gyration.h"

#include <cmath>

namespace vpm {

double radius_of_gyration(const ToolModel& tool) {
  constexpr double kOwnSpread = 0.6;  // mean squared distance within a sample, in squared radii
  double mean_square = 0;
  for (const CellSample& s : tool.levels.back().samples) {
    const double radius = double{s.radius};
    mean_square += s.weight * (squared_norm(widen(s.center)) + kOwnSpread * radius * radius);
  }
  // Mean moment of inertia per mass: two thirds of the mean squared distance.
  return std::sqrt(2.0 / 3 * mean_square);
}

}  // namespace vpm
