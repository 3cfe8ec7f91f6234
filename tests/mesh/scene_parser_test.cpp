// Reads files of scenes made here. Those of all formats, and of units of 3MF, are in
// tests/tools/cases/scenes.t.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <new>
#include <span>

#include "libvpm/core/error.h"
#include "libvpm/mesh/child_process.h"
#include "libvpm/mesh/mesh_parsers.h"
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

std::string all_notes(const RawMesh& mesh) {
  std::string text;
  for (const std::string& note : mesh.notes) text += note + "\n";
  return text;
}

void expect_note(const RawMesh& mesh, const std::string& note) {
  EXPECT_NE(all_notes(mesh).find(note), std::string::npos) << all_notes(mesh);
}

void expect_refusal(const std::string& content, const std::string& name, const std::string& words) {
  const std::string refusal = refusal_of(content, name);
  EXPECT_NE(refusal.find(words), refusal.npos) << refusal;
  EXPECT_NE(refusal.find(name), refusal.npos) << refusal;
}

void append_number(std::string& bytes, std::uint32_t number, int size = 4) {
  for (int k = 0; k < size; ++k) bytes += static_cast<char>(number >> 8 * k & 0xFF);
}

std::string as_glb(std::string json, const std::string& buffer) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string bytes = "glTF";
  append_number(bytes, 2);
  append_number(bytes, static_cast<std::uint32_t>(28 + json.size() + buffer.size()));
  append_number(bytes, static_cast<std::uint32_t>(json.size()));
  bytes += "JSON" + json;
  append_number(bytes, static_cast<std::uint32_t>(buffer.size()));
  return bytes + std::string("BIN\0", 4) + buffer;
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
  const std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"name":"skin","mesh":0)" +
      of_node + "}" + nodes +
      R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"accessors":[)" +
      R"({"bufferView":0,"componentType":5126,"count":8,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},)" +
      R"({"bufferView":1,"componentType":5125,"count":36,"type":"SCALAR"}],"bufferViews":[)" +
      R"({"buffer":0,"byteLength":)" + text(points) + R"(},{"buffer":0,"byteOffset":)" +
      text(points) + R"(,"byteLength":)" + text(buffer.size() - points) +
      R"(}],"buffers":[{"byteLength":)" + text(buffer.size()) + "}]" + members + "}";
  return as_glb(json, buffer);
}

TEST(Gltf, SkinsThatAssimpCannotReadAreSaid) {
  if (!reads_scenes()) GTEST_SKIP() << "no assimp";
  const std::string joint = R"(,{"name":"joint"})";
  for (const std::string skins :
       {R"(,"skins":[{"joints":[1]}])", R"(, "skins" : [{"joints":[]}])"}) {
    const std::string content = glb(skins, R"(,"skin":0)", joint);
    EXPECT_NEAR(solid_of(content, "a.glb").facts.volume, 0.125, 1e-9);
    expect_note(parse(content, "a.glb"), "it has a skin, which is not applied: check its size");
  }
  // A name stays as it is.
  const RawMesh named = node_of(glb(""), "skin");
  EXPECT_EQ(named.polygon_count(), 12U);
  EXPECT_EQ(named.notes.size(), 1U) << all_notes(named);
}

// Returns a binary glTF file of a triangle, its node and its joint with the given members. All of
// its vertices follow the joint.
std::string skinned_gltf(const std::string& of_node, const std::string& of_joint) {
  // Vertices, corners, joints (0 0 0 0 of each), weights (1 0 0 0), the matrix of the joint.
  std::string buffer;
  const auto add = [&](std::initializer_list<float> numbers) {
    for (const float number : numbers) {
      std::uint32_t bits = 0;
      std::memcpy(&bits, &number, sizeof bits);
      append_number(buffer, bits);
    }
  };
  add({0, 0, 0, 1, 0, 0, 0, 1, 0});
  for (std::uint32_t k = 0; k < 3; ++k) append_number(buffer, k);
  buffer += std::string(12, '\0');
  for (int k = 0; k < 3; ++k) add({1, 0, 0, 0});
  add({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
  const std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],"skins":[{"joints":[1],"inverseBindMatrices":4}],
"nodes":[{"name":"n","mesh":0,"skin":0)" +
      of_node + R"(},{"name":"j")" + of_joint +
      R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":2,"WEIGHTS_0":3},"indices":1}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},{"bufferView":1,"componentType":5125,"count":3,"type":"SCALAR"},
{"bufferView":2,"componentType":5121,"count":3,"type":"VEC4"},{"bufferView":3,"componentType":5126,"count":3,"type":"VEC4"},
{"bufferView":4,"componentType":5126,"count":1,"type":"MAT4"}],"bufferViews":[{"buffer":0,"byteLength":36},
{"buffer":0,"byteOffset":36,"byteLength":12},{"buffer":0,"byteOffset":48,"byteLength":12},{"buffer":0,"byteOffset":60,"byteLength":48},
{"buffer":0,"byteOffset":108,"byteLength":64}],"buffers":[{"byteLength":172}]})";
  return as_glb(json, buffer);
}

TEST(Gltf, JointsPlaceAMeshWithASkinNotItsNode) {
  if (!reads_scenes()) GTEST_SKIP() << "no assimp";
  const std::string scale = R"(,"scale":[0.01,0.01,0.01])";
  const auto edge = [](const std::string& content) {
    const RawMesh mesh = parse(content, "a.glb");
    expect_note(mesh, "it has a skin: the joints place its mesh");
    return mesh.vertices.at(1).x;
  };
  EXPECT_NEAR(edge(skinned_gltf("", "")), 1, 1e-6);
  EXPECT_NEAR(edge(skinned_gltf(scale, "")), 1, 1e-6);
  EXPECT_NEAR(edge(skinned_gltf("", scale)), 0.01, 1e-8);
  EXPECT_NEAR(edge(skinned_gltf(scale, scale)), 0.01, 1e-8);
}

TEST(Gltf, WhatIsNotAppliedIsSaid) {
  if (!reads_scenes()) GTEST_SKIP() << "no assimp";
  expect_note(parse(glb("", R"(,"weights":[1.0])"), "a.glb"),
              "its morph targets have weights, which are not applied");
  EXPECT_EQ(parse(glb("", R"(,"weights":[0])"), "a.glb").notes.size(), 1U);
}

// Returns a glTF file in text whose buffer is another file, and the content of that.
std::pair<std::string, std::string> gltf_of_two_files(const std::string& uri) {
  const std::string bytes = glb("");
  const std::size_t begin = 20, end = bytes.find(std::string("BIN\0", 4)) - 4;
  std::string json = bytes.substr(begin, end - begin);
  const std::size_t buffer = json.find("\"buffers\":[{") + 12;
  json.insert(buffer, "\"uri\":\"" + uri + "\",");
  return {json, bytes.substr(end + 8)};
}

TEST(Gltf, FilesThatItNeedsAreFoundOrNamed) {
  if (!reads_scenes()) GTEST_SKIP() << "no assimp";
  const auto folder = std::filesystem::path(testing::TempDir()) / "vpm_gltf_files";
  std::filesystem::create_directories(folder);
  const auto write = [&](const std::string& name, const std::string& content) {
    std::ofstream(folder / name, std::ios::binary) << content;
    return (folder / name).string();
  };
  const auto [json, buffer] = gltf_of_two_files("my%20buffer.bin");
  write("my buffer.bin", buffer);
  EXPECT_EQ(read_mesh(write("a.gltf", json)).polygon_count(), 12U);
  EXPECT_EQ(read_mesh(write("a.txt", json)).polygon_count(), 12U) << "told by its content";
  const std::string missing = gltf_of_two_files("missing.bin").first;
  expect_refusal(missing, write("b.gltf", missing),
                 "it needs the file 'missing.bin' beside it, which is not there");
  expect_refusal(missing, "standard input",
                 "it needs the file 'missing.bin' beside it, whose folder a pipe does not tell");
  std::filesystem::remove_all(folder);
}

TEST(Scenes, TextIsToldByItsContent) {
  const auto format_of = [](const std::string& text) { return scene_by_content(text); };
  EXPECT_EQ(format_of("\xEF\xBB\xBF {\"nodes\":[],\"asset\":{\"version\":\"2.0\"}}"),
            MeshFormat::gltf);
  EXPECT_EQ(format_of("; FBX 7.3.0 project file\n"), MeshFormat::fbx);
  EXPECT_EQ(format_of("FBXHeaderExtension:  {\n"), MeshFormat::fbx);
  EXPECT_EQ(format_of("{\"asset\":{\"version\":\"1.0\"},\"root\":{}}"), std::nullopt);  // 3D tiles
  EXPECT_EQ(format_of("{\"spheres\":[]}"), std::nullopt);
}

TEST(Gltf, BytesBehindTheFileAreSaid) {
  if (!reads_scenes()) GTEST_SKIP() << "no assimp";
  const std::string one = glb("");
  for (const std::string& padded : {one, one + std::string(3, '\0')})
    EXPECT_EQ(all_notes(parse(padded, "a.glb")).find("bytes after"), std::string::npos);
  expect_note(parse(one + one, "a.glb"), "the " + std::to_string(one.size()) +
                                             " bytes after the length in its header are not read");
}

TEST(Gltf, WithoutASceneAllNodesAreRead) {
  if (!reads_scenes()) GTEST_SKIP() << "no assimp";
  const std::string of_scene = R"("scene":0,"scenes":[{"nodes":[0]}],)";
  const std::string moved = R"(,{"name":"up","children":[2]},{"name":"tip","mesh":0})";
  const auto without = [&](std::string bytes, const std::string& instead) {
    bytes.replace(bytes.find(of_scene), of_scene.size(),
                  instead + std::string(of_scene.size() - instead.size(), ' '));
    return bytes;
  };
  for (const char* const instead : {"", R"("scenes":[],)", R"("scene":0,)"}) {
    const RawMesh mesh = parse(without(glb("", "", moved), instead), "a.glb");
    EXPECT_EQ(mesh.polygon_count(), 24U) << instead;
    expect_note(mesh, "it has no scene, and so all of its nodes are read");
  }
  EXPECT_EQ(parse(glb("", "", moved), "a.glb").polygon_count(), 12U) << "the scene's node alone";
  EXPECT_EQ(all_notes(parse(glb(""), "a.glb")).find("no scene"), std::string::npos);
  const auto [json, buffer] = gltf_of_two_files("buffer.bin");
  const auto folder = std::filesystem::path(testing::TempDir()) / "vpm_gltf_no_scene";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "buffer.bin", std::ios::binary) << buffer;
  std::ofstream(folder / "a.gltf", std::ios::binary) << without(json, "");
  EXPECT_EQ(read_mesh((folder / "a.gltf").string()).polygon_count(), 12U);
  std::filesystem::remove_all(folder);
}

// Returns the cube of edge 1 with positions of integers, a node's members and the JSON after them.
std::string quantized(int component, bool is_normalized, int low, int high,
                      const std::string& of_node, const std::string& rest = "") {
  const int size = component <= 5121 ? 1 : 2;
  const int stride = 4 * size;
  const Solid cube = synthetic::make_cube(1);
  std::string buffer;
  for (const Vec3& p : cube.vertices) {
    for (const double c : {p.x, p.y, p.z})
      append_number(buffer, static_cast<std::uint32_t>(c < 0 ? low : high), size);
    append_number(buffer, 0x77, size);  // padding
  }
  const std::size_t points = buffer.size();
  for (const Triangle& t : cube.triangles)
    for (const std::uint32_t corner : t) append_number(buffer, corner, 2);
  const auto text = [](std::size_t number) { return std::to_string(number); };
  const std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"name":"n","mesh":0)" +
      of_node +
      R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":0},"indices":1}]}],"accessors":[)" +
      R"({"bufferView":0,"componentType":)" + std::to_string(component) + R"(,"normalized":)" +
      (is_normalized ? "true" : "false") + R"(,"count":8,"type":"VEC3"},)" +
      R"({"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"}],"bufferViews":[)" +
      R"({"buffer":0,"byteLength":)" + text(points) + R"(,"byteStride":)" + std::to_string(stride) +
      R"(},{"buffer":0,"byteOffset":)" + text(points) + R"(,"byteLength":)" +
      text(buffer.size() - points) + R"(}],"buffers":[{"byteLength":)" + text(buffer.size()) +
      R"(}],"extensionsUsed":["KHR_mesh_quantization"],"extensionsRequired":["KHR_mesh_quantization"])" +
      rest + "}";
  return as_glb(json, buffer);
}

TEST(Gltf, PositionsOfIntegersAreRead) {
  if (!reads_scenes()) GTEST_SKIP() << "no assimp";
  struct Row {
    int component;
    bool is_normalized;
    int low, high;
    double edge;
  };
  for (const Row& row : std::vector<Row>{{5120, true, -127, 127, 2},
                                         {5120, true, -128, 127, 2},
                                         {5120, false, -100, 20, 120},
                                         {5121, true, 0, 255, 1},
                                         {5121, false, 7, 207, 200},
                                         {5122, true, -32767, 32767, 2},
                                         {5122, false, -3000, 3000, 6000},
                                         {5123, true, 0, 65535, 1},
                                         {5123, false, 1, 50001, 50000}}) {
    const double scale = .5 / row.edge;
    const std::string place = R"(,"translation":[3,0,0],"scale":[)" + std::to_string(scale) + "," +
                              std::to_string(scale) + "," + std::to_string(scale) + "]";
    const CheckedSolid solid =
        solid_of(quantized(row.component, row.is_normalized, row.low, row.high, place), "a.glb");
    const double edge = std::stod(std::to_string(scale)) * row.edge;
    EXPECT_NEAR(solid.facts.volume, edge * edge * edge, 1e-6) << row.component;
    EXPECT_NEAR(solid.facts.high.x - solid.facts.low.x, edge, 1e-6) << row.component;
  }
}

TEST(Gltf, NumbersThatAreNotInTheFileAreRefused) {
  if (!reads_scenes()) GTEST_SKIP() << "no assimp";
  const std::string whole = quantized(5122, true, -32767, 32767, "");
  const auto with = [&](const std::string& words, const std::string& instead) {
    std::string bytes = whole;
    return bytes.replace(bytes.find(words), words.size(), instead);
  };
  for (const std::string& bytes :
       {with("\"count\":8", "\"count\":9"), with("\"byteStride\":8", "\"byteStride\":9"),
        with("\"byteLength\":64", "\"byteLength\":10"),
        with("\"componentType\":5122", "\"componentType\":5124")})
    expect_refusal(bytes, "a.glb", "the numbers of its meshes cannot be read");
}

TEST(Gltf, InstancesAreRead) {
  if (!reads_scenes()) GTEST_SKIP() << "no assimp";
  // Accessor 0 are the eight points of the cube of edge 0.5.
  const auto instances = [](const std::string& attributes) {
    return R"(,"scale":[2,2,2],"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{)" +
           attributes + "}}}";
  };
  const auto expect_half = [](const RawMesh& mesh, double half) {
    EXPECT_EQ(mesh.polygon_count(), 8 * 12U);
    double low = 0, high = 0;
    for (const Vec3& p : mesh.vertices) {
      low = std::min({low, p.x, p.y, p.z});
      high = std::max({high, p.x, p.y, p.z});
    }
    EXPECT_NEAR(low, -half, 1e-6);
    EXPECT_NEAR(high, half, 1e-6);
  };
  for (const char* const used : {"extensionsUsed", "extensionsRequired"}) {
    const std::string extensions = std::string(",\"") + used + R"(":["EXT_mesh_gpu_instancing"])";
    const std::string content = glb(extensions, instances(R"("TRANSLATION":0)"));
    expect_half(parse(content, "a.glb"), 1);
    expect_half(node_of(content, "skin"), 1);  // chosen by the name of their node
  }
  expect_half(parse(glb("", instances(R"("SCALE":0)")), "a.glb"), .125);
  expect_half(parse(glb("", instances(R"("SCALE":0,"TRANSLATION":0)")), "a.glb"), .625);
  EXPECT_EQ(parse(glb("", instances("")), "a.glb").polygon_count(), 12U);
  for (const std::string wrong : {R"("TRANSLATION":7)", R"("ROTATION":0)"})
    expect_refusal(glb("", instances(wrong)), "a.glb", "the numbers of its meshes cannot be read");
}

// Returns the members of a node that its file hides, or shows.
std::string visible(bool is_visible) {
  return std::string(R"(,"extensions":{"KHR_node_visibility":{"visible":)") +
         (is_visible ? "true" : "false") + "}}";
}

// Hidden nodes are no part of the solid, and neither are those below them, whatever they say.
TEST(Gltf, HiddenNodesAreLeftOutAndNamed) {
  if (!reads_scenes()) GTEST_SKIP() << "no assimp";
  const std::string tip = R"(,{"name":"tip","mesh":0,"translation":[3,0,0])",
                    lid = R"(,{"name":"lid","mesh":0,"translation":[6,0,0])", end = "}";
  const auto tree = R"(,"children":[1],"translation":[1,0,0])";
  const auto below = R"(,"children":[2])";
  for (const std::string used : {"", R"(,"extensionsUsed":["KHR_node_visibility"])",
                                 R"(,"extensionsRequired":["KHR_node_visibility"])"}) {
    const RawMesh one =
        parse(glb(used, tree, tip + below + end + lid + visible(false) + end), "a.glb");
    EXPECT_EQ(one.polygon_count(), 24U);
    expect_note(one, "1 node is left out as hidden (KHR_node_visibility): lid");
    const RawMesh both = parse(
        glb(used, tree, tip + below + visible(false) + end + lid + visible(true) + end), "a.glb");
    EXPECT_EQ(both.polygon_count(), 12U);
    expect_note(both, "2 nodes are left out as hidden (KHR_node_visibility): tip, lid");
    EXPECT_NEAR(both.vertices.front().x, .75, .26) << "what stays is where it was";
  }
  const std::string all = glb("", tree + visible(false), tip + below + end + lid + end);
  expect_refusal(all, "a.glb",
                 "all of its meshes are hidden (KHR_node_visibility): skin, tip, lid");
  const RawMesh shown = parse(glb("", tree + visible(true), tip + visible(true) + end), "a.glb");
  EXPECT_EQ(shown.polygon_count(), 24U);
  EXPECT_EQ(all_notes(shown).find("hidden"), std::string::npos);
  // A group without a mesh hides what is below; a node that is asked for by name is refused.
  const std::string group =
      glb("", tree, R"(,{"name":"group")" + std::string(below) + visible(false) + end + lid + end);
  expect_note(parse(group, "a.glb"), "1 node is left out as hidden (KHR_node_visibility): lid");
  for (const std::string name : {"lid", "group"}) {
    std::string refusal;
    try {
      node_of(group, name);
    } catch (const Error& fault) {
      refusal = fault.what();
    }
    EXPECT_NE(refusal.find("its node '" + name + "' is hidden"), refusal.npos) << refusal;
  }
  // Instances and integers, which are made plain before, are hidden alike.
  const std::string hides_and_repeats =
      R"(,"extensions":{"KHR_node_visibility":{"visible":false},"EXT_mesh_gpu_instancing":)"
      R"({"attributes":{"TRANSLATION":0}}})";
  EXPECT_EQ(parse(glb("", tree, tip + hides_and_repeats + end), "a.glb").polygon_count(), 12U);
  expect_refusal(quantized(5122, true, -32767, 32767, visible(false)), "a.glb", "hidden");
  // A file of two scenes, or of none, is judged by what is read of it; one of loops ends.
  const std::string outside = glb("", "", tip + visible(false) + end);
  EXPECT_EQ(all_notes(parse(outside, "a.glb")).find("hidden"), std::string::npos);
  std::string none = outside;
  const std::string scenes = R"("scene":0,"scenes":[{"nodes":[0]}],)";
  none.replace(none.find(scenes), scenes.size(), std::string(scenes.size(), ' '));
  expect_note(parse(none, "a.glb"), "1 node is left out as hidden (KHR_node_visibility): tip");
  refusal_of(glb("", tree + visible(false), tip + R"(,"children":[0,1,9,-1,"x"])" + end), "a.glb");
}

// Nodes without a name are told by their places in the file, and chosen by them.
TEST(Gltf, NodesWithoutANameAreToldByTheirPlaces) {
  if (!reads_scenes()) GTEST_SKIP() << "no assimp";
  const std::string bare = R"(,{"mesh":0,"translation":[3,0,0])", end = "}";
  const std::string tree = R"(,"children":[1,2])";
  const std::string content = glb("", tree, bare + R"(,"name":"")" + end + bare + end);
  expect_note(parse(content, "a.glb"), "the meshes of 3 nodes are joined: skin, node 1, node 2");
  EXPECT_EQ(node_of(content, "node 2").polygon_count(), 12U);
  EXPECT_NEAR(node_of(content, "node 2").vertices.front().x, 3, .26);
  expect_note(parse(glb("", tree, bare + end + bare + visible(false) + end), "a.glb"),
              "1 node is left out as hidden (KHR_node_visibility): node 2");
  const std::string instances =
      R"(,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":0}}})";
  const std::string repeated = glb("", R"(,"children":[1])", bare + instances + end);
  expect_note(parse(repeated, "a.glb"), "node 1 instance 1, node 1 instance 2");
  EXPECT_EQ(node_of(repeated, "node 1").polygon_count(), 8 * 12U);
  EXPECT_EQ(node_of(repeated, "node 1 instance 2").polygon_count(), 12U);
}

TEST(Gltf, RequiredExtensionsAreNamed) {
  if (!reads_scenes()) GTEST_SKIP() << "no assimp";
  for (const std::string name : {"EXT_meshopt_compression", "EXT_of_tomorrow"}) {
    const std::string refusal =
        refusal_of(glb(R"(,"extensionsRequired":[")" + name + R"("])"), "a.glb");
    EXPECT_NE(refusal.find("requires the glTF extension " + name), refusal.npos) << refusal;
    EXPECT_NE(refusal.find("save it without compression"), refusal.npos) << refusal;
  }
  expect_refusal(R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":4}],"meshes":[]})",
                 "a.gltf", "the data of its meshes is not in the file");
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
