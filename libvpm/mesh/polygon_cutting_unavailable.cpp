#include "libvpm/mesh/polygon_cutting.h"

namespace vpm {

PolygonCutting cut_polygon(std::span<const Vec2>) {
  return {.fault = CuttingFault::unavailable};
}

}  // namespace vpm
