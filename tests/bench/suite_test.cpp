#include "tools/bench/suite.h"

#include <gtest/gtest.h>

#include "libvpm/core/error.h"
#include "tests/refusal.h"

namespace vpm::bench {
namespace {

TEST(Suite, UnknownOrMissingNameIsWrongUsage) {
  for (const char* name : {"", "speed"}) {
    const auto fault = test::fault_of([&] { run_suite(name, {}); });
    ASSERT_TRUE(fault);
    EXPECT_EQ(fault->kind(), ErrorKind::invalid_argument);
    EXPECT_NE(std::string(fault->what()).find("accuracy"), std::string::npos);
  }
}

TEST(Suite, RefusesADeviceWhereItComputesOnTheCpu) {
  for (const char* name : {"accuracy", "extremes", "replay", "tradeoff"})
    EXPECT_FALSE(needs_device(name));
  for (const char* name : {"packing", "timing"}) {
    SuiteOptions options;
    options.device = {Device::Kind::cuda, 0};
    EXPECT_FALSE(needs_device(name));
    const auto fault = test::fault_of([&] { run_suite(name, options); });
    ASSERT_TRUE(fault) << name;
    EXPECT_EQ(fault->kind(), ErrorKind::unavailable);
    const std::string message = fault->what();
    EXPECT_NE(message.find(name), std::string::npos) << message;
    EXPECT_NE(message.find("scaling"), std::string::npos) << message;
  }
}

TEST(Suite, RefusesOptionsThatItWouldPassOver) {
  const auto refuses = [](const char* name, auto set, const char* who_takes_it) {
    SuiteOptions options;
    set(options);
    const auto fault = test::fault_of([&] { run_suite(name, options); });
    ASSERT_TRUE(fault) << name;
    EXPECT_EQ(fault->kind(), ErrorKind::invalid_argument);
    EXPECT_NE(std::string(fault->what()).find(who_takes_it), std::string::npos) << fault->what();
  };
  refuses(
      "timing", [](SuiteOptions& o) { o.all = true; }, "accuracy, packing, scaling");
  refuses(
      "accuracy", [](SuiteOptions& o) { o.meshes = "folder"; }, "packing, pairs");
  refuses(
      "extremes", [](SuiteOptions& o) { o.data = "folder"; }, "accuracy, replay, timing");
  refuses(
      "tradeoff", [](SuiteOptions& o) { o.noise_seed = 2; }, "accuracy");
  refuses(
      "accuracy", [](SuiteOptions& o) { o.data = "folder"; }, "--all");
  refuses(
      "timing", [](SuiteOptions& o) { o.shadows = Shadows::solid; }, "accuracy");
}

// Refuses before minutes of measuring.
TEST(Suite, SaysWhereAFolderHoldsNoRecordedImages) {
  for (const char* name : {"accuracy", "timing"}) {
    SuiteOptions options;
    options.all = name == std::string("accuracy");  // accuracy reads the folder with --all only
    options.data = "/nowhere";
    const auto fault = test::fault_of([&] { run_suite(name, options); });
    ASSERT_TRUE(fault) << name;
    EXPECT_EQ(fault->kind(), ErrorKind::invalid_argument);
    EXPECT_NE(std::string(fault->what()).find("/nowhere"), std::string::npos);
  }
}

// Refuses on a machine without devices, whatever options are given.
TEST(Suite, ScalingTimesOneDevice) {
  EXPECT_TRUE(needs_device("scaling"));
  for (const Device& device : {Device{}, Device{Device::Kind::cuda, Device::kAll}}) {
    SuiteOptions options;
    options.device = device;
    EXPECT_EQ(test::kind_of_fault([&] { run_suite("scaling", options); }),
              cuda_device_count() == 0 ? ErrorKind::unavailable : ErrorKind::invalid_argument);
  }
}

// Every extreme case of the suite is answered right or refused with a message.
TEST(Extremes, AreRightOrRefused) {
  SuiteOptions options;
  options.quick = true;
  const Report report = run_suite("extremes", options);
  EXPECT_GT(report.results.size(), 50U);
  for (const nlohmann::json& result : report.results) {
    EXPECT_TRUE(result["holds"]) << result;
    if (result.contains("message")) {
      EXPECT_GT(result["message"].get<std::string>().size(), 20U);
    }
  }
  EXPECT_EQ(report.failure, "");
}

// Every pair of the suite closes and is right, and each is timed.
TEST(Pairs, ShareTheTrueVolume) {
  SuiteOptions options;
  options.quick = true;
  const Report report = run_suite("pairs", options);
  EXPECT_GE(report.results.size(), 10U);
  for (const nlohmann::json& result : report.results) {
    EXPECT_LE(result["volume_error"].get<double>(), 1e-6) << result;
    EXPECT_LE(result["closure"].get<double>(), 1e-8) << result;
    EXPECT_GT(result["us"]["5 %"]["force"]["median"].get<double>(), 0) << result;
  }
  EXPECT_EQ(report.failure, "");
}

}  // namespace
}  // namespace vpm::bench
