#include "libvpm/file/text.h"

#include <gtest/gtest.h>

#include <sstream>

#include "libvpm/file/foreign_content.h"

namespace vpm::file {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  TextCursor cursor(text);
  while (const auto line = cursor.line()) lines.emplace_back(*line);
  return lines;
}

std::vector<std::string> streamed_lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  LineStream reader(stream);
  while (const auto line = reader.next()) lines.push_back(*line);
  return lines;
}

TEST(Text, LinesEndInEachKindOfEnd) {
  const std::vector<std::string> lines{"a", "b", "c"};
  for (const char* text : {"a\nb\nc", "a\r\nb\r\nc\r\n", "a\rb\rc\r", "a\nb\r\nc\n", "a\nb\rc\n"}) {
    EXPECT_EQ(lines_of(text), lines) << text;
    EXPECT_EQ(streamed_lines_of(text), lines) << text;
  }
}

TEST(Text, BinaryDataAfterACrKeepsItsFirstByte) {
  TextCursor cursor("ply\rend_header\r\n\x01");
  cursor.line();
  cursor.line();
  EXPECT_EQ(cursor.remaining(), 2U);
  TextCursor pairs("ply\r\nend_header\r\n\x01");
  pairs.line();
  pairs.line();
  EXPECT_EQ(pairs.remaining(), 1U);
}

TEST(Text, NumbersMayHaveAPlus) {
  EXPECT_EQ(to_number("+0.5"), 0.5);
  EXPECT_FALSE(to_number("+-0.5"));
  EXPECT_FALSE(to_number("0x1"));
  EXPECT_EQ(to_count("+12"), 12U);
}

TEST(Text, MessagesShowNoControlCharacters) {
  EXPECT_EQ(shown("a\x1b[31m\n"), "a\\x1b[31m\\x0a");
  EXPECT_EQ(shown("abcdef", 3), "abc…");
  EXPECT_EQ(shown("зуб\xff"), "зуб\\xff");
  EXPECT_EQ(shown("зуб", 3), "з…");
}

TEST(Text, ALineWithoutEndIsRefused) {
  EXPECT_ANY_THROW(streamed_lines_of(std::string(2'000'000, 'x')));
}

TEST(ForeignContent, NamesWhatPeopleGiveByMistake) {
  const auto what = [](std::string_view text) {
    const auto found = foreign_content(std::as_bytes(std::span(text.data(), text.size())));
    return found ? found->what : "";
  };
  EXPECT_EQ(what("version https://git-lfs.github.com/spec/v1\n"),
            "a Git LFS pointer, not the file itself");
  EXPECT_EQ(what("\n<!DOCTYPE HTML>"), "a web page");
  EXPECT_EQ(what("PK\x03\x04"), "an archive (zip, npz)");
  EXPECT_EQ(what("<?xml version=\"1.0\"?>\n<!-- made -->\n<robot name=\"x\">"),
            "a robot description (URDF, MJCF, SDF)");
  EXPECT_EQ(what("<?xml version=\"1.0\"?><svg/>"), "an XML file");
  EXPECT_EQ(what("ISO-10303-21;\nHEADER;"), "a STEP file of CAD");
  EXPECT_EQ(what("\x1f\x8b\x08"), "compressed by gzip");
  EXPECT_EQ(what("%PDF-1.7"), "a PDF document");
  EXPECT_EQ(what("# .PCD v0.7"), "");
  EXPECT_EQ(what(""), "");
}

}  // namespace
}  // namespace vpm::file
