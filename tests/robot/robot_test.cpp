#include <gtest/gtest.h>
#include <vpm/robot.h>

#include <cmath>
#include <fstream>

#include "libvpm/api/handle_access.h"
#include "libvpm/core/pose.h"
#include "libvpm/core/vec3.h"
#include "libvpm/mesh/mesh_check.h"
#include "libvpm/model/sphere.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace vpm {
namespace {

namespace fs = std::filesystem;

std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child, const std::string& more) {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/>" + more +
         "<limit lower=\"-1\" upper=\"2\" effort=\"1\" velocity=\"1\"/></joint>";
}

std::string link(const std::string& name, const std::string& geometry = "<box size=\"1 1 1\"/>",
                 const std::string& origin = "") {
  return "<link name=\"" + name + "\"><collision>" + origin + "<geometry>" + geometry +
         "</geometry></collision></link>";
}

class RobotTest : public test::InTemporaryFolder {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    const std::string full = path(name);
    fs::create_directories(fs::path(full).parent_path());
    std::ofstream(full) << text;
    return full;
  }
  Robot read(const std::string& inner, const RobotOptions& options = {}) const {
    return read_robot(write("robot.urdf", "<robot name=\"r\">" + inner + "</robot>"), options);
  }
  std::string refusal_of(const std::string& inner) const {
    return test::refusal([&] { read(inner); });
  }
  double volume(const Robot& robot, std::size_t k,
                RoundShape round = RoundShape::same_volume) const {
    return HandleAccess::held(link_solid(robot, k, round)).facts.volume;
  }

  static constexpr const char* kTetrahedron =
      "OFF\n4 4 0\n0 0 0\n3 0 0\n0 3 0\n0 0 3\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
};

void expect_near(Vec3 a, Vec3 b) {
  EXPECT_NEAR(a.x, b.x, 1e-12);
  EXPECT_NEAR(a.y, b.y, 1e-12);
  EXPECT_NEAR(a.z, b.z, 1e-12);
}

// The order of joints is that of the file, whatever their names are.
TEST_F(RobotTest, PosesAreThoseOfGeometry) {
  const Robot robot =
      read(link("hand") + link("arm") + link("base") +
           joint("z", "revolute", "base", "arm",
                 "<origin xyz=\"0 0 1\" rpy=\"0 0 1.5707963267948966\"/><axis xyz=\"0 2 0\"/>") +
           joint("a", "prismatic", "arm", "hand", "<origin xyz=\"1 0 0\"/><axis xyz=\"1 0 0\"/>"));
  ASSERT_EQ(robot.movable.size(), 2U);
  EXPECT_EQ(robot.joints[robot.movable[0]].name, "z");
  EXPECT_EQ(robot.links[0].name, "base");
  const std::size_t hand = *robot.link("hand");
  // A quarter about the arm's y turns its x downward, wherever its own frame was turned to.
  const std::vector<Pose> poses =
      link_poses(robot, std::vector<double>{M_PI / 2, 0.5}, {{}, {7, 0, 0}});
  expect_near(poses[hand].translation, {7, 0, 1 - 1.5});
  expect_near(poses[hand] * Vec3{0, 1, 0}, {6, 0, -0.5});
  expect_near(link_poses(robot, std::vector<double>{0, 0})[hand].translation, {0, 1, 1});
  EXPECT_TRUE(beyond_limits(robot, std::vector<double>{-1, 2}).empty());
  ASSERT_EQ(beyond_limits(robot, std::vector<double>{-1.01, 2}).size(), 1U);
  for (const std::vector<double>& wrong : {std::vector<double>{1}, {1, NAN}})
    EXPECT_EQ(test::kind_of_fault([&] { link_poses(robot, wrong); }), ErrorKind::invalid_argument);
}

TEST_F(RobotTest, JointsThatMimicFollowOverOthers) {
  const Robot robot =
      read(link("a") + link("b") + link("c") + link("d") + joint("x", "prismatic", "a", "b", "") +
           joint("y", "prismatic", "b", "c", "<mimic joint=\"x\" multiplier=\"2\" offset=\"1\"/>") +
           joint("w", "prismatic", "c", "d", "<mimic joint=\"y\" multiplier=\"-3\"/>"));
  ASSERT_EQ(robot.movable.size(), 1U);
  const double x = 0.25, y = 2 * x + 1, w = -3 * y;
  expect_near(link_poses(robot, std::vector{x})[*robot.link("d")].translation, {x + y + w, 0, 0});
}

TEST_F(RobotTest, SolidsHaveTheVolumesOfTheirShapes) {
  write("tetra.off", kTetrahedron);
  const Robot robot = read(
      "<link name=\"a\"><collision><geometry><box size=\"1 2 3\"/></geometry></collision>"
      "<collision><origin xyz=\"1 0 0\"/><geometry><box size=\"2 2 "
      "3\"/></geometry></collision></link>" +
      link("b", "<cylinder radius=\"0.5\" length=\"2\"/>") + link("c", "<sphere radius=\"0.5\"/>") +
      link("d", "<mesh filename=\"tetra.off\" scale=\"1 -1 0.5\"/>", "<origin xyz=\"5 0 0\"/>") +
      joint("1", "fixed", "a", "b", "") + joint("2", "fixed", "b", "c", "") +
      joint("3", "fixed", "c", "d", ""));
  EXPECT_NEAR(volume(robot, 0), 2.5 * 2 * 3, 1e-9);
  const double cylinder = M_PI * 0.25 * 2, ball = kPi / 6;
  for (const auto& [k, truth] : {std::pair{std::size_t{1}, cylinder}, {2, ball}}) {
    EXPECT_NEAR(volume(robot, k), truth, 1e-9 * truth);
    EXPECT_LT(volume(robot, k, RoundShape::inside), truth);
    EXPECT_GT(volume(robot, k, RoundShape::inside), 0.99 * truth);
    EXPECT_GT(volume(robot, k, RoundShape::outside), truth);
    EXPECT_LT(volume(robot, k, RoundShape::outside), 1.01 * truth);
  }
  EXPECT_NEAR(volume(robot, 3), 4.5 * 0.5, 1e-12);
  const SolidMesh mirrored = link_solid(robot, 3);
  const MeshFacts& facts = HandleAccess::held(mirrored).facts;
  EXPECT_NEAR(facts.low.y, -3, 1e-12);
  EXPECT_NEAR(facts.low.x, 5, 1e-12);
  EXPECT_EQ(robot.remarks.size(), 1U);  // of the mirrored mesh
}

// A polyhedron that is to be inside of a ball has no corner beyond it; one that is to be outside
// has no face that cuts it.
TEST_F(RobotTest, PolyhedraAreInsideOrOutside) {
  const Robot robot = read(link("a", "<sphere radius=\"2\"/>"));
  for (const RoundShape round : {RoundShape::inside, RoundShape::outside}) {
    const SolidMesh mesh = link_solid(robot, 0, round);
    const Solid& solid = HandleAccess::held(mesh).solid;
    for (const auto& [i, j, k] : solid.triangles) {
      const Vec3 a = solid.vertices[i],
                 normal = normalized_or_zero(cross(solid.vertices[j] - a, solid.vertices[k] - a));
      const bool holds = round == RoundShape::outside ? dot(normal, a) >= 2 * (1 - 1e-12)
                                                      : norm(a) <= 2 * (1 + 1e-12);
      ASSERT_TRUE(holds);
    }
  }
}

TEST_F(RobotTest, PackagesAreFoundWhereTheyAreGivenAndAbout) {
  write("here/pack/meshes/tetra.off", kTetrahedron);
  const std::string inner = link("a", "<mesh filename=\"package://pack/meshes/tetra.off\"/>");
  const std::string here = path("here");
  for (const std::string& given : {here, here + "/pack", here + "/pack/"})
    EXPECT_EQ(read(inner, {.package_path = {given}}).links[0].shapes.size(), 1U) << given;
  const std::string inside =
      write("here/pack/urdf/r.urdf", "<robot name=\"r\">" + inner + "</robot>");
  EXPECT_EQ(read_robot(inside).links.size(), 1U);
  EXPECT_NE(refusal_of(inner).find("`package_path`"), std::string::npos);
}

TEST_F(RobotTest, FaultsAreNamedWithTheirCure) {
  const std::string two = link("a") + link("b");
  const std::pair<std::string, const char*> faults[] = {
      {link("a", "<mesh filename=\"no.stl\"/>"), "there is no mesh"},
      {link("a", "<box size=\"1 -1 1\"/>"), "not positive"},
      {link("a", "<sphere radius=\"0\"/>"), "not positive"},
      {link("a", "<mesh filename=\"http://x/y.stl\"/>"), "not on this machine"},
      {"<link name=\"a\"/>", "no link has collision geometry"},
      {two + joint("j", "floating", "a", "b", ""), "planar or floating"},
      {two + joint("j", "revolute", "a", "b", "<axis xyz=\"0 0 0\"/>"), "axis"},
      {two + joint("j", "fixed", "a", "b", "") + joint("k", "fixed", "b", "a", ""), "circle"},
      {two + link("c") + joint("j", "fixed", "a", "c", "") + joint("k", "fixed", "b", "c", ""),
       "two joints"},
      {two + joint("j", "prismatic", "a", "b", "<mimic joint=\"q\"/>"), "no joint"},
      {two + joint("j", "prismatic", "a", "b", "<mimic joint=\"j\"/>"), "mimics itself"},
      {two, "Two root links"},
      {"<xacro:include filename=\"x\"/>", "xacro"},
  };
  for (const auto& [inner, words] : faults) {
    const std::string said = refusal_of(inner);
    EXPECT_NE(said.find(words), std::string::npos) << inner << "\n" << said;
    EXPECT_NE(said.find(';'), std::string::npos) << said;
  }
  EXPECT_NE(test::refusal([&] { read_robot(write("r.sdf", "<sdf/>")); }).find("not <robot>"),
            std::string::npos);
  EXPECT_NE(
      test::refusal([&] { read_robot(write("r.urdf", "<robot name='r'><link")); }).find("line "),
      std::string::npos);
}

// A collision that cannot be read is refused, also beside one that can, in place of a smaller link.
TEST_F(RobotTest, NoCollisionIsLost) {
  const std::string box = "<geometry><box size=\"1 1 1\"/></geometry>";
  const std::string unread[] = {
      "",
      "<geometry/>",
      "<geometry><capsule radius=\"1\" length=\"1\"/></geometry>",
      "<geometry><sphere radius=\"nan\"/></geometry>",
      "<geometry><sphere radius=\"0,5\"/></geometry>",
      "<geometry><cylinder length=\"1\"/></geometry>",
      "<geometry><box size=\"1 1\"/></geometry>",
      "<geometry><mesh/></geometry>",
      "<geometry><mesh filename=\"tetra.off\" scale=\"1,1,1\"/></geometry>",
      "<origin xyz=\"0 0 1e400\"/>" + box,
      "<origin xyz=\"0 0\"/>" + box,
      "<origin rpy=\"0 0 inf\"/>" + box,
  };
  write("tetra.off", kTetrahedron);
  for (const std::string& inner : unread)
    for (const std::string& beside : {std::string(), "<collision>" + box + "</collision>"}) {
      const std::string said =
          refusal_of("<link name=\"a\">" + beside + "<collision>" + inner + "</collision></link>" +
                     link("b") + joint("j", "fixed", "a", "b", ""));
      EXPECT_NE(said.find("line 1: a <collision> of link 'a' cannot be read; "), std::string::npos)
          << inner << "\n"
          << said;
    }
}

// Of several shapes in one collision urdfdom reads the first.
TEST_F(RobotTest, NoShapeOfACollisionIsLost) {
  const std::string box = "<box size=\"1 1 1\"/>", ball = "<sphere radius=\"1\"/>";
  for (const std::string& inner :
       {"<geometry>" + box + ball + "</geometry>",
        "<geometry>" + ball + "<!-- and -->" + box + "</geometry>",
        "<geometry>" + box + "</geometry><geometry>" + ball + "</geometry>"}) {
    const std::string said =
        refusal_of("<link name=\"a\"><collision>" + inner + "</collision></link>");
    EXPECT_NE(said.find("line 1: a <collision> of link 'a' has several shapes; give each a "
                        "<collision> of its own"),
              std::string::npos)
        << said;
  }
  EXPECT_EQ(refusal_of("<link name=\"a\"><collision><geometry><!-- a box -->" + box +
                       "</geometry></collision></link>"),
            "");
}

TEST_F(RobotTest, PairsAreIgnoredByJointsOrBySrdf) {
  using Pairs = std::vector<std::array<std::size_t, 2>>;
  const Robot robot =
      read(link("a") + "<link name=\"frame\"/>" + link("b") + link("c") +
           joint("1", "fixed", "a", "frame", "") + joint("2", "continuous", "frame", "b", "") +
           joint("3", "continuous", "b", "c", ""));
  const std::size_t a = *robot.link("a"), b = *robot.link("b"), c = *robot.link("c");
  const Pairs adjacent = ignored_pairs(robot);
  const auto has = [](const Pairs& pairs, std::size_t x, std::size_t y) {
    return std::ranges::count(pairs, std::array{std::min(x, y), std::max(x, y)}) == 1;
  };
  EXPECT_TRUE(has(adjacent, a, b));
  EXPECT_TRUE(has(adjacent, b, c));
  EXPECT_FALSE(has(adjacent, a, c));
  const auto srdf = [&](const std::string& inner) {
    return write("r.srdf", "<robot name=\"r\">" + inner + "</robot>");
  };
  EXPECT_EQ(
      ignored_pairs(robot, srdf("<disable_collisions link1=\"c\" link2=\"a\" reason=\"Never\"/>")),
      (Pairs{{a, c}}));
  const Pairs all = ignored_pairs(robot, srdf("<disable_default_collisions link=\"c\"/>"
                                              "<enable_collisions link1=\"a\" link2=\"c\"/>"));
  EXPECT_TRUE(has(all, b, c));
  EXPECT_FALSE(has(all, a, c));
  EXPECT_NE(test::refusal([&] {
              ignored_pairs(robot, srdf("<disable_collisions link1=\"a\" link2=\"q\"/>"));
            }).find("no link 'q'"),
            std::string::npos);
}

TEST_F(RobotTest, UrdfOfSpheresKeepsAllButCollisions) {
  const std::string path =
      write("in.urdf",
            "<robot name=\"r\"><!-- kept -->" + link("a") + link("b") +
                joint("j", "revolute", "a", "b", "<origin xyz=\"1 2 3\"/><axis xyz=\"0 0 1\"/>") +
                "<gazebo reference=\"a\"><k>1</k></gazebo></robot>");
  const Robot robot = read_robot(path);
  const std::vector<std::vector<Sphere>> spheres{{{{1, 2, 3}, 0.5}, {{4, 5, 6}, 0.25}},
                                                 {{{0, 0, 1}, 2}}};
  const std::string text = urdf_with_spheres(path, robot, spheres);
  EXPECT_NE(text.find("<!-- kept -->"), std::string::npos);
  EXPECT_NE(text.find("<gazebo"), std::string::npos);
  const Robot again = read_robot(write("out.urdf", text));
  for (std::size_t k = 0; k < 2; ++k) {
    ASSERT_EQ(again.links[k].shapes.size(), spheres[k].size());
    for (std::size_t i = 0; i < spheres[k].size(); ++i) {
      EXPECT_EQ(again.links[k].shapes[i].kind, CollisionShape::Kind::sphere);
      EXPECT_EQ(again.links[k].shapes[i].size.x, spheres[k][i].radius);
      EXPECT_EQ(again.links[k].shapes[i].to_link.translation, spheres[k][i].center);
    }
  }
  expect_near(link_poses(again, std::vector{0.3})[1] * Vec3{1, 0, 0},
              link_poses(robot, std::vector{0.3})[1] * Vec3{1, 0, 0});
}

}  // namespace
}  // namespace vpm
