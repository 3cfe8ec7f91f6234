// Poses in a device's memory get the answers that poses on the host get, and stay there.

#include "tests/cuda/resident_poses.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "libvpm/synthetic/render.h"
#include "tests/cuda/effort.h"
#include "tests/query/lattice_model.h"
#include "tests/query/replay.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

constexpr Device kFirst{Device::Kind::cuda, 0};

class PosesOnADevice : public ::testing::Test {
 protected:
  void SetUp() override {
    if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  }

  Cloud seen_ = testing::see(synthetic::make_scene("wall"));
  AnyBody image_{seen_}, points_{without_camera(testing::see(synthetic::make_scene("block")))};
  ToolModel tool_ = testing::lattice_cube(0.2, 9, 3);
};

// Returns a quaternion and a place before, in and behind the wall, with the rounding of floats.
std::array<double, 7> numbers_of(int k, int count) {
  const double angle = 0.7 * k, half = std::sin(angle / 2);
  const auto rounded = [](double x) { return static_cast<double>(static_cast<float>(x)); };
  return {
      0.01 * (k % 5),        -0.02 * (k % 3),      0.8 + 0.4 * k / count,       rounded(0.6 * half),
      rounded(-0.64 * half), rounded(0.48 * half), rounded(std::cos(angle / 2))};
}
Pose pose_of(const std::array<double, 7>& n) {
  return {rotation_from_quaternion({n[3], n[4], n[5], n[6]}), {n[0], n[1], n[2]}};
}
// Returns the matrix of 3 x 4 numbers, a little off a rotation.
std::array<double, 12> matrix_of(const Pose& pose) {
  const auto& [r, t] = pose;
  const double off = 1 + 1e-7;
  return {off * r.row0.x, r.row0.y, r.row0.z, t.x,      r.row1.x, r.row1.y,
          r.row1.z,       t.y,      r.row2.x, r.row2.y, r.row2.z, t.z};
}
Pose pose_of(const std::array<double, 12>& n) {
  return {rotation_from_matrix({n[0], n[1], n[2], n[4], n[5], n[6], n[8], n[9], n[10]}),
          {n[3], n[7], n[11]}};
}

void expect_same(const Result& expected, const DeviceResult& row) {
  EXPECT_EQ(expected.volume, row.volume);
  EXPECT_EQ(expected.volume_fraction, row.volume_fraction);
  EXPECT_EQ(expected.wrench.force, row.force);
  EXPECT_EQ(expected.wrench.torque, row.torque);
  EXPECT_EQ(expected.boundary, row.boundary);
  EXPECT_EQ(expected.inside, row.inside);
  ASSERT_EQ(expected.visibility.has_value(), !std::isnan(row.seen_free));
  if (!expected.visibility) return;
  EXPECT_EQ(expected.visibility->seen_free, row.seen_free);
  EXPECT_EQ(expected.visibility->unseen, row.unseen);
  EXPECT_EQ(expected.visibility->out_of_view, row.out_of_view);
}

TEST_F(PosesOnADevice, HaveTheAnswersOfPosesOnTheHost) {
  constexpr int kCount = testing::effort(200);
  ToolQuery on_cpu(tool_, {.stiffness = 300}),
      on_device(tool_, {.device = kFirst, .stiffness = 300});
  std::vector<double> sevens, matrices;
  std::vector<Result> of_sevens, of_matrices;
  const std::vector<AnyBody> one{image_}, two{points_, image_}, points{points_};
  double touched = 0;
  for (const auto& scene : {one, two, points}) {
    sevens.clear(), matrices.clear(), of_sevens.clear(), of_matrices.clear();
    for (int k = 0; k < kCount; ++k) {
      const auto seven = numbers_of(k, kCount);
      const auto matrix = matrix_of(pose_of(seven));
      sevens.insert(sevens.end(), seven.begin(), seven.end());
      matrices.insert(matrices.end(), matrix.begin(), matrix.end());
      of_sevens.push_back(on_cpu.run(scene, pose_of(seven)));
      of_matrices.push_back(on_cpu.run(scene, pose_of(matrix)));
      touched += of_sevens.back().volume_fraction;
    }
    const auto rows = testing::ask_on_device(on_device, scene, sevens, 7);
    const auto of_12 = testing::ask_on_device(on_device, scene, matrices, 12);
    for (int k = 0; k < kCount; ++k) {
      SCOPED_TRACE(k);
      expect_same(of_sevens[k], rows[k]);
      expect_same(of_matrices[k], of_12[k]);
    }
  }
  EXPECT_GT(touched, 0.1);
}

TEST_F(PosesOnADevice, AreAsManyAsYouLike) {
  constexpr int kCount = testing::kIsEmulated ? 3 : 40000;
  ToolQuery query(tool_, {.device = kFirst});
  std::vector<double> numbers;
  for (int k = 0; k < kCount; ++k)
    for (const double x : numbers_of(k % 97, 97)) numbers.push_back(x);
  const auto rows = testing::ask_on_device(query, {&image_, 1}, numbers, 7);
  const auto first =
      testing::ask_on_device(query, {&image_, 1}, {numbers.begin(), numbers.begin() + 7}, 7);
  ASSERT_EQ(rows.size(), kCount);
  for (int k = 0; k < kCount; k += 97) EXPECT_EQ(rows[k].volume, first[0].volume);
  EXPECT_TRUE(testing::ask_on_device(query, {&image_, 1}, {}, 7).empty());
}

// What Query::run refuses has no answer, and the poses beside it have theirs.
TEST_F(PosesOnADevice, HaveNoAnswerWhereTheyAreRefused) {
  ToolQuery query(tool_, {.device = kFirst});
  constexpr double kNone = NAN;
  const std::array<double, 16> sound{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1};
  auto mirrored = sound, nowhere = sound, far = sound, transposed = sound, scaled = sound;
  mirrored[0] = -1, nowhere[6] = kNone, far[3] = 1e40, transposed[12] = 0.5, scaled[5] = 1.1;
  std::vector<double> numbers;
  const std::array all{sound, mirrored, nowhere, far, transposed, scaled, sound};
  for (const auto& matrix : all) numbers.insert(numbers.end(), matrix.begin(), matrix.end());
  const auto rows = testing::ask_on_device(query, {&image_, 1}, numbers, 16);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    SCOPED_TRACE(k);
    const bool is_sound = k == 0 || k == 6;
    EXPECT_EQ(std::isnan(rows[k].volume), !is_sound);
    EXPECT_EQ(std::isnan(rows[k].torque.y), !is_sound);
    EXPECT_EQ(std::isnan(rows[k].unseen), !is_sound);
    EXPECT_EQ(rows[k].boundary > 0, is_sound);
  }
  const std::vector<double> too_long{0, 0, 1, 0, 0, 0, 1.5}, unknown{0, 0, 1, kNone, 0, 0, 1};
  EXPECT_TRUE(std::isnan(testing::ask_on_device(query, {&image_, 1}, too_long, 7)[0].volume));
  EXPECT_TRUE(std::isnan(testing::ask_on_device(query, {&image_, 1}, unknown, 7)[0].force.x));
}

TEST_F(PosesOnADevice, AreForAQueryOnOneDevice) {
  const auto kind_of = [&](const QueryOptions& options, const DevicePoses& poses) {
    return test::kind_of_fault([&] { ToolQuery(tool_, options).run({&image_, 1}, poses); });
  };
  EXPECT_EQ(kind_of({}, {}), ErrorKind::invalid_argument);
  EXPECT_EQ(kind_of({.device = {Device::Kind::cuda, Device::kAll}}, {}),
            ErrorKind::invalid_argument);
  EXPECT_EQ(kind_of({.device = kFirst}, {.width = 9}), ErrorKind::invalid_argument);
  const double on_the_host[7]{0, 0, 1, 0, 0, 0, 1};
  if (!testing::kIsEmulated) {
    EXPECT_EQ(kind_of({.device = kFirst}, {on_the_host, 1}), ErrorKind::invalid_argument);
  }
}

}  // namespace
}  // namespace vpm
