// What must change no bit of an answer, and what must never be answered.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libvpm/synthetic/shapes.h"
#include "tests/solid/pair_cases.h"

namespace vpm {
namespace {

using synthetic::make_box;
using synthetic::make_icosphere;
using synthetic::make_tetrahedron;
using synthetic::make_torus;
using synthetic::make_torus_knot;
using test::surface;

std::vector<Solid> solids() {
  return {make_box(.5, .4, .3),
          make_tetrahedron(.7),
          make_torus(.3, .1, 40, 20),
          make_icosphere(.4, 2),
          make_torus_knot(2, 3, .25, .1, .05, 160, 8),
          make_box(.6, .6, .006)};
}

void expect_opposite(const SharedSolid& a, const SharedSolid& b) {
  EXPECT_EQ(a.volume, b.volume);
  EXPECT_EQ(a.closure, b.closure);
  EXPECT_EQ(a.centroid, b.centroid);
  EXPECT_EQ(a.area, -b.area);
  EXPECT_EQ(a.turn, -b.turn);
  EXPECT_EQ(a.force, -b.force);
  EXPECT_EQ(a.torque, -b.torque);
}

// Whichever solid is called the first, and twins too.
TEST(PairOrder, SwappedSolidsGiveTheSameBits) {
  std::mt19937_64 random(2);
  std::vector<std::shared_ptr<const SolidSurface>> all;
  for (const Solid& solid : solids()) all.push_back(surface(solid, true));
  int met = 0;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i; j < all.size(); ++j) {
      SolidPair pair(all[i], all[j]), swapped(all[j], all[i]);
      for (int k = 0; k < 3; ++k) {
        const Pose a = test::random_pose(random, .25), b = test::random_pose(random, .25);
        const SharedSolid there = pair.measure(a, b), back = swapped.measure(b, a);
        expect_opposite(there, back);
        met += there.volume > 0;
      }
    }
  EXPECT_GE(met, 30);
}

// Answers do not depend on the poses asked before.
TEST(PairOrder, AnswersDoNotDependOnEarlierOnes) {
  std::mt19937_64 random(3);
  const auto a = surface(make_torus(.3, .1, 40, 20), true), b = surface(make_box(.5, .4, .3), true);
  SolidPair used(a, b);
  for (int k = 0; k < 10; ++k) {
    const Pose pose = test::random_pose(random, .3);
    const SharedSolid there = used.measure({}, pose), fresh = SolidPair(a, b).measure({}, pose);
    EXPECT_EQ(there.volume, fresh.volume);
    EXPECT_EQ(there.force, fresh.force);
    EXPECT_EQ(there.torque, fresh.torque);
  }
}

// Triangles and vertices in another order are the same solid, and every sum is free of their order.
TEST(PairOrder, OrderOfTrianglesChangesAnswersByRoundingOnly) {
  Solid shuffled = make_torus(.3, .1, 40, 20);
  std::mt19937_64 random(4);
  std::shuffle(shuffled.triangles.begin(), shuffled.triangles.end(), random);
  const auto box = surface(make_box(.5, .4, .3));
  SolidPair pair(surface(make_torus(.3, .1, 40, 20)), box), other(surface(shuffled), box);
  for (int k = 0; k < 10; ++k) {
    const Pose pose = test::random_pose(random, .3);
    EXPECT_NEAR(pair.measure({}, pose, false).volume, other.measure({}, pose, false).volume, 1e-13);
  }
}

// Solids, and their places, in units of a power of two.
TEST(PairOrder, ScalingByPowersOfTwoChangesExponentsOnly) {
  std::mt19937_64 random(5);
  for (const double scale : {0x1p-30, 0x1p-3, 8.0, 0x1p30}) {
    const auto scaled = [&](Solid solid) {
      for (Vec3& v : solid.vertices) v = scale * v;
      return surface(solid, true);
    };
    const Solid torus = make_torus(.3, .1, 30, 15), box = make_box(.5, .4, .3);
    SolidPair pair(surface(torus, true), surface(box, true)), large(scaled(torus), scaled(box));
    for (int k = 0; k < 8; ++k) {
      const Pose a = test::random_pose(random, .2), b = test::random_pose(random, .2);
      const SharedSolid one = pair.measure(a, b);
      const SharedSolid two =
          large.measure({a.rotation, scale * a.translation}, {b.rotation, scale * b.translation});
      const double area = scale * scale, volume = area * scale;
      EXPECT_EQ(volume * one.volume, two.volume);
      EXPECT_EQ(scale * one.centroid, two.centroid);
      EXPECT_EQ(area * one.area, two.area);
      EXPECT_EQ(volume * one.force, two.force);
      EXPECT_EQ(volume * scale * one.torque, two.torque);
    }
  }
}

TEST(PairOrder, MovingBothSolidsMovesTheAnswer) {
  std::mt19937_64 random(6);
  SolidPair pair(surface(make_torus(.3, .1, 40, 20), true), surface(make_tetrahedron(.7), true));
  for (int k = 0; k < 20; ++k) {
    const Pose a = test::random_pose(random, .2), b = test::random_pose(random, .2),
               motion = test::random_pose(random, 5);
    const SharedSolid here = pair.measure(a, b), there = pair.measure(motion * a, motion * b);
    EXPECT_NEAR(here.volume, there.volume, 1e-12);
    EXPECT_NEAR(norm(motion.rotation * here.area - there.area), 0, 1e-11);
    EXPECT_NEAR(norm(motion.rotation * here.force - there.force), 0, 1e-10);
    if (here.volume < 1e-6) continue;
    EXPECT_NEAR(norm(motion * here.centroid - there.centroid), 0, 1e-8);
  }
}

// Random and nearly coincident pairs: each answer closes, and none is more than either solid.
TEST(PairOrder, EveryAnswerCloses) {
  std::mt19937_64 random(7);
  std::vector<std::shared_ptr<const SolidSurface>> all;
  for (const Solid& solid : solids()) all.push_back(surface(solid));
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = 0; j < all.size(); ++j) {
      SolidPair pair(all[i], all[j]);
      const double smaller = std::min(all[i]->volume(), all[j]->volume());
      for (const double half : {.3, .05, 1e-6, 1e-10, 0.0}) {
        Pose pose = test::random_pose(random, half);
        if (half < .01) pose.rotation = {};
        const SharedSolid shared = pair.measure({}, pose, false);
        EXPECT_LE(shared.closure, SolidPair::kMaxClosure);
        EXPECT_GE(shared.volume, 0);
        EXPECT_LE(shared.volume, (1 + 1e-9) * smaller);
      }
    }
}

}  // namespace
}  // namespace vpm
