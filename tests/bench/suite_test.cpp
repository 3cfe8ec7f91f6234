#include "tools/bench/suite.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

#include "libvpm/core/error.h"
#include "tests/refusal.h"
#include "tools/bench/peers/fcl_pair.h"

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
      "accuracy", [](SuiteOptions& o) { o.meshes = "folder"; }, "packing, pairs, peers");
  refuses(
      "extremes", [](SuiteOptions& o) { o.data = "folder"; }, "accuracy, peers, replay, timing");
  refuses(
      "tradeoff", [](SuiteOptions& o) { o.noise_seed = 2; }, "accuracy");
  refuses(
      "accuracy", [](SuiteOptions& o) { o.data = "folder"; }, "--all");
  refuses(
      "timing", [](SuiteOptions& o) { o.shadows = Shadows::solid; }, "accuracy");
}

// Refuses before minutes of measuring.
TEST(Suite, SaysWhereAFolderHoldsNoRecordedImages) {
  for (const char* name : {"accuracy", "peers", "timing"}) {
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

// Every peer contends in its kinds of scenes, with a setting for the larger budget, and tells what
// it can tell; the measure keeps to the truth.
TEST(Peers, StandBesideTheMeasure) {
  SuiteOptions options;
  options.quick = true;
  const Report report = run_suite("peers", options);
  std::map<std::string, std::set<std::string>> kinds;
  for (const nlohmann::json& r : report.results) {
    kinds[r["peer"].get<std::string>()].insert(r["kind"].get<std::string>());
    EXPECT_TRUE(r["volume"].is_object() || r["force"].is_object()) << r;
    EXPECT_EQ(r["force"].is_null(), r["torque"].is_null()) << r;
    EXPECT_GT(r["median_us"].get<double>(), 0) << r;
    EXPECT_GT(r["bytes"].get<double>(), 0) << r;
    if (r["peer"] == "vpm") {
      EXPECT_LE(r["volume"]["worst"].get<double>(), .01) << r;
      EXPECT_LE(r["force"]["worst"].get<double>(), .02) << r;
    }
    if (r["kind"] == "walls" && r["force"].is_object()) {
      EXPECT_GT(r["jitter"]["mean"].get<double>(), 0) << r;
    }
  }
  using Kinds = std::set<std::string>;
  const Kinds depth{"walls", "clutter"}, all{"walls", "clutter", "pairs"}, pairs{"pairs"};
  for (const char* name : {"vpm", "pointshell, flat", "pointshell, tree",
                           "pointshell, nested levels", "voxels in the field"})
    EXPECT_EQ(kinds[name], all) << name;
  for (const char* name : {"distance grid, penalty of pixels", "OpenVDB, count behind pixels"})
    EXPECT_EQ(kinds[name], depth) << name;
  EXPECT_EQ(kinds["spheres against spheres"], pairs);
  EXPECT_EQ(kinds["FCL, contacts"], kHasFcl ? pairs : Kinds{});
  EXPECT_EQ(report.settings["fcl"], kHasFcl);
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
    EXPECT_GT(result["volume_error_of_spheres"].get<double>(), 1e-3) << result;
    EXPECT_LT(result["volume_error_of_spheres"].get<double>(), 1) << result;
  }
  EXPECT_EQ(report.failure, "");
}

}  // namespace
}  // namespace vpm::bench
