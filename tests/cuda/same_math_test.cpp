// One definition of the math for host and device: every cell of a tool comes to the same bits on
// both.

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

#include "tests/cuda/device_cells.h"
#include "tests/cuda/device_division.h"
#include "tests/query/lattice_model.h"
#include "tests/test_name.h"

namespace vpm {
namespace {

using testing::CellAnswer;

void expect_same_bits(const ToolSum& a, const ToolSum& b) {
  EXPECT_EQ(a.volume.value, b.volume.value);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(a.force[k].value, b.force[k].value);
    EXPECT_EQ(a.torque[k].value, b.torque[k].value);
  }
}

using SceneCase = std::tuple<const char*, bool>;  // with camera

std::string name_of(const ::testing::TestParamInfo<SceneCase>& tested) {
  const auto& [scene, camera] = tested.param;
  return test::test_name(scene) + (camera ? "_camera" : "_points");
}

class SameMath : public ::testing::TestWithParam<SceneCase> {};

TEST_P(SameMath, OnHostAndDevice) {
  if (!testing::has_device()) GTEST_SKIP() << "no CUDA device here";
  const auto& [scene, camera] = GetParam();
  const Cloud seen = testing::see(synthetic::make_scene(scene));
  const PreparedCloud cloud(camera ? seen : without_camera(seen));
  const ToolModel tool = testing::lattice_cube(0.2, 9, 3);
  const Level& level = tool.levels[0];
  int cut = 0;
  for (int pose = 0; pose < 8; ++pose) {
    const Pose to_surface{testing::generic_rotation(), {0.011, -0.02, 0.86 + 0.02 * pose}};
    const std::vector<CellAnswer> host = testing::cells_on_host(cloud, tool, level, to_surface);
    const std::vector<CellAnswer> device = testing::cells_on_device(cloud, tool, level, to_surface);
    ASSERT_EQ(host.size(), device.size());
    for (std::size_t i = 0; i < host.size(); ++i) {
      EXPECT_EQ(host[i].side, device[i].side);
      expect_same_bits(host[i].cut.sum, device[i].cut.sum);
      expect_same_bits(host[i].whole, device[i].whole);
      EXPECT_EQ(host[i].cut.plane.count, device[i].cut.plane.count);
      for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(host[i].cut.plane.normal[k].value, device[i].cut.plane.normal[k].value);
        EXPECT_EQ(host[i].cut.plane.foot[k].value, device[i].cut.plane.foot[k].value);
      }
      cut += host[i].cut.plane.count > 0;
    }
  }
  EXPECT_GT(cut, 100);
}

INSTANTIATE_TEST_SUITE_P(Scenes, SameMath,
                         ::testing::Combine(::testing::Values("wall", "groove", "block",
                                                              "inverted-ball"),
                                            ::testing::Bool()),
                         name_of);

// Random ones over all of the range that division.h promises, and those next to powers of two,
// where the last step is most easily wrong.
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
  if (!testing::has_device()) GTEST_SKIP() << "no CUDA device here";
  expect_same_division(operands_of_all_kinds());
}

// Every fraction of an even and an odd exponent, which is all that reciprocals and square roots
// depend on, far from the ends of the range and near them; and quotients by some other number.
TEST(SameDivision, OfFloats) {
  if (!testing::has_device()) GTEST_SKIP() << "no CUDA device here";
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
