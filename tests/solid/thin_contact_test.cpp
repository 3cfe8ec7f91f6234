// Forces of thin overlaps are right relative to themselves, whatever the solids' sizes are: 10 um
// deep and more between parts of 0.1 m.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "libvpm/synthetic/shapes.h"
#include "tests/solid/depth_truth.h"
#include "tests/solid/pair_cases.h"

namespace vpm {
namespace {

using synthetic::make_box;
using synthetic::make_icosphere;

// Returns the hull of two outlines of equally many corners in planes across z, the second higher.
Solid prism(const std::vector<Vec3>& low, const std::vector<Vec3>& high) {
  const auto n = static_cast<std::uint32_t>(low.size());
  Solid solid;
  for (const auto& outline : {low, high})
    solid.vertices.insert(solid.vertices.end(), outline.begin(), outline.end());
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t next = (k + 1) % n;
    solid.triangles.push_back({k, next, n + next});
    solid.triangles.push_back({k, n + next, n + k});
    if (k == 0 || next == 0) continue;
    solid.triangles.push_back({0, next, k});
    solid.triangles.push_back({n, n + k, n + next});
  }
  return solid;
}

std::vector<Vec3> circle(double radius, double z, int sides) {
  std::vector<Vec3> corners;
  for (int k = 0; k < sides; ++k) {
    const double angle = 2 * M_PI * (k + .5) / sides;
    corners.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
  }
  return corners;
}

Solid cylinder(double radius, double length, int sides) {
  return prism(circle(radius, -.5 * length, sides), circle(radius, .5 * length, sides));
}

// Returns a cone with its tip at the origin, below its base.
Solid cone(double radius, double height, int sides) {
  Solid solid;
  solid.vertices = circle(radius, height, sides);
  const auto n = static_cast<std::uint32_t>(sides);
  solid.vertices.push_back({});
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t next = (k + 1) % n;
    solid.triangles.push_back({n, next, k});
    if (k != 0 && next != 0) solid.triangles.push_back({0, k, next});
  }
  return solid;
}

// Returns a disk across z with a round hole. Corners: inner and outer ones below, then above.
Solid disk_with_hole(double radius, double thickness, double hole, int sides) {
  Solid solid;
  const auto n = static_cast<std::uint32_t>(sides);
  for (const double z : {-.5 * thickness, .5 * thickness})
    for (const double r : {hole, radius})
      for (const Vec3& v : circle(r, z, sides)) solid.vertices.push_back(v);
  for (std::uint32_t k = 0; k < n; ++k)
    for (const auto& [a, b] : {std::pair{0u, n}, {n, 3 * n}, {3 * n, 2 * n}, {2 * n, 0u}}) {
      const std::uint32_t next = (k + 1) % n;
      solid.triangles.push_back({a + k, a + next, b + next});
      solid.triangles.push_back({a + k, b + next, b + k});
    }
  return solid;
}

// Returns the sectors of a disk_with_hole(). The nearest part of the wall of the hole is an edge
// for some places near where sectors join; the facets beside that are as near, but for half their
// angle.
test::ConvexParts sectors_of(const Solid& disk) {
  const auto n = static_cast<std::uint32_t>(disk.vertices.size() / 4);
  test::ConvexParts parts;
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t next = (k + 1) % n;
    std::vector<Vec3> low, high;
    for (const std::uint32_t v : {k, n + k, n + next, next}) {
      low.push_back(disk.vertices[v]);
      high.push_back(disk.vertices[2 * n + v]);
    }
    const test::ConvexPart whole = test::one_part(prism(low, high))[0];
    const Vec3 along = normalized_or_zero(cross(high[0] - low[0], low[1] + low[2]));
    test::ConvexPart part{whole.region, {}};
    for (const test::HalfSpace& face : whole.faces)
      if (std::abs(dot(face.n, along)) < .5) part.faces.push_back(face);
    parts.push_back(part);
  }
  return parts;
}

// Errors that forces may have, relative to themselves, and work along closed paths, relative to
// what is done and given back.
constexpr double kMost = .07, kMostWork = .02;

struct Thin {
  const char* name;
  Solid a, b;
  Vec3 turn;   // of a, a rotation vector
  Vec3 start;  // of a, where it does not touch b
  Vec3 way;    // along which it does
};

std::vector<Thin> thin_contacts() {
  const Solid wall = make_box(.2, .18, .1), disk = disk_with_hole(.03, .01, .005, 32);
  const Solid rod = cylinder(.02, .1, 48), peg = cylinder(.0045, .03, 32);
  const Vec3 up{.003, .002, .2}, down{0, 0, -1};
  return {
      {"slab on a slab", make_box(.1, .1, .05), wall, {0, 0, .3}, up, down},
      {"slab over a rim", make_box(.1, .1, .05), wall, {0, 0, 1.1}, {.07, .05, .2}, down},
      {"slab, tilted", make_box(.1, .1, .05), wall, {2e-4, 1e-4, .7}, up, down},
      {"sheet on its edge", make_box(.001, .1, .1), wall, {0, 0, .4}, up, down},
      {"edge in a plane", make_box(.08, .08, .08), wall, {0, M_PI / 4, 0}, up, down},
      {"corner in a plane", make_box(.08, .08, .08), wall, {.7, .5, .2}, up, down},
      {"edge in an edge",
       make_box(.08, .08, .08),
       make_box(.1, .1, .1),
       {0, M_PI / 4, .2},
       {.09, .002, .2},
       {-.2, 0, -1}},
      {"tip in a plane", cone(.03, .05, 32), wall, {.1, .2, 0}, up, down},
      {"ball in a plane", make_icosphere(.05, 2), wall, {.3, .2, .1}, up, down},
      {"ball in a ball", make_icosphere(.05, 2), make_icosphere(.05, 2), {.3, .2, .1}, up, down},
      {"coarse balls", make_icosphere(.05, 1), make_icosphere(.04, 2), {.3, .2, .1}, up, down},
      {"rods across", rod, rod, {M_PI / 2, 0, 0}, {.2, .003, .01}, {-1, 0, 0}},
      {"rods askew", rod, rod, {.5, .02, .1}, {.2, .003, .01}, {-1, 0, 0}},
      {"rod on a plane", rod, wall, {M_PI / 2, 0, .3}, up, down},
      {"rim of a rod in a plane", rod, wall, {.4, .1, 0}, up, down},
      {"peg in a hole", peg, disk, {}, {}, {1, .3, 0}},
      {"peg askew in a hole", peg, disk, {.01, -.02, .1}, {}, {1, .2, .1}}};
}

test::ConvexParts parts_of(const Solid& solid) {
  return solid.vertices.size() == 4 * 32 && solid.triangles.size() == 8 * 32
             ? sectors_of(solid)
             : test::one_part(solid);
}

// Two solids that touch along a line of approach: as the bodies that are measured, and as the
// convex parts whose overlap gives the true force.
class ThinContact {
 public:
  explicit ThinContact(const Thin& thin)
      : turn_(rotation_from_vector(thin.turn)),
        start_(thin.start),
        way_(normalized_or_zero(thin.way)),
        a_(parts_of(thin.a)),
        b_(parts_of(thin.b)),
        pair_(test::surface(thin.a, true), test::surface(thin.b, true)) {
    double high = 1e-4;
    for (; !(truth(pose(high), false).volume > 0); high *= 1.5) touch_ = high;
    while (high - touch_ > 1e-10) {
      const double middle = .5 * (touch_ + high);
      (truth(pose(middle), false).volume > 0 ? high : touch_) = middle;
    }
  }

  // Returns the pose of a, so far along the way from first touch and so far aside.
  Pose at_depth(double depth, double aside = 0) const {
    Pose at = pose(touch_ + depth);
    at.translation += aside * normalized_or_zero(cross(way_, Vec3{.3, .9, .2}));
    return at;
  }
  test::DepthTruth truth(const Pose& pose_a, bool with_force = true) const {
    return test::depth_truth(test::moved(a_, pose_a), b_, with_force);
  }
  SharedSolid measure(const Pose& pose_a) { return pair_.measure(pose_a, {}); }

 private:
  Pose pose(double along) const { return {turn_, start_ + along * way_}; }

  Rotation turn_;
  Vec3 start_, way_;
  test::ConvexParts a_, b_;
  SolidPair pair_;
  double touch_ = 0;  // along the way
};

// Prepared once.
std::vector<std::pair<std::string, ThinContact>>& prepared() {
  static std::vector<std::pair<std::string, ThinContact>> contacts = [] {
    std::vector<std::pair<std::string, ThinContact>> all;
    for (const Thin& thin : thin_contacts()) all.emplace_back(thin.name, ThinContact(thin));
    return all;
  }();
  return contacts;
}

// Forces err by .07 of themselves at most, and lines of action by as much of the contact's extent
// and 2 um. Sums of such small volumes resolve centroids to 3 um.
TEST(ThinContact, ForcesAreRightRelativeToThemselves) {
  for (auto& [name, contact] : prepared()) {
    for (const double depth : {1e-5, 1e-4, 5e-4}) {
      SCOPED_TRACE(name + ", " + std::to_string(1e6 * depth) + " um");
      const Pose pose = contact.at_depth(depth);
      const test::DepthTruth truth = contact.truth(pose);
      const SharedSolid shared = contact.measure(pose);
      const double force = norm(truth.force);
      ASSERT_GT(force, 0);
      EXPECT_NEAR(shared.volume / truth.volume, 1, 1e-4);
      EXPECT_LE(norm(shared.force - truth.force), kMost * force);
      const Vec3 off = shared.centroid - truth.centroid,
                 torque = shared.torque + cross(off, shared.force);  // about the true centroid
      EXPECT_LE(norm(torque - truth.torque), force * (kMost * truth.extent + 2e-6));
      EXPECT_LE(norm(off), 3e-6);
    }
  }
}

// Moves a solid along a closed path on which it always touches the other: the force may do no work
// in all, since it is the gradient of an energy.
TEST(ThinContact, ForcesDoNoWorkAlongClosedPaths) {
  for (auto& [name, contact] : prepared()) {
    SCOPED_TRACE(name);
    constexpr int kSteps = 64;
    const double half = 4e-5;
    Vec3 last_force, last_place;
    double work = 0, moved = 0;
    for (int k = 0; k <= kSteps; ++k) {
      const double angle = 2 * M_PI * k / kSteps;
      const Pose pose = contact.at_depth(6e-5 + half * std::cos(angle), half * std::sin(angle));
      const Vec3 force = contact.measure(pose).force, step = pose.translation - last_place;
      if (k > 0) {
        work += .5 * dot(force + last_force, step);
        moved += .5 * std::abs(dot(force + last_force, step));
      }
      last_force = force, last_place = pose.translation;
    }
    EXPECT_LE(std::abs(work), kMostWork * moved);
  }
}

}  // namespace
}  // namespace vpm
