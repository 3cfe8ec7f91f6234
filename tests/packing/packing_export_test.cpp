#include "libvpm/packing/packing_export.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <regex>
#include <span>
#include <sstream>

#include "libvpm/core/error.h"
#include "libvpm/mesh/mesh_check.h"
#include "libvpm/mesh/mesh_reader.h"
#include "libvpm/view/sphere_files.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

const std::vector<Sphere> kSpheres{{{0.1, -2.0 / 3, 3e-7}, 0.5}, {{10, 20, 30}, 1.0 / 300}};

RobotSpheres one_link(const std::string& link, const std::vector<Sphere>& spheres = kSpheres) {
  return {link, {{link, spheres}}};
}

TEST(PackingExport, ExtensionsChooseTheFormat) {
  EXPECT_EQ(export_format("a/b.csv"), ExportFormat::spheres);
  EXPECT_EQ(export_format("b.ply"), ExportFormat::spheres);
  EXPECT_EQ(export_format("b.points.ply"), ExportFormat::spheres);
  EXPECT_EQ(export_format("b.glb"), ExportFormat::spheres);
  EXPECT_EQ(export_format("b.json"), ExportFormat::json);
  EXPECT_EQ(export_format("b.vtk"), ExportFormat::vtk);
  EXPECT_EQ(export_format("b.urdf"), ExportFormat::urdf);
  EXPECT_EQ(export_format("b.srdf"), ExportFormat::srdf);
  EXPECT_EQ(export_format("b.xrdf"), ExportFormat::xrdf);
  EXPECT_EQ(export_format("b.yml"), ExportFormat::yml);
  EXPECT_EQ(export_format("b.yaml"), ExportFormat::yml);
  for (const char* const name : {"b", "b.CSV.txt", "csv", "-", ""})
    EXPECT_EQ(test::kind_of_fault([&] { export_format(name); }), ErrorKind::invalid_argument)
        << name;
}

TEST(PackingExport, CsvHasAHeaderAndNineDigits) {
  EXPECT_EQ(view::spheres_as(view::SphereFormat::csv, kSpheres),
            "x,y,z,r\n0.1,-0.666666667,3e-07,0.5\n10,20,30,0.00333333333\n");
}

TEST(PackingExport, YmlListsTheSpheresOfALink) {
  EXPECT_EQ(packing_as_yml(one_link("hand", {kSpheres[0]})),
            "collision_spheres:\n  \"hand\":\n"
            "    - \"center\": [0.1, -0.666666667, 3e-07]\n      \"radius\": 0.5\n");
}

TEST(PackingExport, XrdfNamesItsGeometryWhereSpheresCollide) {
  EXPECT_EQ(packing_as_xrdf({"arm", {{"a", {kSpheres[1]}}}}),
            "format: \"xrdf\"\nformat_version: 1.0\ncollision:\n  geometry: \"arm_spheres\"\n"
            "self_collision:\n  geometry: \"arm_spheres\"\ngeometry:\n  \"arm_spheres\":\n"
            "    spheres:\n      \"a\":\n        - \"center\": [10, 20, 30]\n"
            "          \"radius\": 0.00333333333\n");
}

TEST(PackingExport, CsvOfARobotNamesLinks) {
  EXPECT_EQ(
      robot_as_csv({"arm", {{"a \"b\"", {kSpheres[0]}}, {"c", {kSpheres[1]}}}}),
      "link,x,y,z,r\n\"a \"\"b\"\"\",0.1,-0.666666667,3e-07,0.5\n\"c\",10,20,30,0.00333333333\n");
}

// Returns the spheres that `pattern` finds in the text, each with its numbers in the order x, y, z,
// r.
std::vector<Sphere> found_by(const std::regex& pattern, const std::string& text) {
  std::vector<Sphere> spheres;
  for (std::sregex_iterator at(text.begin(), text.end(), pattern), end; at != end; ++at) {
    spheres.push_back(
        {{std::stod((*at)[1]), std::stod((*at)[2]), std::stod((*at)[3])}, std::stod((*at)[4])});
  }
  return spheres;
}

void expect_nine_digits(const std::vector<Sphere>& read) {
  ASSERT_EQ(read.size(), kSpheres.size());
  for (std::size_t k = 0; k < read.size(); ++k) {
    const Sphere& truth = kSpheres[k];
    const auto near = [](double a, double b) { EXPECT_NEAR(a, b, 5e-9 * std::abs(b)); };
    near(read[k].center.x, truth.center.x);
    near(read[k].center.y, truth.center.y);
    near(read[k].center.z, truth.center.z);
    near(read[k].radius, truth.radius);
  }
}

TEST(PackingExport, TextIsReadBackToNineDigits) {
  const std::string number = "([-+.e0-9]+)";
  const std::string xyz = number + " " + number + " " + number;
  expect_nine_digits(found_by(std::regex(number + "," + number + "," + number + "," + number),
                              view::spheres_as(view::SphereFormat::csv, kSpheres)));
  expect_nine_digits(found_by(std::regex("\"center\": \\[" + number + ", " + number + ", " +
                                         number + "\\]\\s+\"radius\": " + number),
                              packing_as_yml(one_link("hand"))));
  expect_nine_digits(found_by(std::regex("<collision>\\s*<origin xyz=\"" + xyz +
                                         "\" rpy=\"0 0 0\"/>\\s*<geometry><sphere radius=\"" +
                                         number + "\"/></geometry>\\s*</collision>"),
                              packing_as_urdf(one_link("hand"))));
  expect_nine_digits(
      found_by(std::regex("<sphere center=\"" + xyz + "\" radius=\"" + number + "\"/>"),
               packing_as_srdf(one_link("hand"))));
}

TEST(PackingExport, VtkListsPointsThenRadii) {
  std::istringstream in(packing_as_vtk(kSpheres));
  std::string line, word;
  std::getline(in, line);
  EXPECT_EQ(line, "# vtk DataFile Version 3.0");
  std::vector<Sphere> read(kSpheres.size());
  while (in >> word && word != "POINTS") continue;
  in >> word >> word;
  for (Sphere& s : read) in >> s.center.x >> s.center.y >> s.center.z;
  in >> word;
  EXPECT_EQ(word, "VERTICES");
  while (in >> word && word != "default") continue;
  for (Sphere& s : read) in >> s.radius;
  EXPECT_TRUE(in);
  expect_nine_digits(read);
}

TEST(PackingExport, JsonIsReadBackToTheBit) {
  const nlohmann::json read = nlohmann::json::parse(packing_as_json(kSpheres));
  ASSERT_EQ(read["centers"].size(), kSpheres.size());
  for (std::size_t k = 0; k < kSpheres.size(); ++k) {
    EXPECT_EQ(
        read["centers"][k].get<std::vector<double>>(),
        (std::vector<double>{kSpheres[k].center.x, kSpheres[k].center.y, kSpheres[k].center.z}));
    EXPECT_EQ(read["radii"][k].get<double>(), kSpheres[k].radius);
  }
}

TEST(PackingExport, LinkNamesAreQuoted) {
  const std::string link = "a \"b\" <c> & d\\";
  EXPECT_NE(packing_as_yml(one_link(link)).find("\n  \"a \\\"b\\\" <c> & d\\\\\":\n"),
            std::string::npos);
  for (const std::string& text : {packing_as_urdf(one_link(link)), packing_as_srdf(one_link(link))})
    EXPECT_NE(text.find("=\"a &#34;b&#34; &#60;c&#62; &#38; d\\\""), std::string::npos);
  // That a parser of XML reads the same names is tested in tests/tools/cases/pack_export.t.
  for (const char* const bad : {"\x01", "a\x1f", "\x0b", "\xEF\xBF\xBE", "\xEF\xBF\xBF"}) {
    EXPECT_EQ(test::kind_of_fault([&] { packing_as_urdf(one_link(bad)); }),
              ErrorKind::invalid_argument);
    EXPECT_EQ(test::kind_of_fault([&] { packing_as_srdf(one_link(bad)); }),
              ErrorKind::invalid_argument);
  }
}

TEST(PackingExport, LinkNamesAreUtf8) {
  const std::string link = "\xC3\xA4\xFF\xFE", shown = "\xC3\xA4\xEF\xBF\xBD\xEF\xBF\xBD";
  for (const std::string& text : {packing_as_yml(one_link(link)), packing_as_urdf(one_link(link)),
                                  packing_as_srdf(one_link(link))}) {
    EXPECT_NE(text.find('"' + shown + '"'), std::string::npos);
    EXPECT_EQ(text.find('\xFF'), std::string::npos);
  }
}

TEST(PackingExport, PointsCarryColourAndRadius) {
  const std::string bytes = view::spheres_as(view::SphereFormat::points, kSpheres);
  const std::size_t body = bytes.find("end_header\n") + 11;
  constexpr std::size_t kStride = 19;  // x, y, z, red, green, blue, radius
  ASSERT_EQ(bytes.size(), body + kStride * kSpheres.size());
  for (std::size_t k = 0; k < kSpheres.size(); ++k) {
    Vec3f center;
    float radius = 0;
    std::memcpy(&center, bytes.data() + body + kStride * k, sizeof center);
    std::memcpy(&radius, bytes.data() + body + kStride * k + 15, sizeof radius);
    EXPECT_EQ(center, narrow(kSpheres[k].center));
    EXPECT_EQ(radius, static_cast<float>(kSpheres[k].radius));
  }
  const auto lightness = [&](std::size_t k) {
    int sum = 0;
    for (std::size_t i = 12; i < 15; ++i)
      sum += static_cast<unsigned char>(bytes[body + kStride * k + i]);
    return sum;
  };
  EXPECT_GT(lightness(0), 2 * lightness(1));  // the colour-blind see the larger one lighter
}

TEST(PackingExport, PlyIsAMeshOfOneClosedBallPerSphere) {
  const std::string bytes = view::spheres_as(view::SphereFormat::ply, kSpheres);
  const CheckedSolid balls =
      make_solid(parse_mesh(std::as_bytes(std::span(bytes.data(), bytes.size())), "balls.ply"));
  EXPECT_EQ(balls.facts.shells, 2U);
  EXPECT_EQ(balls.facts.triangles, 160U);
  EXPECT_TRUE(balls.notes.empty());
  EXPECT_NEAR(balls.facts.high.z, 30 + 1.0 / 300, 1e-5);
  for (std::size_t k = 0; k < balls.solid.vertices.size(); ++k) {
    const Sphere& s = kSpheres[k / 42];
    EXPECT_NEAR(norm(balls.solid.vertices[k] - s.center), s.radius, 1e-5);
  }
}

}  // namespace
}  // namespace vpm
