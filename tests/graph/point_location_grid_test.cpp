#include "libvpm/graph/point_location_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/graph/test_packing.h"

namespace vpm {
namespace {

bool lists(const PointLocationGrid& grid, Vec3 p, std::uint32_t sphere) {
  const double x = std::floor((p.x - grid.low.x) / grid.cell);
  const double y = std::floor((p.y - grid.low.y) / grid.cell);
  const double z = std::floor((p.z - grid.low.z) / grid.cell);
  if (x < 0 || y < 0 || z < 0 || x >= grid.nx || y >= grid.ny || z >= grid.nz) return false;
  const std::size_t cell =
      (static_cast<std::size_t>(z) * grid.ny + static_cast<std::size_t>(y)) * grid.nx +
      static_cast<std::size_t>(x);
  return std::binary_search(grid.spheres.begin() + grid.begin[cell],
                            grid.spheres.begin() + grid.begin[cell + 1], sphere);
}

void expect_found(const std::vector<Sphere>& spheres) {
  const PointLocationGrid grid = build_point_location_grid(spheres);
  test::Numbers numbers(1);
  for (std::uint32_t i = 0; i < spheres.size(); ++i) {
    for (int k = 0; k < 20; ++k) {
      const Vec3 p =
          spheres[i].center + numbers.uniform(0.9, 1) * spheres[i].radius * numbers.direction();
      ASSERT_TRUE(lists(grid, p, i)) << "sphere " << i;
    }
    for (const Vec3 axis : {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
      EXPECT_TRUE(lists(grid, spheres[i].center + spheres[i].radius * axis, i));
      EXPECT_TRUE(lists(grid, spheres[i].center - spheres[i].radius * axis, i));
    }
  }
}

TEST(PointLocationGrid, FindsEverySphereOfAPacking) {
  const Packing packing = test::greedy_packing(test::cube(), 500, 40000);
  expect_found(packing.spheres);
  const PointLocationGrid grid = build_point_location_grid(packing.spheres);
  const double cells = static_cast<double>(grid.begin.size() - 1);
  EXPECT_GE(cells, 2 * 500);
  EXPECT_LE(cells, 8 * 500);
}

TEST(PointLocationGrid, HoldsFarFromTheOrigin) {
  Packing packing = test::greedy_packing(test::cube(), 100, 8000);
  for (Sphere& s : packing.spheres) s.center += Vec3{1e7, -1e7, 3e6};
  expect_found(packing.spheres);
}

TEST(PointLocationGrid, TakesNeedlesAndSizesFrom1To1e4) {
  std::vector<Sphere> needle{{{0, 0, 0}, 1}};
  for (int k = 0; k < 300; ++k) needle.push_back({{2.0 + 0.001 * k, 0, 0}, 1e-4});
  expect_found(needle);
  std::vector<Sphere> row;
  for (int k = 0; k < 1000; ++k) row.push_back({{0, 0.002 * k, 0}, 0.001});
  expect_found(row);
  EXPECT_LE(build_point_location_grid(row).begin.size(), 10000u);
  expect_found({{{5, 5, 5}, 0.25}});
}

}  // namespace
}  // namespace vpm
