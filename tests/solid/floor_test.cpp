// Small solids on much larger ones, as on a floor: what they share is as right as of solids alike
// in size, wherever they stand on it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "libvpm/synthetic/shapes.h"
#include "tests/refusal.h"
#include "tests/solid/pair_cases.h"

namespace vpm {
namespace {

using synthetic::make_box;
using synthetic::make_icosphere;
using synthetic::make_tetrahedron;
using test::at;
using test::surface;

// A large solid, convex parts of which it is made, and places on its surface with outward normals.
struct Floor {
  std::string name;
  Solid solid;
  std::vector<Solid> parts;
  std::vector<Vec3> places;
};

// A box, with places in the middle of a face, beside its corners, on an edge and at a corner.
Floor box_floor(const std::string& name, Vec3 edges) {
  const auto [x, y, z] = 0.5 * edges;
  const Solid box = make_box(edges.x, edges.y, edges.z);
  return {name,
          box,
          {box},
          {{.11 * x, .23 * y, z},
           {.9999 * x, -.9998 * y, z},
           {x, .3 * y, z},
           {x, y, z},
           {-x, .4 * y, -.2 * z}}};
}

// Returns a block whose top is uneven ground, of n x n squares of two triangles each. Small solids
// are put on it at places in a face, on a ridge between two and at a vertex.
Floor ground(double edge, std::uint32_t n) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> height(-.02 * edge, .02 * edge);
  Floor floor{"ground", {}, {}, {}};
  std::vector<Vec3>& v = floor.solid.vertices;
  for (int side = 0; side < 2; ++side)
    for (std::uint32_t k = 0; k < (n + 1) * (n + 1); ++k)
      v.push_back({edge * (double(k % (n + 1)) / n - .5), edge * (double(k / (n + 1)) / n - .5),
                   side == 0 ? height(random) : -.2 * edge});
  const std::uint32_t below = (n + 1) * (n + 1);
  const auto wall = [&](std::uint32_t p, std::uint32_t q) {
    floor.solid.triangles.push_back({p, p + below, q});
    floor.solid.triangles.push_back({q, p + below, q + below});
  };
  for (std::uint32_t j = 0; j < n; ++j) {
    wall(j, j + 1), wall((n + 1) * n + j + 1, (n + 1) * n + j);
    wall((n + 1) * (j + 1), (n + 1) * j), wall((n + 1) * j + n, (n + 1) * (j + 1) + n);
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = (n + 1) * j + i, b = a + 1, c = a + n + 1, d = c + 1;
      for (const Triangle& t : {Triangle{a, b, d}, Triangle{a, d, c}}) {
        floor.solid.triangles.push_back(t);
        floor.solid.triangles.push_back({t[0] + below, t[2] + below, t[1] + below});
        Solid part;
        for (const std::uint32_t k : {t[0], t[1], t[2], t[0] + below, t[1] + below, t[2] + below})
          part.vertices.push_back(v[k]);
        part.triangles = {{0, 1, 2}, {3, 5, 4}, {0, 3, 1}, {1, 3, 4},
                          {1, 4, 2}, {2, 4, 5}, {2, 5, 0}, {0, 5, 3}};
        floor.parts.push_back(part);
      }
    }
  }
  const std::uint32_t a = (n + 1) * (n - 1) + n - 1, d = a + n + 2, b = a + 1;
  floor.places = {(v[a] + v[b] + v[d]) / 3, .4 * v[a] + .6 * v[d], v[a]};
  return floor;
}

std::vector<Floor> floors(double edge) {
  return {box_floor("box", {edge, edge, edge}),
          box_floor("plate", {edge, .7 * edge, .01 * edge}),
          ground(edge, 6),
          {"ball",
           make_icosphere(edge / 2, 2),
           {make_icosphere(edge / 2, 2)},
           {make_icosphere(edge / 2, 2).vertices[7], make_icosphere(edge / 2, 2).vertices[90]}}};
}

double truth_of(const Floor& floor, Vec3 place, const Solid& small) {
  double sum = 0;
  for (const Solid& part : floor.parts)
    sum += test::convex_intersection(small, test::moved(part, at(-place))).volume;
  return sum;
}

Solid scaled(Solid solid, double s) {
  for (Vec3& v : solid.vertices) v = s * v;
  return solid;
}

class OnAFloor : public testing::TestWithParam<double> {};

TEST_P(OnAFloor, WhatASmallSolidSharesIsRight) {
  std::mt19937_64 random(3);
  const double size = std::max(.1, GetParam() / 5e4);  // up to 10^5 : 1
  const Solid smalls[]{make_box(size, size, size), make_box(size, .8 * size, .1 * size),
                       make_tetrahedron(size), make_icosphere(size / 2, 1)};
  for (const Floor& floor : floors(GetParam())) {
    SCOPED_TRACE(floor.name);
    const auto large = surface(floor.solid);
    int met = 0;
    for (const Solid& small : smalls) {
      const auto own = surface(small);
      SolidPair pair(own, large), turned(large, own);
      for (std::size_t k = 0; k < 2 * floor.places.size(); ++k) {
        const Vec3 place = floor.places[k / 2];
        const Pose stands = test::random_pose(random, k % 2 == 0 ? .1 : 1000),
                   beside = test::random_pose(random, .04),
                   pose = stands * Pose{beside.rotation, beside.translation + place};
        const auto truth_at = [&](Vec3 by) {
          return truth_of(floor, place,
                          test::moved(small, {beside.rotation, beside.translation + by}));
        };
        const SharedSolid shared = pair.measure(pose, stands, false),
                          other = turned.measure(stands, pose, false);
        // The jitter moves the floor's faces, which matters to thin solids on the largest ones.
        const double moved = std::sqrt(3.0) / 2 * SolidSurface::kJitter * large->reach();
        ASSERT_NEAR(shared.volume, truth_at({}),
                    std::max(1e-6 * own->volume(), moved * own->area() / 2))
            << k;
        ASSERT_LE(shared.closure, SolidPair::kMaxClosure);
        ASSERT_EQ(shared.volume, other.volume);
        ASSERT_EQ(norm(shared.area + other.area) + norm(shared.centroid - other.centroid), 0);
        if (shared.volume < 1e-3 * own->volume()) continue;
        ++met;
        const Vec3 area = transpose(stands.rotation) * shared.area;
        constexpr double kStep = 1e-5;
        EXPECT_NEAR(area.z, (truth_at({0, 0, kStep}) - truth_at({0, 0, -kStep})) / (2 * kStep),
                    1e-4 * own->area())
            << k;
        EXPECT_NEAR(area.x, (truth_at({kStep, 0, 0}) - truth_at({-kStep, 0, 0})) / (2 * kStep),
                    1e-4 * own->area())
            << k;
      }
    }
    EXPECT_GE(met, 8);
  }
}

// Below a face the depth is that of a half-space: the force is the volume along the normal and
// acts at the centroid.
TEST_P(OnAFloor, ForcesAreThoseOfAHalfSpace) {
  std::mt19937_64 random(4);
  const double edge = GetParam();
  const auto large = surface(make_box(edge, .8 * edge, .3 * edge), true);
  const double size = std::max(.1, edge / 5e4);
  for (const Solid& small : {make_box(size, size, size), make_icosphere(size / 2, 2)}) {
    const auto own = surface(small, true);
    SolidPair pair(own, large);
    for (int k = 0; k < 8; ++k) {
      const Pose stands = test::random_pose(random, 10);
      Pose beside = test::random_pose(random, .03);
      beside.translation += Vec3{-.31 * edge, .21 * edge, .15 * edge};
      const SharedSolid s = pair.measure(stands * beside, stands, true, 4);
      const Vec3 expected = s.volume * (stands.rotation * Vec3{0, 0, 1});
      EXPECT_NEAR(norm(s.force - expected), 0, 1e-6 * own->volume());
      EXPECT_NEAR(norm(s.torque), 0, 1e-6 * own->volume() * own->reach());
      ASSERT_LE(s.contacts.size(), 1u);
      for (const SharedContact& contact : s.contacts) EXPECT_EQ(contact.volume, s.volume);
    }
  }
}

TEST_P(OnAFloor, WhatOnlyTouchesSharesNothing) {
  std::mt19937_64 random(6);
  const double edge = GetParam();
  const auto large = surface(make_box(edge, edge, .1 * edge)), own = surface(make_box(.1, .1, .1));
  SolidPair pair(own, large);
  for (int k = 0; k < 8; ++k) {
    const Pose stands = test::random_pose(random, k < 4 ? 1 : 1000);
    const double turn = k;
    const Pose beside{exact_rotation(rotation_from_vector({0, 0, turn})),
                      {.03 * k * edge, .31 * edge, .05 * edge + .05}};
    EXPECT_EQ(pair.measure(stands * beside, stands, false).volume, 0) << k;
  }
}

TEST_P(OnAFloor, FeetAreContactsOfTheirOwn) {
  const double edge = GetParam();
  Solid feet = make_box(.02, .02, .1);
  test::append(feet, make_box(.02, .02, .1), {.1, 0, 0});
  SolidPair pair(surface(feet, true), surface(make_box(edge, edge, edge), true));
  // One pose across the diagonal of a face, where its two triangles meet.
  for (const Vec3 place :
       {Vec3{.2 * edge, .1 * edge, .5 * edge + .04}, Vec3{0, 0, .5 * edge + .04}}) {
    const SharedSolid s = pair.measure(at(place), {}, true, 4);
    ASSERT_EQ(s.contacts.size(), 2u);
    for (const SharedContact& contact : s.contacts) {
      EXPECT_NEAR(contact.volume, .02 * .02 * .01, 1e-6 * .02 * .02 * .1);
      EXPECT_NEAR(contact.force.z, contact.volume, 1e-6 * .02 * .02 * .1);
      EXPECT_NEAR(contact.depth, .01, 1e-6);
    }
  }
}

TEST_P(OnAFloor, ScalingByPowersOfTwoIsExact) {
  const double edge = GetParam();
  const Solid small = make_tetrahedron(std::max(.1, edge / 5e4));
  const Pose pose{exact_rotation(rotation_from_vector({.3, -.5, .2})),
                  {.1 * edge, .2 * edge, edge / 2}};
  std::vector<double> volumes;
  for (const double s : {1.0, 0x1p-9, 0x1p7}) {
    const double e = s * edge;
    SolidPair pair(surface(scaled(small, s)), surface(make_box(e, e, e)));
    volumes.push_back(pair.measure({pose.rotation, s * pose.translation}, {}, false).volume /
                      (s * s * s));
  }
  EXPECT_GT(volumes[0], 0);
  EXPECT_EQ(volumes[1], volumes[0]);
  EXPECT_EQ(volumes[2], volumes[0]);
}

INSTANTIATE_TEST_SUITE_P(Edges, OnAFloor, testing::Values(3, 100, 1e3, 1e4),
                         [](const auto& of) { return std::to_string(int(of.param)) + "m"; });

}  // namespace
}  // namespace vpm
