// Classifying a ball also classifies all balls in it.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "libvpm/scene/depth/depth_body.h"
#include "tests/query/lattice_model.h"
#include "tests/test_name.h"

namespace vpm {
namespace {

struct Ball {
  Vec3 center;
  double radius = 0;
};

class RandomBalls {
 public:
  // Returns a ball anywhere before a camera that sees about a metre, sometimes beside its image or
  // around it.
  Ball next() {
    const double depth = between(0.05, 1.6);
    return {{depth * between(-0.8, 0.8), depth * between(-0.7, 0.7), depth},
            std::exp(between(std::log(2e-4), std::log(0.3)))};
  }
  // Returns a ball in `ball`; some touch it from within.
  Ball next_in(const Ball& ball) {
    const Vec3 direction = normalized_or_zero(Vec3{between(-1, 1), between(-1, 1), between(-1, 1)});
    const double radius = ball.radius * between(0, 1);
    const double away = (ball.radius - radius) * (between(0, 1) < 0.5 ? 1 : between(0, 1));
    return {ball.center + (1 - 1e-9) * away * direction, radius};
  }

 private:
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(random_()) / 4294967296.0;
  }
  std::mt19937 random_{1};
};

class LookAtABall : public ::testing::TestWithParam<const char*> {};

TEST_P(LookAtABall, SaysOfTheBallsInItWhatALookAtThemDoes) {
  const DepthBody cloud(testing::see(synthetic::make_scene(GetParam())));
  const DepthSurface surface = cloud.surface();
  RandomBalls balls;
  int free = 0, free_parts = 0, none_free = 0;
  for (int k = 0; k < 20000; ++k) {
    const Ball ball = balls.next();
    const DepthSurface::BallClass in_ball = surface.classify_ball(ball.center, ball.radius);
    const bool tells = surface.tells_of_parts(ball.center, ball.radius);
    for (int part = 0; part < 20; ++part) {
      const Ball in = balls.next_in(ball);
      const Side side = surface.classify_ball(in.center, in.radius).side;
      if (tells && in_ball.side == Side::free) {
        ++free;
        EXPECT_EQ(side, Side::free);
      } else if (tells && surface.is_free_part(in_ball, in.center, in.radius)) {
        ++free_parts;
        EXPECT_EQ(side, Side::free);
      }
      if (!surface.may_hold_free(in_ball, ball.center, ball.radius)) {
        ++none_free;
        EXPECT_FALSE(
            surface.may_be_free(DepthSurface::least_inverse_depth(in_ball), in.center, in.radius));
      }
    }
  }
  EXPECT_GT(free, 10000);
  EXPECT_GT(free_parts, 1000);
  EXPECT_GT(none_free, 10000);
}

TEST_P(LookAtABall, CloserTellsTheSideOfMoreBallsAndNoneWrongly) {
  const DepthBody cloud(testing::see(synthetic::make_scene(GetParam())));
  const DepthSurface surface = cloud.surface();
  RandomBalls balls;
  int free = 0, behind = 0;
  for (int k = 0; k < 20000; ++k) {
    const Ball ball = balls.next();
    const DepthSurface::BallClass in_ball = surface.classify_ball(ball.center, ball.radius);
    if (in_ball.side != Side::ambiguous) continue;
    const Side side = surface.side_by_small_tiles(in_ball, ball.center, ball.radius);
    free += side == Side::free;
    behind += side == Side::behind;
    for (int part = 0; part < 20; ++part) {
      const bool is_behind = is_behind_surface(surface.sample(balls.next_in(ball).center));
      EXPECT_FALSE(side == Side::free && is_behind);
      EXPECT_FALSE(side == Side::behind && !is_behind);
    }
  }
  // Of a wall across the view small tiles tell no more than large ones.
  if (std::string(GetParam()) == "inverted-ball") {
    EXPECT_GT(free, 100);
    EXPECT_GT(behind, 100);
  }
}

TEST(BallClass, OverflowsNowhere) {
  const DepthBody cloud(testing::see(synthetic::make_scene("wall")));
  DepthSurface surface = cloud.surface();
  surface.k.fx = surface.k.fy = 1e300;
  for (const Vec3 center : {Vec3{1e20, 0, 0.3}, Vec3{-1e20, 1e20, 0.3}})
    EXPECT_EQ(surface.classify_ball(center, 1e-301).side, Side::free);
  // Pixels tell nothing so near to the camera: the place may be free, so it must not be classified
  // as behind.
  for (const Vec3 center : {Vec3{0, 0, 1e-300}, Vec3{1e30, 1e30, 1e-290}})
    EXPECT_EQ(surface.classify_ball(center, 1e-301).side, Side::ambiguous);
}

INSTANTIATE_TEST_SUITE_P(Scenes, LookAtABall, ::testing::Values("wall", "step", "inverted-ball"),
                         [](const auto& variant) { return test::test_name(variant.param); });

}  // namespace
}  // namespace vpm
