// Checks that contacts add up to the answer that they are parts of.
#pragma once

#include <gtest/gtest.h>
#include <vpm/query_types.h>

#include <algorithm>
#include <vector>

namespace vpm::testing {

// Expects that the contacts' volumes, forces and torques add up to those of the answer in the same
// bits, in the order of the list and in the opposite one.
inline void expect_sums(std::vector<Contact> contacts, const Result& whole) {
  const auto add = [](Vec3& sum, Vec3 part) {
    sum = {sum.x + part.x, sum.y + part.y, sum.z + part.z};
  };
  for (int turn = 0; turn < 2; ++turn) {
    Contact sum;
    for (const Contact& c : contacts) {
      sum.volume += c.volume;
      add(sum.wrench.force, c.wrench.force), add(sum.wrench.torque, c.wrench.torque);
    }
    EXPECT_EQ(sum.volume, whole.volume);
    EXPECT_EQ(sum.wrench, whole.wrench);
    std::reverse(contacts.begin(), contacts.end());
  }
}

}  // namespace vpm::testing
