#include "libvpm/view/sphere_files.h"

#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <vector>

namespace vpm::view {
namespace {

const std::vector<Sphere> kSpheres{
    {{0, 0, 0}, 0.5}, {{1e6 + 1.0 / 3, 0, 0}, 0.25}, {{2, 1, 0}, 0.125}};
const std::vector<std::uint8_t> kStates{0, 2, 2};

TEST(SphereFiles, SuffixesChooseTheFormat) {
  EXPECT_EQ(sphere_format("a.csv"), SphereFormat::csv);
  EXPECT_EQ(sphere_format("a.ply"), SphereFormat::ply);
  EXPECT_EQ(sphere_format("a.points.ply"), SphereFormat::points);
  EXPECT_EQ(sphere_format("a.glb"), SphereFormat::glb);
  EXPECT_EQ(sphere_format("a.xyz"), std::nullopt);
}

TEST(SphereFiles, TablesNameTheStates) {
  EXPECT_EQ(spheres_as(SphereFormat::csv, kSpheres, kStates),
            "x,y,z,r,state\n0,0,0,0.5,outside\n1000000.3333333334,0,0,0.25,inside\n"
            "2,1,0,0.125,inside\n");
}

TEST(SphereFiles, BallsHaveTheColoursOfTheirStates) {
  const std::string bytes = spheres_as(SphereFormat::ply, kSpheres, kStates);
  EXPECT_NE(bytes.find("element face 240\n"), std::string::npos);
  const std::size_t body = bytes.find("end_header\n") + 11;
  constexpr std::size_t kVertex = 15, kCorners = 42;
  for (std::size_t k = 0; k < kSpheres.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(static_cast<std::uint8_t>(bytes[body + kVertex * kCorners * k + 12 + i]),
                kStateLooks[kStates[k]].rgb[i]);
}

TEST(SphereFiles, PointsHaveTheState) {
  const std::string bytes = spheres_as(SphereFormat::points, kSpheres, kStates);
  const std::size_t body = bytes.find("end_header\n") + 11;
  ASSERT_EQ(bytes.size(), body + 20 * kSpheres.size());
  EXPECT_EQ(bytes[body + 19], 0);
  EXPECT_EQ(bytes[body + 39], 2);
}

// The layout of glTF 2.0, section "Binary glTF Layout".
TEST(SphereFiles, GlbHasAMeshForEachStateThatThereIs) {
  const std::string bytes = spheres_as(SphereFormat::glb, kSpheres, kStates);
  const auto word = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
  };
  ASSERT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(word(4), 2U);
  EXPECT_EQ(word(8), bytes.size());
  const std::uint32_t json_size = word(12);
  EXPECT_EQ(json_size % 4, 0U);
  const nlohmann::json document = nlohmann::json::parse(bytes.substr(20, json_size));
  EXPECT_EQ(word(20 + json_size), document["buffers"][0]["byteLength"]);
  EXPECT_EQ(28 + json_size + word(20 + json_size), bytes.size());
  ASSERT_EQ(document["nodes"].size(), 2U);
  EXPECT_EQ(document["nodes"][0]["name"], "outside");
  EXPECT_EQ(document["nodes"][1]["name"], "inside");
  for (const nlohmann::json& view : document["bufferViews"])
    EXPECT_LE(view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>(),
              word(20 + json_size));
  for (const nlohmann::json& mesh : document["meshes"]) {
    const nlohmann::json& primitive = mesh["primitives"][0];
    const nlohmann::json& indices = document["accessors"][primitive["indices"].get<std::size_t>()];
    const nlohmann::json& positions =
        document["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
    const std::size_t begin =
        28 + json_size +
        document["bufferViews"][indices["bufferView"].get<std::size_t>()]["byteOffset"]
            .get<std::size_t>();
    for (std::size_t k = 0; k < indices["count"]; ++k)
      EXPECT_LT(word(begin + 4 * k), positions["count"].get<std::uint32_t>());
  }
}

}  // namespace
}  // namespace vpm::view
