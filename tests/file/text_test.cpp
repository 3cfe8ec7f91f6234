#include "libvpm/file/text.h"

#include <gtest/gtest.h>

#include <sstream>
#include <tuple>

#include "libvpm/file/sniff.h"

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

// Returns the lines that are handed out together and, after them, one by one.
std::vector<std::string> handed_out(const std::string& text, bool may_wait = false) {
  std::istringstream stream(text);
  LineStream reader(stream);
  std::vector<std::string> lines{reader.next_lines(may_wait)};
  while (const auto line = reader.next()) lines.push_back(*line);
  return lines;
}

TEST(Text, LinesThatEndInLfAreHandedOutTogether) {
  using Lines = std::vector<std::string>;
  EXPECT_EQ(handed_out("a\nb\r\nc"), (Lines{"a\nb\r\n", "c"}));
  EXPECT_EQ(handed_out("a\nb\rc\n"), (Lines{"", "a", "b", "c"}));
  EXPECT_EQ(handed_out("a\rb\r"), (Lines{"", "a", "b"}));
  EXPECT_EQ(handed_out("a"), (Lines{"", "a"}));
  EXPECT_EQ(handed_out(""), Lines{""});
  // After these lines one would have to wait.
  EXPECT_EQ(handed_out("a\nb\n", true), (Lines{"", "a", "b"}));
}

TEST(Text, LinesMayBeGivenBack) {
  std::istringstream stream("a\nb\nc\nd");
  LineStream reader(stream);
  EXPECT_EQ(reader.next(), "a");
  EXPECT_EQ(reader.next_lines(false), "b\nc\n");
  reader.give_back("c\n");
  EXPECT_EQ(reader.next(), "c");
  EXPECT_EQ(reader.next(), "d");
  EXPECT_EQ(reader.next(), std::nullopt);
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

TEST(Sniff, NamesWhatPeopleGiveByMistake) {
  const auto what = [](std::string_view text) {
    const auto found = sniff(std::as_bytes(std::span(text.data(), text.size())));
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
  EXPECT_EQ(what("MATLAB 5.0 MAT-file, Platform: posix"), "a MATLAB file");
  EXPECT_EQ(what("MATLAB 7.3 MAT-file, Platform: posix"), "a MATLAB file (HDF5)");
  EXPECT_EQ(what({"\0\0\0\0\3\0\0\0\3\0\0\0\0\0\0\0\2\0\0\0K\0\0\0\0\0\0\0\0\0", 30}),
            "a MATLAB file");
  EXPECT_EQ(what({"\0\0\0\0\3\0\0\0\3\0\0\0\0\0\0\0\2\0\0\0\1\0\0\0\0\0\0\0\0\0", 30}), "");
  for (const std::string_view start :
       {"\x80\x02]q", "\x80\x03}q", "\x80\x04\x95\x10", "\x80\x05\x95\x10", "(dp0\n"})
    EXPECT_EQ(what(start), "a pickle of Python");
  EXPECT_EQ(what({"\0\0\0\x20"
                  "ftypisom\0\0",
                  14}),
            "a video (MP4, MOV) or a HEIC picture");
  EXPECT_EQ(what("1.png" + std::string(252, '\0') + "ustar"), "an archive (tar)");
  EXPECT_EQ(what({"\0\0\0\0\0\0\0\0\0\0\0\0\xa0\0\0\0\x78\0\0\0\1\2\3\4", 24}),
            "a message of ROS' compressedDepth, coded by RVL");
  EXPECT_EQ(what({"PAR1\x15\0", 6}), "a table in Parquet");
  EXPECT_EQ(what({"0\0.\0005\0 \0", 8}), "text in UTF-16 without its mark");
  EXPECT_EQ(what({"\0000\0.\0005\0\n", 8}), "text in UTF-16 without its mark");
  EXPECT_EQ(what({"\xff\xfe\0\0000\0\0\0", 8}), "text in UTF-32");
  EXPECT_EQ(what({"1 0\0 0", 6}), "");
  EXPECT_EQ(what("\x1a\x45\xdf\xa3\xa3"), "a Matroska recording (.mkv), such as an Azure Kinect's");
  EXPECT_EQ(what("# fx fy cx cy\n1 2 3 4\n"), "");
  EXPECT_EQ(what("v 0 0 0\nv 1 0 0\n"), "");
  EXPECT_EQ(what(""), "");
}

TEST(Sniff, NamesWhatIsReadToo) {
  for (const auto& [text, scan] : std::vector<std::pair<std::string_view, ScanFormat>>{
           {"\x89PNG\r\n", ScanFormat::png},
           {"v/1\1", ScanFormat::exr},
           {{"MM\0*", 4}, ScanFormat::tiff},
           {"P5\n", ScanFormat::netpbm},
           {"Pf 2 2", ScanFormat::netpbm},
           {"\x93NUMPY\1", ScanFormat::npy},
           {"# .PCD v0.7", ScanFormat::pcd},
           {"# made\n#\nVERSION .7\n", ScanFormat::pcd},
           {"\xEF\xBB\xBFply\n", ScanFormat::ply},
           {{"\0\0\0\0\0\0\0\0\0\0\0\0\x89PNG", 16}, ScanFormat::compressed_depth}}) {
    const auto found = sniff(std::as_bytes(std::span(text.data(), text.size())));
    ASSERT_TRUE(found) << text;
    EXPECT_EQ(found->scan, scan) << found->what;
    EXPECT_EQ(found->holds, Holds::scan);
  }
  for (const std::string& text : {std::string("glTF\2\0\0\0", 8), std::string("solid cube\n"),
                                  std::string("OFF\n8 6 0\n"), std::string("<COLLADA>")}) {
    const auto found = sniff(std::as_bytes(std::span(text.data(), text.size())));
    ASSERT_TRUE(found) << text;
    EXPECT_EQ(found->next, "give it to vpm-pack");
    EXPECT_TRUE(found->is_mesh);
  }
}

// Returns the units in UTF-16 with their mark.
std::string utf16(std::u16string_view units, bool is_big) {
  std::string bytes = is_big ? "\xFE\xFF" : "\xFF\xFE";
  for (const char16_t unit : units) {
    const auto high = static_cast<char>(unit >> 8), low = static_cast<char>(unit & 0xFF);
    bytes += {is_big ? high : low, is_big ? low : high};
  }
  return bytes;
}

TEST(Text, Utf16BecomesUtf8) {
  for (const bool is_big : {false, true}) {
    EXPECT_EQ(utf8_of(utf16(u"fx = 1\r\n", is_big)), "fx = 1\r\n");
    EXPECT_EQ(utf8_of(utf16(u"\u00e9\u20ac\U0001F600", is_big)), "é€😀");
    EXPECT_EQ(utf8_of(utf16(std::u16string{'a', 0xD800, 'b', 0xDC00}, is_big)), "a\uFFFDb\uFFFD");
    EXPECT_EQ(utf8_of(utf16(u"ab", is_big) + "x"), "ab") << "half a character at the end";
    EXPECT_EQ(streamed_lines_of(utf16(u"a b\r\nc\nd", is_big)),
              (std::vector<std::string>{"a b", "c", "d"}));
  }
  EXPECT_EQ(utf8_of("\xFF\xFE"), "");
  const std::string of_32_bits("\xFF\xFE\0\0x\0\0\0", 8);
  EXPECT_EQ(utf8_of(of_32_bits), of_32_bits);
  EXPECT_EQ(utf8_of("plain"), "plain");
}

TEST(Text, ListsHaveFiveNamesAndACount) {
  EXPECT_EQ(listed({}), "");
  EXPECT_EQ(listed({"a", "b", "c", "d", "e"}), "a, b, c, d, e");
  EXPECT_EQ(listed(std::vector<std::string>(1000, "P")), "P, P, P, P, P and 995 more");
}

TEST(Text, TheNumberInANameIsTheLastBeforeItsFirstDot) {
  EXPECT_EQ(number_in_name("scene7/depth/000012.png"), 12U);
  EXPECT_EQ(number_in_name("frame-000460.depth2.png"), 460U);
  EXPECT_EQ(number_in_name("7.png"), 7U);
  EXPECT_FALSE(number_in_name("scene7/depth.png"));
  EXPECT_FALSE(number_in_name("-"));
  EXPECT_FALSE(number_in_name(""));
}

// Returns a mesh of MuJoCo: counts of vertices, normals, texture coordinates and faces, then `rest`
// bytes.
std::string mesh_of_mujoco(std::size_t rest) {
  const std::uint32_t counts[] = {4, 4, 4, 2};
  return std::string(reinterpret_cast<const char*>(counts), sizeof counts) + std::string(rest, 1);
}

TEST(Sniff, NamesFilesOfOtherPrograms) {
  constexpr std::size_t kMujoco = 4 * 12 + 4 * 12 + 4 * 8 + 2 * 12;
  const std::string xml = "<?xml version=\"1.0\"?>\n<!-- made -->\n";
  for (const auto& [text, what, next, holds] :
       std::vector<std::tuple<std::string, const char*, const char*, Holds>>{
           {"160&120&1&....", "a depth map of COLMAP", "save its depths as .npy", Holds::scan},
           {"PIEH....", "a depth map of Sintel (.dpt) or optical flow", "save its depths",
            Holds::scan},
           {std::string("SQLite format 3\0", 16), "a database of SQLite",
            "convert the bag's folder to MCAP: rosbags-convert", Holds::scan},
           {mesh_of_mujoco(kMujoco), "a mesh of MuJoCo", "export it as OBJ", Holds::mesh},
           {"OCTM\5", "a mesh of OpenCTM", "export it as OBJ", Holds::mesh},
           {"\nDBRep_DrawableShape\n\nCASCADE Topology V1", "in BREP", "export a mesh",
            Holds::mesh},
           {"CASCADE Topology V1, (c) Matra", "in BREP", "export a mesh", Holds::mesh},
           {"*Heading\n** Job name", "a model of Abaqus", "export a mesh", Holds::mesh},
           {"*NODE\n1, 0, 0, 0", "a model of Abaqus", "export a mesh", Holds::mesh},
           {"<amf unit=\"inch\">", "a mesh in AMF", "export it as OBJ", Holds::mesh},
           {xml + "<amf unit=\"inch\">", "a mesh in AMF", "export it as OBJ", Holds::mesh},
           {xml + "<VTKFile type=\"PolyData\">", "a file of VTK", "export it as PLY",
            Holds::anything},
           {xml + "<sdf version=\"1.6\">", "a robot description", "one of the files",
            Holds::mesh}}) {
    const auto found = sniff(std::as_bytes(std::span(text.data(), text.size())));
    ASSERT_TRUE(found) << text;
    EXPECT_NE(found->what.find(what), std::string::npos) << found->what;
    EXPECT_NE(found->next.find(next), std::string::npos) << found->next;
    EXPECT_EQ(found->holds, holds) << text;
  }
  for (const std::string& text :
       {mesh_of_mujoco(kMujoco + 1), std::string("160&120&"), std::string("160&&1&"),
        std::string("&&&"), std::string("160 120 1"), std::string("*nod")})
    EXPECT_FALSE(sniff(std::as_bytes(std::span(text.data(), text.size())))) << text;
}

}  // namespace
}  // namespace vpm::file
