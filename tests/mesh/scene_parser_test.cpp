// Reads files of scenes made here. Those of all formats, and of units of 3MF, are in
// tests/tools/cases/scenes.t.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <new>
#include <span>

#include "libvpm/core/error.h"
#include "libvpm/mesh/child_process.h"
#include "libvpm/synthetic/shapes.h"
#include "tests/mesh/mesh_files.h"

namespace vpm::test {
namespace {

constexpr ChildLimits kLimits{100'000'000, 5};
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
constexpr bool kKeepsItsLimits = false;  // without memory, a sanitizer ends the program
#else
constexpr bool kKeepsItsLimits = true;
#endif

TEST(ChildProcess, ReturnsWhatItsWorkDoes) {
  const std::string large(1 << 20, 'x');  // more than a pipe holds
  EXPECT_EQ(run_in_child([&] { return large; }, kLimits).bytes, large);
  const ChildResult empty = run_in_child([] { return std::string(); }, kLimits);
  EXPECT_EQ(empty.end, ChildResult::End::returned);
  EXPECT_EQ(empty.bytes, "");
}

TEST(ChildProcess, ACrashIsSeen) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGKILL}) {
    const auto crash = [&] {
      std::raise(signal);
      return std::string("done");
    };
    EXPECT_EQ(run_in_child(crash, kLimits).end, ChildResult::End::crashed) << signal;
  }
}

TEST(ChildProcess, HasLimitedMemoryAndTime) {
  const auto take_memory = [] {
    try {
      return std::string(300'000'000, 'x').substr(0, 1);
    } catch (const std::bad_alloc&) {
      return std::string("no memory");
    }
  };
  if (kKeepsItsLimits) {
    EXPECT_EQ(run_in_child(take_memory, kLimits).bytes, "no memory");
  }
  const auto take_time = []() -> std::string {
    for (;;) std::clock();
  };
  EXPECT_EQ(run_in_child(take_time, {kLimits.memory, 1}).end, ChildResult::End::out_of_time);
}

bool reads_scenes() {
  try {
    parse("{}", "a.gltf");
  } catch (const Error& fault) {
    return fault.kind() != ErrorKind::unavailable;
  }
  return true;
}

RawMesh node_of(const std::string& content, const std::string& name) {
  return parse_mesh(std::as_bytes(std::span(content)), "a", name);
}

void append_number(std::string& bytes, std::uint32_t number) {
  for (int k = 0; k < 4; ++k) bytes += static_cast<char>(number >> 8 * k & 0xFF);
}

// Returns a binary glTF file of a cube of edge 0.5, with more members in its JSON, its node and its
// list of nodes.
std::string glb(const std::string& members, const std::string& of_node = "",
                const std::string& nodes = "") {
  const Solid cube = synthetic::make_cube(0.5);
  std::string buffer;
  for (const Vec3& p : cube.vertices) {
    for (const double c : {p.x, p.y, p.z}) {
      const auto single = static_cast<float>(c);
      std::uint32_t bits = 0;
      std::memcpy(&bits, &single, sizeof bits);
      append_number(buffer, bits);
    }
  }
  const std::size_t points = buffer.size();
  for (const Triangle& t : cube.triangles)
    for (const std::uint32_t corner : t) append_number(buffer, corner);
  const auto text = [](std::size_t number) { return std::to_string(number); };
  std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"name":"skin","mesh":0)" +
      of_node + "}" + nodes +
      R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"accessors":[)" +
      R"({"bufferView":0,"componentType":5126,"count":8,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},)" +
      R"({"bufferView":1,"componentType":5125,"count":36,"type":"SCALAR"}],"bufferViews":[)" +
      R"({"buffer":0,"byteLength":)" + text(points) + R"(},{"buffer":0,"byteOffset":)" +
      text(points) + R"(,"byteLength":)" + text(buffer.size() - points) +
      R"(}],"buffers":[{"byteLength":)" + text(buffer.size()) + "}]" + members + "}";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string bytes = "glTF";
  append_number(bytes, 2);
  append_number(bytes, static_cast<std::uint32_t>(28 + json.size() + buffer.size()));
  append_number(bytes, static_cast<std::uint32_t>(json.size()));
  bytes += "JSON" + json;
  append_number(bytes, static_cast<std::uint32_t>(buffer.size()));
  return bytes + std::string("BIN\0", 4) + buffer;
}

TEST(Gltf, SkinsArePassedOver) {
  if (!reads_scenes()) GTEST_SKIP() << "no assimp";
  const std::string joint = R"(,{"name":"joint"})";
  for (const std::string skins :
       {R"(,"skins":[{"joints":[1]}])", R"(, "skins" : [{"joints":[]}])"}) {
    const CheckedSolid solid = solid_of(glb(skins, R"(,"skin":0)", joint), "a.glb");
    EXPECT_NEAR(solid.facts.volume, 0.125, 1e-9);
  }
  // A name stays as it is.
  EXPECT_EQ(node_of(glb(""), "skin").polygon_count(), 12U);
}

TEST(Gltf, RequiredExtensionsAreNamed) {
  if (!reads_scenes()) GTEST_SKIP() << "no assimp";
  for (const std::string name :
       {"KHR_mesh_quantization", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing"}) {
    const std::string refusal =
        refusal_of(glb(R"(,"extensionsRequired":[")" + name + R"("])"), "a.glb");
    EXPECT_NE(refusal.find("requires the glTF extension " + name), refusal.npos) << refusal;
    EXPECT_NE(refusal.find("save it without compression"), refusal.npos) << refusal;
  }
  const std::string looks = R"(,"extensionsRequired":["KHR_materials_unlit","KHR_texture_basisu"])";
  EXPECT_EQ(refusal_of(glb(looks), "a.glb"), "");
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
