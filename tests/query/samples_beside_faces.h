// A level's samples, of which some are beside faces, as queries ask them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>

#include "libvpm/backend/cell_clusters.h"
#include "libvpm/core/vec3.h"

namespace vpm::testing {

class Draws {
 public:
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(random_()) / 4294967296.0;
  }
  Vec3 place(double half) {
    return {between(-half, half), between(-half, half), between(-half, half)};
  }

 private:
  std::mt19937 random_{1};
};

// Makes a level's samples one block, gives the last ones a face, and returns them.
inline NumberedSamples with_faces(Draws& numbers, Level& level) {
  const auto count = static_cast<std::uint32_t>(level.samples.size());
  level.blocks = {{{}, 0, 0, count}};
  for (auto k = static_cast<std::uint32_t>(numbers.between(0, 1.3) * count); k < count; ++k) {
    float& radius = level.samples[k].radius;
    radius = std::max(radius, 0.001F);
    const auto part = [&] { return radius * static_cast<float>(numbers.between(0.6, 1)); };
    const Vec3 axis = normalized_or_zero(numbers.place(1));
    level.faces.push_back({k, narrow(axis), part(), part(), radius, part()});
  }
  return numbered_samples(level);
}

}  // namespace vpm::testing
