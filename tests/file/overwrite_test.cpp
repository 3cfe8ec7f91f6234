#include "libvpm/file/overwrite.h"

#include "libvpm/core/error.h"
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

  // Returns the exit code of the refusal, or 0 if there is none.
  template <class Check>
  static int outcome(const Check& check) {
    const std::optional<ErrorKind> kind = test::kind_of_fault(check);
    return kind ? static_cast<int>(*kind) : 0;
  }
  int container(const std::string& name) const {
    return outcome([&] { check_container_output(path(name), Kind::cloud); });
  }
  int text(const std::string& name) const {
    return outcome([&] { check_text_output(path(name)); });
  }
};

TEST_F(Overwrite, AContainerReplacesOnlyItsOwnKind) {
  EXPECT_EQ(container("cloud"), 0);
  EXPECT_EQ(container("empty"), 0);
  EXPECT_EQ(container("new"), 0);
  EXPECT_EQ(container("text"), 2);
  EXPECT_EQ(outcome([&] { check_container_output(path("cloud"), Kind::packing); }), 2);
}

TEST_F(Overwrite, TextReplacesAnythingButAContainer) {
  EXPECT_EQ(text("text"), 0);
  EXPECT_EQ(text("empty"), 0);
  EXPECT_EQ(text("new"), 0);
  EXPECT_EQ(text("cloud"), 2);
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
  EXPECT_EQ(container("missing/cloud"), 4);
  EXPECT_EQ(text("missing/text"), 4);
  EXPECT_EQ(text("text/file"), 4);
  EXPECT_EQ(text("."), 4);
  EXPECT_EQ(outcome([&] { check_folder_of(path("missing/text")); }), 4);
}

TEST_F(Overwrite, StreamsAndDevicesPass) {
  for (const char* name : {"-", "", "/dev/null", "/dev/stdout"}) {
    EXPECT_EQ(outcome([&] { check_container_output(name, Kind::cloud); }), 0) << name;
    EXPECT_EQ(outcome([&] { check_text_output(name); }), 0) << name;
  }
}

}  // namespace
}  // namespace vpm::file
