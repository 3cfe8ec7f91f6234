// Tests winding numbers of points against sums over all of them and against solid angles, and what
// they tell of the points themselves.
#include "libvpm/scene/points/disk_winding.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "libvpm/scene/points/prepared_points.h"
#include "tests/scene/scans.h"

namespace vpm {
namespace {

constexpr double kScanned = 0.01;  // m

struct Scan {
  Cloud cloud;
  SolidDistance distance;
};

Scan scanned_ball() {
  Scan scan{{}, [](Vec3 x) { return norm(x) - 0.2; }};
  add_ball(
      0.2, kScanned, [](Vec3) { return true; }, scan.cloud);
  return scan;
}
Scan scanned_box() {
  Scan scan{{}, [](Vec3 x) { return box_distance(x, {0.3, 0.2, 0.1}); }};
  add_box({}, {0.3, 0.2, 0.1}, 1, kScanned, scan.cloud);
  return scan;
}
Scan scanned_shell() {
  Scan scan{{}, [](Vec3 x) {
              return std::max(box_distance(x, {0.3, 0.3, 0.3}), -box_distance(x, {0.2, 0.2, 0.2}));
            }};
  add_box({}, {0.3, 0.3, 0.3}, 1, kScanned, scan.cloud);
  add_box({}, {0.2, 0.2, 0.2}, -1, kScanned, scan.cloud);
  return scan;
}
Scan scanned_torus() {
  Scan scan{{}, [](Vec3 x) { return std::hypot(std::hypot(x.x, x.y) - 0.25, x.z) - 0.1; }};
  add_torus(0.25, 0.1, kScanned, scan.cloud);
  return scan;
}
std::vector<Scan> closed_scans() {
  return {scanned_ball(), scanned_box(), scanned_shell(), scanned_torus()};
}

// Calls check(x) for places about the origin.
template <class Check>
void for_places(const Check& check) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> at(-0.45, 0.45);
  for (int k = 0; k < 1200; ++k) {
    const double x = at(random), y = at(random), z = at(random);
    check({x, y, z});
  }
}

TEST(DiskWinding, IsOneInsideOfClosedScansAndZeroOutside) {
  for (const Scan& scan : closed_scans()) {
    const PreparedPoints points(scan.cloud);
    const DiskWinding winding = points.surface().winding;
    EXPECT_TRUE(winding.may_enclose);
    int inside = 0;
    for_places([&](Vec3 x) {
      const double distance = scan.distance(x);
      if (std::fabs(distance) < 1.5 * kScanned) return;
      inside += distance < 0;
      EXPECT_NEAR(winding.at(x - points.origin()), distance < 0 ? 1 : 0, 0.1) << distance;
    });
    EXPECT_GT(inside, 40);
  }
}

// Distant groups of disks have the number of their disks.
TEST(DiskWinding, OfGroupsIsThatOfAllDisks) {
  for (const Scan& scan : closed_scans()) {
    const PreparedPoints points(scan.cloud);
    const DiskWinding winding = points.surface().winding;
    for_places([&](Vec3 x) {
      if (std::fabs(scan.distance(x)) < 1.5 * kScanned) return;
      double sum = 0;
      for (std::uint32_t i = 0; i < winding.count; ++i) {
        const Vec3 to = widen(winding.disks[i].center) - x;
        sum += dipole_angle(widen(winding.disks[i].area), to, squared_norm(to));
      }
      EXPECT_NEAR(winding.at(x), sum / kFullSolidAngle, 0.06);
    });
  }
}

// The directions that a cap of a ball takes, seen from the middle.
TEST(DiskWinding, OfAnOpenScanIsWhatItCoversOfAllDirections) {
  for (const double lowest : {-0.5, 0.0, 0.5, 0.9}) {
    Cloud cap;
    add_ball(
        0.2, 0.5 * kScanned, [&](Vec3 n) { return n.z > lowest; }, cap);
    const PreparedPoints points(cap);
    EXPECT_NEAR(points.surface().winding.at(Vec3{} - points.origin()), 0.5 * (1 - lowest), 0.07)
        << lowest;
  }
}

TEST(DiskWinding, OfAWallSeenFromOneSideEnclosesNothing) {
  for (const double bend : {0.0, -0.5}) {  // 1/m; negative: hollow to whoever sees it
    Cloud wall;
    for (int i = -40; i <= 40; ++i) {
      for (int k = -40; k <= 40; ++k) {
        const double x = kScanned * i, y = kScanned * k;
        add_point({x, y, -bend * (x * x + y * y)}, {2 * bend * x, 2 * bend * y, 1}, kScanned, wall);
      }
    }
    EXPECT_FALSE(PreparedPoints(wall).surface().winding.may_enclose);
  }
}

// Two boxes that were each scanned as a whole: what of one lies in the other bounds nothing.
TEST(DiskWinding, TellsFacesThatLieInsideOfAnotherSolid) {
  const Vec3 half{0.2, 0.2, 0.2}, first{-0.1, 0, 0}, second{0.1, 0.05, 0.03};
  Cloud boxes;
  add_box(first, half, 1, kScanned, boxes);
  add_box(second, half, 1, kScanned, boxes);
  const PreparedPoints points(boxes);
  std::size_t inner = 0;
  for (const Vec3f& p : boxes.positions) {
    const Vec3 x = widen(p);
    const double depth = std::min(box_distance(x - first, half), box_distance(x - second, half));
    inner += depth < -1e-6;
  }
  EXPECT_GT(inner, boxes.size() / 10);
  EXPECT_NEAR(static_cast<double>(points.inner()), static_cast<double>(inner), 0.03 * inner);
  for (const Vec3f& p : points.positions()) {
    const Vec3 x = widen(p) + points.origin();
    EXPECT_GT(std::min(box_distance(x - first, half), box_distance(x - second, half)),
              -2 * kScanned);
  }
}

}  // namespace
}  // namespace vpm
