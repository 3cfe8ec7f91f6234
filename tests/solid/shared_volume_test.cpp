// Volume, centroid and gradient of what two solids share, against analysis.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "libvpm/synthetic/shapes.h"
#include "tests/refusal.h"
#include "tests/solid/pair_cases.h"

namespace vpm {
namespace {

using synthetic::make_box;
using synthetic::make_icosphere;
using synthetic::make_octahedron;
using synthetic::make_tetrahedron;
using synthetic::make_torus;
using test::at;
using test::surface;

// Boxes with edges along the axes: what they share is the product of three intervals.
struct BoxCase {
  const char* name;
  Vec3 a, b, place;  // edges and the second's centre
};

double interval(double a, double b, double place) {
  return std::max(0.0, std::min(a / 2, place + b / 2) - std::max(-a / 2, place - b / 2));
}

class AlignedBoxes : public testing::TestWithParam<BoxCase> {};

TEST_P(AlignedBoxes, ShareTheProductOfTheirIntervals) {
  const BoxCase& c = GetParam();
  SolidPair pair(surface(make_box(c.a.x, c.a.y, c.a.z)), surface(make_box(c.b.x, c.b.y, c.b.z)));
  const SharedSolid shared = pair.measure({}, at(c.place), false);
  const double expected = interval(c.a.x, c.b.x, c.place.x) * interval(c.a.y, c.b.y, c.place.y) *
                          interval(c.a.z, c.b.z, c.place.z);
  const double smaller = std::min(c.a.x * c.a.y * c.a.z, c.b.x * c.b.y * c.b.z);
  if (expected < 1e-12)
    EXPECT_EQ(shared.volume, 0) << "what only touches shares nothing";
  else
    EXPECT_NEAR(shared.volume, expected, 1e-9 * smaller);
  EXPECT_LE(shared.closure, SolidPair::kMaxClosure);
}

INSTANTIATE_TEST_SUITE_P(
    Cases, AlignedBoxes,
    testing::Values(BoxCase{"Flush", {1, 1, 1}, {1, 1, 1}, {0.5, 0, 0}},
                    BoxCase{"Touching", {1, 1, 1}, {1, 1, 1}, {1, 0, 0}},
                    BoxCase{"TouchingAtAnEdge", {1, 1, 1}, {1, 1, 1}, {1, 1, 0}},
                    BoxCase{"TouchingAtACorner", {1, 1, 1}, {1, 1, 1}, {1, 1, 1}},
                    BoxCase{"Coincident", {1, 1, 1}, {1, 1, 1}, {}},
                    BoxCase{"TenMicrometresOfAMetre", {1, 1, 1}, {1, 1, 1}, {1 - 1e-5, 0, 0}},
                    BoxCase{"Enclosed", {1, 1, 1}, {.5, .5, .5}, {}},
                    BoxCase{"EnclosedFlush", {1, 1, 1}, {.5, .5, .5}, {.25, 0, 0}},
                    BoxCase{"InACorner", {1, 1, 1}, {.5, .5, .5}, {.25, .25, .25}},
                    BoxCase{"OnAFace", {1, 1, 1}, {.5, .5, .5}, {.75, .1, .2}},
                    BoxCase{"PlateOnAFace", {1, 1, 1}, {1, 1, .01}, {0, 0, .505}},
                    BoxCase{"PlateHalfway", {1, 1, 1}, {1, 1, .01}, {0, 0, .5}},
                    BoxCase{"PlateInside", {1, 1, 1}, {1, 1, .01}, {.1, 0, .2}},
                    BoxCase{"PlateInPlate", {1, 1, .01}, {1, .01, 1}, {.2, .1, 0}},
                    BoxCase{"Cross", {3, 1, 1}, {1, 3, 1}, {}},
                    BoxCase{"SmallInLarge", {10, 10, 10}, {.1, .1, .1}, {5, 3, 4}},
                    BoxCase{"Apart", {1, 1, 1}, {1, 1, 1}, {1.2, 0, 0}}),
    [](const auto& of) { return std::string(of.param.name); });

// The jitter of a solid that is larger by so much moves its faces by more than is promised: what
// it hides is refused, not taken for nothing.
TEST(SharedVolume, OfSolidsTooUnlikeIsRefusedWhereTheyShareSomething) {
  const auto small = surface(make_box(.1, .1, .1));
  for (const double edge : {1.5e4, 1e6, 1e8}) {
    SolidPair pair(surface(make_box(edge, edge, edge)), small);
    for (const double part : {.5, .3}) {  // at a face, and inside
      const Vec3 place{part * edge, .1 * edge, .2 * edge};
      const std::string said = test::refusal([&] { pair.measure({}, at(place), false); });
      EXPECT_NE(said.find("up to 131072 times"), std::string::npos) << edge << ' ' << part << said;
      EXPECT_NE(said.find("cut it down to what is near"), std::string::npos) << said;
    }
    EXPECT_EQ(pair.measure({}, at({.7 * edge, 0, 0}), false).volume, 0);
  }
}

// Of solids that stand together anywhere, turned in any way.
TEST(SharedVolume, OfSolidsThatOnlyTouchIsNothing) {
  Solid hollow = make_box(1, 1, 1);
  const Solid plug = make_box(.5, .4, .3), cube = make_box(1, 1, 1), plate = make_box(1, 1, .001);
  for (const auto& [i, j, k] : plug.triangles) hollow.triangles.push_back({i + 8, k + 8, j + 8});
  hollow.vertices.insert(hollow.vertices.end(), plug.vertices.begin(), plug.vertices.end());
  const struct {
    const Solid &a, &b;
    Vec3 place;
  } cases[]{
      {cube, cube, {1, 0, 0}},         {cube, cube, {1, .3, .2}},   {cube, cube, {1, 1, 0}},
      {cube, cube, {1, 1, 1}},         {hollow, plug, {}},          {plate, plate, {0, 0, .001}},
      {plate, plate, {.2, .1, -.001}}, {cube, plate, {0, 0, .5005}}};
  std::mt19937_64 random(7);
  for (const auto& [a, b, place] : cases) {
    SolidPair pair(surface(a, true), surface(b, true));
    for (int k = 0; k < 4; ++k) {
      const Pose together = k == 0 ? Pose{} : test::random_pose(random, k == 3 ? 100 : 1);
      const SharedSolid s = pair.measure(together, together * at(place), true, 4);
      EXPECT_EQ(s.volume, 0) << k << ": " << place.x << ' ' << place.y << ' ' << place.z;
      EXPECT_EQ(norm(s.force) + norm(s.torque) + norm(s.area), 0);
      EXPECT_TRUE(s.contacts.empty());
    }
  }
}

// A cube that stands on a corner in the middle of a face shares sqrt(3) / 2 times its depth cubed.
TEST(SharedVolume, OfATipIsNotLost) {
  const Pose on_corner{exact_rotation(rotation_from_vector(std::acos(1 / std::sqrt(3.0)) /
                                                           std::sqrt(2.0) * Vec3{-1, 1, 0})),
                       {}};
  SolidPair pair(surface(make_box(.1, .1, .1)), surface(make_box(.2, .2, .2)));
  for (const double depth : {1e-3, 5e-5, 1e-5, 2e-6}) {
    const Pose pose{on_corner.rotation, {.01, .02, .1 + .05 * std::sqrt(3.0) - depth}};
    const double expected = std::sqrt(3.0) / 2 * depth * depth * depth;
    EXPECT_NEAR(pair.measure(pose, {}, false).volume, expected, .01 * expected) << depth;
  }
}

TEST(SharedVolume, OfTenMicrometresIsRightToATenThousandthOfItself) {
  SolidPair pair(surface(synthetic::make_cube(.1)), surface(synthetic::make_cube(.1)));
  const SharedSolid shared = pair.measure({}, at({.1 - 1e-5, .02, .03}), false);
  const double expected = 1e-5 * .08 * .07;
  EXPECT_NEAR(shared.volume, expected, 1e-4 * expected);
  EXPECT_NEAR(shared.centroid.x, .05 - .5e-5, 1e-9);
  EXPECT_NEAR(shared.centroid.y, .01, 1e-9);
  // Inside the other lie .08 x .07 m of the first cube's face toward +x, and strips of two of the
  // faces beside it, which do not count along x.
  EXPECT_NEAR(shared.area.x, .08 * .07, 1e-9);
}

struct ConvexCase {
  const char* name;
  Solid a, b;
};

// Random convex pairs, against cutting faces by half-spaces.
TEST(SharedVolume, OfConvexSolidsEqualsTheirClippedFaces) {
  std::mt19937_64 random(1);
  const std::vector<ConvexCase> cases{
      {"tetrahedra", make_tetrahedron(1), make_tetrahedron(.8)},
      {"octahedron and box", make_octahedron(1), make_box(.7, .5, 1.1)},
      {"plate and tetrahedron", make_box(1, 1, .01), make_tetrahedron(1.2)},
      {"balls", make_icosphere(.6, 2), make_icosphere(.5, 3)},
      {"needle and ball", make_box(.01, .02, 2), make_icosphere(.5, 2)}};
  for (const ConvexCase& c : cases) {
    SCOPED_TRACE(c.name);
    const auto a = surface(c.a), b = surface(c.b);
    SolidPair pair(a, b);
    int met = 0;
    for (int k = 0; k < 40; ++k) {
      const Pose pose_a = test::random_pose(random, .4), pose_b = test::random_pose(random, .4);
      const SharedSolid shared = pair.measure(pose_a, pose_b, false);
      const MassProperties truth =
          test::convex_intersection(test::moved(c.a, pose_a), test::moved(c.b, pose_b));
      const double smaller = std::min(a->volume(), b->volume());
      ASSERT_NEAR(shared.volume, truth.volume, 1e-9 * smaller) << k;
      if (truth.volume < 1e-3 * smaller) continue;
      ++met;
      ASSERT_NEAR(norm(shared.centroid - truth.center_of_mass), 0, 1e-7) << k;
    }
    EXPECT_GE(met, 5);
  }
}

// The rate of the volume along each motion is the surface integral that is given.
TEST(SharedVolume, ChangesByItsGradient) {
  SolidPair pair(surface(make_torus(.4, .15, 48, 24)), surface(make_box(.5, .4, .6)));
  const Pose pose_a{rotation_from_vector({.3, .8, -.2}), {.1, .05, .2}}, pose_b = at({.3, .1, 0});
  const SharedSolid shared = pair.measure(pose_a, pose_b, false);
  ASSERT_GT(shared.volume, 0);
  constexpr double kStep = 1e-5;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 unit{axis == 0 ? 1.0 : 0, axis == 1 ? 1.0 : 0, axis == 2 ? 1.0 : 0};
    const auto moved = [&](double by) {
      return pair.measure({pose_a.rotation, pose_a.translation + by * unit}, pose_b, false).volume;
    };
    EXPECT_NEAR((moved(kStep) - moved(-kStep)) / (2 * kStep), dot(shared.area, unit), 1e-6);
    const auto turned = [&](double by) {
      const Rotation turn = rotation_from_vector(by * unit);
      const Vec3 place = shared.centroid + turn * (pose_a.translation - shared.centroid);
      return pair.measure({turn * pose_a.rotation, place}, pose_b, false).volume;
    };
    EXPECT_NEAR((turned(kStep) - turned(-kStep)) / (2 * kStep), dot(shared.turn, unit), 1e-6);
  }
}

TEST(SharedVolume, OfASolidWithItselfIsItsOwn) {
  for (const Solid& solid :
       {make_torus(.4, .15, 64, 32), make_icosphere(.5, 3), make_tetrahedron(1)}) {
    const auto a = surface(solid);
    SolidPair pair(a, a);
    const SharedSolid shared = pair.measure({}, {}, false);
    EXPECT_NEAR(shared.volume, a->volume(), 1e-9 * a->volume());
    EXPECT_LE(shared.closure, SolidPair::kMaxClosure);
  }
}

// A part in its own mould: a box with the part's surface as a cavity shares nothing with it.
TEST(SharedVolume, OfAPartInItsOwnMouldIsNothing) {
  const Solid part = make_torus(.4, .15, 48, 24);
  Solid mould = make_box(1.4, 1.4, .8);
  const auto first = static_cast<std::uint32_t>(mould.vertices.size());
  mould.vertices.insert(mould.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const auto& [i, j, k] : part.triangles)
    mould.triangles.push_back({first + i, first + k, first + j});
  const auto a = surface(part), b = surface(mould);
  SolidPair pair(a, b);
  EXPECT_EQ(pair.measure({}, {}, false).volume, 0);
  // Moved out sideways it meets the mould.
  EXPECT_GT(pair.measure(at({0, 0, .1}), {}, false).volume, .1 * a->volume());
}

// Two boxes that cross in one mesh: their common part counts once.
TEST(SharedVolume, OfAMeshThatCrossesItselfIsThatOfItsOuterSurface) {
  Solid cross = make_box(3, 1, 1);
  const Solid beam = make_box(1, 3, 1.0625);
  const auto first = static_cast<std::uint32_t>(cross.vertices.size());
  cross.vertices.insert(cross.vertices.end(), beam.vertices.begin(), beam.vertices.end());
  for (const auto& [i, j, k] : beam.triangles)
    cross.triangles.push_back({first + i, first + j, first + k});
  const auto a = surface(cross), b = surface(make_box(2, 2, 2));
  EXPECT_NEAR(a->volume(), 3 + 3 * 1.0625 - 1, 1e-9);
  SolidPair pair(a, b);
  EXPECT_NEAR(pair.measure({}, {}, false).volume, 2 + 2 * 1.0625 - 1, 1e-9);
  EXPECT_NEAR(pair.measure({}, at({.1, 0, 0}), false).volume, 2 + 2 * 1.0625 - 1, 1e-9);
}

}  // namespace
}  // namespace vpm
