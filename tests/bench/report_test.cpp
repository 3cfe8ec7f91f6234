#include "tools/bench/report.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"
#include "tools/bench/statistics.h"
#include "tools/bench/tradeoff_report.h"

namespace vpm::bench {
namespace {

TEST(Report, CsvHasAHeaderAndNineDigits) {
  Table table;
  table.columns = {"name", "value"};
  table.rows = {{std::string("a"), 1.0 / 3}, {std::string("b"), 2.0}};
  EXPECT_EQ(to_csv(table), "name,value\na,0.333333333\nb,2\n");
}

TEST(Report, CsvQuotesWhatHoldsCommasAndQuotes) {
  Table table;
  table.columns = {"stage", "ms"};
  table.rows = {{std::string("frame, all at once"), 2.0}, {std::string("a \"quick\" one"), 1.0}};
  EXPECT_EQ(to_csv(table), "stage,ms\n\"frame, all at once\",2\n\"a \"\"quick\"\" one\",1\n");
}

TEST(Report, JsonSaysWhatWasRunAndWhere) {
  Report report;
  report.suite = "timing";
  const nlohmann::json json = to_json(report, "vpm-bench timing");
  for (const char* key :
       {"suite", "version", "commit", "command", "machine", "settings", "results"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_EQ(json["command"], "vpm-bench timing");
  EXPECT_GE(json["machine"]["cores"], 1);
}

TEST(Report, IsWrittenIntoANewFolder) {
  Report report;
  report.suite = "accuracy";
  const file::TemporaryFolder temporary;
  const std::string folder = temporary.path("new");
  EXPECT_EQ(test::kind_of_fault([&] { write(report, "", folder + "/deep"); }),
            ErrorKind::cannot_write);  // one folder at most: the other may be a typing error
  write(report, "vpm-bench accuracy", folder);
  EXPECT_FALSE(file::read_all(folder + "/accuracy.json").empty());
  EXPECT_FALSE(file::read_all(folder + "/accuracy.csv").empty());
}

TEST(Report, FolderThatCannotBeMadeIsSaid) {
  EXPECT_EQ(test::kind_of_fault([] { write(Report{}, "", "/dev/null/folder"); }),
            ErrorKind::cannot_write);
}

TEST(Spread, OfOneSampleIsThatSample) {
  const Spread s = spread_of({3});
  EXPECT_EQ(s.median, 3);
  EXPECT_EQ(s.min, 3);
  EXPECT_EQ(s.max, 3);
}

TEST(Spread, QuartilesInterpolate) {
  const Spread s = spread_of({4, 1, 3, 2});
  EXPECT_DOUBLE_EQ(s.quartile1, 1.75);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.quartile3, 3.25);
  EXPECT_EQ(s.min, 1);
  EXPECT_EQ(s.max, 4);
}

TEST(MeanAndWorst, OfNothingIsZero) {
  EXPECT_EQ(MeanAndWorst().mean(), 0);
  EXPECT_EQ(MeanAndWorst().worst(), 0);
}

TEST(MeanAndWorst, NotANumberIsTheWorst) {
  MeanAndWorst errors;
  errors.add(1);
  errors.add(NAN);
  errors.add(0.5);
  EXPECT_FALSE(errors.worst() <= 1);
  EXPECT_TRUE(std::isnan(errors.mean()));
}

TEST(ParetoFront, KeepsWhatNothingBeats) {
  const std::vector<double> time{3, 1, 2, 2.5, 4}, error{1, 9, 5, 6, 1};
  EXPECT_EQ(pareto_front(time, error), (std::vector<std::size_t>{1, 2, 0}));
  EXPECT_TRUE(pareto_front({}, {}).empty());
}

TEST(Knee, IsWhereTheCurveTurns) {
  EXPECT_EQ(knee({1, 10, 100, 1000}, {100, 1, 0.9, 0.8}), 1u);
  EXPECT_EQ(knee({1, 10, 100, 1000}, {100, 10, 1, 0.99}), 2u);
  EXPECT_EQ(knee({5}, {1}), 0u);
}

}  // namespace
}  // namespace vpm::bench
