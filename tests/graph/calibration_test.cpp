#include "libvpm/graph/calibration.h"

#include <gtest/gtest.h>

#include "libvpm/backend/cell_clusters.h"
#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"
#include "libvpm/graph/build_tool_model.h"
#include "libvpm/measure/tool_piece.h"
#include "libvpm/model/tool_model.h"
#include "tests/graph/test_packing.h"

namespace vpm {
namespace {

struct Made {
  Packing packing;
  ToolModel model;
};

const Made& octahedron() {
  static const Made kMade = [] {
    Made made{test::greedy_packing(test::octahedron(), 600, 40000), {}};
    GraphOptions options;
    options.levels = {10, 60};
    made.model = build_tool_model(made.packing, options);
    made.model.calibration = calibrate(made.model, made.packing.solid);
    return made;
  }();
  return kMade;
}

TEST(Calibration, FallsWithTheNumberOfSpheres) {
  const std::vector<LevelError>& levels = octahedron().model.calibration;
  ASSERT_EQ(levels.size(), 3u);
  for (std::size_t k = 0; k < levels.size(); ++k) {
    EXPECT_LE(levels[k].mean, levels[k].p95);
    EXPECT_LE(levels[k].p95, levels[k].worst);
    if (k == 0) continue;
    EXPECT_LT(levels[k].mean, 0.7 * levels[k - 1].mean);
    EXPECT_LT(levels[k].worst, levels[k - 1].worst);
  }
  EXPECT_LT(levels.back().worst, 2e-3);
}

// Uses cuts that the calibration has not seen, by planes of another random source.
TEST(Calibration, HoldsForOtherCuts) {
  const Made& made = octahedron();
  test::Numbers numbers(7);
  for (std::size_t k = 0; k < made.model.levels.size(); ++k) {
    double mean = 0, worst = 0;
    constexpr int kCuts = 300;
    for (int cut = 0; cut < kCuts; ++cut) {
      const Vec3 normal = numbers.direction();
      const double offset = numbers.uniform(-0.9, 0.9) * made.model.radius;
      double sum = 0;
      const NumberedSamples numbered = numbered_samples(made.model.levels[k]);
      for (const CellSample& s : numbered.samples) {
        const double height = dot(normal, widen(s.center)) - offset;
        sum += s.weight * fraction_behind(shape_of(s, numbered.faces()), height, normal);
      }
      const double truth = test::volume_below(made.packing.solid, normal,
                                              offset + dot(normal, made.model.center_of_mass)) /
                           made.model.volume;
      mean += std::abs(sum - truth) / kCuts;
      worst = std::max(worst, std::abs(sum - truth));
    }
    EXPECT_LE(worst, 1.2 * made.model.calibration[k].worst);
    EXPECT_LE(mean, 1.5 * made.model.calibration[k].mean);
  }
}

TEST(Calibration, SameBitsForAnyThreads) {
  const Made& made = octahedron();
  set_thread_count(3);
  const std::vector<LevelError> again = calibrate(made.model, made.packing.solid);
  set_thread_count(0);
  for (std::size_t k = 0; k < again.size(); ++k) {
    EXPECT_EQ(again[k].mean, made.model.calibration[k].mean);
    EXPECT_EQ(again[k].worst, made.model.calibration[k].worst);
  }
}

TEST(Calibration, RefusesAnotherSolid) {
  const Made& made = octahedron();
  EXPECT_THROW(calibrate(made.model, test::cube().solid), Error);
}

TEST(Samples, FollowTheNumberOfSpheres) {
  const ToolModel& model = octahedron().model;
  for (const Level& level : model.levels) {
    const double each = static_cast<double>(level.samples.size()) / level.sphere_count;
    EXPECT_GT(each, 30);
    EXPECT_LT(each, 120);
  }
  EXPECT_EQ(samples_per_length(1000), kMaxSamplesPerLength);
  EXPECT_EQ(samples_per_length(1000000), kMaxSamplesPerLength);
  EXPECT_EQ(samples_per_length(1), kMinSamplesPerLength);
}

}  // namespace
}  // namespace vpm
