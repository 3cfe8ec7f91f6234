#include "libvpm/core/error.h"

#include <gtest/gtest.h>

#include <string>

namespace vpm {
namespace {

TEST(Error, ShowsNoControlCharacterOfAFile) {
  const Error fault(ErrorKind::refused, "no word: \x1b[31mred\n", "a\tb.ply", std::string("\0", 1));
  EXPECT_STREQ(fault.what(), "a\\x09b.ply: no word: \\x1b[31mred\\x0a; \\x00");
  EXPECT_EQ(fault.problem(), "no word: \\x1b[31mred\\x0a");
  EXPECT_EQ(fault.where(), "a\\x09b.ply");
  EXPECT_EQ(fault.hint(), "\\x00");
}

TEST(Error, KeepsTextsOfOtherLanguages) {
  EXPECT_STREQ(Error(ErrorKind::refused, "is broken", "Würfel.obj").what(),
               "Würfel.obj: is broken");
}

TEST(Error, IsCutBetweenCharacters) {
  std::string text;
  for (int k = 0; k < 1'000'000; ++k) text += "ü";
  const std::string said = Error(ErrorKind::refused, text).what();
  EXPECT_LT(said.size(), 1010U);
  EXPECT_TRUE(said.ends_with("ü…"));
}

}  // namespace
}  // namespace vpm
