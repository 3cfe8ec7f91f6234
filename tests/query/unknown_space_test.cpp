// What points without a camera know of a tool: outside, or unknown where the scan is open, beside
// the volume.

#include <gtest/gtest.h>
#include <vpm/query_types.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "libvpm/core/parallel.h"
#include "libvpm/model/solid.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/scene/points/points_body.h"
#include "tests/query/expect_equal.h"
#include "tests/query/lattice_model.h"
#include "tests/scene/scans.h"

namespace vpm {
namespace {

using testing::generic_rotation;
using testing::lattice_cube;

constexpr double kTableSpacing = 0.01, kCubeAtScan = 0.1;  // m

double all_parts_of(const Result& r) {
  return r.volume_fraction + r.visibility->seen_free + r.visibility->unseen +
         r.visibility->out_of_view;
}
bool is_all_free(const Result& r) {
  return r.visibility && r.visibility->seen_free == 1 && r.volume == 0;
}

// Returns a table top about the origin that was scanned from above: a square in the plane z = 0.
constexpr double kHalfTable = 0.3;
Cloud table_top() {
  Cloud cloud;
  const auto many = static_cast<int>(std::lround(2 * kHalfTable / kTableSpacing));
  for (int i = 0; i < many; ++i)
    for (int k = 0; k < many; ++k)
      add_point({(i + 0.5) * kTableSpacing - kHalfTable, (k + 0.5) * kTableSpacing - kHalfTable, 0},
                {0, 0, 1}, kTableSpacing, cloud);
  return cloud;
}
// Returns the part of all directions in which it is seen from a place below it; 0 above.
double part_of_table(Vec3 x) {
  if (x.z >= 0) return 0;
  double sum = 0;
  for (const double a : {kHalfTable - x.x, kHalfTable + x.x})
    for (const double b : {kHalfTable - x.y, kHalfTable + x.y})
      sum += std::atan(a * b / (-x.z * std::sqrt(a * a + b * b + x.z * x.z)));
  return sum / (16 * std::atan(1.0));
}

template <class IsSeen>
AnyBody ball_scanned(const IsSeen& is_seen) {
  Cloud cloud;
  add_ball(0.3, kTableSpacing, is_seen, cloud);
  return AnyBody(PointsBody(cloud));
}
AnyBody box_scanned(double side) {
  Cloud cloud;
  add_box({}, {0.3, 0.3, 0.3}, side, kTableSpacing, cloud);
  return AnyBody(PointsBody(cloud));
}

// Inside and outside of what points show from all sides nothing is unknown, cut by it or not.
TEST(UnknownSpace, IsNowhereAboutClosedScans) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> at(-0.5, 0.5);
  Cloud plate, torus, noisy;
  add_ball(
      0.3, kTableSpacing, [](Vec3) { return true; }, noisy);
  std::normal_distribution<double> noise(0, 0.15);  // of normals, and in spacings
  for (std::size_t k = 0; k < noisy.size(); ++k) {
    const Vec3 n = widen(noisy.normals[k]), off{noise(random), noise(random), noise(random)};
    noisy.positions[k] = narrow(widen(noisy.positions[k]) + kTableSpacing * noise(random) * n);
    noisy.normals[k] = narrow(normalized_or_zero(n + off));
  }
  add_box({}, {0.3, 0.3, 0.02}, 1, kTableSpacing, plate);
  add_torus(0.3, 0.12, kTableSpacing, torus);
  for (const AnyBody& body :
       {ball_scanned([](Vec3) { return true; }), box_scanned(1), AnyBody(PointsBody(plate)),
        AnyBody(PointsBody(torus)), AnyBody(PointsBody(noisy)),
        AnyBody(PointsBody(noisy, Denoising::off))}) {
    for (const ToolModel& tool :
         {lattice_cube(kCubeAtScan, 5, 3), lattice_cube(2 * kCubeAtScan, 12, 1)}) {
      ToolQuery query(tool, {});
      for (int k = 0; k < 100; ++k) {
        const double x = at(random), y = at(random), z = at(random);
        const Result r = query.run(body, {generic_rotation(), {x, y, z}});
        ASSERT_TRUE(r.visibility);
        EXPECT_EQ(r.visibility->unseen, 0) << x << ' ' << y << ' ' << z;
        EXPECT_EQ(r.visibility->out_of_view, 0);
        EXPECT_NEAR(all_parts_of(r), 1, 1e-9);
        if (r.volume == 0) {
          EXPECT_EQ(collides(r), Collides::no);
        }
      }
    }
  }
}

// Below a table top a place is unknown as long as the top fills a quarter of all directions, beside
// and above it never. Where that ends the tool, which no disk touches, is decided as one.
TEST(UnknownSpace, IsBehindWhatWasScannedFromOneSide) {
  const AnyBody body{PointsBody(table_top())};
  const std::vector<Vec3> places = testing::places_in_cube(kCubeAtScan, 16);
  for (const ToolModel& tool :
       {lattice_cube(kCubeAtScan, 5, 3), lattice_cube(kCubeAtScan, 10, 1)}) {
    ToolQuery query(tool, {});
    double least = 1, most = 0;
    for (const double x : {0.0, 0.13, 0.4, 2.0}) {
      for (double z = -0.8; z < 0.8; z += 0.02) {
        const Pose pose{generic_rotation(), {x, 0.02, z}};
        double expected = 0;
        for (const Vec3& place : places)
          expected +=
              (part_of_table(pose * place) > 0.25 ? 1.0 : 0.0) / static_cast<double>(places.size());
        const Result r = query.run(body, pose);
        ASSERT_TRUE(r.visibility);
        SCOPED_TRACE(::testing::Message() << x << ' ' << z);
        EXPECT_NEAR(all_parts_of(r), 1, 1e-9);
        if (r.volume > 0) {  // what hangs together with the cut counts
          EXPECT_NEAR(r.visibility->unseen, 0, 0.05);
          continue;
        }
        const double now = r.visibility->unseen;
        least = std::min(least, now), most = std::max(most, now);
        if (expected == 0 || expected == 1) {
          EXPECT_NEAR(now, expected, 0.02);
        }
      }
    }
    EXPECT_EQ(least, 0);
    EXPECT_NEAR(most, 1, 1e-9);
  }
}

// However near below it lies.
TEST(UnknownSpace, BeginsAtTheBackOfTheScan) {
  const AnyBody body{PointsBody(table_top())};
  const ToolModel tool = lattice_cube(kCubeAtScan, 5, 3);
  ToolQuery query(tool, {});
  const double top = 0.5 * kCubeAtScan;
  for (const double gap : {0.006, 0.01, 0.02, 0.05}) {
    const Result below = query.run(body, {{}, {0.01, 0.02, -top - gap}});
    EXPECT_EQ(below.volume, 0) << gap;
    EXPECT_NEAR(below.visibility->unseen, 1, 1e-9) << gap;
    EXPECT_EQ(collides(below), Collides::unknown);
    const Result above = query.run(body, {{}, {0.01, 0.02, top + gap}});
    EXPECT_TRUE(is_all_free(above)) << gap;
    EXPECT_EQ(collides(above), Collides::no);
  }
}

// The upper half of a ball tells what is in it, not how far it goes on below.
TEST(UnknownSpace, IsBelowHalfABall) {
  const AnyBody half = ball_scanned([](Vec3 n) { return n.z > 0; });
  const ToolModel tool = lattice_cube(kCubeAtScan, 5, 3);
  ToolQuery query(tool, {});
  const Result in = query.run(half, {{}, {0, 0, 0.15}}),
               below = query.run(half, {{}, {0, 0, -0.06}}),
               aside = query.run(half, {{}, {0.4, 0, 0.1}}),
               far = query.run(half, {{}, {0, 0, -0.6}});
  EXPECT_NEAR(in.volume_fraction, 1, 0.01);
  EXPECT_EQ(in.visibility->unseen, 0);
  EXPECT_EQ(below.volume, 0);
  EXPECT_NEAR(below.visibility->unseen, 1, 1e-9);
  EXPECT_TRUE(is_all_free(aside));
  EXPECT_TRUE(is_all_free(far));
  for (const double far_away : {3.0, 100.0, 1e4})
    EXPECT_TRUE(is_all_free(query.run(half, {{}, {0.3, far_away, -far_away}})));
}

// A scanned room is free inside, and nobody knows what is behind its walls.
TEST(UnknownSpace, IsBehindTheWallsOfARoom) {
  const AnyBody room = box_scanned(-1);
  const ToolModel tool = lattice_cube(kCubeAtScan, 5, 3);
  ToolQuery query(tool, {});
  EXPECT_TRUE(is_all_free(query.run(room, Pose{})));
  EXPECT_TRUE(is_all_free(query.run(room, {generic_rotation(), {0.2, -0.2, 0.2}})));
  for (const double x : {0.37, 0.5, 2.0}) {
    const Result behind = query.run(room, {{}, {x, 0.02, 0.03}});
    EXPECT_EQ(behind.volume, 0) << x;
    EXPECT_NEAR(behind.visibility->unseen, 1, 1e-9) << x;
  }
}

// Any number of threads finds the same bits, and points as measured tell as much.
TEST(UnknownSpace, HasTheSameBitsWithAnyThreads) {
  const AnyBody body{PointsBody(table_top())}, raw{PointsBody(table_top(), Denoising::off)};
  const ToolModel tool = lattice_cube(kCubeAtScan, 12, 1);
  double unknown = 0;
  for (const AnyBody& points : {body, raw}) {
    for (double z = -0.3; z < 0.1; z += 0.03) {
      const Pose pose{generic_rotation(), {0.25, 0.1, z}};
      std::vector<Result> of_threads;
      for (const int threads : {1, 3}) {
        set_thread_count(threads);
        of_threads.push_back(ToolQuery(tool, {}).run(points, pose));
      }
      set_thread_count(1);
      testing::expect_equal(of_threads[0], of_threads[1]);
      unknown += of_threads[0].visibility->unseen;
    }
  }
  EXPECT_GT(unknown, 1);
}

// Two clouds are two bodies, of which one may know what the other does not: nothing is told.
TEST(UnknownSpace, IsToldOfOneCloud) {
  const AnyBody table{PointsBody(table_top())}, ball = ball_scanned([](Vec3) { return true; });
  const ToolModel tool = lattice_cube(kCubeAtScan, 5, 3);
  ToolQuery query(tool, {});
  const Pose below{{}, {0, 0, -0.1}};
  EXPECT_TRUE(query.run(table, below).visibility);
  EXPECT_FALSE(query.run(std::array{table, ball}, below).visibility);
  QueryOptions paper;
  paper.measure = Measure::paper;
  EXPECT_FALSE(ToolQuery(tool, paper).run(table, below).visibility);
  for (const double limit : {0.0, 0.02, 1.0})
    EXPECT_EQ(query.collides(std::span(&table, 1), below, limit, {}),
              limit < 1 ? Collides::unknown : Collides::no);
  EXPECT_EQ(query.collides(std::span(&table, 1), Pose{}, 0.02, {}), Collides::yes);
  EXPECT_EQ(query.collides(std::span(&ball, 1), {{}, {0.5, 0, 0}}, 0, {}), Collides::no);
}

}  // namespace
}  // namespace vpm
