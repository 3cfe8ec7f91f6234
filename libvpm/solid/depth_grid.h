// Depth below a closed surface on a dense grid, between samples linear along each axis. Samples are
// kept in 24 bits, to a 16 millionth of the greatest depth, as floats would be: a small solid deep
// in a large one is pushed by differences of depths.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "libvpm/core/vec3.h"

namespace vpm {

struct Depth {
  double value = 0;  // m; positive inside
  Vec3 gradient;     // toward deeper places
};

class DepthGrid {
 public:
  // Samples from `low` to `high` and a cell beyond; `cells` along the longest side. `distance`
  // gives the distance of the surface where it is below `within`, else at least `within`.
  using Inside = std::function<bool(Vec3 x)>;
  using Distance = std::function<double(Vec3 x, double within)>;
  DepthGrid(Vec3 low, Vec3 high, int cells, const Inside& inside, const Distance& distance);

  // Returns depth and gradient at x, own frame; of the nearest place of the grid beyond it.
  Depth at(Vec3 x) const;
  double cell() const { return cell_; }
  std::size_t bytes() const { return samples_.size() * sizeof samples_[0]; }

 private:
  static constexpr std::size_t kBytes = 3;
  std::int32_t sample(std::size_t k) const {
    const std::uint8_t* at = samples_.data() + kBytes * k;
    return at[0] | at[1] << 8 | at[2] << 16;
  }

  Vec3 low_;
  double cell_, per_cell_;
  std::array<std::size_t, 3> count_{};
  double least_ = 0, step_ = 0;        // depth of sample 0, and between samples that differ by 1
  std::vector<std::uint8_t> samples_;  // kBytes each, the lowest first
};

}  // namespace vpm
