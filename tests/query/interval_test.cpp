// Intervals of the volume: how often the truth lies in them, how wide they are, and what has none.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "libvpm/cloud/normals.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/synthetic/render.h"
#include "libvpm/synthetic/shapes.h"
#include "libvpm/synthetic/surface.h"
#include "libvpm/synthetic/truth.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

using testing::generic_rotation;

constexpr double kEdge = .2;  // m, of the tool

// Returns a camera that looks along z from a place.
Camera camera_at(Vec3 place) {
  Camera camera;
  camera.intrinsics = {150, 150, 79.5, 59.5};
  camera.width = 160, camera.height = 120;
  camera.to_world.translation = place;
  return camera;
}

// Describes a wall, z = 1 + slope x - what is measured of it errs by a depth that is drawn.
struct MeasuredWall {
  double slope = 0;
  std::function<double(double depth, std::uint64_t pixel)> measured;

  Cloud seen_by(const Camera& camera, const Camera& said_to_be) const {
    DepthImage image{camera.width, camera.height, {}};
    for (std::uint32_t v = 0; v < camera.height; ++v)
      for (std::uint32_t u = 0; u < camera.width; ++u) {
        const double x = (u - camera.intrinsics.cx) / camera.intrinsics.fx;
        const Vec3 from = camera.to_world.translation;
        const double depth = (1 + slope * from.x - from.z) / (1 - slope * x);
        image.depth.push_back(static_cast<float>(measured(depth, image.depth.size())));
      }
    return make_cloud(image, said_to_be, {});
  }
  Cloud seen_by(const Camera& camera) const { return seen_by(camera, camera); }
};

// Counts how often the truth lies in the interval, and compares the width with the errors.
struct Coverage {
  int draws = 0, inside = 0;
  double squared_errors = 0, widths = 0;

  void add(const Result& result, double truth) {
    const Interval in = result.volume_interval.value();
    EXPECT_LE(in.low, result.volume);
    EXPECT_GE(in.high, result.volume);
    ++draws;
    inside += in.low <= truth && truth <= in.high;
    squared_errors += (result.volume - truth) * (result.volume - truth);
    widths += in.high - in.low;
  }
  // Returns the deviation that the intervals tell, in that of the errors.
  double ratio() const { return widths / (2 * 1.96 * draws) / std::sqrt(squared_errors / draws); }
  void expect_95() const {
    const double three_deviations = 3 * std::sqrt(.95 * .05 * draws);
    EXPECT_NEAR(inside, .95 * draws, three_deviations);
    EXPECT_GT(ratio(), 1 / 1.5);
    EXPECT_LT(ratio(), 1.5);
  }
};

class Intervals : public ::testing::Test {
 protected:
  // Returns the volume of the tool behind the wall, by planes through its spheres' cells: the cube
  // is cut as a polyhedron is, sum over its faces.
  double truth(const MeasuredWall& wall, const Pose& pose) const {
    constexpr int kPlaces = 200;           // lines across two of the tool's axes, each cut exactly
    const Vec3 normal{-wall.slope, 0, 1};  // not of unit length: z - slope x - 1 is 0 on the wall
    const Vec3 axis = transpose(pose.rotation) * normal;
    double sum = 0;
    for (int i = 0; i < kPlaces; ++i)
      for (int j = 0; j < kPlaces; ++j) {
        const Vec3 line{((i + .5) / kPlaces - .5) * kEdge, ((j + .5) / kPlaces - .5) * kEdge, 0};
        const double height = dot(normal, pose * line) - 1;  // behind the wall: positive
        const double end = -height / axis.z;                 // of the line's part before the wall
        const double behind = axis.z > 0 ? kEdge / 2 - end : end + kEdge / 2;
        sum += std::clamp(behind, 0.0, kEdge);
      }
    return sum * kEdge * kEdge / (kPlaces * kPlaces);
  }

  const ToolModel tool_ = testing::lattice_cube(kEdge, 10, 3);
  ToolQuery query_{tool_, {.interval = true}};
};

TEST_F(Intervals, HoldTheTruthBehindANoisyWall) {
  constexpr double kNoise = .003, kStep = .002;  // m
  for (const double slope : {0.0, .6}) {
    Coverage of_image, of_points;
    for (std::uint64_t draw = 0; draw < 200; ++draw) {
      const MeasuredWall wall{slope, [&](double depth, std::uint64_t pixel) {
                                synthetic::NormalNumbers numbers(draw + 1, pixel);
                                return kStep *
                                       std::nearbyint((depth + kNoise * numbers.next()) / kStep);
                              }};
      const Pose pose{generic_rotation(), {.02, -.01, .95 + 4e-4 * static_cast<double>(draw)}};
      const Cloud seen = wall.seen_by(camera_at({}));
      of_image.add(query_.run(AnyBody(seen), pose), truth(wall, pose));
      if (draw % 2 == 0)
        of_points.add(query_.run(AnyBody(without_camera(seen)), pose), truth(wall, pose));
    }
    SCOPED_TRACE(slope);
    of_image.expect_95();
    of_points.expect_95();
  }
}

// Both sides of a plate are so near that the disks about a place are of both, and each errs by
// itself.
TEST_F(Intervals, HoldTheTruthAtAThinPlateOfPoints) {
  constexpr double kNoise = .001, kThickness = .004;  // m
  Camera behind = camera_at({0, 0, 2 + kThickness});
  behind.to_world.rotation = {{-1, 0, 0}, {0, 1, 0}, {0, 0, -1}};
  Coverage coverage;
  for (std::uint64_t draw = 0; draw < 30; ++draw) {
    const auto wall = [&](std::uint64_t side) {
      return MeasuredWall{0, [=](double depth, std::uint64_t pixel) {
                            synthetic::NormalNumbers numbers(2 * draw + side + 1, pixel);
                            return depth + kNoise * numbers.next();
                          }};
    };
    Cloud plate = without_camera(wall(0).seen_by(camera_at({})));
    const Cloud back = wall(1).seen_by(camera_at({}), behind);
    for (const Vec3f& place : back.positions)
      plate.positions.push_back(narrow(widen(place) + back.origin - plate.origin));
    plate.normals.insert(plate.normals.end(), back.normals.begin(), back.normals.end());
    plate.radii.insert(plate.radii.end(), back.radii.begin(), back.radii.end());
    const Pose pose{generic_rotation(), {.02, -.01, .97 + .0013 * static_cast<double>(draw)}};
    Pose further = pose;
    further.translation.z -= kThickness;
    coverage.add(query_.run(AnyBody(plate), pose), truth(wall(0), pose) - truth(wall(0), further));
  }
  coverage.expect_95();
}

// Points do not lie on the edge between two walls, so that it errs alike along all of its length,
// which no noise tells.
TEST_F(Intervals, HoldTheTruthAtAnEdgeOfPoints) {
  const auto roof = synthetic::make_prism({{-9, 10}, {0, 1}, {9, 10}}, {});
  const synthetic::TrueSolid cube(synthetic::make_cube(kEdge));
  const Cloud seen = make_cloud(synthetic::render(*roof, camera_at({})), camera_at({}), {});
  const AnyBody points(without_camera(seen));
  Coverage coverage;
  for (int k = 0; k < 24; ++k) {
    const Pose pose{generic_rotation(), {.01, -.01, .93 + .005 * k}};
    coverage.add(query_.run(points, pose), cube.penetration(pose, *roof, 1e-6).volume);
  }
  coverage.expect_95();
}

// A camera that is not where its pose says errs alike over all of the tool, and no mean over pixels
// takes that away; only another camera, which disagrees, can tell.
TEST_F(Intervals, HoldTheTruthBetweenCamerasThatDisagree) {
  Coverage coverage, of_one;
  for (std::uint64_t draw = 0; draw < 60; ++draw) {
    const MeasuredWall wall{.1, [](double depth, std::uint64_t) { return depth; }};
    synthetic::NormalNumbers numbers(7, draw);
    std::vector<DepthBody> images;
    for (const double x : {-.15, 0.0, .15}) {
      Camera said = camera_at({x, 0, 0});
      said.to_world.translation.z += .002 * numbers.next();
      images.emplace_back(wall.seen_by(camera_at({x, 0, 0}), said));
    }
    const Pose pose{generic_rotation(), {.02, -.01, .95 + .001 * static_cast<double>(draw)}};
    of_one.add(query_.run(AnyBody(images.front()), pose), truth(wall, pose));
    coverage.add(query_.run(body_of_cameras(images), pose), truth(wall, pose));
  }
  EXPECT_GE(coverage.inside, 45) << "three readings tell a deviation roughly";
  EXPECT_LT(of_one.inside, 15) << "one camera cannot know where it is";
}

TEST_F(Intervals, HaveNoWidthWhereNothingIsCut) {
  const Cloud wall = testing::see(synthetic::make_scene("wall"));
  for (const AnyBody& body : {AnyBody(wall), AnyBody(without_camera(wall))}) {
    const Result free = query_.run(body, {generic_rotation(), {0, 0, .5}});
    EXPECT_EQ(free.volume_interval, (Interval{0, 0}));
  }
  const Result inside = query_.run(AnyBody(wall), {{}, {0, 0, 1.11}});
  EXPECT_EQ(inside.boundary, 0u);
  EXPECT_GT(inside.volume_fraction, .5);
  EXPECT_EQ(inside.volume_interval, (Interval{inside.volume, inside.volume}));
}

TEST_F(Intervals, AreToldWhereTheyAreAskedAndKnown) {
  const Cloud wall = testing::see(synthetic::make_scene("tilted-wall"));
  const Pose pose{generic_rotation(), {0, 0, .95}};
  ToolQuery plain(tool_, {});
  for (const AnyBody& body : {AnyBody(wall), AnyBody(without_camera(wall))}) {
    Result asked = query_.run(body, pose);
    EXPECT_TRUE(std::exchange(asked.volume_interval, std::nullopt));
    EXPECT_EQ(asked, plain.run(body, pose));
  }
  EXPECT_FALSE(query_.run(AnyBody(without_camera(wall), Denoising::off), pose).volume_interval)
      << "nothing tells what noise points as measured have";
}

// Errors of bodies are independent, so their squares add up, in any order.
TEST_F(Intervals, OfSeveralBodiesAddUp) {
  const std::vector<AnyBody> bodies{
      AnyBody(testing::see(synthetic::make_scene("ball"))),
      AnyBody(testing::see(synthetic::make_scene("tilted-wall"))),
      AnyBody(without_camera(testing::see(synthetic::make_scene("step"))))};
  const Pose pose{generic_rotation(), {.01, -.02, .95}};
  const Result whole = query_.run(bodies, pose);
  double squares = 0;
  for (const Result& part : query_.parts()) {
    const double half = part.volume_interval->high - part.volume;
    squares += half * half;
  }
  EXPECT_GT(squares, 0);
  EXPECT_NEAR(whole.volume_interval->high - whole.volume, std::sqrt(squares), 1e-6 * whole.volume);
  EXPECT_EQ(query_.run(std::vector<AnyBody>{bodies[2], bodies[0], bodies[1]}, pose), whole);
}

}  // namespace
}  // namespace vpm
