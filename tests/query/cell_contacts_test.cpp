// Contacts with depth images and points: how many there are, what each holds, and that they add up.
#include <gtest/gtest.h>
#include <vpm/device.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "libvpm/cloud/cloud.h"
#include "libvpm/cloud/normals.h"
#include "libvpm/query/tool_query.h"
#include "tests/contact_sums.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

using testing::expect_sums;
using testing::see;

constexpr double kLeftEnd = -.03, kRightBegin = .04;  // m

// Returns the image of a wall at 1 m with two ledges on it, .1 m nearer, left and right.
Cloud ledges() {
  const Camera camera = synthetic::default_camera();
  DepthImage image{camera.width, camera.height, {}};
  image.depth.assign(std::size_t{image.width} * image.height, 1.0F);
  for (std::uint32_t v = 0; v < image.height; ++v)
    for (std::uint32_t u = 0; u < image.width; ++u) {
      const double x = .9 * (u - camera.intrinsics.cx) / camera.intrinsics.fx;
      if (x < kLeftEnd || x > kRightBegin) image.depth[image.index(u, v)] = .9F;
    }
  return assemble_cloud(image, camera, std::vector<Vec3f>(image.depth.size(), {0, 0, -1}));
}

void expect_near(Vec3 a, Vec3 b, double within) {
  EXPECT_LT(norm(a - b), within) << a.x << ' ' << a.y << ' ' << a.z;
}

class CellContacts : public ::testing::Test {
 protected:
  const ToolModel tool_ = testing::lattice_cube(.2, 8, 2);
  ToolQuery query_{tool_, {.contacts = 10}};
};

// Right but for the edges of the ledges, which the image shows to three pixels (5 mm), and the
// area of each depth but for the tool's pieces being balls; of several depths these make up.
TEST_F(CellContacts, OfTwoLedgesAreOneEach) {
  const AnyBody body(ledges());
  double area_left = 0;
  constexpr int kDepths = 5;
  for (int k = 0; k < kDepths; ++k) {
    const double depth = .015 + .0025 * k;  // m, over a piece's edge
    const Result whole = query_.run(body, {{}, {0, 0, .8 + depth}});
    const std::vector<Contact> contacts = query_.contacts();
    ASSERT_EQ(contacts.size(), 2U);
    for (const Contact& c : contacts) {
      const double from = c.centroid.x < 0 ? -.1 : kRightBegin,
                   to = c.centroid.x < 0 ? kLeftEnd : .1, area = .2 * (to - from);
      EXPECT_NEAR(c.volume, area * depth, .2 * .005 * depth);
      expect_near(c.centroid, {(from + to) / 2, 0, .9 + depth / 2}, .003);
      expect_near(c.normal, {0, 0, 1}, 1e-3);
      EXPECT_NEAR(c.area, area, .25 * area);
      EXPECT_NEAR(c.depth, depth, 1e-4);
      expect_near(c.wrench.force, {0, 0, -c.volume}, .01 * c.volume);
      expect_near(c.wrench.torque, {0, c.volume * c.centroid.x, 0}, .05 * c.volume * .1);
    }
    EXPECT_LT(contacts[0].centroid.x, 0) << "the larger";
    area_left += contacts[0].area / kDepths;
    expect_sums(contacts, whole);
  }
  EXPECT_NEAR(area_left, .014, .2 * .004);
  query_.run(body, {{}, {0, 0, .92}});
  EXPECT_EQ(query_.contacts().size(), 1U) << "the tool stands on the wall between them, too";
}

// A convex tool shares one connected piece with a wall, however it stands and however little.
TEST_F(CellContacts, OfOneWallAreOne) {
  const Cloud wall = see(synthetic::make_scene("wall"));
  for (const AnyBody& body : {AnyBody(wall), AnyBody(without_camera(wall))})
    for (const Rotation& turn : {Rotation{}, testing::generic_rotation()})
      for (int k = 0; k < 20; ++k) {
        const Result whole = query_.run(body, {turn, {.01, -.02, .81 + .01 * k}});
        EXPECT_EQ(query_.contacts().size(), whole.volume > 0 ? 1U : 0U) << k;
        expect_sums(query_.contacts(), whole);
      }
}

// Neither the number of threads nor the order of bodies changes a bit.
TEST_F(CellContacts, AddUpInBits) {
  const std::vector<AnyBody> bodies{AnyBody(ledges()), AnyBody(see(synthetic::make_scene("ball"))),
                                    AnyBody(without_camera(see(synthetic::make_scene("step"))))};
  ToolQuery few(tool_, {.stiffness = 3e4, .contacts = 1}), plain(tool_, {});
  std::size_t most = 0;
  for (int k = 0; k < 6; ++k) {
    const Pose pose{testing::generic_rotation(), {.02 * k - .06, -.02, .78 + .04 * k}};
    const Result whole = query_.run(bodies, pose), as_ever = plain.run(bodies, pose);
    const std::vector<Contact> contacts = query_.contacts();
    expect_sums(contacts, whole);
    EXPECT_EQ(whole.volume, as_ever.volume);
    EXPECT_LE(norm(whole.wrench.force - as_ever.wrench.force), 1e-13 * whole.volume);
    most = std::max(most, contacts.size());
    const Result scaled = few.run(bodies, pose);
    expect_sums(few.contacts(), scaled);
    EXPECT_LE(few.contacts().size(), 2U);
    set_thread_count(3);
    query_.run(bodies, pose);
    set_thread_count(0);
    EXPECT_EQ(query_.contacts(), contacts);
    EXPECT_EQ(query_.run(std::vector<AnyBody>{bodies[2], bodies[0], bodies[1]}, pose), whole);
    std::vector<Contact> turned = query_.contacts();
    for (Contact& c : turned) c.body = std::array<std::size_t, 3>{2, 0, 1}[c.body];
    EXPECT_EQ(turned, contacts);
  }
  EXPECT_GE(most, 3U);
}

// Steps of a hundredth of a cell move what a contact holds by as little.
TEST_F(CellContacts, MoveContinuously) {
  const AnyBody body(ledges());
  constexpr double kStep = 2.5e-4, kArea = .02;  // m, m^2: larger than a ledge
  Contact before;
  for (int k = 0; k < 100; ++k) {
    query_.run(body, {{}, {.003, 0, .81 + kStep * k}});
    const std::vector<Contact> contacts = query_.contacts();
    ASSERT_EQ(contacts.size(), 2U);
    if (k > 0) {
      EXPECT_LE(std::abs(contacts[0].volume - before.volume), 1.2 * kArea * kStep);
      expect_near(contacts[0].centroid, before.centroid, 4 * kStep);
      expect_near(contacts[0].wrench.force, before.wrench.force, 1.2 * kArea * kStep);
      EXPECT_LE(std::abs(contacts[0].depth - before.depth), 2 * kStep);
    }
    before = contacts[0];
  }
}

// Of two bodies that are alike, the first comes first.
TEST_F(CellContacts, TellWhichBodyPushes) {
  const Cloud wall = see(synthetic::make_scene("wall"));
  const std::vector<AnyBody> bodies{AnyBody(wall), AnyBody(wall)};
  const Result whole = query_.run(bodies, {{}, {0, 0, .93}});
  const std::vector<Contact> contacts = query_.contacts();
  ASSERT_EQ(contacts.size(), 2U);
  EXPECT_EQ(contacts[0].body, 0U);
  EXPECT_EQ(contacts[1].body, 1U);
  EXPECT_EQ(contacts[0].centroid, contacts[1].centroid);
  expect_sums(contacts, whole);
}

}  // namespace
}  // namespace vpm
