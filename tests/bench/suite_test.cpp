#include "tools/bench/suite.h"

#include <gtest/gtest.h>

#include "libvpm/core/error.h"

namespace vpm::bench {
namespace {

TEST(Suite, UnknownOrMissingNameIsWrongUsage) {
  for (const char* name : {"", "speed"}) {
    try {
      run_suite(name, {});
      FAIL();
    } catch (const Error& fault) {
      EXPECT_EQ(fault.kind(), ErrorKind::usage);
      EXPECT_NE(std::string(fault.what()).find("accuracy"), std::string::npos);
    }
  }
}

TEST(Suite, RefusesADeviceWhereItComputesOnTheCpu) {
  for (const char* name : {"accuracy", "extremes", "packing", "replay", "timing", "tradeoff"}) {
    SuiteOptions options;
    options.device = {Device::Kind::cuda, 0};
    EXPECT_FALSE(takes_device(name));
    try {
      run_suite(name, options);
      FAIL() << name;
    } catch (const Error& fault) {
      EXPECT_EQ(fault.kind(), ErrorKind::unavailable);
      const std::string message = fault.what();
      EXPECT_NE(message.find(name), std::string::npos) << message;
      EXPECT_NE(message.find("scaling"), std::string::npos) << message;
    }
  }
}

// On a machine without devices it says so, whatever was asked for.
TEST(Suite, ScalingTimesOneDevice) {
  EXPECT_TRUE(takes_device("scaling"));
  for (const Device& device : {Device{}, Device{Device::Kind::cuda, Device::kAll}}) {
    SuiteOptions options;
    options.device = device;
    try {
      run_suite("scaling", options);
      FAIL();
    } catch (const Error& fault) {
      EXPECT_EQ(fault.kind(), cuda_device_count() == 0 ? ErrorKind::unavailable : ErrorKind::usage);
    }
  }
}

}  // namespace
}  // namespace vpm::bench
