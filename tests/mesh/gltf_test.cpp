// Reads glTF made here. Files of all formats of scenes are in tests/tools/cases/scenes.t.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "libvpm/synthetic/shapes.h"
#include "tests/mesh/scene_checks.h"

namespace vpm::test {
namespace {

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

// Returns what is said instead of the node's mesh.
std::string refusal_of_node(const std::string& content, const std::string& node) {
  try {
    node_of(content, node);
  } catch (const Error& fault) {
    return fault.what();
  }
  return "";
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
  // A hidden node hides those below it, though it has no mesh itself. Who asks for a hidden node by
  // its name is refused.
  const std::string group =
      glb("", tree, R"(,{"name":"group")" + std::string(below) + visible(false) + end + lid + end);
  expect_note(parse(group, "a.glb"), "1 node is left out as hidden (KHR_node_visibility): lid");
  for (const std::string name : {"lid", "group"}) {
    const std::string refusal = refusal_of_node(group, name);
    EXPECT_NE(refusal.find("its node '" + name + "' is hidden"), refusal.npos) << refusal;
  }
  // So is one that is shown while all that it holds is hidden.
  const std::string shell =
      glb("", tree, R"(,{"name":"group")" + std::string(below) + end + lid + visible(false) + end);
  EXPECT_NE(refusal_of_node(shell, "group")
                .find("all meshes of its node 'group' are hidden (KHR_node_visibility): lid"),
            std::string::npos);
  EXPECT_EQ(node_of(shell, "skin").polygon_count(), 12U);
  EXPECT_NE(refusal_of_node(shell, "gone").find("it has no node 'gone'"), std::string::npos);
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

}  // namespace
}  // namespace vpm::test
