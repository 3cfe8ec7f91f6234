// Spheres against spheres: balls whose overlap is known, and what must change no bit.
#include "libvpm/solid/sphere_pair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libvpm/graph/hierarchy.h"
#include "libvpm/measure/sphere_contact.h"
#include "libvpm/packing/packer.h"
#include "libvpm/synthetic/shapes.h"
#include "tests/solid/pair_cases.h"

namespace vpm {
namespace {

using test::at;

// Returns as much of a tool model as spheres against spheres asks for.
ToolModel model_of(const Solid& solid, std::vector<Sphere> spheres) {
  const MassProperties mass = mass_properties(solid);
  ToolModel model;
  model.volume = mass.volume, model.center_of_mass = mass.center_of_mass;
  model.radius = bounding_radius(solid, mass.center_of_mass);
  model.solid_hash = content_hash(solid);
  Level& level = model.levels.emplace_back();
  level.sphere_count = static_cast<std::uint32_t>(spheres.size());
  level.hierarchy = build_hierarchy(spheres);
  model.spheres = std::move(spheres);
  return model;
}

ToolModel packed(const Solid& solid, std::uint32_t spheres) {
  PackOptions options;
  options.spheres = spheres;
  return model_of(solid, pack(solid, options).spheres);
}

ToolModel ball(double radius) {
  return model_of(synthetic::make_icosphere(1.01 * radius, 3), {{{}, radius}});
}

InnerSphereTree tree_of(const ToolModel& model) {
  return {model, model.levels.back()};
}

// Volume of a lens by both radii and the distance (Weisstein, "Sphere-sphere intersection"), and
// its centroid along the line of centres, from a's, by the midpoint rule.
struct Lens {
  double volume = 0, middle = 0;
  Lens(double a, double b, double apart) {
    constexpr int kSlices = 200000;
    const double low = std::max(-a, apart - b), high = std::min(a, apart + b);
    for (int k = 0; k < kSlices; ++k) {
      const double x = low + (high - low) * (k + .5) / kSlices;
      const double r2 = std::min(a * a - x * x, b * b - (x - apart) * (x - apart));
      const double slice = kPi * std::max(r2, 0.) * (high - low) / kSlices;
      volume += slice, middle += slice * x;
    }
    middle /= volume;
  }
};

TEST(SpherePair, TwoBallsShareALens) {
  const Pose turned = {exact_rotation(rotation_from_vector({.3, -.8, .5})), {7, -2, 3}};
  const Vec3 way = normalized_or_zero(Vec3{2, 1, -2});
  SpherePair pair;
  for (const double b : {.05, .03, .01})
    for (const double apart : {.005, .025, .05, .061}) {
      const ToolModel first = ball(.05), second = ball(b);
      const Pose pose{turned.rotation, turned.translation + apart * way};
      const SharedSolid s = pair.measure(tree_of(first), turned, tree_of(second), pose);
      if (apart >= .05 + b) {
        EXPECT_EQ(s.volume, 0);
        continue;
      }
      const Lens lens(.05, b, apart);
      EXPECT_NEAR(s.volume, lens.volume, 1e-8 * lens.volume) << b << " " << apart;
      EXPECT_LT(norm(s.centroid - (turned.translation + lens.middle * way)), 1e-8);
      EXPECT_LT(norm(s.force + lens.volume * way), 1e-8 * lens.volume) << "away from the other";
      EXPECT_LT(norm(s.torque), 1e-9 * lens.volume);
    }
  EXPECT_EQ(pair.contacts(), 0U) << "those that are apart came last";
}

TEST(SpherePair, TouchingAndConcentricBalls) {
  const SphereContact touching = SphereContact::of({{}, 1}, {{0, 0, 3}, 2}),
                      concentric = SphereContact::of({{}, 1}, {{}, 2}),
                      same = SphereContact::of({{}, 1}, {{}, 1}),
                      within = SphereContact::of({{}, 2}, {{0, 0, 1}, 1});
  EXPECT_EQ(touching.volume, 0);
  for (const SphereContact& c : {concentric, same, within}) EXPECT_EQ(c.volume, volume({{}, 1}));
  EXPECT_EQ(norm(concentric.normal), 0);
  EXPECT_TRUE(concentric.is_a_inside && !concentric.is_b_inside);
  EXPECT_TRUE(same.is_a_inside && same.is_b_inside);
  EXPECT_TRUE(within.is_b_inside && !within.is_a_inside);
  EXPECT_EQ(within.normal, (Vec3{0, 0, -1}));
}

// A ball in the middle of a box lies in the box's largest sphere, and beside a face it shares less
// than it has there, since spheres do not fill a box.
TEST(SpherePair, BallInBox) {
  const ToolModel box = packed(synthetic::make_cube(.1), 200), small = ball(.02);
  SpherePair pair;
  std::vector<SphereState> states(1);
  const auto shared = [&](Vec3 place) {
    return pair.measure(tree_of(small), at(place), tree_of(box), {}, states);
  };
  EXPECT_NEAR(shared({.001, 0, 0}).volume, volume(small.spheres[0]), 1e-12 * small.volume);
  EXPECT_EQ(states[0], SphereState::inside);
  const SharedSolid beside = shared({.05, 0, 0});
  EXPECT_GT(beside.volume, .3 * volume(small.spheres[0]));
  EXPECT_LT(beside.volume, .5 * volume(small.spheres[0]));
  EXPECT_GT(beside.force.x, 0) << "out of the box";
  EXPECT_EQ(states[0], SphereState::boundary);
  EXPECT_EQ(shared({.08, 0, 0}).volume, 0);
  EXPECT_EQ(states[0], SphereState::outside);
}

// The hierarchies leave out no pair, and sums have the bits of any order.
TEST(SpherePair, SumsAllPairsOfSpheresInTheSameBits) {
  const ToolModel cube = packed(synthetic::make_cube(.1), 120);
  const ToolModel knot = packed(synthetic::make_torus_knot(2, 3, .035, .014, .007, 100, 8), 80);
  const auto reversed = [](ToolModel model) {
    std::ranges::reverse(model.levels[0].hierarchy.leaves);  // a root above all, in another order
    const auto count = model.levels[0].sphere_count;
    model.levels[0].hierarchy.nodes.assign(1, {{model.center_of_mass, model.radius}, 0, count, 1});
    return model;
  };
  const ToolModel flat_cube = reversed(cube), flat_knot = reversed(knot);
  std::mt19937_64 random(3);
  SpherePair pair;
  int met = 0;
  for (int k = 0; k < 40; ++k) {
    const Pose a = test::random_pose(random, .05), b = test::random_pose(random, .05);
    const SharedSolid s = pair.measure(tree_of(cube), a, tree_of(knot), b);
    const std::size_t contacts = pair.contacts();
    const SharedSolid flat = pair.measure(tree_of(flat_cube), a, tree_of(flat_knot), b);
    EXPECT_EQ(s.volume, flat.volume);
    EXPECT_EQ(s.force, flat.force);
    EXPECT_EQ(s.torque, flat.torque);
    EXPECT_EQ(s.centroid, flat.centroid);
    EXPECT_EQ(contacts, pair.contacts());
    met += s.volume > 0;
  }
  EXPECT_GT(met, 30);
}

// Whichever solid is called the first, twins too.
TEST(SpherePair, SwappedSolidsGiveTheSameBits) {
  const std::vector<ToolModel> all{packed(synthetic::make_cube(.1), 60), ball(.04),
                                   packed(synthetic::make_torus(.04, .015, 32, 16), 60)};
  std::mt19937_64 random(5);
  SpherePair pair;
  int met = 0;
  for (const ToolModel& p : all)
    for (const ToolModel& q : all)
      for (int k = 0; k < 5; ++k) {
        const Pose a = test::random_pose(random, .04), b = test::random_pose(random, .04);
        const SharedSolid there = pair.measure(tree_of(p), a, tree_of(q), b),
                          back = pair.measure(tree_of(q), b, tree_of(p), a);
        EXPECT_EQ(there.volume, back.volume);
        EXPECT_EQ(there.centroid, back.centroid);
        EXPECT_EQ(there.force, -back.force);
        EXPECT_EQ(there.torque, -back.torque);
        met += there.volume > 0;
      }
  EXPECT_GT(met, 30);
}

}  // namespace
}  // namespace vpm
