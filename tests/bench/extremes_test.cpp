// Every extreme case of the suite is answered right or refused with a message.
#include <gtest/gtest.h>

#include "tools/bench/suite.h"

namespace vpm::bench {
namespace {

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

}  // namespace
}  // namespace vpm::bench
