// Coherent poses that reuse surface readings.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"
#include "libvpm/haptics/rotation_vector.h"
#include "libvpm/query/cell_samples.h"
#include "libvpm/query/query.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

using testing::generic_rotation;
using testing::lattice_cube;
using testing::see;

constexpr double kEdge = 0.1;

QueryOptions reusing(double reuse) {
  QueryOptions options;
  options.coherent = true;
  options.reuse = reuse;
  return options;
}

// Returns poses by steps of this length about a pose in the middle of the contact with a wall at 1
// m, turning.
std::vector<Pose> wandering(double step, int poses) {
  constexpr double kRadius = 0.012;
  std::vector<Pose> path;
  for (int k = 0; k < poses; ++k) {
    const double t = k * step / kRadius;
    path.push_back(
        {rotation_from_vector(0.3 * std::sin(0.2 * t) * Vec3{0.6, -0.64, 0.48}) *
             generic_rotation(),
         Vec3{0.01, -0.008, 0.97} + kRadius * Vec3{std::sin(t), std::cos(t), std::sin(0.7 * t)}});
  }
  return path;
}

struct Differences {
  double volume = 0, force = 0,
         torque = 0;  // largest ones, relative to the tool's volume and reach
  int same_bits = 0;
};

Differences differences(const ToolModel& tool, const PreparedCloud& cloud, double reuse,
                        const std::vector<Pose>& path) {
  Query query(tool, reusing(reuse)), alone(tool, {});
  Differences largest;
  for (const Pose& pose : path) {
    const Result a = query.run(cloud, pose), b = alone.run(cloud, pose);
    EXPECT_EQ(a.points, b.points);
    const auto grow = [](double& most, double difference) {
      most = std::max(most, std::abs(difference));
    };
    grow(largest.volume, a.volume_fraction - b.volume_fraction);
    grow(largest.force, norm(a.wrench.force - b.wrench.force) / tool.volume);
    grow(largest.torque, norm(a.wrench.torque - b.wrench.torque) / tool.volume / tool.reach);
    largest.same_bits += a == b;
  }
  return largest;
}

// On a plane the error of the first order is of second order: about a quarter for half the way. It
// is a small part of the volume that may pass the surface on the way.
TEST(Reuse, ErrsByTheSecondOrder) {
  const PreparedCloud cloud(see(synthetic::make_scene("wall")));
  const ToolModel tool = lattice_cube(kEdge, 12, 2);
  constexpr double kWay = 0.004;
  const double passing = kWay * 1.8 * kEdge * kEdge / tool.volume;  // at most a cut of the cube
  const std::vector<Pose> path = wandering(kWay / 16, 1500);
  const Differences far = differences(tool, cloud, kWay, path),
                    near = differences(tool, cloud, kWay / 2, path);
  EXPECT_LT(far.volume, 0.03 * passing);
  EXPECT_LT(far.force, 0.03 * passing);
  EXPECT_LT(far.torque, 0.03 * passing);
  EXPECT_GT(far.volume, 1e-6 * passing);
  EXPECT_LT(near.volume, 0.4 * far.volume);
  EXPECT_LT(near.force, 0.4 * far.force);
  EXPECT_LT(near.torque, 0.4 * far.torque);
}

TEST(Reuse, HasTheBitsOfThePoseAloneWhereNothingIsUsedAgain) {
  const PreparedCloud cloud(see(synthetic::make_scene("groove")));
  const ToolModel tool = lattice_cube(kEdge, 12, 2);
  const std::vector<Pose> path = wandering(0.001, 100);
  EXPECT_EQ(differences(tool, cloud, 0.0009, path).same_bits, 100);
  EXPECT_LT(differences(tool, cloud, 0.003, path).same_bits, 50);
}

TEST(Reuse, HasTheSameBitsWhereTheToolStands) {
  const PreparedCloud cloud(see(synthetic::make_scene("groove")));
  const ToolModel tool = lattice_cube(kEdge, 12, 2);
  const std::vector<Pose> path(50, wandering(0.001, 10).back());
  EXPECT_EQ(differences(tool, cloud, 0.003, path).same_bits, 50);
}

TEST(Reuse, EndsWithTheFrameAndWhereThePosesEnd) {
  const ToolModel tool = lattice_cube(kEdge, 12, 2);
  const std::vector<Pose> path = wandering(0.0005, 60);
  Query query(tool, reusing(0.003)), alone(tool, {});
  const Cloud wall = see(synthetic::make_scene("wall"));
  PreparedCloud cloud(wall);
  int others = 0;
  for (std::size_t k = 0; k < path.size(); ++k) {
    if (k % 20 == 0) cloud = PreparedCloud(wall);
    if (k % 20 == 10) query.forget();
    const bool same = query.run(cloud, path[k]) == alone.run(cloud, path[k]);
    EXPECT_TRUE(same || k % 10 != 0) << k;
    others += !same;
  }
  EXPECT_GT(others, 40);
}

// Free space is checked at every pose.
TEST(Reuse, MissesNoNewContact) {
  const PreparedCloud cloud(see(synthetic::make_scene("wall")));
  const ToolModel tool = lattice_cube(kEdge, 12, 2);
  Query query(tool, reusing(0.004)), alone(tool, {});
  int touches = 0;
  for (double z = 0.9; z < 0.95; z += 0.0001) {
    const Pose pose{generic_rotation(), {0, 0, z}};
    const Result a = query.run(cloud, pose), b = alone.run(cloud, pose);
    touches += b.volume > 0;
    EXPECT_EQ(a.volume > 0, b.volume > 0) << z;
  }
  EXPECT_GT(touches, 100);
}

TEST(Reuse, KeepsInsideWhatHasPassedTheSurface) {
  const PreparedCloud cloud(see(synthetic::make_scene("wall")));
  const ToolModel tool = lattice_cube(kEdge, 12, 2);
  Query query(tool, reusing(0.004));
  const auto run = [&](double z) { return query.run(cloud, {generic_rotation(), {0, 0, z}}); };
  const auto expect_inside_behind = [&](double z) {
    const double volume_fraction = run(z).volume_fraction;
    EXPECT_TRUE(z < 1 + tool.reach || std::abs(volume_fraction - 1) < 1e-12) << z;
  };
  for (double z = 0.85; z < 1.5; z += 0.0007) expect_inside_behind(z);
  for (double z = 1.5; z > 0.85; z -= 0.0007) expect_inside_behind(z);
  EXPECT_EQ(run(0.85).volume, 0);
}

TEST(Reuse, HasTheSameBitsForAnyNumberOfThreads) {
  const PreparedCloud cloud(see(synthetic::make_scene("groove")));
  const ToolModel tool = lattice_cube(kEdge, 16, 2);
  const std::vector<Pose> path = wandering(0.0005, 100);
  std::vector<Result> results[2];
  for (const int threads : {1, 3}) {
    set_thread_count(threads);
    Query query(tool, reusing(0.003));
    for (const Pose& pose : path) results[threads / 2].push_back(query.run(cloud, pose));
  }
  set_thread_count(0);
  EXPECT_TRUE(results[0] == results[1]);
}

// The flood needs all readings.
TEST(Reuse, IsNotForPointsWithoutACamera) {
  const PreparedCloud cloud(without_camera(see(synthetic::make_scene("wall"))));
  const ToolModel tool = lattice_cube(kEdge, 6, 2);
  EXPECT_EQ(differences(tool, cloud, 0.003, wandering(0.0005, 20)).same_bits, 20);
}

TEST(Reuse, IsRefusedWhereItMeansNothing) {
  const ToolModel tool = lattice_cube(kEdge, 2, 2);
  QueryOptions alone = reusing(0.001);
  alone.coherent = false;
  for (const QueryOptions& options : {alone, reusing(-0.001), reusing(std::nan("")),
                                      reusing(1.01 * QueryOptions::kMostReuse * tool.reach)}) {
    try {
      const Query query(tool, options);
      FAIL() << options.reuse;
    } catch (const Error& fault) {
      EXPECT_EQ(fault.kind(), ErrorKind::usage);
    }
  }
}

// Cuts samples by planes, seen by a tool that moves. The difference quotient of small motions to
// both sides errs by the third order.
TEST(ContactSlopes, AreTheDerivatives) {
  std::mt19937 numbers(7);
  const auto between = [&](double a, double b) {
    return a + (b - a) * static_cast<double>(numbers()) / static_cast<double>(numbers.max());
  };
  const auto place = [&](double range) {
    return Vec3{between(-range, range), between(-range, range), between(-range, range)};
  };
  constexpr double kReach = 0.25, kSmall = 1e-6;
  struct Sums {
    double part = 0;
    Vec3 force, torque;
  };
  for (int round = 0; round < 50; ++round) {
    std::vector<CellSample> samples;
    for (int k = 0; k < 37; ++k)
      samples.push_back(
          {narrow(place(0.2)), static_cast<float>(between(0.01, 0.05)), between(0, 0.01)});
    const TangentPlane planes[2] = {{normalized_or_zero(place(1)), place(0.05)},
                                    {normalized_or_zero(place(1)), place(0.05)}};
    const Vec3 pushed = place(0.1), arm = place(1), pushed_along = normalized_or_zero(place(1));
    ContactSlopes slopes;
    // The surface moves in the tool's frame.
    const auto sums = [&](const SmallMotion& motion, bool notes) {
      const Rotation turn = rotation_from_vector(motion.turn);
      Sums all;
      for (const TangentPlane& plane : planes) {
        const CrossingPlane moved({turn * plane.normal, turn * plane.foot + kReach * motion.shift},
                                  Pose{});
        CrossedSlopes of_plane;
        const CrossedSums crossed = crossed_sums(moved, samples, of_plane);
        if (notes) slopes.add_crossed(moved.normal, crossed, of_plane, 1 / kReach);
        all.part += crossed.weight;
        all.force += crossed.weight * moved.normal;
        all.torque += 1 / kReach * cross(crossed.moment, moved.normal);
      }
      const Vec3 force = norm(pushed) * (turn * pushed_along);
      if (notes) slopes.add_pushed(force, arm);
      all.force += force;
      all.torque += cross(arm, force);
      return all;
    };
    const Sums here = sums({}, true);
    const SmallMotion motion{place(1), place(1)},
        there{kSmall * motion.shift, kSmall * motion.turn},
        back{-kSmall * motion.shift, -kSmall * motion.turn};
    const Sums after = sums(there, false), before = sums(back, false);
    const SumChange change = slopes.change(motion, here.force);
    const auto slope = [](auto a, auto b) { return (0.5 / kSmall) * (a - b); };
    EXPECT_NEAR(change.part, slope(after.part, before.part), 1e-7);
    EXPECT_LE(norm(change.force - slope(after.force, before.force)), 1e-7);
    EXPECT_LE(norm(change.torque - slope(after.torque, before.torque)), 1e-7);
    EXPECT_GT(norm(change.torque), 1e-3);
    EXPECT_LE(std::abs(change.part), slopes.most_passing(norm(motion.shift) + norm(motion.turn)));
  }
}

}  // namespace
}  // namespace vpm
