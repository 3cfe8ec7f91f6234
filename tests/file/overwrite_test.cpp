#include "libvpm/file/overwrite.h"

#include "libvpm/core/error.h"
#include "libvpm/file/container.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace vpm::file {
namespace {

class Overwrite : public test::InTemporaryFolder {
 protected:
  void SetUp() override {
    Writer(Kind::cloud, {{"unit", "m"}}).write(path("cloud"));
    write_all(path("text"), std::string_view("x,y,z\n"));
    write_all(path("empty"), std::string_view());
  }

  // Returns the kind of the refusal, or none if the check passes.
  using Outcome = std::optional<ErrorKind>;
  template <class Check>
  static Outcome outcome(const Check& check) {
    return test::kind_of_fault(check);
  }
  Outcome container(const std::string& name) const {
    return outcome([&] { check_output(path(name), Kind::cloud); });
  }
  Outcome text(const std::string& name) const {
    return outcome([&] { check_output(path(name), std::nullopt); });
  }
};

TEST_F(Overwrite, NothingIsReplacedButEmptyFiles) {
  for (const char* name : {"cloud", "text"}) {
    EXPECT_EQ(container(name), ErrorKind::invalid_argument) << name;
    EXPECT_EQ(text(name), ErrorKind::invalid_argument) << name;
  }
  for (const char* name : {"empty", "new"}) {
    EXPECT_EQ(container(name), std::nullopt) << name;
    EXPECT_EQ(text(name), std::nullopt) << name;
  }
}

TEST_F(Overwrite, AContainerIsToldByItsFirstBytes) {
  EXPECT_TRUE(is_container(path("cloud")));
  for (const char* name : {"text", "empty", "new"}) EXPECT_FALSE(is_container(path(name))) << name;
  EXPECT_FALSE(is_container("-"));
  EXPECT_FALSE(is_container("/dev/null"));
}

TEST_F(Overwrite, NamesMustNotEndLikeOtherKinds) {
  EXPECT_EQ(container("new.vpmc"), std::nullopt);
  EXPECT_EQ(container("new.v2"), std::nullopt);
  EXPECT_EQ(container("new.STL"), ErrorKind::invalid_argument);
  EXPECT_EQ(container("new.vpmp"), ErrorKind::invalid_argument);
  EXPECT_EQ(text("new.json"), std::nullopt);
  EXPECT_EQ(text("new.ply"), std::nullopt);
  for (const char* name : {"new.txt", "new.csv"})
    EXPECT_EQ(container(name), ErrorKind::invalid_argument) << name;
}

TEST_F(Overwrite, JsonIsNamedSo) {
  const auto refused = [&](const char* name) {
    return test::refusal([&] { check_json(path(name)); });
  };
  for (const char* name : {"new.json", "new.jsonl", "new.txt", "new.log", "new"})
    EXPECT_EQ(refused(name), "") << name;
  for (const char* name : {"new.csv", "new.vpmp", "new.ply", "new.html"})
    EXPECT_NE(refused(name).find("name it .json or .jsonl"), std::string::npos) << name;
  EXPECT_NE(refused("text").find("exists"), std::string::npos);
}

TEST_F(Overwrite, PagesEndInHtml) {
  const auto refused = [&](const char* name) {
    return test::refusal([&] { check_page(path(name)); });
  };
  for (const char* name : {"new.html", "new.HTML", "new.htm", "new"}) EXPECT_EQ(refused(name), "");
  for (const char* name : {"new.vpmc", "new.json", "new.ply"})
    EXPECT_NE(refused(name).find("let its name end in .html"), std::string::npos) << name;
  EXPECT_NE(refused("text").find("exists"), std::string::npos);
}

TEST_F(Overwrite, KnowsOneFileByManyNames) {
  std::filesystem::create_symlink(path("text"), path("link"));
  EXPECT_TRUE(is_same_file(path("text"), path("text")));
  EXPECT_TRUE(is_same_file(path("text"), path("./text")));
  EXPECT_TRUE(is_same_file(path("link"), path("text")));
  EXPECT_TRUE(is_same_file(path("new"), path("./new")));
  EXPECT_FALSE(is_same_file(path("text"), path("cloud")));
  EXPECT_FALSE(is_same_file(path("text"), path("new")));
  EXPECT_FALSE(is_same_file(path("new"), path("newer")));
  for (const char* name : {"-", "", "/dev/null"}) EXPECT_FALSE(is_same_file(name, name)) << name;
}

TEST_F(Overwrite, FoldersMustBeThere) {
  EXPECT_EQ(container("missing/cloud"), ErrorKind::cannot_write);
  EXPECT_EQ(text("missing/text"), ErrorKind::cannot_write);
  EXPECT_EQ(text("text/file"), ErrorKind::cannot_write);
  EXPECT_EQ(text("."), ErrorKind::cannot_write);
  EXPECT_EQ(outcome([&] { check_folder_of(path("missing/text")); }), ErrorKind::cannot_write);
}

TEST_F(Overwrite, StreamsAndDevicesPass) {
  for (const char* name : {"-", "", "/dev/null", "/dev/stdout"}) {
    EXPECT_EQ(outcome([&] { check_output(name, Kind::cloud); }), std::nullopt) << name;
    EXPECT_EQ(outcome([&] { check_output(name, std::nullopt); }), std::nullopt) << name;
  }
}

}  // namespace
}  // namespace vpm::file
