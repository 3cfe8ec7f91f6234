// A query reads the part of an image that part_read() names, and notes where it would read more.
#include "libvpm/query/image_part.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "libvpm/surface/prepared_cloud.h"
#include "tests/query/lattice_model.h"
#include "tests/test_name.h"

namespace vpm {
namespace {

struct Ball {
  Vec3 center;
  double radius = 0;
};

class Numbers {
 public:
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(random_()) / 4294967296.0;
  }
  Vec3 direction() {
    return normalized_or_zero(Vec3{between(-1, 1), between(-1, 1), between(-1, 1)});
  }

 private:
  std::mt19937 random_{3};
};

// Balls of a tool about its centre of mass: many small ones, a few large ones.
struct Tool {
  double reach;
  std::vector<Ball> balls;
  LookSizes looks;

  Tool(double size, Numbers& numbers) : reach(size) {
    for (int k = 0; k < 300; ++k) {
      const double radius = reach * std::exp(numbers.between(std::log(1e-3), std::log(0.7)));
      const double away = (reach - radius) * (k % 3 == 0 ? 1 - 1e-12 : numbers.between(0, 1));
      balls.push_back({away * numbers.direction(), radius});
      looks.add(balls.back().center, radius);
    }
  }
};

// Returns a place before a camera that sees about a metre, sometimes beside its image or around it.
Vec3 place(Numbers& numbers) {
  const double depth = numbers.between(-0.1, 2);
  return {depth * numbers.between(-0.8, 0.8), depth * numbers.between(-0.7, 0.7), depth};
}

bool is_same(const DepthSurface::Look& a, const DepthSurface::Look& b) {
  return a.side == b.side && a.leaves_image == b.leaves_image && a.pixels == b.pixels &&
         a.tiles == b.tiles && a.range.low == b.range.low && a.range.high == b.range.high &&
         a.middle == b.middle;
}

bool is_same(const Reading& a, const Reading& b) {
  return a.known == b.known && a.distance == b.distance && a.normal.x == b.normal.x &&
         a.foot.x == b.foot.x && a.point == b.point;
}

class ImagePart : public ::testing::TestWithParam<const char*> {
 protected:
  const PreparedCloud cloud_{testing::see(synthetic::make_scene(GetParam()))};
  const DepthSurface whole_ = cloud_.depth_surface();
  Numbers numbers_;
};
INSTANTIATE_TEST_SUITE_P(Scenes, ImagePart, ::testing::Values("wall", "block"),
                         [](const auto& variant) { return test::test_name(variant.param); });

TEST_P(ImagePart, HoldsAllLooksAndReadingsInTheTool) {
  int parts = 0;
  for (const double reach : {0.003, 0.02, 0.1, 0.3}) {
    for (int t = 0; t < 100; ++t) {
      const Tool tool(reach, numbers_);
      const Vec3 center = place(numbers_);
      const PixelRectangle made = part_read(whole_, center, tool.reach, tool.looks.largest());
      volatile std::uint32_t beyond = 0;
      DepthSurface part = whole_;
      part.restrict_to(made, &beyond);
      for (const Ball& ball : tool.balls) {
        const Vec3 at = center + ball.center;
        EXPECT_TRUE(
            is_same(whole_.look_at_ball(at, ball.radius), part.look_at_ball(at, ball.radius)));
        EXPECT_TRUE(is_same(whole_.read(at), part.read(at)));
      }
      EXPECT_EQ(beyond, 0U);
      parts += holds(made, whole_image(whole_.width, whole_.height)) ? 0 : 1;
    }
  }
  EXPECT_GT(parts, 250);
}

TEST_P(ImagePart, NotesWhatWouldBeReadBeyondIt) {
  const PixelRectangle made{64, 96, 127, 159};
  const Intrinsics& k = whole_.k;
  for (const double u : {-40.2, 0.0, 30.4, 63.5, 67.9, 68.0, 100.0, 122.9, 123.1, 639.2, 640.3}) {
    for (const double v : {-1.0, 0.2, 99.9, 100.0, 154.9, 155.1, 300.0, 479.3, 480.0}) {
      volatile std::uint32_t beyond = 0;
      DepthSurface part = whole_;
      part.restrict_to(made, &beyond);
      const Vec3 at{0.5 * (u - k.cx) / k.fx, 0.5 * (v - k.cy) / k.fy, 0.5};
      const Reading reading = part.read(at);
      const bool is_in_image = u >= -0.5 && v >= -0.5 && u < 639.5 && v < 479.5;
      const bool is_in_part = u >= 68 && v >= 100 && u < 123 && v < 155;
      // Neighbours kAcross further on lie in it too.
      EXPECT_EQ(beyond, is_in_image && !is_in_part ? 1U : 0U) << u << " " << v;
      EXPECT_TRUE(is_same(reading, is_in_part ? whole_.read(at) : Reading{})) << u << " " << v;
    }
  }
}

// Nothing is read there, since these pixels cannot be.
TEST_P(ImagePart, NotesLooksBeyondIt) {
  volatile std::uint32_t beyond = 0;
  DepthSurface part = whole_;
  part.restrict_to({}, &beyond);
  part.normals = nullptr;
  part.measured = nullptr;
  for (const InverseDepthRange*& tiles : part.tiles) tiles = nullptr;
  const DepthSurface::Look look = part.look_at_ball({0, 0, 1}, 0.05);
  EXPECT_EQ(beyond, 1U);
  EXPECT_EQ(look.side, Side::free);
  EXPECT_FALSE(part.read({0, 0, 1}).known);
  beyond = 0;
  EXPECT_EQ(part.look_at_ball({9, 0, 1}, 0.05).side, Side::free);  // beside the image
  EXPECT_EQ(beyond, 0U);
}

TEST_P(ImagePart, MayReachTheRimOfTheImage) {
  volatile std::uint32_t beyond = 0;
  DepthSurface part = whole_;
  part.restrict_to({0, 0, 63, whole_.height - 1}, &beyond);
  const Intrinsics& k = whole_.k;
  for (const double v : {-0.4, 479.4}) {
    const Vec3 at{0.9 * (-0.4 - k.cx) / k.fx, 0.9 * (v - k.cy) / k.fy, 0.9};
    EXPECT_TRUE(is_same(whole_.read(at), part.read(at)));
    EXPECT_EQ(beyond, 0U);
  }
}

TEST(LookSizes, GoByPowersOfTwoAndAreTheLargest) {
  LookSizes looks;
  looks.add({1, 0, 0}, 0.5);
  looks.add({3, 0, 0}, 0.9);
  looks.add({0, 0, 4}, 0.25);
  looks.add({0, 0, 1}, 0.1);  // smaller than the first
  looks.add({0, 9, 0}, 0);    // no ball
  const std::vector<LooksOfSize> largest = looks.largest();
  ASSERT_EQ(largest.size(), 2U);
  EXPECT_EQ(largest[0].radius, 0.9);
  EXPECT_EQ(largest[0].reach, 3.9);
  EXPECT_EQ(largest[1].radius, 0.25);
  EXPECT_EQ(largest[1].reach, 4.25);
}

// The part is empty if the tool cannot be seen, and the whole image if the tool may be around the
// camera.
TEST_P(ImagePart, OfToolsNotSeenOrAroundTheCamera) {
  const Tool tool(0.1, numbers_);
  const auto part_at = [&](Vec3 at) {
    return part_read(whole_, at, tool.reach, tool.looks.largest());
  };
  EXPECT_EQ(part_at({0, 0, -1}), PixelRectangle{});
  EXPECT_EQ(part_at({10, 0, 1}), PixelRectangle{});
  EXPECT_EQ(part_at({0, 0, 0.05}), whole_image(whole_.width, whole_.height));
}

}  // namespace
}  // namespace vpm
