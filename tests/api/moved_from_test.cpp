// Handles that were moved from: whatever is asked of one throws an error that names its type.

#include <gtest/gtest.h>
#include <vpm/depth_stream.h>
#include <vpm/level_query.h>
#include <vpm/query.h>
#include <vpm/setup_check.h>
#include <vpm/solid.h>
#include <vpm/view.h>
#include <vpm/virtual_coupling.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace {

constexpr std::uint32_t kSide = 20;  // pixels of the camera
constexpr vpm::Camera kCamera{{20, 20, 9.5, 9.5}, kSide, kSide, {}};
constexpr vpm::Pose kPose{{}, {0, 0, 1}};

vpm::PointCloud cloud() {
  return vpm::PointCloud::from_depth(std::vector<float>(std::size_t{kSide} * kSide, 1.0F), kCamera);
}

vpm::SolidMesh tetrahedron() {
  const std::vector<vpm::Vec3> corners{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}};
  const std::vector<std::array<std::uint32_t, 3>> triangles{
      {0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  return vpm::SolidMesh::from_triangles(corners, triangles);
}

vpm::VirtualCoupling coupling() {
  return vpm::VirtualCoupling({.stiffness = 500, .damping = 5, .mass = 0.0125, .gyration = 0.05},
                              {}, {});
}

// Moves the handle away and expects each use of it to throw. What it was moved to is still good,
// and so is the handle when it is assigned to again.
template <class Handle>
void expect_refused(Handle handle, const std::string& name,
                    const std::vector<std::function<void(Handle&)>>& uses) {
  Handle kept = std::move(handle);
  for (std::size_t k = 0; k < uses.size(); ++k) {
    try {
      uses[k](handle);  // NOLINT(bugprone-use-after-move)
      ADD_FAILURE() << name << ", use " << k << " throws nothing";
    } catch (const vpm::Error& error) {
      EXPECT_EQ(error.kind(), vpm::ErrorKind::invalid_argument) << name << ", use " << k;
      EXPECT_NE(error.problem().find("moved-from " + name), std::string::npos) << error.what();
    }
  }
  EXPECT_NO_THROW(uses.front()(kept)) << name;
  handle = std::move(kept);
  EXPECT_NO_THROW(uses.front()(handle)) << name;
}

const vpm::SpherePacking& packing() {
  static const vpm::SpherePacking made = vpm::pack(tetrahedron(), {.spheres = 4});
  return made;
}

const vpm::Tool& tool() {
  static const vpm::Tool made = vpm::build_tool(packing());
  return made;
}

const char* const kNowhere = "no-such-folder/file";

TEST(MovedFrom, PointCloud) {
  expect_refused<vpm::PointCloud>(
      cloud(), "PointCloud",
      {[](auto& c) { c.size(); }, [](auto& c) { c.camera(); }, [](auto& c) { c.write(kNowhere); },
       [](auto& c) { vpm::Body body(c); }, [](auto& c) { vpm::Scene scene(c); }});
}

TEST(MovedFrom, Body) {
  expect_refused<vpm::Body>(vpm::Body(cloud()), "Body",
                            {[](auto& b) { b.points(); }, [](auto& b) { vpm::Scene scene(b); },
                             [](auto& b) { vpm::Scene(std::vector<vpm::Body>{b}); }});
}

TEST(MovedFrom, SolidRemover) {
  static const std::vector<vpm::SolidBody> solids{vpm::SolidBody(tetrahedron(), false)};
  static const std::vector<vpm::SolidPlace> places{{kPose, 0.01}};
  static std::vector<float> depth(std::size_t{kSide} * kSide, 1.0F);
  expect_refused<vpm::SolidRemover>(
      vpm::SolidRemover(solids), "SolidRemover",
      {[](auto& r) { r.remove(places, kCamera, depth); },
       [](auto& r) { r.remove(places, cloud()); }, [](auto& r) { r.found(); }});
}

TEST(MovedFrom, Scene) {
  static std::vector<vpm::Result> results(1);
  static vpm::Query query(tool());
  expect_refused<vpm::Scene>(vpm::Scene(cloud()), "Scene",
                             {[](auto& s) { s.bodies(); }, [](auto& s) { query.run(s, kPose); },
                              [](auto& s) { query.run(s, std::vector<vpm::Job>(1), results); },
                              [](auto& s) { vpm::LevelQuery(tool(), {}, {}, s, kPose); },
                              [](auto& s) { vpm::scene_scale(s, 1); }});
}

TEST(MovedFrom, Tool) {
  static const vpm::Scene scene(cloud());
  expect_refused<vpm::Tool>(
      tool(), "Tool",
      {[](auto& t) { t.volume(); }, [](auto& t) { t.center_of_mass(); },
       [](auto& t) { t.radius(); }, [](auto& t) { t.gyration(); }, [](auto& t) { t.spheres(); },
       [](auto& t) { t.levels(); }, [](auto& t) { t.write(kNowhere); },
       [](auto& t) { vpm::Query query(t); },
       [](auto& t) {
         vpm::Query(std::vector<vpm::Tool>{tool(), t});
       },
       [](auto& t) { vpm::LevelQuery(t, {}, {}, scene, kPose); }});
}

TEST(MovedFrom, SolidBody) {
  expect_refused<vpm::SolidBody>(
      vpm::SolidBody(tetrahedron(), false), "SolidBody",
      {[](auto& b) { b.volume(); }, [](auto& b) { b.center_of_mass(); },
       [](auto& b) { b.radius(); }, [](auto& b) { b.triangles(); },
       [](auto& b) { vpm::overlap(b, {}, b, {}, {.with_force = false}); }});
}

TEST(MovedFrom, OverlapQuery) {
  const vpm::SolidBody body(tetrahedron(), false);
  expect_refused<vpm::OverlapQuery>(vpm::OverlapQuery(body, body, {.with_force = false}),
                                    "OverlapQuery", {[](auto& q) { q.run({}, {}); }});
}

TEST(MovedFrom, SolidMesh) {
  expect_refused<vpm::SolidMesh>(
      tetrahedron(), "SolidMesh",
      {[](auto& m) { m.volume(); }, [](auto& m) { m.vertices(); }, [](auto& m) { m.triangles(); },
       [](auto& m) { m.notes(); }, [](auto& m) { m.warnings(); },
       [](auto& m) { vpm::pack(m, {.spheres = 1}); }});
}

TEST(MovedFrom, SpherePacking) {
  expect_refused<vpm::SpherePacking>(
      packing(), "SpherePacking",
      {[](auto& p) { p.spheres(); }, [](auto& p) { p.write(kNowhere); },
       [](auto& p) { vpm::build_tool(p); }});
}

TEST(MovedFrom, Query) {
  static std::vector<vpm::Result> results(1);
  static const vpm::Scene scene(cloud());
  expect_refused<vpm::Query>(
      vpm::Query(tool()), "Query",
      {[](auto& q) { q.run(scene, kPose); },
       [](auto& q) { q.run(scene, std::vector<vpm::Job>(1), results); },
       [](auto& q) { q.forget(); }, [](auto& q) { q.states(); }, [](auto& q) { q.level(); }});
}

TEST(MovedFrom, SetupCheck) {
  expect_refused<vpm::SetupCheck>(
      vpm::SetupCheck(tool(), cloud()), "SetupCheck",
      {[](auto& c) { c.see(kPose, vpm::Result{}); }, [](auto& c) { c.remarks(); }});
}

TEST(MovedFrom, LevelQuery) {
  static const vpm::Scene scene(cloud());
  expect_refused<vpm::LevelQuery>(vpm::LevelQuery(tool(), {}, {}, scene, kPose), "LevelQuery",
                                  {[](auto& q) { q.run(scene, kPose); }, [](auto& q) { q.level(); },
                                   [](auto& q) { q.seconds(); }, [](auto& q) { q.reason(); },
                                   [](auto& q) { q.scale(); }, [](auto& q) { q.states(); }});
}

TEST(MovedFrom, View) {
  static const vpm::Scene scene(cloud());
  static vpm::Query query(tool());
  try {
    expect_refused<vpm::View>(
        vpm::View(std::vector<vpm::Tool>{tool()}, {"tool"}), "View",
        {[](auto& v) { v.add_scene(scene); }, [](auto& v) { v.add({kPose}, vpm::Result{}, query); },
         [](auto& v) { v.add_batch(query, scene, {}); }, [](auto& v) { v.html(); },
         [](auto& v) { v.write(kNowhere); }});
  } catch (const vpm::Error& error) {
    if (error.kind() != vpm::ErrorKind::unavailable) throw;
    GTEST_SKIP() << error.what();
  }
}

TEST(MovedFrom, DepthStream) {
  expect_refused<vpm::DepthStream>(
      vpm::DepthStream({kCamera.intrinsics, kSide, kSide, std::nullopt}), "DepthStream",
      {[](auto& s) { s.metres(); }, [](auto& s) { s.counts(); }, [](auto& s) { s.prepare({}); }});
}

TEST(MovedFrom, VirtualCoupling) {
  expect_refused<vpm::VirtualCoupling>(
      coupling(), "VirtualCoupling",
      {[](auto& c) { c.tool(); }, [](auto& c) { c.advance({}, {}); }, [](auto& c) { c.energy(); },
       [](auto& c) { vpm::VirtualCoupling copy(c); }});
}

// An error keeps its texts, also when it was moved.
TEST(MovedFrom, ErrorsStayWhole) {
  vpm::Error error(vpm::ErrorKind::refused, "is broken", "file", "mend it");
  const vpm::Error moved = std::move(error);
  EXPECT_EQ(error.problem(), "is broken");  // NOLINT(bugprone-use-after-move)
  EXPECT_EQ(moved.hint(), "mend it");
}

TEST(Copies, OfACouplingGoTheirOwnWay) {
  vpm::VirtualCoupling one = coupling(), other = one;
  const vpm::Pose device{{}, {0.01, 0, 0}};
  one.advance(device, {});
  EXPECT_EQ(other.tool().translation, (vpm::Vec3{}));
  other.advance(device, {});
  EXPECT_EQ(other.tool().translation, one.tool().translation);
}

}  // namespace
