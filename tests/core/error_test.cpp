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

TEST(Error, ShowsNothingThatTurnsTheDirectionOfText) {
  const auto said = [](const std::string& text) { return printable(text, 100); };
  EXPECT_EQ(said("a\u202eb"), "a\\xe2\\x80\\xaeb");
  EXPECT_EQ(said("\u2066"), "\\xe2\\x81\\xa6");
  EXPECT_EQ(said("\u061c"), "\\xd8\\x9c");
  EXPECT_EQ(said("\u0085"), "\\xc2\\x85");
  EXPECT_EQ(said("\xed\xa0\x80"), "\\xed\\xa0\\x80");  // half of a surrogate pair
  EXPECT_EQ(said("\xe0\x80\x80"), "\\xe0\\x80\\x80");  // an overlong form
  EXPECT_EQ(said("“…” \u05d0\u4e2d\U0001F600"), "“…” \u05d0\u4e2d\U0001F600");
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
