// Force and torque of the energy of depth, against analysis and fine cubature.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>
#include <utility>
#include <vector>

#include "libvpm/synthetic/shapes.h"
#include "tests/solid/pair_cases.h"

namespace vpm {
namespace {

using synthetic::make_box;
using synthetic::make_cube;
using synthetic::make_icosphere;
using synthetic::make_tetrahedron;
using synthetic::make_torus;
using test::at;
using test::surface;

// Returns ∫ -d n dA and its moment about the origin over the part of a's surface inside of b, with
// the depth d below b's nearest face, by triangles no larger than `size`.
std::pair<Vec3, Vec3> pushed_out_of(const Solid& a, const Solid& b, double size) {
  Vec3 force, torque;
  std::vector<std::pair<Vec3, double>> planes;
  for (const auto& [i, j, k] : b.triangles) {
    const Vec3 p = b.vertices[i];
    const Vec3 n = normalized_or_zero(cross(b.vertices[j] - p, b.vertices[k] - p));
    planes.push_back({n, dot(n, p)});
  }
  const auto depth = [&](Vec3 x) {
    double least = HUGE_VAL;
    for (const auto& [n, offset] : planes) least = std::min(least, offset - dot(n, x));
    return std::max(least, 0.0);
  };
  const std::function<void(Vec3, Vec3, Vec3)> add = [&](Vec3 p, Vec3 q, Vec3 r) {
    if (std::max({norm(q - p), norm(r - q), norm(p - r)}) > size) {
      const Vec3 pq = 0.5 * (p + q), qr = 0.5 * (q + r), rp = 0.5 * (r + p);
      add(p, pq, rp), add(pq, q, qr), add(rp, qr, r), add(pq, qr, rp);
      return;
    }
    const Vec3 n = 0.5 * cross(q - p, r - p);
    for (const Vec3 x : {0.5 * (p + q), 0.5 * (q + r), 0.5 * (r + p)}) {
      const Vec3 f = -depth(x) / 3 * n;
      force += f, torque += cross(x, f);
    }
  };
  for (const auto& [i, j, k] : a.triangles) {
    const auto part = test::clipped({a.vertices[i], a.vertices[j], a.vertices[k]}, b);
    for (std::size_t m = 2; m < part.size(); ++m) add(part[0], part[m - 1], part[m]);
  }
  return {force, torque};
}

struct Truth {
  Vec3 force, torque;  // torque about the centroid
};

Truth truth_of(const Solid& a, const Solid& b, Vec3 centroid, double size) {
  const double v = mass_properties(a).volume, w = mass_properties(b).volume,
               of_b = w * w / (v * v + w * w);
  const auto [f, t] = pushed_out_of(a, b, size);
  const auto [g, u] = pushed_out_of(b, a, size);
  const Vec3 force = of_b * f - (1 - of_b) * g, torque = of_b * t - (1 - of_b) * u;
  return {force, torque - cross(centroid, force)};
}

// A large box is a half-space: pressure is depth, so the force is the volume, through its centroid.
TEST(PairForce, AgainstAHalfSpaceIsTheVolume) {
  const auto wall = surface(make_box(20, 20, 10), true);
  std::mt19937_64 random(1);
  for (const Solid& solid : {make_torus(.4, .15, 48, 24), make_icosphere(.5, 3), make_cube(.6),
                             make_box(.5, .5, .01), make_tetrahedron(.8)}) {
    const auto tool = surface(solid, true);
    SolidPair pair(tool, wall);
    for (int k = 0; k < 6; ++k) {
      Pose pose = test::random_pose(random, .2);
      pose.translation.z += 5;
      const SharedSolid shared = pair.measure(pose, {});
      ASSERT_GT(shared.volume, 0);
      const double error = 1e-8 * tool->volume();
      EXPECT_NEAR(shared.force.z, shared.volume, error);
      EXPECT_NEAR(std::hypot(shared.force.x, shared.force.y), 0, error);
      EXPECT_NEAR(std::hypot(shared.torque.x, shared.torque.y), 0, error * tool->reach());
    }
  }
}

struct Pairing {
  const char* name;
  Solid a, b;
  double most;  // mean error, of the smaller solid
};

TEST(PairForce, OfConvexSolidsAgreesWithCubature) {
  const std::vector<Pairing> cases{
      {"cubes", make_cube(1), make_cube(1), 5e-4},
      {"tetrahedron and cube", make_tetrahedron(1.2), make_cube(1), 5e-4},
      {"plate and cube", make_box(1, 1, .01), make_cube(1), 5e-4},
      {"ball and box", make_icosphere(.5, 2), make_box(1, .8, .6), 5e-4}};
  std::mt19937_64 random(2);
  for (const Pairing& c : cases) {
    SCOPED_TRACE(c.name);
    const auto a = surface(c.a, true), b = surface(c.b, true);
    SolidPair pair(a, b);
    const double small = std::min(a->volume(), b->volume()),
                 reach = std::min(a->reach(), b->reach());
    double sum = 0, torques = 0;
    int met = 0;
    for (int k = 0; met < 4; ++k) {
      ASSERT_LT(k, 100);
      const Pose pose_a = test::random_pose(random, .45), pose_b = test::random_pose(random, .45);
      const SharedSolid shared = pair.measure(pose_a, pose_b);
      if (shared.volume < .01 * small) continue;
      ++met;
      const Truth truth =
          truth_of(test::moved(c.a, pose_a), test::moved(c.b, pose_b), shared.centroid, reach / 30);
      const double off = norm(shared.force - truth.force) / small,
                   off_torque = norm(shared.torque - truth.torque) / (small * reach);
      EXPECT_LE(off, 2e-3) << k;
      EXPECT_LE(off_torque, 2e-3) << k;
      sum += off, torques += off_torque;
      if (norm(truth.force) < .1 * shared.volume) continue;
      const double sine =
          norm(cross(shared.force, truth.force)) / norm(shared.force) / norm(truth.force);
      EXPECT_LE(std::asin(std::min(1.0, sine)) * 180 / M_PI, 1) << k;
    }
    EXPECT_LE(sum / met, c.most);
    EXPECT_LE(torques / met, c.most);
  }
}

// Returns a prism about the origin whose base has so many sides.
Solid make_prism(std::uint32_t sides, double radius, double height) {
  Solid prism;
  for (std::uint32_t k = 0; k < sides; ++k) {
    const double angle = 2 * M_PI * k / sides;
    for (const double z : {-height / 2, height / 2})
      prism.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
  }
  for (std::uint32_t k = 0; k < sides; ++k) {
    const std::uint32_t low = 2 * k, next = 2 * ((k + 1) % sides);
    prism.triangles.push_back({low, next, next + 1});
    prism.triangles.push_back({low, next + 1, low + 1});
    if (k == 0 || next == 0) continue;
    prism.triangles.push_back({0, next, low});
    prism.triangles.push_back({1, low + 1, next + 1});
  }
  return prism;
}

// The depth below a convex solid with few faces is not sampled: forces have no error but rounding
// and the jitter, whatever the sizes, however thin the solids are, and however much they share.
TEST(PairForce, OfConvexSolidsWithFewFacesIsExact) {
  const Solid cube = make_cube(1), octahedron = synthetic::make_octahedron(1);
  const std::pair<Solid, Solid> pairs[]{{cube, cube},
                                        {make_tetrahedron(1.2), cube},
                                        {octahedron, make_box(1, 1, .01)},
                                        {make_box(1, 1, .01), cube},
                                        {make_box(1, 1, .01), make_box(1, 1, .01)},
                                        {make_box(.02, .02, 2), octahedron},
                                        {make_prism(30, .5, 1), make_prism(5, .6, .4)},
                                        {make_box(20, 15, 10), make_prism(8, .5, 1)}};
  std::mt19937_64 random(3);
  for (const auto& [solid_a, solid_b] : pairs) {
    const auto a = surface(solid_a, true), b = surface(solid_b, true);
    ASSERT_TRUE(a->face_planes() && b->face_planes());
    const test::ConvexParts parts_a = test::one_part(solid_a), parts_b = test::one_part(solid_b);
    SolidPair pair(a, b);
    const double small = std::min(a->volume(), b->volume()),
                 reach = std::min(a->reach(), b->reach());
    int met = 0;
    for (int k = 0; met < 12; ++k) {
      ASSERT_LT(k, 1000);
      const Pose pose_a = test::random_pose(random, .45 * b->reach()),
                 pose_b = test::random_pose(random, .1);
      const SharedSolid shared = pair.measure(pose_a, pose_b, true, 4);
      const test::DepthTruth truth =
          test::depth_truth(test::moved(parts_a, pose_a), test::moved(parts_b, pose_b));
      if (shared.volume < 1e-6 * small) continue;
      ++met;
      EXPECT_LE(norm(shared.force - truth.force), 1e-7 * small) << k;
      EXPECT_LE(norm(shared.torque - truth.torque), 1e-7 * small * reach) << k;
      ASSERT_EQ(shared.contacts.size(), 1);
      EXPECT_EQ(shared.contacts[0].force, shared.force);
      EXPECT_GT(shared.contacts[0].depth, 0);
    }
  }
}

// Forces do not jump along paths in steps of a 4000th of the smaller reach: their second
// differences are small. Tried are faces that are curved, large or flush, and plates and a needle,
// whose cuts pass the corners of many small pieces.
TEST(PairForce, DoesNotJumpAlongPaths) {
  struct Path {
    Solid a, b;
    Vec3 turn, way;
    double start;  // distance of the centres, with a 20th of the smaller solid shared or nearly
    double most = 2e-4;  // jump of the force, of the smaller solid
    double most_of_volume = 1e-6;
  };
  const Solid cube = make_cube(.1), plate = make_box(.1, .1, .001), ball = make_icosphere(.05, 3),
              tetrahedron = make_tetrahedron(.12);
  const Path paths[]{
      {make_torus(.4, .15, 48, 24), make_box(.6, .5, .4), {-.3, -.7, -.1}, {1, .3, .1}, .52},
      {cube, cube, {}, {1, 0, 0}, .095},
      {cube, cube, {.3, .5, .2}, {1, .3, .2}, .0989},
      {synthetic::make_octahedron(.1), plate, {.2, .3, .1}, {.2, .1, 1}, .0554},
      {plate, cube, {.4, .1, .2}, {1, .1, .4}, .1014},
      {plate, cube, {.08, -1.92, .03}, {.75, .16, .64}, .0965, 7e-4, 1e-5},
      {synthetic::make_octahedron(.1),
       plate,
       {-.1, -.92, -.86},
       {.78, -.13, -.61},
       .0470,
       6e-4,
       1e-5},
      {make_box(.002, .002, .2), ball, {.4, .3, 0}, {1, .1, .2}, .0505, 5e-4, 1e-5},
      {ball, ball, {.3, .5, .2}, {1, .3, .2}, .0815},
      {tetrahedron, cube, {.7, -.2, .4}, {.3, 1, .2}, .0885}};
  for (const Path& path : paths) {
    const auto a = surface(path.a, true), b = surface(path.b, true);
    SolidPair pair(a, b);
    const double smaller = std::min(a->volume(), b->volume()),
                 step = std::min(a->reach(), b->reach()) / 4000;
    const Rotation turn = exact_rotation(rotation_from_vector(path.turn));
    std::vector<SharedSolid> shared;
    for (int k = 0; k < 200; ++k) {
      const double apart = path.start - k * step;
      shared.push_back(pair.measure({}, {turn, apart * normalized_or_zero(path.way)}));
    }
    EXPECT_GT(shared.back().volume, .05 * smaller);
    for (std::size_t k = 2; k < shared.size(); ++k) {
      const auto& [p, q, r] = std::tie(shared[k - 2], shared[k - 1], shared[k]);
      EXPECT_LE(std::abs(p.volume - 2 * q.volume + r.volume), path.most_of_volume * smaller)
          << path.start;
      EXPECT_LE(norm(p.force - 2 * q.force + r.force), path.most * smaller)
          << path.start << " " << k;
    }
  }
}

// Of two cubes that are flush on four sides only the other two faces push: sides lie at depth 0,
// however far the other's end cuts into them.
TEST(PairForce, IsNothingAtFlushSides) {
  const Solid cube = make_cube(.1);
  SolidPair pair(surface(cube, true), surface(cube, true));
  for (const double deep : {.00313, .00513, .00587, .00613, .0117}) {
    const Vec3 force = pair.measure({}, at({.1 - deep, 0, 0})).force;
    EXPECT_LT(std::hypot(force.y, force.z), 5e-3 * std::abs(force.x)) << deep;
  }
}

// An enclosed solid is pushed toward the nearest face of the other.
TEST(PairForce, ActsOnAnEnclosedSolid) {
  const auto a = surface(make_cube(.2), true), b = surface(make_cube(2), true);
  SolidPair pair(a, b);
  const SharedSolid shared = pair.measure(at({.7, .1, -.2}), {});
  EXPECT_NEAR(shared.volume, .008, 1e-11);
  EXPECT_NEAR(shared.force.x, .008, 1e-5 * .008);
  EXPECT_NEAR(std::hypot(shared.force.y, shared.force.z), 0, 1e-5 * .008);
}

// Far apart, at a touch and without force: nothing.
TEST(PairForce, IsNothingWithoutContact) {
  const auto a = surface(make_cube(1), true), b = surface(make_cube(1), true);
  SolidPair pair(a, b);
  for (const double place : {1.5, 3.0, 1e6}) {
    const SharedSolid shared = pair.measure(at({place, 0, 0}), {});
    EXPECT_EQ(shared.volume, 0);
    EXPECT_EQ(shared.force, Vec3{});
    EXPECT_EQ(shared.torque, Vec3{});
  }
}

}  // namespace
}  // namespace vpm
