// Contacts of a tool with the bodies of a scene: what each holds, and that they add up in bits.
#include <gtest/gtest.h>
#include <vpm/level_query.h>
#include <vpm/query.h>
#include <vpm/solid.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/api/boxes.h"
#include "tests/contact_sums.h"

namespace {

using vpm::Body;
using vpm::Contact;
using vpm::Pose;
using vpm::Result;
using vpm::Vec3;
using vpm::test::kind_of;
using vpm::testing::expect_sums;

Pose at(double x, double y, double z) {
  return {{}, {x, y, z}};
}

void expect_near(Vec3 a, Vec3 b, double within) {
  EXPECT_NEAR(a.x, b.x, within);
  EXPECT_NEAR(a.y, b.y, within);
  EXPECT_NEAR(a.z, b.z, within);
}

void expect_order(const std::vector<Contact>& contacts) {
  for (std::size_t k = 1; k < contacts.size(); ++k)
    EXPECT_TRUE(contacts[k].patches > 1 || contacts[k].volume <= contacts[k - 1].volume);
}

class Contacts : public testing::Test {
 protected:
  // Returns a wall of which the tool at the origin is `depth` inside, on the side of negative or
  // positive x.
  static Body wall(double depth, bool is_right) {
    static const vpm::SolidBody slab(vpm::test::box({-5, -20, -20}, {5, 20, 20}));
    return Body(slab, at((is_right ? 1 : -1) * (5.1 - depth), 0, 0));
  }
  // Returns `count` cubes of .04 m at random places in and around the tool; some overlap each
  // other.
  static std::vector<Body> cubes(int count) {
    static const vpm::SolidBody cube(vpm::test::box({-.02, -.02, -.02}, {.02, .02, .02}));
    std::mt19937 random(5);
    std::uniform_real_distribution<double> place(-.12, .12);
    std::vector<Body> bodies;
    for (int k = 0; k < count; ++k)
      bodies.push_back(Body(cube, at(place(random), place(random), place(random))));
    return bodies;
  }

  // A cube of edge .2 m.
  const vpm::Tool tool_ = vpm::Tool::read(VPM_SOURCE_DIR "/formats/golden/v1/surface.vpmg");
};

TEST_F(Contacts, OfTwoWallsAreOneEach) {
  constexpr double kStiffness = 1e5;
  vpm::Query query(tool_, {.stiffness = kStiffness, .contacts = 10});
  const vpm::Scene scene({wall(.02, false), wall(.03, true)});
  const Result whole = query.run(scene, at(0, .01, .02));
  const std::vector<Contact> contacts = query.contacts();
  ASSERT_EQ(contacts.size(), 2U);
  for (const Contact& c : contacts) {
    const double depth = c.body == 0 ? .02 : .03, side = c.body == 0 ? -1 : 1;
    EXPECT_NEAR(c.volume, .04 * depth, 1e-11);
    expect_near(c.centroid, {side * (.1 - depth / 2), .01, .02}, 1e-8);
    expect_near(c.normal, {side, 0, 0}, 1e-8);
    EXPECT_NEAR(c.area, .04, 1e-10);
    EXPECT_NEAR(c.depth, depth, 1e-6);
    expect_near(c.wrench.force, {-side * kStiffness * .04 * depth, 0, 0}, 1e-4);
    expect_near(c.wrench.torque, {}, 1e-4);
    EXPECT_EQ(c.patches, 1U);
  }
  EXPECT_EQ(contacts[0].body, 1U) << "the larger";
  expect_sums(contacts, whole);
}

// A tool that is squeezed: forces cancel, and what is left of them is told in bits all the same.
TEST_F(Contacts, WhoseForcesCancelAddUp) {
  vpm::Query query(tool_, {.stiffness = 3e4, .contacts = 10});
  const vpm::Scene scene({wall(.02, false), wall(.02, true)});
  for (int k = 0; k < 20; ++k) {
    const double angle = .005 * k;
    const vpm::Rotation turn =
        vpm::rotation_from_quaternion({0, std::sin(angle), 0, std::cos(angle)});
    const Result whole = query.run(scene, {turn, {1e-6 * k, 0, 0}});
    EXPECT_EQ(query.contacts().size(), 2U);
    EXPECT_LT(std::abs(whole.wrench.force.x), .01 * 3e4 * whole.volume);
    expect_sums(query.contacts(), whole);
  }
}

TEST_F(Contacts, AddUpWhateverTheirNumberAndOrder) {
  std::vector<Body> bodies = cubes(12);
  bodies.push_back(wall(.01, true));
  vpm::Query all(tool_, {.contacts = 100}), few(tool_, {.contacts = 3}), plain(tool_);
  std::vector<std::size_t> order(bodies.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::mt19937 random(7);
  for (int k = 0; k < 8; ++k) {
    const Pose pose = at(.001 * k, -.002 * k, .0005 * k);
    const Result whole = all.run(vpm::Scene(bodies), pose),
                 less = few.run(vpm::Scene(bodies), pose);
    const std::vector<Contact> contacts = all.contacts(), listed = few.contacts();
    ASSERT_GT(contacts.size(), 8U);
    expect_sums(contacts, whole), expect_order(contacts);
    ASSERT_EQ(listed.size(), 4U);
    EXPECT_EQ(listed.back().patches, contacts.size() - 3);
    EXPECT_EQ(listed.back().body, Contact::kSeveralBodies);
    for (std::size_t c = 1; c < 3; ++c) EXPECT_EQ(listed[c], contacts[c]);
    expect_sums(listed, less), expect_order(listed);
    EXPECT_EQ(whole, less);
    const Result as_ever = plain.run(vpm::Scene(bodies), pose);
    EXPECT_TRUE(plain.contacts().empty());
    EXPECT_EQ(whole.volume, as_ever.volume) << "contacts change no bit of it";
    expect_near(whole.wrench.force, as_ever.wrench.force, 1e-13 * whole.volume);
    std::shuffle(order.begin(), order.end(), random);
    std::vector<Body> turned;
    for (const std::size_t place : order) turned.push_back(bodies[place]);
    EXPECT_EQ(all.run(vpm::Scene(turned), pose), whole);
    std::vector<Contact> again = all.contacts();
    for (Contact& c : again) c.body = order[c.body];
    EXPECT_EQ(again, contacts);
  }
}

// Along a path between two walls the contact's quantities move by steps as small as the path's.
TEST_F(Contacts, MoveContinuously) {
  vpm::Query query(tool_, {.contacts = 4});
  const vpm::Scene scene({wall(.015, false), wall(.025, true)});
  constexpr double kStep = 1e-5, kArea = .06;  // m, m^2: larger than any cut
  Contact before;
  for (int k = 0; k < 60; ++k) {
    query.run(scene, at(kStep * k, 0, 0));
    const std::vector<Contact> contacts = query.contacts();
    ASSERT_EQ(contacts.size(), 2U);
    ASSERT_EQ(contacts[0].body, 1U);
    if (k > 0) {
      EXPECT_LE(std::abs(contacts[0].volume - before.volume), kArea * kStep);
      expect_near(contacts[0].centroid, before.centroid, 2 * kStep);
      expect_near(contacts[0].wrench.force, before.wrench.force, kArea * kStep);
    }
    before = contacts[0];
  }
}

TEST_F(Contacts, OfALevelQueryAndOfAnotherQueryAreTheSame) {
  const vpm::Scene scene({wall(.02, false), wall(.03, true)});
  vpm::Query query(tool_, {.contacts = 5});
  vpm::LevelQuery by_level(tool_, {.contacts = 5}, {}, scene, Pose{});
  vpm::Query other = query.another();
  query.run(scene, Pose{}), by_level.run(scene, Pose{}), other.run(scene, Pose{});
  EXPECT_EQ(query.contacts().size(), 2U);
  EXPECT_EQ(by_level.contacts(), query.contacts());
  EXPECT_EQ(other.contacts(), query.contacts());
  query.run(scene, at(0, 0, 90));
  EXPECT_TRUE(query.contacts().empty()) << "nothing is shared there";
}

TEST_F(Contacts, AreNotAskedOfTheMeasureAsPrinted) {
  EXPECT_EQ(kind_of([&] { vpm::Query(tool_, {.measure = vpm::Measure::paper, .contacts = 1}); }),
            vpm::ErrorKind::invalid_argument);
}

}  // namespace
