// Linear programmes over blocks of four unknowns, such as the steps of several spheres at once.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace vpm {

struct LinearProgramme {
  static constexpr std::uint32_t kNone = 0xffffffffu;
  using Four = std::array<double, 4>;
  // a . x_i + b . x_j <= limit, where x_i are the four unknowns of block i; j may be kNone. The
  // limit must not be negative: x = 0 is allowed.
  struct Row {
    std::uint32_t i = 0, j = kNone;
    Four a{}, b{};
    double limit = 0;
  };
  std::vector<Four> gain;  // per block; what is to be maximised is the sum of gain_i . x_i
  std::vector<Row> rows;   // beside -1 <= x <= 1 for every unknown
};

// Maximises to one thousandth of the gain, or to one millionth of what the bounds of the unknowns
// alone would allow, by an interior point method. Rows may be violated
// by rounding. Deterministic. Unknowns are eliminated in the order of their blocks: those that
// share rows with few others are best put first. Memory grows with the square of the number of
// blocks.
std::vector<LinearProgramme::Four> solve(const LinearProgramme& programme);

}  // namespace vpm
