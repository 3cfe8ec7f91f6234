// Quotients and square roots have the same bits on host and device.

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

#include "libvpm/device/device.h"
#include "tests/cuda/device_division.h"

namespace vpm {
namespace {

// Returns random operands over all of the range that division.h promises, and those next to powers
// of two, where the last step is most easily wrong.
std::vector<testing::Operands<double>> operands_of_all_kinds() {
  std::vector<testing::Operands<double>> operands;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> mantissa(1, 2);
  std::uniform_int_distribution<int> exponent(-440, 440);
  const auto any = [&] {
    return (random() % 2 == 0 ? 1 : -1) * std::ldexp(mantissa(random), exponent(random));
  };
  for (int k = 0; k < 4'000'000; ++k) operands.push_back({any(), any()});
  const auto one = std::bit_cast<std::int64_t>(1.0);
  for (std::int64_t i = -1000; i <= 1000; ++i) {
    const auto a = std::bit_cast<double>(one + i);
    operands.push_back({0, a});
    operands.push_back({1, a});
    for (std::int64_t j = -200; j <= 200; ++j)
      operands.push_back({a, std::bit_cast<double>(one + j)});
  }
  return operands;
}

template <class Real>
void expect_same_division(const std::vector<testing::Operands<Real>>& operands) {
  const std::vector<testing::Divided<Real>> divided = testing::divide_on_device(operands);
  std::size_t wrong = 0;
  for (std::size_t k = 0; k < operands.size(); ++k) {
    const auto [a, b] = operands[k];
    const testing::Divided<Real>& d = divided[k];
    if (d.quotient == a / b && d.square_root == std::sqrt(std::fabs(a)) && d.reciprocal == 1 / b)
      continue;
    if (++wrong < 10) ADD_FAILURE() << std::hexfloat << a << " / " << b;
  }
  EXPECT_EQ(wrong, 0U);
}

TEST(SameDivision, OfDoubles) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  expect_same_division(operands_of_all_kinds());
}

// Tries every fraction with an even and an odd exponent, far from the ends of the range and near
// them, since reciprocals and square roots depend on nothing else; and quotients by some other
// number.
TEST(SameDivision, OfFloats) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  constexpr std::uint32_t kFractions = 1U << 23, kOne = 127 * kFractions;
  std::mt19937 random(1);
  std::uniform_int_distribution<int> exponent(-24, 24);
  for (const int power : {-96, 0, 96}) {
    std::vector<testing::Operands<float>> operands;
    operands.reserve(4 * std::size_t{kFractions});
    for (std::uint32_t k = 0; k < 2 * kFractions; ++k) {
      const float a = std::ldexp(std::bit_cast<float>(kOne + k), power);
      const float other =
          std::ldexp(std::bit_cast<float>(kOne + static_cast<std::uint32_t>(random() % kFractions)),
                     power / 2 + exponent(random));
      operands.push_back({a, other});
      operands.push_back({other, -a});
    }
    expect_same_division(operands);
  }
}

}  // namespace
}  // namespace vpm
