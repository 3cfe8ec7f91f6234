// Compares results that must have the same bits.
#pragma once

#include <gtest/gtest.h>
#include <vpm/query_types.h>

namespace vpm::testing {

// Expects equal bits. `scale`, a power of two, is the length unit of b's scene in that of a's.
inline void expect_equal(const Result& a, const Result& b, double scale = 1) {
  const double cubed = scale * scale * scale;
  EXPECT_EQ(cubed * a.volume, b.volume);
  EXPECT_EQ(a.volume_fraction, b.volume_fraction);
  EXPECT_EQ(cubed * a.wrench.force, b.wrench.force);
  EXPECT_EQ(cubed * scale * a.wrench.torque, b.wrench.torque);
  EXPECT_EQ(a.boundary, b.boundary);
  EXPECT_EQ(a.inside, b.inside);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.visibility, b.visibility);
  ASSERT_EQ(a.volume_interval.has_value(), b.volume_interval.has_value());
  if (!a.volume_interval) return;
  EXPECT_EQ(cubed * a.volume_interval->low, b.volume_interval->low);
  EXPECT_EQ(cubed * a.volume_interval->high, b.volume_interval->high);
}

}  // namespace vpm::testing
