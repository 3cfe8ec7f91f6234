#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace vpm {

// Depth along the optical axis in metres, row by row. Anything that is not finite and positive
// means that nothing was measured; stored images hold 0 there.
struct DepthImage {
  std::uint32_t width = 0, height = 0;
  std::vector<float> depth;

  std::size_t index(std::uint32_t u, std::uint32_t v) const { return std::size_t{v} * width + u; }
};

inline bool is_measured(float depth) {
  return depth > 0 && std::isfinite(depth);
}

}  // namespace vpm
