#include "tests/cuda/waiting.h"

#include <gtest/gtest.h>

#include "libvpm/query/device.h"

namespace vpm {
namespace {

TEST(WorkOnDevice, MayBeAskedForWithoutHarmToTheNextLaunch) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  const testing::Asked asked = testing::ask_while_a_kernel_waits();
  EXPECT_FALSE(asked.was_done);
  EXPECT_FALSE(asked.left_error);
  EXPECT_TRUE(asked.is_done_now);
}

}  // namespace
}  // namespace vpm
