// Contacts of two solids: how many there are, what each holds, and that they add up.
#include <gtest/gtest.h>
#include <vpm/solid.h>

#include <cmath>
#include <map>
#include <numbers>

#include "libvpm/api/handle_access.h"
#include "libvpm/synthetic/shapes.h"
#include "tests/solid/pair_cases.h"

namespace vpm {
namespace {

using synthetic::make_box;
using synthetic::make_icosphere;
using synthetic::make_torus;
using synthetic::make_torus_knot;
using test::append;
using test::at;
using test::turned;

SolidBody body(const Solid& solid) {
  const Enclosure enclosure = enclosure_of(solid);
  return HandleAccess::make<SolidBody>(
      SolidSurface(enclosure.surface ? *enclosure.surface : solid, true));
}

Overlap overlap_of(const Solid& a, const Solid& b, const Pose& pose, std::uint32_t count = 100) {
  return overlap(body(a), {}, body(b), pose, {.contacts = count});
}

// The contract of a list of contacts: exact sums, in any order, and its own order.
void expect_sums(const Overlap& whole) {
  double there = 0, back = 0;
  Wrench sum;
  for (const Contact& c : whole.contacts) {
    there += c.volume, sum.force += c.wrench.force, sum.torque += c.wrench.torque;
    EXPECT_GT(c.volume, 0);
    EXPECT_GE(c.depth, 0);
  }
  for (std::size_t k = whole.contacts.size(); k-- > 0;) back += whole.contacts[k].volume;
  EXPECT_EQ(there, whole.volume);
  EXPECT_EQ(back, whole.volume);
  if (whole.contacts.empty()) return;
  EXPECT_EQ(sum, whole.wrench);
  for (std::size_t k = 1; k < whole.contacts.size(); ++k)
    EXPECT_TRUE(whole.contacts[k].patches > 1 ||
                whole.contacts[k].volume <= whole.contacts[k - 1].volume);
}

// Two pegs through the two triangles of a plate's face: neither the plate nor its triangles join
// them. Pegs of different sides, so that which is which is known.
TEST(Contacts, PegsInAPlateAreOneEach) {
  Solid pegs;
  append(pegs, make_box(.02, .02, .1), {-.2, .11, 0});
  append(pegs, make_box(.03, .03, .1), {.19, .12, 0});
  append(pegs, make_box(.04, .04, .1), {.13, -.2, 0});
  const Overlap whole = overlap_of(make_box(1, 1, .04), pegs, at({0, 0, .055}));
  expect_sums(whole);
  ASSERT_EQ(whole.contacts.size(), 3u);
  const double sides[] = {.04, .03, .02};
  const Vec3 places[] = {{.13, -.2, 0}, {.19, .12, 0}, {-.2, .11, 0}};
  for (std::size_t k = 0; k < 3; ++k) {
    const Contact& c = whole.contacts[k];
    const double area = sides[k] * sides[k];
    EXPECT_NEAR(c.volume, area * .015, 1e-11);
    EXPECT_LT(norm(c.centroid - (places[k] + Vec3{0, 0, .0125})), 1e-7);
    EXPECT_LT(norm(c.normal - Vec3{0, 0, 1}), 1e-6);
    EXPECT_NEAR(c.area, area, 1e-9);
    EXPECT_NEAR(c.depth, .015, 1e-9);
    EXPECT_NEAR(c.wrench.force.z, -c.volume, 1e-3 * c.volume);
    EXPECT_EQ(c.patches, 1u);
  }
}

// Pins that are flat in a block by half a millimetre: all places of their ends are as deep.
TEST(Contacts, ShallowPinsAreAsDeepAsTheyReach) {
  Solid pins;
  for (const auto& [x, side] : {std::pair(.016, .01), std::pair(.051, .02), std::pair(.0775, .005)})
    append(pins, make_box(side, side, .04), {x, .015, .0395});
  const Overlap whole = overlap_of(make_box(.2, .1, .04), pins, {});
  expect_sums(whole);
  ASSERT_EQ(whole.contacts.size(), 3u);
  for (const Contact& c : whole.contacts) EXPECT_NEAR(c.depth, .0005, 1e-9);
}

// Tubes through a plate: the plate's face has a ring inside each, with a hole that only the ring
// joins to it.
TEST(Contacts, TubesThroughAPlateAreOneEach) {
  Solid tubes;
  for (const double x : {-.2, .13}) {
    append(tubes, make_box(.06, .06, .2), {x, .11, 0});
    append(tubes, turned(make_box(.03, .03, .16)), {x, .11, 0});
  }
  for (const double z : {0., .03}) {
    const Overlap whole = overlap_of(make_box(1, 1, .04), tubes, at({0, 0, z}));
    expect_sums(whole);
    ASSERT_EQ(whole.contacts.size(), 2u);
    for (const Contact& c : whole.contacts)
      EXPECT_NEAR(c.volume, (.06 * .06 - .03 * .03) * .04, 1e-11);
  }
}

// The teeth of a comb are joined by its back, which is outside of the plate.
TEST(Contacts, TeethOfACombAreOneEach) {
  constexpr int kTeeth = 7;
  Solid comb = make_box(.8, .05, .05);
  for (int k = 0; k < kTeeth; ++k) append(comb, make_box(.02, .02, .2), {.1 * (k - 3), 0, -.1});
  const Overlap whole = overlap_of(comb, make_box(1, 1, .1), at({0, 0, -.2}));
  expect_sums(whole);
  ASSERT_EQ(whole.contacts.size(), static_cast<std::size_t>(kTeeth));
  for (const Contact& c : whole.contacts) {
    EXPECT_NEAR(c.volume, .02 * .02 * .05, 1e-11);
    EXPECT_LT(norm(c.normal - Vec3{0, 0, -1}), 1e-6);
  }
}

TEST(Contacts, TorusThroughAPlateIsTwo) {
  const Solid torus = make_torus(.3, .1, 64, 32);
  const Pose upright{exact_rotation(rotation_from_vector({std::numbers::pi / 2 + .01, 0, 0})),
                     {.02, 0, .03}};
  const Overlap through = overlap_of(make_box(2, 2, .02), torus, upright);
  expect_sums(through);
  ASSERT_EQ(through.contacts.size(), 2u);
  for (const Contact& c : through.contacts) {
    EXPECT_NEAR(c.volume, std::numbers::pi * .01 * .02, .03 * std::numbers::pi * .01 * .02);
    EXPECT_NEAR(std::abs(c.centroid.x - .02), .3, .01);
  }
  const Overlap lying = overlap_of(make_box(2, 2, .02), torus, at({0, 0, .02}));
  EXPECT_EQ(lying.contacts.size(), 1u) << "a ring";
}

TEST(Contacts, ContainedSolidIsOne) {
  const Overlap one = overlap_of(make_box(1, 1, 1), make_icosphere(.2, 3), at({.1, 0, 0}));
  expect_sums(one);
  ASSERT_EQ(one.contacts.size(), 1u);
  EXPECT_EQ(one.contacts[0].volume, one.volume);
  EXPECT_NEAR(one.contacts[0].depth, .428, .01) << "of the place nearest to the middle";
}

// The wall of a hollow belongs to what is around it, and what is in the hollow does not.
TEST(Contacts, HollowsBelongToWhatIsAroundThem) {
  Solid shells;
  append(shells, make_icosphere(.2, 2), {-.25, 0, 0});
  append(shells, turned(make_icosphere(.1, 2)), {-.25, 0, 0});
  append(shells, make_icosphere(.05, 2), {-.25, 0, 0});
  append(shells, make_icosphere(.15, 2), {.25, 0, 0});
  const Overlap whole = overlap_of(make_box(1, 1, 1), shells, {});
  expect_sums(whole);
  ASSERT_EQ(whole.contacts.size(), 3u);
  const double ball = mass_properties(make_icosphere(1, 2)).volume;
  EXPECT_NEAR(whole.contacts[0].volume, ball * (.008 - .001), 1e-9);
  EXPECT_NEAR(whole.contacts[1].volume, ball * .003375, 1e-9);
  EXPECT_NEAR(whole.contacts[2].volume, ball * .000125, 1e-9);
}

// Returns the solid of a lattice of small balls, most of which a plane cuts or leaves inside.
Solid balls(int across) {
  Solid all;
  for (int i = 0; i < across; ++i)
    for (int j = 0; j < across; ++j)
      append(all, make_icosphere(.02 + .001 * (i + across * j) / across, 1), {.1 * i, .1 * j, 0});
  return all;
}

TEST(Contacts, RestIsSummedInOne) {
  const Overlap all = overlap_of(make_box(4, 4, 1), balls(4), at({.01, .02, .51})),
                few = overlap_of(make_box(4, 4, 1), balls(4), at({.01, .02, .51}), 3);
  expect_sums(all);
  expect_sums(few);
  ASSERT_EQ(all.contacts.size(), 16u);
  ASSERT_EQ(few.contacts.size(), 4u);
  EXPECT_EQ(few.contacts.back().patches, 13u);
  EXPECT_EQ(few.volume, all.volume);
  EXPECT_EQ(few.wrench, all.wrench);
  for (std::size_t k = 1; k < 3; ++k) EXPECT_EQ(few.contacts[k], all.contacts[k]);
}

std::vector<Solid> solids_of_contacts() {
  Solid comb = make_box(.8, .1, .1);
  for (int k = 0; k < 5; ++k) append(comb, make_box(.05, .06, .4), {.15 * (k - 2), 0, -.2});
  return {make_box(.5, .4, .3), comb, balls(3), make_torus(.3, .1, 40, 20),
          make_torus_knot(2, 3, .25, .1, .05, 160, 8)};
}

// Contacts add up in bits, change nothing of the whole, and are the same whichever is called a.
TEST(Contacts, OfRandomPairsAddUpAndDoNotDependOnTheOrder) {
  std::mt19937_64 random(11);
  std::vector<SolidBody> all;
  for (const Solid& solid : solids_of_contacts()) all.push_back(body(solid));
  std::map<std::size_t, int> counts;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i; j < all.size(); ++j) {
      OverlapQuery query(all[i], all[j], {.contacts = 100}), plain(all[i], all[j]),
          back(all[j], all[i], {.contacts = 100});
      for (int k = 0; k < 6; ++k) {
        const Pose a = test::random_pose(random, .2), b = test::random_pose(random, .2);
        Overlap with = query.run(a, b), turned = back.run(b, a);
        expect_sums(with);
        ++counts[with.contacts.size()];
        ASSERT_EQ(with.contacts.size(), turned.contacts.size());
        for (std::size_t c = 0; c < with.contacts.size(); ++c) {
          Contact& other = turned.contacts[c];
          other.normal = -other.normal;
          other.wrench = {-other.wrench.force, -other.wrench.torque};
          EXPECT_EQ(with.contacts[c], other);
        }
        with.contacts.clear();
        EXPECT_EQ(with, plain.run(a, b));
      }
    }
  EXPECT_GE(counts[1], 10);
  EXPECT_GE(counts[2], 10);
  EXPECT_GE(counts[4] + counts[5], 2);
}

// The largest contact's volume moves by its gradient along a path, but where contacts merge.
TEST(Contacts, MoveContinuouslyButWhereTheyMergeOrSplit) {
  const SolidBody torus = body(make_torus(.3, .1, 40, 20)), box = body(make_box(.5, .4, .3));
  OverlapQuery query(torus, box, {.with_force = false, .contacts = 10});
  Overlap before;
  int compared = 0;
  constexpr double kStep = .6 / 4000;
  for (int k = 0; k < 4000; k += k % 40 == 0 ? 1 : 39) {  // pairs of neighbours
    const Overlap now = query.run(
        {}, {exact_rotation(rotation_from_vector({.3, .2, .1})), {kStep * k - .3, .02, .05}});
    if (k % 40 == 1 && now.contacts.size() == before.contacts.size() && !now.contacts.empty()) {
      const Contact &c = now.contacts[0], &d = before.contacts[0];
      // The volume's gradient is the area vector, that of the box's turned.
      const double most = kStep * (std::max(c.area, d.area) * 1.5 + 1e-3);
      EXPECT_LE(std::abs(c.volume - d.volume), most);
      EXPECT_LE(norm(c.centroid - d.centroid), 20 * kStep);
      ++compared;
    }
    before = now;
  }
  EXPECT_GE(compared, 40);
}

}  // namespace
}  // namespace vpm
