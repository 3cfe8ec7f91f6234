// Solids as bodies of a scene: boxes whose overlap is known, alone, together, and beside a cloud.
#include <gtest/gtest.h>
#include <vpm/level_query.h>
#include <vpm/query.h>
#include <vpm/solid.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/api/boxes.h"

namespace {

using vpm::Body;
using vpm::Pose;
using vpm::Result;
using vpm::Vec3;
using vpm::test::kind_of;

// Returns a closed box about the origin with these edges.
vpm::SolidMesh box(double x, double y, double z) {
  return vpm::test::box({-x / 2, -y / 2, -z / 2}, {x / 2, y / 2, z / 2});
}

Pose at(double x, double y, double z) {
  return {{}, {x, y, z}};
}

bool is_near(Vec3 a, Vec3 b, double within) {
  return std::abs(a.x - b.x) <= within && std::abs(a.y - b.y) <= within &&
         std::abs(a.z - b.z) <= within;
}

// A wall at z = 1 m that a camera at the origin sees.
vpm::PointCloud wall() {
  vpm::Camera camera;
  camera.intrinsics = {60, 60, 31.5, 23.5};
  camera.width = 64;
  camera.height = 48;
  return vpm::PointCloud::from_depth(std::vector<float>(64 * 48, 1.0F), camera);
}

class SolidsInScene : public testing::Test {
 protected:
  static vpm::Tool make_tool() {
    return vpm::build_tool(vpm::pack(box(.2, .2, .2), {.spheres = 60}), {.levels = {20}});
  }

  const vpm::Tool tool_ = make_tool();  // of edge .2 m
  const double volume_ = .008;          // m^3
  const vpm::SolidBody cube_{box(.2, .2, .2)}, slab_{box(40, 40, 10)};
};

TEST_F(SolidsInScene, GiveTheVolumeOfTheOverlap) {
  vpm::Query query(tool_);
  const vpm::Scene scene(Body(cube_, at(.15, 0, 0)));
  const Result r = query.run(scene, Pose{});
  EXPECT_NEAR(r.volume, .05 * .2 * .2, 1e-9 * volume_);
  EXPECT_NEAR(r.volume_fraction, .25, 1e-9);
  EXPECT_LT(r.wrench.force.x, 0) << "it is pushed out, away from the solid";
  ASSERT_TRUE(r.closure);
  EXPECT_LE(*r.closure, 1e-8);
  EXPECT_EQ(query.run(scene, at(-.05, 0, 0)).volume, 0) << "flush faces share nothing";
  EXPECT_EQ(query.collides(scene, at(-.05, .03, .02)), vpm::Collides::no);
  EXPECT_EQ(query.run(scene, at(-9, 0, 0)).volume, 0);
  EXPECT_NEAR(query.run(scene, at(.15, 0, 0)).volume, volume_, 1e-9 * volume_) << "the same cube";
}

// The promise of units: a force of K times V against what is as good as a half-space, and the
// torque of the shared volume's centroid about the centre of mass.
TEST_F(SolidsInScene, PushLikeAWallWithStiffnessTimesVolume) {
  constexpr double kStiffness = 2e5;
  vpm::Query query(tool_, {.stiffness = kStiffness});
  const vpm::Scene scene(Body(slab_, at(0, 0, 5)));  // solid from z = 0
  const vpm::Rotation turn = vpm::rotation_from_quaternion({std::sin(.1), 0, 0, std::cos(.1)});
  const Pose pose{turn, {.3, .4, -.06}};
  const Result r = query.run(scene, pose);
  EXPECT_GT(r.volume, .1 * volume_);
  EXPECT_TRUE(is_near(r.wrench.force, {0, 0, -kStiffness * r.volume}, 1e-9 * kStiffness * volume_));
  const vpm::Overlap o =
      vpm::overlap(vpm::SolidBody(tool_), pose, slab_, at(0, 0, 5), {.stiffness = kStiffness});
  const Vec3 c = o.centroid, t = pose.translation;  // the centre of mass is the tool's origin
  const double f = r.wrench.force.z;
  EXPECT_TRUE(is_near(r.wrench.torque, {(c.y - t.y) * f, -(c.x - t.x) * f, 0},
                      1e-9 * kStiffness * volume_));
}

TEST_F(SolidsInScene, AddUpInAnyOrderToTheSameBits) {
  vpm::Query query(tool_);
  const std::vector<Body> bodies{Body(cube_, at(.15, 0, 0)), Body(wall()),
                                 Body(cube_, at(-.1, .03, .9)), Body(slab_, at(0, 20.07, .9))};
  const Pose pose{vpm::rotation_from_quaternion({0, std::sin(.2), 0, std::cos(.2)}), {0, 0, .93}};
  std::vector<int> order{0, 1, 2, 3};
  const Result all = query.run(vpm::Scene(bodies), pose);
  double sum = 0;
  do {
    std::vector<Body> turned;
    for (const int k : order) turned.push_back(bodies[static_cast<std::size_t>(k)]);
    EXPECT_EQ(query.run(vpm::Scene(turned), pose), all);
    const std::vector<Result> parts = query.parts();
    ASSERT_EQ(parts.size(), 4U);
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_EQ(parts[k], query.run(vpm::Scene(turned[k]), pose)) << "a part is the body alone";
  } while (std::next_permutation(order.begin(), order.end()));
  for (const Body& body : bodies) sum += query.run(vpm::Scene(body), pose).volume_fraction;
  EXPECT_NEAR(all.volume_fraction, sum, 4e-16) << "whole numbers of 2^-60, rounded once";
  EXPECT_GT(all.volume, .1 * volume_);
}

TEST_F(SolidsInScene, MoveWithEachJob) {
  vpm::Query query(tool_);
  const vpm::Scene scene({Body(cube_, at(9, 0, 0)), Body(wall()), Body(cube_, at(8, 0, 0))});
  std::vector<std::array<Pose, 2>> places;
  std::vector<vpm::Job> jobs;
  for (int k = 0; k < 5; ++k) places.push_back({at(.02 * k, 0, 0), at(0, .15, .01 * k)});
  for (const auto& of_job : places) jobs.push_back({Pose{}, 0, of_job});
  jobs.push_back({at(9.1, 0, 0), 0, {}});
  std::vector<Result> results(jobs.size());
  query.run(scene, jobs, results);
  for (std::size_t k = 0; k < places.size(); ++k) {
    const double step = static_cast<double>(k);
    EXPECT_NEAR(results[k].volume, .04 * (.2 - .02 * step) + .05 * .2 * (.2 - .01 * step),
                1e-8 * volume_);
    EXPECT_EQ(results[k], query.run(scene, Pose{}, places[k]));
  }
  EXPECT_NEAR(results.back().volume, .5 * volume_, 1e-8 * volume_) << "without poses: where made";
}

TEST_F(SolidsInScene, AreMeasuredTheSameAtEachLevel) {
  const vpm::Scene scene(Body(cube_, at(.15, 0, 0)));
  vpm::Query fine(tool_), coarse(tool_, {.level = 20});
  vpm::LevelQuery chosen(tool_, {}, {}, scene, Pose{});
  const Result r = fine.run(scene, Pose{}), c = coarse.run(scene, Pose{});
  EXPECT_EQ(r.volume, c.volume);
  EXPECT_EQ(r.wrench, c.wrench);
  EXPECT_EQ(chosen.run(scene, Pose{}), r);
}

TEST_F(SolidsInScene, TellTheStateOfSpheres) {
  vpm::Query query(tool_);
  const vpm::Scene scene(Body(slab_, at(0, 0, 5.001)));  // solid from z = .001
  const Result r = query.run(scene, Pose{});
  const std::vector<vpm::Sphere> spheres = tool_.spheres();
  std::uint32_t boundary = 0, inside = 0;
  for (std::size_t k = 0; k < spheres.size(); ++k) {
    const double depth = spheres[k].center.z - .001;  // below the one face within the tool
    const vpm::SphereState state = query.states()[k];
    if (std::abs(std::abs(depth) - spheres[k].radius) < 1e-9) continue;  // touches
    EXPECT_EQ(state == vpm::SphereState::boundary, std::abs(depth) < spheres[k].radius) << k;
    EXPECT_EQ(state == vpm::SphereState::inside, depth > spheres[k].radius) << k;
    boundary += state == vpm::SphereState::boundary;
    inside += state == vpm::SphereState::inside;
  }
  EXPECT_EQ(r.boundary, boundary);
  EXPECT_GT(inside, 0U);
  EXPECT_NEAR(r.inside, inside, 10) << "but for those that touch";
}

TEST_F(SolidsInScene, RefuseWhatCannotBeMeasured) {
  using Kind = vpm::ErrorKind;
  vpm::Query query(tool_);
  const vpm::Scene scene{Body(cube_)};
  const std::vector<Pose> two(2);
  EXPECT_EQ(kind_of([&] { query.run(scene, Pose{}, two); }), Kind::invalid_argument);
  std::vector<Result> results(1);
  EXPECT_EQ(kind_of([&] {
              query.run(scene, std::vector<vpm::Job>{{Pose{}, 0, two}}, results);
            }),
            Kind::invalid_argument);
  EXPECT_EQ(kind_of([&] { Body(vpm::SolidBody(box(1, 1, 1), false)); }), Kind::invalid_argument);
  EXPECT_EQ(kind_of([&] { Body(cube_, {{{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}}); }), Kind::refused);
  vpm::Query paper(tool_, {.measure = vpm::Measure::paper});
  EXPECT_EQ(kind_of([&] { paper.run(scene, Pose{}); }), Kind::invalid_argument);
  vpm::LevelRequest by_points;
  by_points.for_scene = true;
  EXPECT_EQ(kind_of([&] { vpm::LevelQuery(tool_, {}, by_points, scene, Pose{}); }),
            Kind::invalid_argument);
}

// By the measure as printed, solids are spheres: what these share is less than the overlap, is
// summed over bodies in any order in the same bits, and is told without a closure.
TEST_F(SolidsInScene, AreSpheresByTheMeasureAsPrinted) {
  vpm::Query paper(tool_, {.measure = vpm::Measure::paper}), exact(tool_);
  const vpm::SolidBody solid(tool_);
  const Body right(solid, at(.15, .01, .02)), left(solid, at(-.12, .03, 0)),
      front(wall(), vpm::Denoising::off);
  const Pose pose{vpm::rotation_from_quaternion({std::sin(.1), 0, 0, std::cos(.1)}), {0, 0, .95}};
  const std::vector<Pose> places{at(.15, 0, .9), at(-.12, 0, .9)};
  const vpm::Scene scene({right, left, front}), backward({front, left, right});
  const Result r = paper.run(scene, pose, places);
  const std::vector<Result> parts = paper.parts();
  ASSERT_EQ(parts.size(), 3U);
  const std::vector<Pose> turned{places[1], places[0]};
  const Result other = paper.run(backward, pose, turned);
  EXPECT_EQ(r.volume, other.volume);
  EXPECT_EQ(r.wrench, other.wrench);
  EXPECT_EQ(r.closure, std::nullopt);
  EXPECT_GT(r.boundary, 0U);
  EXPECT_NEAR(parts[0].volume + parts[1].volume + parts[2].volume, r.volume, 1e-12 * volume_);
  for (const std::size_t k : {0, 1}) {
    const Result truth = exact.run(vpm::Scene(Body(solid, places[k])), pose);
    EXPECT_GT(parts[k].volume, .1 * truth.volume);
    EXPECT_LT(parts[k].volume, .9 * truth.volume);
    EXPECT_GT(parts[k].wrench.force.x * truth.wrench.force.x, 0);
  }
  std::vector<Result> batch(5);
  paper.run(scene, std::vector<vpm::Job>(5, {pose, 0, places}), batch);
  for (const Result& one : batch) EXPECT_EQ(one, r);
}

// A file of before, whose model keeps no surface, is read, asked of clouds, and refused for solids.
TEST(SolidsOfOldFiles, AreRefusedWithTheCure) {
  const vpm::Tool old = vpm::Tool::read(VPM_SOURCE_DIR "/formats/golden/v1/cube.vpmg");
  vpm::Query query(old);
  EXPECT_GT(query.run(vpm::Scene(wall()), at(0, 0, 1)).volume, 0);
  const vpm::Tool now = vpm::Tool::read(VPM_SOURCE_DIR "/formats/golden/v1/surface.vpmg");
  const vpm::Scene scene(Body(vpm::SolidBody(now), at(.15, 0, 0)));
  EXPECT_EQ(kind_of([&] { vpm::SolidBody{old}; }), vpm::ErrorKind::refused);
  EXPECT_EQ(kind_of([&] { query.run(scene, Pose{}); }), vpm::ErrorKind::refused);
  EXPECT_NEAR(vpm::Query(now).run(scene, Pose{}).volume, .002, 1e-11);
}

// A cloud's points on a removed solid go, and one without a camera has nothing to remove from.
TEST(SolidRemover, TakesPointsOfClouds) {
  const vpm::Camera camera{{60, 60, 31.5, 23.5}, 64, 48, {}};
  const vpm::PointCloud wall =
      vpm::PointCloud::from_depth(std::vector<float>(64 * 48, 1.0F), camera);
  const std::vector<vpm::SolidBody> solids{vpm::SolidBody(box(.2, .2, .2), false)};
  const std::vector<vpm::SolidPlace> places{{{{}, {0, 0, 1}}, 0.01}};
  vpm::SolidRemover remover(solids);
  const vpm::PointCloud rest = remover.remove(places, wall);
  EXPECT_LT(rest.size() + 100, wall.size());
  EXPECT_GT(rest.size(), wall.size() / 2);
  EXPECT_GT(remover.found()[0].explained, 100);  // the wall goes through it
  EXPECT_EQ(rest.camera()->width, 64);
  const std::vector<vpm::Vec3> points{{0, 0, 1}, {0.1, 0, 1}}, normals(2, {0, 0, -1});
  EXPECT_THROW(remover.remove(places, vpm::PointCloud::from_points(points, normals)), vpm::Error);
  EXPECT_THROW(remover.remove({}, wall), vpm::Error);
}

}  // namespace
