#include <gtest/gtest.h>

#include <random>
#include <set>
#include <sstream>

#include "libvpm/core/error.h"
#include "libvpm/synthetic/shapes.h"
#include "tests/mesh/mesh_files.h"
#include "tests/refusal.h"

namespace vpm::test {
namespace {

using synthetic::make_cube;
using synthetic::make_icosphere;
using synthetic::make_tetrahedron;

// Returns a solid whose coordinates need all digits of a double.
Solid awkward() {
  return moved(make_icosphere(1.0 / 3, 1), {1e3 + 1.0 / 7, -1e-5 / 3, 0.1});
}

void expect_same(const RawMesh& mesh, const Solid& solid) {
  EXPECT_EQ(mesh.vertices, solid.vertices);
  EXPECT_EQ(triangulate(mesh), solid.triangles);
}

TEST(MeshReader, TextAndBinaryKeepEveryBitOfACoordinate) {
  const Solid solid = awkward();
  expect_same(parse(as_obj(solid), "a.obj"), solid);
  expect_same(parse(as_off(solid), "a.off"), solid);
  expect_same(parse(as_ascii_ply(solid), "a.ply"), solid);
  expect_same(parse(as_binary_ply(solid, false), "a.ply"), solid);
  expect_same(parse(as_binary_ply(solid, true), "a.ply"), solid);
}

TEST(MeshReader, StlListsEachCorner) {
  const Solid cube = make_cube(0.5);  // with coordinates that floats hold exactly
  for (const std::string& content : {as_ascii_stl(cube), as_binary_stl(cube)}) {
    const RawMesh mesh = parse(content, "a.stl");
    ASSERT_EQ(mesh.polygon_count(), 12U);
    ASSERT_EQ(mesh.vertices.size(), 36U);
    for (std::size_t t = 0; t < 12; ++t) {
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(mesh.vertices[3 * t + k], cube.vertices[cube.triangles[t][k]]);
    }
  }
}

TEST(MeshReader, ContentTellsTheFormatFromAPipe) {
  const Solid cube = make_cube(0.5);
  EXPECT_EQ(parse(as_obj(cube), "standard input").format, MeshFormat::obj);
  EXPECT_EQ(parse(as_off(cube), "standard input").format, MeshFormat::off);
  EXPECT_EQ(parse(as_ascii_ply(cube), "standard input").format, MeshFormat::ply);
  EXPECT_EQ(parse(as_binary_ply(cube, false), "standard input").format, MeshFormat::ply);
  EXPECT_EQ(parse(as_ascii_stl(cube), "standard input").format, MeshFormat::stl);
  EXPECT_EQ(parse(as_binary_stl(cube), "standard input").format, MeshFormat::stl);
}

TEST(MeshReader, BinaryStlWhoseHeaderSaysSolidIsBinary) {
  std::string content = as_binary_stl(make_cube(0.5));
  content.replace(0, 13, "solid facet x");
  EXPECT_EQ(parse(content, "a.stl").polygon_count(), 12U);
}

TEST(MeshReader, WindowsLinesAndBlanksDoNotMatter) {
  const Solid cube = make_cube(0.5);
  for (std::string content : {as_obj(cube), as_off(cube), as_ascii_stl(cube)}) {
    for (std::size_t at = 0; (at = content.find('\n', at)) != std::string::npos; at += 4)
      content.replace(at, 1, "\t\r\n\n");
    EXPECT_EQ(parse(content, "standard input").polygon_count(), 12U);
    EXPECT_EQ(parse("\xEF\xBB\xBF" + content, "standard input").polygon_count(), 12U);
  }
}

TEST(MeshReader, ObjCornersMayNameTexturesNormalsAndCountBackwards) {
  const RawMesh mesh = parse(
      "mtllib x.mtl\no thing\nv 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\ns off\n"
      "f 1/1/1 2//1 3/1\nf -3 -2 -1\nf 4 1 2\nv 5 5 5\n",
      "a.obj");
  EXPECT_EQ(mesh.corners, (std::vector<std::uint32_t>{0, 1, 2, 0, 1, 2, 3, 0, 1}));
}

TEST(MeshReader, OffMayHaveCommentsColoursAndNormals) {
  const RawMesh mesh = parse(
      "# first\nCNOFF # keyword\n\n3 1 3\n# vertices\n0 0 0 0 0 1 255 0 0\n1 0 0 0 0 1 0 0 0\n"
      "0 1 0 0 0 1 0 0 0 # last\n3 0 1 2 0.5 0.5 0.5\n",
      "a.off");
  EXPECT_EQ(mesh.vertices.size(), 3U);
  EXPECT_EQ(mesh.corners, (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(MeshReader, PlySkipsWhatItDoesNotNeed) {
  const RawMesh mesh = parse(
      "ply\nformat ascii 1.0\nobj_info x\nelement camera 1\nproperty list uchar float k\n"
      "element vertex 3\nproperty float confidence\nproperty float x\nproperty double y\n"
      "property int z\nelement face 1\nproperty uchar red\nproperty list uchar uint vertex_index\n"
      "property list uchar float texcoord\nend_header\n2 1.5 2.5\n9 0 0 0\n9 1 0 0\n9 0 1 0\n"
      "7 3 0 1 2 6 0 0 0 0 0 0\n",
      "a.ply");
  EXPECT_EQ(mesh.vertices, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(mesh.corners, (std::vector<std::uint32_t>{0, 1, 2}));
}

struct Bad {
  const char* name;
  std::string content;
  const char* message;  // part of the refusal
};

TEST(MeshReader, RefusesNamingFileAndPlace) {
  const std::string ply = "ply\nformat ascii 1.0\n";
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  const std::string face = "property list uchar int vertex_indices\n";
  const Bad cases[] = {
      {"a.off", "", "a.off: the file is empty"},
      {"a.obj", "   \n", "this is no mesh: it has no vertices and no faces"},
      {"a.obj", "Some words\nof a letter\n", "this is no mesh: it has no vertices and no faces"},
      {"a.obj", "v 0 0 0\nv 1 0 0\n", "the mesh has no faces, only 2 vertices"},
      {"a.xyz", "1 2 3\n", "a.xyz: this is no mesh"},
      {"a.obj", "v 0 0\n", "line 1: z is missing"},
      {"a.obj", "v 0 0 x\n", "line 1: z is 'x'"},
      {"a.obj", "\n\nv 0 nan 0\n", "line 3: a coordinate is not finite"},
      {"a.obj", "v 0 0 1e400\n", "line 1: a coordinate is not finite"},
      {"a.obj", "v 0 0 inf\n", "line 1: a coordinate is not finite"},
      {"a.obj", "v 0 0 0\nf 1 2 3\n", "line 2: vertex index 3 is out of range; the file has 1"},
      {"a.obj", "v 0 0 0\nf 0 1 1\n", "line 2: vertex index 0 is out of range"},
      {"a.obj", "v 0 0 0\nf -2 1 1\n", "line 2: vertex index -2 is out of range"},
      {"a.obj", "f 99999999999999999999 1 1\n", "is out of range"},
      {"a.obj", "v 0 0 0\nf 1 1\n", "the mesh has no faces"},
      {"a.obj", "v 0 0 0 0\nf 1 1 1\n", "line 1: the vertex divided by its w is not finite"},
      {"a.obj", "v 0 0 0 w\nf 1 1 1\n", "line 1: w is 'w'"},
      {"a.obj", "v 0 0 0\nf a b c\n", "line 2: a corner of the face is not a vertex index"},
      {"a.off", "OFF\n", "the file ends after line 1"},
      {"a.off", "OFF\n8 x\n", "line 2: the number of faces is 'x'"},
      {"a.off", "OFF\n-8 1\n", "line 2: a count is negative"},
      {"a.off", "OFF\n1000000000000 4 0\n", "the header says 1000000000000 vertices"},
      {"a.off", "OFF\n4 9000000000000000000 0\n", "but the file has only"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "line 6: vertex index 3"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", "line 6: vertex index -1"},
      {"a.off", "OFF\n3 1 0\n0 0 0.0000\n1 0 0\n0 1 0\n2 0 1\n", "the mesh has no faces"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", "number of corners is negative"},
      {"a.off", "OFF 3 1 0\n0 0 0 1 0 0 0\n1 0\n3 0 1\n", "line 3: z is missing"},
      {"a.off", "4nOFF\n4\n3 1 0\n", "its points have 4 dimensions"},
      {"a.off", "4OFF\n1 0 0\n1 2 3 0\n", "divided by its w"},
      {"a.off", "COFF BINARY\n", "binary OFF is read with three coordinates only"},
      {"a.off", "OFF\n3 2 0\n0 0 0.00000000\n1 0 0\n0 1 0\n3 0 1 2\n", "truncated"},
      {"a.off", "OFFER\n3 1 0\n", "expected the keyword OFF"},
      {"a.ply", "plx\n", "must begin with 'ply'"},
      {"a.ply", "ply\nformat ascii 1.0\n", "the file ends after line 2"},
      {"a.ply", "ply\nformat text 1.0\nend_header\n", "line 2: unknown format"},
      {"a.ply", ply + "element vertex 1\nproperty real x\nend_header\n", "real is not a type"},
      {"a.ply",
       ply + "element vertex 1000000000000\n" + xyz + "element face 1\n" + face + "end_header\n",
       "1000000000000 x vertex"},
      {"a.ply", ply + "element vertex 3\n" + xyz + "end_header\n0 0 0\n0 0 0\n0 0 0\n",
       "one element 'face'"},
      {"a.ply",
       ply + "element vertex 1\nproperty float x\nelement face 0\n" + face + "end_header\n0\n",
       "one property 'y'"},
      {"a.ply",
       ply + "element vertex 1\n" + xyz + "element face 1\n" + face +
           "end_header\n0 0 0\n3 0 0 1\n",
       "face 0: a vertex index is out of range"},
      {"a.ply",
       ply + "element vertex 1\n" + xyz + "element face 1\n" + face +
           "end_header\n0 0 0\n3 0 0 0.5\n",
       "face 0: a vertex index is out of range"},
      {"a.ply",
       ply + "element vertex 1\n" + xyz + "element face 1\n" + face +
           "end_header\n0 0 nan\n3 0 0 0\n",
       "vertex 0: a coordinate is not finite"},
      {"a.ply",
       ply + "element vertex 1\n" + xyz + "element face 1\n" + face +
           "end_header\n0 0 0\n300000000 0 0\n",
       "a value is missing"},
      {"a.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", "truncated"},
      {"a.stl",
       "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop\nendfacet\n"
       "endsolid\n",
       "line 6: a facet must have 3 vertices"},
      {"a.stl", "too short", "too few for a binary STL file"},
      {"a.stl", std::string(200, 'x'), "the file is text, but no STL"},
      {"a.stl", std::string(200, '\0'), "the header says 0 triangles, and 116 bytes follow"},
  };
  for (const Bad& bad : cases) {
    const std::string message = refusal_of(bad.content, bad.name);
    EXPECT_NE(message.find(bad.message), std::string::npos)
        << bad.content << "\nexpected: " << bad.message << "\nsaid: " << message;
    EXPECT_EQ(message.find(bad.name), 0U) << message;
  }
}

TEST(MeshReader, BinaryCountsAreHeldAgainstTheFileBeforeMemoryIsTaken) {
  std::string stl = as_binary_stl(make_cube(1));
  stl.replace(80, 4, "\xff\xff\xff\xff");
  stl.pop_back();
  EXPECT_NE(refusal_of(stl, "a.stl").find("4294967295 triangles"), std::string::npos);
  std::string ply = as_binary_ply(make_cube(1), false);
  ply.replace(ply.find("element vertex 8"), 16, "element vertex 9000000000000000000");
  EXPECT_NE(refusal_of(ply, "a.ply").find("9000000000000000000 x vertex"), std::string::npos);
}

// Returns all that a check of the mesh sees but its name, to tell meshes that repeat each other.
std::string content_of(const RawMesh& mesh) {
  std::ostringstream text;
  text << std::hexfloat << mesh.dropped_polygons << ';' << mesh.doubt << ';';
  for (const Vec3& p : mesh.vertices) text << p.x << ',' << p.y << ',' << p.z << ' ';
  for (const std::uint32_t corner : mesh.corners) text << corner << ' ';
  for (const std::size_t end : mesh.polygon_end) text << end << ' ';
  for (const std::string& note : mesh.notes) text << note << ';';
  return text.str();
}

// Every length is read. Those that give the mesh of a shorter one, e.g. without the end of a line
// that makes a triangle, are not checked again: a refused mesh is repaired to find the advice that
// helps.
TEST(MeshReader, TruncationAnywhereIsRefusedOrSaid) {
  const Solid tetrahedron = make_tetrahedron(0.1);
  const std::pair<const char*, std::string> files[] = {{"a.obj", as_obj(tetrahedron)},
                                                       {"a.off", as_off(tetrahedron)},
                                                       {"a.ply", as_ascii_ply(tetrahedron)},
                                                       {"b.ply", as_binary_ply(tetrahedron, false)},
                                                       {"c.ply", as_binary_ply(tetrahedron, true)},
                                                       {"a.stl", as_ascii_stl(tetrahedron)},
                                                       {"b.stl", as_binary_stl(tetrahedron)}};
  for (const auto& [name, content] : files) {
    std::set<std::string> checked;
    // The last bytes are the end of a line or, in OBJ and OFF, part of a last digit.
    for (std::size_t size = 0; size + 2 < content.size(); ++size) {
      const std::string cut = content.substr(0, size);
      RawMesh mesh;
      const auto fault = fault_of([&] { mesh = parse(cut, name); });
      if (fault) {
        ASSERT_EQ(fault->kind(), ErrorKind::refused) << name << " cut at " << size;
        continue;
      }
      if (!checked.insert(content_of(mesh)).second) continue;
      if (!refusal_of(cut, name).empty()) continue;
      // An STL file that lacks its last line only is read.
      const std::vector<std::string> notes = solid_of(cut, name).notes;
      ASSERT_EQ(notes.size(), 1U) << name << " cut at " << size;
      EXPECT_NE(notes[0].find("it may be truncated"), std::string::npos) << notes[0];
    }
  }
}

TEST(MeshReader, DamagedBytesNeverDoMoreThanRefuse) {
  const Solid cube = make_cube(0.1);
  std::mt19937 random(7);
  for (const std::string& content :
       {as_obj(cube), as_off(cube), as_ascii_ply(cube), as_binary_ply(cube, false),
        as_binary_ply(cube, true), as_ascii_stl(cube), as_binary_stl(cube)}) {
    for (int round = 0; round < 80; ++round) {
      std::string damaged = content;
      for (int flips = 0; flips < 1 + round % 4; ++flips)
        damaged[random() % damaged.size()] = static_cast<char>(random() % 256);
      try {
        const CheckedSolid checked = solid_of(damaged, "standard input");
        for (const Vec3& p : checked.solid.vertices) ASSERT_TRUE(is_finite(p));
        ASSERT_GT(checked.facts.volume, 0);
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::refused);
      }
    }
  }
}

}  // namespace
}  // namespace vpm::test
