// Reads what programs write that differs from the plain form of a format, each after public reports
// about other readers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "libvpm/synthetic/shapes.h"
#include "tests/mesh/mesh_files.h"

namespace vpm::test {
namespace {

using synthetic::make_cube;

// Returns the text with all of `what`, which it must hold, replaced.
std::string replaced(std::string text, const std::string& what, const std::string& by) {
  EXPECT_NE(text.find(what), text.npos) << what;
  for (std::size_t at = 0; (at = text.find(what, at)) != text.npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

std::string in_capitals(std::string text) {
  for (char& c : text) c = static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
  return text;
}

std::string all_of(const std::vector<std::string>& notes) {
  std::string text;
  for (const std::string& note : notes) text += note + "\n";
  return text;
}

// Expects a cube of the given edge and notes that hold the given text, or none if it is empty.
void expect_cube(const std::string& content, const std::string& name, double edge,
                 const std::string& note = "") {
  const CheckedSolid solid = solid_of(content, name);
  EXPECT_NEAR(solid.facts.volume, edge * edge * edge, 1e-12) << content.substr(0, 400);
  EXPECT_EQ(solid.facts.triangles, 12U);
  const std::string notes = all_of(solid.notes);
  if (note.empty()) {
    EXPECT_EQ(notes, "") << content.substr(0, 400);
  } else {
    EXPECT_NE(notes.find(note), notes.npos) << notes;
  }
}

TEST(LineEnds, MayBeOfAnyKindInTextAndInHeaders) {
  const Solid cube = make_cube(0.5);
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    expect_cube(replaced(as_obj(cube), "\n", end), "a.obj", 0.5);
    expect_cube(replaced(as_off(cube), "\n", end), "a.off", 0.5);
    expect_cube(replaced(as_ascii_stl(cube), "\n", end), "a.stl", 0.5);
    expect_cube(replaced(as_ascii_ply(cube), "\n", end), "a.ply", 0.5);
    for (const bool big_endian : {false, true}) {
      const std::string ply = as_binary_ply(cube, big_endian);
      const std::size_t body = ply.find("end_header\n") + 11;
      expect_cube(replaced(ply.substr(0, body), "\n", end) + ply.substr(body), "a.ply", 0.5);
    }
  }
  // The format is recognised without a name, too.
  for (const std::string& text : {as_obj(cube), as_off(cube), as_ascii_stl(cube)})
    expect_cube(replaced(text, "\n", "\r"), "standard input", 0.5);
}

TEST(LineEnds, MayBeMixed) {
  std::string mixed = as_off(make_cube(0.5));
  const std::string ends[] = {"\n", "\r\n", "\r"};
  std::size_t count = 0;
  for (std::size_t at = 0; (at = mixed.find('\n', at)) != mixed.npos; ++count) {
    mixed.replace(at, 1, ends[count % 3]);
    at += ends[count % 3].size();
  }
  expect_cube(mixed, "a.off", 0.5);
}

TEST(LineEnds, ALineFeedAfterACarriageReturnMayBeData) {
  // The first byte after the header is 10, a line feed, in a header whose lines end in CR.
  std::string ply = as_binary_ply(make_cube(0.5), false);
  ply.replace(ply.find("element vertex 8\n"), 17,
              "element odd 1\nproperty uchar k\nelement vertex 8\n");
  const std::size_t body = ply.find("end_header\n") + 11;
  expect_cube(replaced(ply.substr(0, body), "\n", "\r") + "\n" + ply.substr(body), "a.ply", 0.5);
  expect_cube(replaced(ply.substr(0, body), "\n", "\r\n") + "\n" + ply.substr(body), "a.ply", 0.5);
}

TEST(Off, IsReadByWords) {
  const std::string off = as_off(make_cube(0.5));
  const std::string rest = off.substr(4);  // after "OFF\n"
  expect_cube("OFF8 12 0\n" + rest.substr(7), "a.off", 0.5);
  expect_cube("OFF " + rest, "a.off", 0.5);
  expect_cube("# first\n\nOFF # second\n# third\n" + replaced(rest, "\n", " # c\n\n#\n"), "a.off",
              0.5);
  expect_cube("OFF " + replaced(rest, "\n", " "), "a.off", 0.5);
  expect_cube("OFF\n" + replaced(rest, " ", "\n"), "a.off", 0.5);
  expect_cube("OFF\n8\n12 " + rest.substr(7), "a.off", 0.5);  // without the count of edges
  expect_cube(rest, "a.off", 0.5);                            // without the keyword
  expect_cube("OFF 8 12 0\n" + rest.substr(7), "standard input", 0.5);
}

// Returns the cube with `extras` after each vertex and `colors` after each face.
std::string off_with(const std::string& keyword, const std::string& extras,
                     const std::string& colors, const std::string& end) {
  const Solid cube = make_cube(0.5);
  std::string out = keyword + "\n8 12 0\n";
  for (const Vec3& p : cube.vertices) {
    for (const double c : {p.x, p.y, p.z}) out += std::to_string(c) + " ";
    out += end + extras + "\n";
  }
  for (const Triangle& t : cube.triangles) {
    out += "3";
    for (const std::uint32_t k : t) out += " " + std::to_string(k);
    out += " " + colors + "\n";
  }
  return out;
}

TEST(Off, HasWhatItsKeywordSays) {
  for (const std::string end : {"", "\n"}) {
    expect_cube(off_with("COFF", "255 0 0 255", "", end), "a.off", 0.5);
    expect_cube(off_with("COFF", "1 0 0", "", end), "a.off", 0.5);
    expect_cube(off_with("COFF", "1 0 0 1", "1 0 0", end), "a.off", 0.5);
    expect_cube(off_with("NOFF", "1 0 0", "", end), "a.off", 0.5);
    expect_cube(off_with("CNOFF", "1 0 0 255 0 0 255", "7", end), "a.off", 0.5);
    expect_cube(off_with("STOFF", "0 1", "", end), "a.off", 0.5);
    expect_cube(off_with("STCN4OFF", "1 1 0 0 0.5 0.5 0.5 0.5 0 0", "", end), "a.off", 0.5);
    expect_cube(off_with("4OFF", "1", "", end), "a.off", 0.5);
    expect_cube(off_with("4OFF", "2", "", end), "a.off", 0.25, "8 vertices have a fourth");
    expect_cube(off_with("nOFF\n3", "", "", end), "a.off", 0.5);
    expect_cube(off_with("4nOFF 3", "1", "1 0 0", end), "a.off", 0.5);
  }
  // Colours that the keyword does not announce are passed over where each vertex has its line.
  expect_cube(off_with("OFF", "255 0 0", "3 255 0 0", ""), "a.off", 0.5);
}

// Expects a note that holds the text, or none about what is not read if it is empty.
void expect_unread(const std::string& content, const std::string& name, const std::string& note) {
  const std::string notes = all_of(solid_of(content, name).notes);
  if (note.empty()) {
    EXPECT_EQ(notes.find("not read"), notes.npos) << notes;
  } else {
    EXPECT_NE(notes.find(note), notes.npos) << notes << content.substr(0, 400);
  }
}

// Expects a refusal that holds both texts.
void expect_both_in_refusal(const std::string& content, const std::string& name,
                            const std::string& cause, const std::string& effect) {
  const std::string refusal = refusal_of(content, name);
  EXPECT_NE(refusal.find(cause), refusal.npos) << refusal;
  EXPECT_NE(refusal.find(effect), refusal.npos) << refusal;
}

// Returns two cubes side by side, the faces of the first before those of the second.
Solid two_cubes() {
  return together(make_cube(0.5), moved(make_cube(0.5), {2, 0, 0}));
}

TEST(Off, WhatFollowsTheCountedFacesIsSaid) {
  const std::string off = as_off(make_cube(0.5)), both = as_off(two_cubes());
  expect_unread(replaced(both, "16 24 0", "16 12 0"), "a.off",
                "the header counts 12 faces, but more follows in line 31, which is not read");
  expect_unread(off + off, "a.off", "another OFF file follows in line 23, which is not read");
  expect_both_in_refusal(replaced(off, "8 12 0", "8 11 0"), "a.off",
                         "the header counts 11 faces, but more follows in line 22",
                         "the mesh is open");
  for (const std::string end : {"\n\n", "# an end\n", " ", "\x1a", "\x1a\n"})
    expect_cube(off + end, "a.off", 0.5);
  expect_cube(off + std::string(100, '\0'), "a.off", 0.5);
}

TEST(Off, AFaceReadAsAVertexIsSaid) {
  const std::string off = as_off(make_cube(0.5));
  const std::string cause = "the header counts 9 vertices, but line 11 does not look like one";
  expect_both_in_refusal(replaced(off, "8 12 0", "9 11 0"), "a.off", cause, "the mesh is open");
  // All numbers may fit by chance where they are read as words.
  const std::string quads =
      "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n4 3 2 1 0\n"
      "4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";
  expect_both_in_refusal("OFF\n9 6 0\n" + quads, "a.off", cause, "the mesh is open");
  expect_cube("OFF\n8 6 0\n" + replaced(quads, "\n4 3 2", " 4 3 2"), "a.off", 1);
}

TEST(Ply, WhatFollowsTheCountedElementsIsSaid) {
  const Solid cube = make_cube(0.5);
  expect_unread(replaced(as_ascii_ply(two_cubes()), "face 24", "face 12"), "a.ply",
                "the header counts 12 faces, but more follows in line");
  const std::string ply = as_ascii_ply(cube);
  expect_unread(ply + ply, "a.ply", "another PLY file follows in line");
  expect_both_in_refusal(replaced(ply, "face 12", "face 11"), "a.ply",
                         "the header counts 11 faces, but", "the mesh is open");
  expect_both_in_refusal(
      replaced(replaced(ply, "vertex 8", "vertex 9"), "face 12", "face 11"), "a.ply",
      "line 19 holds more numbers than the header says; they are not read", "the mesh is open");
  for (const bool big_endian : {false, true}) {
    const std::string binary = as_binary_ply(cube, big_endian);
    expect_unread(replaced(as_binary_ply(two_cubes(), big_endian), "face 24", "face 12"), "a.ply",
                  "the header counts 12 faces, but 156 bytes more follow at byte");
    expect_unread(binary + binary, "a.ply", "another PLY file follows at byte");
    expect_both_in_refusal(replaced(binary, "face 12", "face 11"), "a.ply",
                           "the header counts 11 faces, but 13 bytes more follow",
                           "the mesh is open");
    for (const std::string end : {"\n", "\r\n", "\x1a"}) expect_cube(binary + end, "a.ply", 0.5);
    expect_cube(binary + '\0', "a.ply", 0.5);
  }
  for (const std::string end : {"\n\n", " ", "\x1a"}) expect_cube(ply + end, "a.ply", 0.5);
  expect_cube(ply + '\0', "a.ply", 0.5);
  // Elements after the faces are counted, too.
  const std::string edge = "element edge 1\nproperty int vertex1\nproperty int vertex2\n";
  expect_cube(replaced(ply, "end_header", edge + "end_header") + "0 1\n", "a.ply", 0.5);
  expect_unread(replaced(ply, "end_header", edge + "end_header") + "0 1\n1 2\n", "a.ply",
                "the header counts 1 x edge, but more follows");
}

TEST(Obj, LinesContinueAfterABackslash) {
  const std::string obj = as_obj(make_cube(0.5));
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    const std::string broken = replaced(replaced(obj, " 0", " \\\n0"), "f ", "f\\\n ");
    expect_cube(replaced("vt 0 \\\n0\n" + broken, "\n", end), "a.obj", 0.5);
  }
}

TEST(Obj, NamesMayEndInABackslash) {
  const std::string obj = as_obj(make_cube(0.5));
  const std::size_t faces = obj.find("f ");
  for (const std::string end : {"\n", "\r\n", " \n"}) {
    for (const std::string keyword : {"g", "o", "usemtl", "mtllib"}) {
      const std::string name = keyword + " C:\\x\\" + end;
      expect_cube(name + obj.substr(0, faces) + name + obj.substr(faces), "a.obj", 0.5);
    }
  }
}

TEST(Obj, WIsDividedAndColoursAreNot) {
  const std::string obj = as_obj(make_cube(0.5));
  const std::size_t faces = obj.find("f ");
  const std::string vertices = obj.substr(0, faces).substr(obj.find("v "));
  const auto with = [&](const std::string& more) {
    return replaced(vertices, "\n", more + "\n") + obj.substr(faces);
  };
  expect_cube(with(" 1"), "a.obj", 0.5);
  expect_cube(with(" 1.0"), "a.obj", 0.5);
  expect_cube(with(" 2"), "a.obj", 0.25, "8 vertices have a fourth coordinate w other than 1");
  expect_cube(with(" 0.5 0.5 0.5"), "a.obj", 0.5);
  expect_cube(with(" 0.5 0.5 0.5 1"), "a.obj", 0.5);
}

TEST(Numbers, MayHaveAPlus) {
  const Solid cube = make_cube(0.5);
  expect_cube(replaced(as_obj(cube), " 0", " +0"), "a.obj", 0.5);
  expect_cube(replaced(as_off(cube), " 0.25", " +0.25"), "a.off", 0.5);
  expect_cube(replaced(as_ascii_ply(cube), " 0.25", " +2.5e-1"), "a.ply", 0.5);
  expect_cube(replaced(as_ascii_stl(cube), "vertex 0.25", "vertex +0.25"), "a.stl", 0.5);
  EXPECT_EQ(parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nf +1 +2/+2 +3\n", "a.obj").polygon_count(), 1U);
}

TEST(Faces, OfFewerThanThreeCornersAreDropped) {
  const Solid cube = make_cube(0.5);
  const std::string note = "2 faces of fewer than three corners dropped";
  expect_cube(as_obj(cube) + "f 1 2\nf 3\n", "a.obj", 0.5, note);
  const std::string off = replaced(as_off(cube), "8 12 0", "8 14 0") + "2 0 1\n1 0\n";
  expect_cube(off, "a.off", 0.5, note);
  expect_cube(replaced(as_ascii_ply(cube), "face 12", "face 14") + "2 0 1\n0\n", "a.ply", 0.5,
              note);
}

TEST(AsciiStl, KeywordsAreReadAsProgramsWriteThem) {
  const std::string stl = as_ascii_stl(make_cube(0.5));
  expect_cube(in_capitals(stl), "a.stl", 0.5);
  expect_cube(in_capitals(stl), "standard input", 0.5);
  const std::string apart =
      replaced(replaced(replaced(stl, "endloop", "end loop"), "endfacet", "end facet"), "endsolid",
               "end solid");
  expect_cube(apart, "a.stl", 0.5);
  expect_cube(in_capitals(apart), "a.stl", 0.5);
}

TEST(Keywords, MayBeInEitherCase) {
  const Solid cube = make_cube(0.5);
  const std::string ply = as_ascii_ply(cube), binary = as_binary_ply(cube, true);
  const std::size_t body = binary.find("end_header\n");
  for (const std::string name : {"a.ply", "standard input"}) {
    expect_cube(in_capitals(ply), name, 0.5);
    expect_cube(in_capitals(binary.substr(0, body)) + binary.substr(body), name, 0.5);
    expect_cube(replaced(ply, "ply\n", "ply \n"), name, 0.5);
  }
  expect_cube(replaced(as_off(cube), "OFF", "off"), "standard input", 0.5);
}

TEST(Messages, TellOfDecimalCommasAndOfCountingFromZero) {
  const auto expect_cure = [](const std::string& content, const std::string& name,
                              const std::string& cure) {
    const std::string message = refusal_of(content, name);
    EXPECT_NE(message.find(cure), message.npos) << message;
  };
  const std::string obj = as_obj(make_cube(0.5)), stl = as_ascii_stl(make_cube(0.5));
  expect_cure(replaced(obj, "0.25", "0,25"), "a.obj", "decimals have a point");
  expect_cure(replaced(stl, "0.25", "0,25"), "a.stl", "decimals have a point");
  expect_cure(obj + "f 0 1 2\n", "a.obj", "vertex index 0 is out of range; OBJ counts from 1");
}

TEST(AsciiStl, IsReadByWords) {
  const std::string stl = as_ascii_stl(make_cube(0.5));
  for (const std::string& text : {stl, in_capitals(stl)}) {
    for (const std::string name : {"a.stl", "standard input"}) {
      expect_cube(replaced(text, "\n", " "), name, 0.5);
      const std::size_t begin = text.find('\n'), end = text.rfind('\n', text.size() - 2);
      const std::string facets = replaced(text.substr(begin, end - begin), " ", "\n");
      expect_cube(text.substr(0, begin) + facets + text.substr(end), name, 0.5);
    }
  }
  const std::size_t second = stl.find('\n') + 1;
  for (const std::string line : {"  vertex", " endloop", "endfacet", "facet", " outer"})
    expect_cube(stl.substr(0, second) + replaced(stl.substr(second), "\n" + line, " " + line),
                "a.stl", 0.5);
  const std::string other = as_ascii_stl(moved(make_cube(0.5), {2, 0, 0}));
  EXPECT_NEAR(solid_of(replaced(stl + other, "\n", " "), "a.stl").facts.volume, 0.25, 1e-12);
}

TEST(AsciiStl, NamesHoldAnyWords) {
  const std::string stl = as_ascii_stl(make_cube(0.5));
  const std::string facets =
      stl.substr(stl.find("facet"), stl.find("endsolid") - stl.find("facet"));
  for (const std::string name : {"", " vertex facet endfacet", " solid", " facet normal", " end"})
    expect_cube("solid" + name + "\n" + facets + "endsolid" + name + "\n", "a.stl", 0.5);
}

TEST(AsciiStl, MayLackItsLastLine) {
  const std::string stl = as_ascii_stl(make_cube(0.5));
  const std::string cut = stl.substr(0, stl.find("endsolid"));
  expect_cube(cut, "a.stl", 0.5, "the file ends without 'endsolid', after 12 whole facets");
  // Where facets are missing, that is what is wrong with the mesh.
  expect_both_in_refusal(cut.substr(0, cut.rfind("facet normal")), "a.stl",
                         "the file ends without 'endsolid', after 11 whole facets",
                         "the mesh is open");
  EXPECT_NE(refusal_of(cut.substr(0, cut.rfind("endfacet")), "a.stl").find("truncated"), cut.npos);
}

TEST(AsciiStl, MayBePadded) {
  const std::string stl = as_ascii_stl(make_cube(0.5));
  for (const std::size_t count : {1, 100, 5000})
    expect_cube(stl + std::string(count, '\0'), "a.stl", 0.5);
  expect_cube(stl + "\x1a", "a.stl", 0.5);
  expect_cube(stl + "\x1a\r\n", "standard input", 0.5);
}

TEST(AsciiStl, SeveralSolidsAreAllRead) {
  const std::string stl = as_ascii_stl(make_cube(0.5)),
                    other = as_ascii_stl(moved(make_cube(0.5), {2, 0, 0}));
  const CheckedSolid both = solid_of(stl + other, "a.stl");
  EXPECT_NEAR(both.facts.volume, 0.25, 1e-12);
  EXPECT_EQ(all_of(both.notes), "2 solids stand one after the other; all were read\n");
  EXPECT_NEAR(solid_of(stl + other.substr(0, other.find("endsolid")), "a.stl").facts.volume, 0.25,
              1e-12);
  EXPECT_NE(refusal_of(stl + "solid x\n", "a.stl"), "");
}

std::string with_count(std::string stl, std::uint32_t count) {
  std::memcpy(stl.data() + 80, &count, sizeof count);
  return stl;
}

TEST(BinaryStl, TrianglesAreCountedFromTheBytes) {
  const std::string stl = as_binary_stl(make_cube(0.5));
  expect_cube(with_count(stl, 0), "a.stl", 0.5, "says 0 triangles, but the file has 12, which");
  expect_cube(with_count(stl, 5), "a.stl", 0.5, "says 5 triangles, but the file has 12, which");
  expect_cube(with_count(stl, 0xffffffff), "a.stl", 0.5, "but the file has 12, which");
  expect_cube(stl + "\n", "a.stl", 0.5, "1 byte after the last of 12 triangles");
  // Where bytes are missing, that is what is wrong with the mesh.
  const std::string cut = stl.substr(0, stl.size() - 100);
  EXPECT_NE(refusal_of(cut, "a.stl").find("the header says 12 triangles, but the file has 10 and"),
            std::string::npos)
      << refusal_of(cut, "a.stl");
}

TEST(BinaryStl, SeveralFilesAreAllRead) {
  const std::string stl = as_binary_stl(make_cube(0.5)),
                    other = as_binary_stl(moved(make_cube(0.5), {2, 0, 0}));
  for (const std::string name : {"a.stl", "standard input"}) {
    const CheckedSolid both = solid_of(stl + other, name);
    EXPECT_NEAR(both.facts.volume, 0.25, 1e-12);
    EXPECT_EQ(all_of(both.notes), "2 STL files stand one after the other; all were read\n");
  }
}

TEST(BinaryStl, AttributesMayBeBytesThatFollow) {
  const std::string stl = as_binary_stl(make_cube(0.5));
  std::string with_payload = stl.substr(0, 84), with_colors = stl;
  for (std::size_t k = 0; k < 12; ++k) {
    const std::size_t facet = 84 + 50 * k;
    const char payload = static_cast<char>(k % 4);
    with_payload += stl.substr(facet, 48) + payload + '\0' + std::string(k % 4, 'x');
    with_colors[facet + 48] = 31;
  }
  expect_cube(with_payload, "a.stl", 0.5, "18 bytes of attributes between the triangles");
  expect_cube(with_colors, "a.stl", 0.5);
}

TEST(FarFromTheOrigin, TheLossOfFloatsIsSaid) {
  const std::string far = as_binary_stl(moved(make_cube(0.3), {4.65e6, 1e3, 20}));
  EXPECT_NE(refusal_of(far, "a.stl").find("where floats of 32 bits are 0.5 apart"), far.npos)
      << refusal_of(far, "a.stl");
  EXPECT_NE(refusal_of(far, "a.stl").find("move it to the origin before"), far.npos);
  // A cube whose corners are floats all the same.
  const CheckedSolid coarse =
      solid_of(as_binary_stl(moved(make_cube(0.5), {1 << 20, 0, 0})), "a.stl");
  ASSERT_EQ(coarse.warnings.size(), 1U);
  EXPECT_NE(coarse.warnings[0].find("coarse for a mesh of 0.866"), far.npos);
  // A ball in text of six digits, as %g and C++ streams write it.
  const Solid ball = moved(synthetic::make_icosphere(0.1, 3), {1e4, 0, 0});
  std::string digits;
  for (const Vec3& p : ball.vertices) {
    char line[100];
    std::snprintf(line, sizeof line, "v %g %g %g\n", p.x, p.y, p.z);
    digits += line;
  }
  const std::string faces = as_obj(ball).substr(as_obj(ball).find("f "));
  try {
    EXPECT_NE(
        all_of(solid_of(digits + faces, "a.obj").warnings).find("numbers of six digits are 0.1"),
        far.npos);
  } catch (const Error& fault) {
    EXPECT_NE(std::string(fault.what()).find("numbers of six digits are 0.1"), far.npos)
        << fault.what();
  }
  EXPECT_TRUE(solid_of(as_obj(ball), "a.obj").warnings.empty());
  // Doubles are fine enough there, and floats are near the origin.
  EXPECT_TRUE(solid_of(as_obj(moved(make_cube(0.3), {4.65e6, 1e3, 20})), "a.obj").warnings.empty());
  EXPECT_TRUE(solid_of(as_binary_stl(make_cube(0.3)), "a.stl").warnings.empty());
}

TEST(NotAMesh, IsNamedWithTheNextStep) {
  const std::pair<std::string, const char*> cases[] = {
      {"version https://git-lfs.github.com/spec/v1\n",
       "a Git LFS pointer, not the file itself; fetch"},
      {"<!DOCTYPE html>", "this is a web page; download"},
      {"\x1f\x8b\x08", "compressed by gzip; unpack"},
      {"PK\x03\x04", "an archive"},
      {"PK\x03\x04", "an archive (zip, npz); unpack it first"},
      {"\xff\xd8\xff\xe0", "a JPEG picture, which holds no exact values; give the mesh"},
      {"#usda 1.0\n", "a scene in USD; export it as OBJ, PLY or STL"},
      {"PXR-USDC", "a scene in USD; export it"},
      {"#VRML V2.0 utf8\n", "a scene in VRML; export it as OBJ, PLY or STL"},
      {"<?xml version=\"1.0\"?>\n<X3D>", "a scene in X3D; export it as OBJ, PLY or STL"},
      {"  0\r\nSECTION\r\n  2\r\n", "a drawing in DXF; export a mesh"},
      {"999\nmade by x\n0\nSECTION\n", "a drawing in DXF; export a mesh"},
      {std::string(72, ' ') + "S      1\n", "a file of CAD in IGES; export a mesh"},
      {std::string("MM\x06\0\0\0", 6), "a scene of 3D Studio (3DS); export it"},
      {std::string("\xff\xfev\0", 4), "text in UTF-16; save it as UTF-8"},
      {"ISO-10303-21;\n", "a STEP file of CAD; export a mesh"},
      {"<?xml version=\"1.0\"?>\n<robot name=\"x\">", "a robot description"},
      {"%PDF-1.4", "a PDF document"},
      {"\x89PNG\r\n", "a PNG picture; give the mesh"},
      {"\x76\x2f\x31\x01", "an OpenEXR image; give the mesh"},
      {std::string("II*\0", 4), "a TIFF image; give the mesh"},
      {"\x93NUMPY\x01", "an array of NumPy; give the mesh"},
      {"P5\n2 2\n65535\n", "a PGM, PPM or PFM image; give the mesh"},
      {"# vtk DataFile Version 3.0\n", "a file of VTK; export it as PLY"},
      {"<VTKFile type=\"PolyData\">", "a file of VTK; export it as PLY"},
      {"$MeshFormat\n4.1 0 8\n", "a mesh of Gmsh; export it as OBJ, PLY or STL"},
      {"MeshVersionFormatted 2\n", "a mesh of MEDIT; export it"},
      {"3D Geometry File Format", "a file of Rhino; export a mesh"},
      {"DRACO\x02\x02", "compressed by Draco; decode it to PLY"},
      {"\x28\xb5\x2f\xfd", "compressed by zstd; unpack it first"},
      {"RIFF\x10", "a WebP picture or a film; give the mesh"},
      {"P7\nWIDTH 2\n", "a PAM picture; give the mesh"},
      {"# made by x\nVERSION .7\n", "a cloud of points"},
      {"# .PCD v0.7", "a cloud of points"}};
  for (const auto& [content, message] : cases) {
    for (const char* const name : {"a.obj", "a.stl", "a.off", "a.ply", "a.dae", "standard input"})
      EXPECT_NE(refusal_of(content, name).find(message), std::string::npos)
          << name << ": " << refusal_of(content, name);
  }
  for (const char* const table :
       {"0 0 0\n0.5 0.2 0.3\n1 1 1\n", "x,y,z\n0,0,0\n0.5,0.2,0.3\n", "2\n0 0 0 9\n1 1 1 9\n"}) {
    const std::string points = refusal_of(table, "a.xyz");
    EXPECT_NE(points.find("a table of points, without faces; give a mesh"), points.npos) << points;
  }
}

}  // namespace
}  // namespace vpm::test
