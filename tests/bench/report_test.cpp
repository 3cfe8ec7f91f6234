#include "tools/bench/report.h"

#include <gtest/gtest.h>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

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

}  // namespace
}  // namespace vpm::bench
