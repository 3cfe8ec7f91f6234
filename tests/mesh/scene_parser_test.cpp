// Reads scenes made here: what tells their formats, COLLADA, and names of nodes. Those of
// all formats, and of units of 3MF, are in tests/tools/cases/scenes.t.
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "libvpm/core/error.h"
#include "libvpm/mesh/mesh_parsers.h"
#include "tests/mesh/scene_checks.h"

namespace vpm::test {
namespace {

TEST(Scenes, TextIsToldByItsContent) {
  const auto format_of = [](const std::string& text) { return scene_by_content(text); };
  EXPECT_EQ(format_of("\xEF\xBB\xBF {\"nodes\":[],\"asset\":{\"version\":\"2.0\"}}"),
            MeshFormat::gltf);
  EXPECT_EQ(format_of("; FBX 7.3.0 project file\n"), MeshFormat::fbx);
  EXPECT_EQ(format_of("FBXHeaderExtension:  {\n"), MeshFormat::fbx);
  EXPECT_EQ(format_of("{\"asset\":{\"version\":\"1.0\"},\"root\":{}}"), std::nullopt);  // 3D tiles
  EXPECT_EQ(format_of("{\"spheres\":[]}"), std::nullopt);
}

// Returns a COLLADA file of a triangle, of the given unit (an element or nothing) and nodes.
std::string dae(const std::string& unit, const std::string& nodes) {
  return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset>)" +
         unit + R"(<up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 1 0</float_array><technique_common>
<accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s">)" +
         nodes +
         R"(</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

// Returns what stands in a COLLADA file's root before the scene: a skin of the triangle by one
// joint.
std::string dae_skin(const std::string& bind_shape) {
  const std::string unit_matrix = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";
  const auto source = [](const std::string& id, const std::string& list, const std::string& param,
                         const std::string& stride) {
    return "<source id=\"" + id + "\">" + list + "<technique_common><accessor source=\"#" + id +
           "a\" count=\"1\" stride=\"" + stride + "\">" + param +
           "</accessor></technique_common></source>";
  };
  return "<library_controllers><controller id=\"c\"><skin source=\"#g\"><bind_shape_matrix>" +
         bind_shape + "</bind_shape_matrix>" +
         source("j", R"(<Name_array id="ja" count="1">b</Name_array>)",
                R"(<param name="JOINT" type="name"/>)", "1") +
         source("m", R"(<float_array id="ma" count="16">)" + unit_matrix + "</float_array>",
                R"(<param name="TRANSFORM" type="float4x4"/>)", "16") +
         source("w", R"(<float_array id="wa" count="1">1</float_array>)",
                R"(<param name="WEIGHT" type="float"/>)", "1") +
         R"(<joints><input semantic="JOINT" source="#j"/><input semantic="INV_BIND_MATRIX" source="#m"/></joints>
<vertex_weights count="3"><input semantic="JOINT" source="#j" offset="0"/><input semantic="WEIGHT" source="#w" offset="1"/>
<vcount>1 1 1</vcount><v>0 0 0 0 0 0</v></vertex_weights></skin></controller></library_controllers>)";
}

std::string node(const std::string& id, const std::string& name, double x,
                 const std::string& below = "") {
  return "<node id=\"" + id + "\" name=\"" + name + "\"><translate>" + std::to_string(x) +
         " 0 0</translate><instance_geometry url=\"#g\"/>" + below + "</node>";
}

TEST(Collada, ItsUnitIsSaid) {
  if (!reads_scenes()) GTEST_SKIP() << "no assimp";
  const std::string one = node("a", "a", 0);
  const RawMesh mm = parse(dae("<unit name=\"x\" meter='0.001'/>", one), "a.dae");
  EXPECT_EQ(mm.notes.at(0).substr(0, 32), "its unit of 0.001 m was applied;");
  EXPECT_NEAR(mm.vertices[1].x, 0.001, 1e-9);
  const RawMesh none = parse(dae("", one), "a.dae");
  EXPECT_EQ(none.notes.at(0).substr(0, 63),
            "its coordinates are taken to be metres, as it names no unit; tr");
}

TEST(Collada, OnlyTheUnitOfItsAssetCounts) {
  if (!reads_scenes()) GTEST_SKIP() << "no assimp";
  const std::string one = node("a", "a", 0);
  const auto edge = [&](const std::string& unit) {
    return parse(dae(unit, one), "a.dae").vertices.at(1).x;
  };
  EXPECT_NEAR(edge("<unit meter=\" 0.001\t\"/>"), 0.001, 1e-9);
  EXPECT_NEAR(edge("<unit meter=\"1e-3\" name='a>b'></unit>"), 0.001, 1e-9);
  EXPECT_EQ(edge("<!-- <unit meter=\"0.001\"/> --><unit meter=\"2\"/>"), 2);
  EXPECT_EQ(edge("<extra><technique><unit meter=\"0.5\"/></technique></extra>"), 1);
  EXPECT_NEAR(edge("<extra><unit meter=\"0.5\"/></extra><comments>" + std::string(100'000, 'x') +
                   "</comments><unit meter=\"0.01\"/>"),
              0.01, 1e-8);
  expect_note(parse(dae("<!-- <unit meter=\"0.001\"/> --><unit meter=\"2\"/>", one), "a.dae"),
              "its unit of 2 m was applied");
  expect_note(parse(dae("<unit name=\"inch\"/>", one), "a.dae"),
              "taken to be metres, as its unit 'inch' has no length");
}

TEST(Collada, AUnitWithoutALengthThatIsANumberIsRefused) {
  if (!reads_scenes()) GTEST_SKIP() << "no assimp";
  for (const std::string length : {"0,01", "-0.001", "0", "mm", "", "nan", "inf", "0.001 m"}) {
    expect_refusal(dae("<unit meter=\"" + length + "\"/>", node("a", "a", 0)), "a.dae",
                   "its unit has the length meter=\"" + length + "\", which is no positive number");
  }
}

TEST(Collada, NodesWithoutFacesAreNoMesh) {
  if (!reads_scenes()) GTEST_SKIP() << "no assimp";
  for (const std::string nodes :
       {"<node id=\"a\"><translate>0 0 1</translate></node>", "<node id=\"a\"/>"})
    expect_refusal(dae("", nodes), "a.dae", "it has no faces, only nodes");
}

TEST(Collada, ACoordinateThatIsNotFiniteIsRefusedWithTheFile) {
  if (!reads_scenes()) GTEST_SKIP() << "no assimp";
  std::string content = dae("", node("a", "a", 0));
  content.replace(content.find(">0 0 0 1"), 4, ">NaN 0");
  expect_refusal(content, "a.dae", "not finite");
}

TEST(Collada, JointsPlaceAMeshWithASkin) {
  if (!reads_scenes()) GTEST_SKIP() << "no assimp";
  const auto with_skin = [](const std::string& bind_shape, const std::string& joint) {
    std::string content = dae(
        "", R"(<node id="n" name="n"><scale>5 5 5</scale><instance_controller url="#c"/></node>)"
            R"(<node id="b" sid="b" name="b" type="JOINT">)" +
                joint + "</node>");
    content.insert(content.find("<library_visual_scenes>"), dae_skin(bind_shape));
    return parse(content, "a.dae");
  };
  const std::string as_is = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";
  EXPECT_NEAR(with_skin(as_is, "").vertices.at(1).x, 1, 1e-6);
  EXPECT_NEAR(with_skin(as_is, "<scale>.5 .5 .5</scale>").vertices.at(1).x, 0.5, 1e-6);
  const RawMesh bound = with_skin(".1 0 0 0 0 .1 0 0 0 0 .1 0 0 0 0 1", "");
  EXPECT_NEAR(bound.vertices.at(1).x, 0.1, 1e-6);
  expect_note(bound, "it has a skin: the joints place its mesh");
}

TEST(Nodes, OfOneNameAreToldApart) {
  if (!reads_scenes()) GTEST_SKIP() << "no assimp";
  const std::string two = dae("", node("a", "finger", 10) + node("b", "finger", 20));
  EXPECT_NE(parse(two, "a.dae").notes.at(1).find("joined: finger[1], finger[2];"),
            std::string::npos);
  try {
    node_of(two, "finger");
    ADD_FAILURE() << "accepted";
  } catch (const Error& fault) {
    EXPECT_EQ(fault.problem(), "2 nodes have the name 'finger'");
    EXPECT_NE(fault.hint().find("finger[1], finger[2]"), std::string::npos) << fault.hint();
  }
  EXPECT_EQ(node_of(two, "finger[2]").vertices.at(0).x, 20);
  EXPECT_THROW(node_of(two, "finger[3]"), Error);
  // One above the others of its name is all of them.
  const std::string nested = dae("", node("a", "arm", 10, node("b", "arm", 20)));
  EXPECT_EQ(node_of(nested, "arm").polygon_count(), 2U);
  EXPECT_EQ(node_of(nested, "arm[2]").polygon_count(), 1U);
  // Names in other languages can be copied from the list.
  const std::string cyrillic = dae("", node("a", "кисть", 0) + node("b", "рука", 0));
  EXPECT_NE(parse(cyrillic, "a.dae").notes.at(1).find("кисть, рука"), std::string::npos);
}

}  // namespace
}  // namespace vpm::test
