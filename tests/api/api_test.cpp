// The library as programs see it: these tests include nothing but <vpm/...>.

#include <gtest/gtest.h>
#include <unistd.h>
#include <vpm/depth_stream.h>
#include <vpm/error.h>
#include <vpm/import.h>
#include <vpm/level_query.h>
#include <vpm/query.h>
#include <vpm/setup_check.h>
#include <vpm/solid.h>
#include <vpm/version.h>
#include <vpm/virtual_coupling.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <thread>
#include <type_traits>

namespace {

constexpr std::uint32_t kSide = 60;  // pixels of the camera
constexpr double kWall = 1;          // depth of the wall that it sees, m
constexpr double kCube = 0.2;        // side of the tool, m
constexpr vpm::Camera kCamera{{60, 60, 29.5, 29.5}, kSide, kSide, {}};

std::vector<float> wall_image() {
  return std::vector<float>(std::size_t{kSide} * kSide, static_cast<float>(kWall));
}

vpm::Scene wall() {
  return vpm::Scene(vpm::PointCloud::from_depth(wall_image(), kCamera));
}

vpm::SolidMesh cube(bool is_open = false, double scale = 1) {
  std::vector<vpm::Vec3> corners;
  for (int k = 0; k < 8; ++k)
    corners.push_back(
        {kCube * ((k & 1) - 0.5), kCube * ((k >> 1 & 1) - 0.5), kCube * ((k >> 2 & 1) - 0.5)});
  std::vector<std::array<std::uint32_t, 3>> triangles = {
      {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  if (is_open) triangles.pop_back();
  return vpm::SolidMesh::from_triangles(corners, triangles, {.scale = scale});
}

const vpm::Tool& tool() {
  static const vpm::Tool made =
      vpm::build_tool(vpm::pack(cube(), {.spheres = 120}), {.levels = {40}, .calibrate = true});
  return made;
}

// The tool's centre so far behind the wall, m; turned so that no face is parallel to it.
vpm::Pose behind(double depth) {
  return {vpm::rotation_from_quaternion({0.1825742, 0.3651484, 0.5477226, 0.7302967}),
          {0, 0, kWall + depth}};
}

template <class Action>
std::optional<vpm::Error> error_of(const Action& action) {
  try {
    action();
  } catch (const vpm::Error& error) {
    return error;
  }
  return std::nullopt;
}

// What takes a millisecond or more is asked for by name: query.run(cloud, pose) does not compile.
static_assert(!std::is_convertible_v<vpm::PointCloud, vpm::Scene>);
static_assert(!std::is_convertible_v<vpm::PointCloud, vpm::Body>);
static_assert(!std::is_convertible_v<std::vector<vpm::Body>, vpm::Scene>);
static_assert(!std::is_convertible_v<vpm::Tool, vpm::Query>);
static_assert(std::is_constructible_v<vpm::Scene, vpm::PointCloud>);

TEST(PublicApi, TheVersionIsTheSameInHeaderLibraryAndProject) {
  EXPECT_STREQ(VPM_VERSION, VPM_PROJECT_VERSION);
  EXPECT_STREQ(vpm::version(), VPM_PROJECT_VERSION);
  EXPECT_EQ(std::to_string(VPM_VERSION_MAJOR) + "." + std::to_string(VPM_VERSION_MINOR) + "." +
                std::to_string(VPM_VERSION_PATCH),
            VPM_PROJECT_VERSION);
  constexpr int kMajor = VPM_VERSION_MAJOR, kMinor = VPM_VERSION_MINOR, kPatch = VPM_VERSION_PATCH;
  static_assert(VPM_VERSION_AT_LEAST(kMajor, kMinor, kPatch));
  static_assert(!VPM_VERSION_AT_LEAST(kMajor, kMinor, kPatch + 1));
  static_assert(!VPM_VERSION_AT_LEAST(kMajor, kMinor + 1, 0));
  static_assert(!VPM_VERSION_AT_LEAST(kMajor + 1, 0, 0));
}

TEST(PublicApi, MeshToAnswer) {
  EXPECT_NEAR(tool().volume(), kCube * kCube * kCube, 1e-15);
  vpm::Query query(tool());
  const vpm::Result half = query.run(wall(), behind(0));
  EXPECT_NEAR(half.volume_fraction, 0.5, 0.01);
  EXPECT_LT(half.wrench.force.z, 0);  // back to the camera
  EXPECT_EQ(query.run(wall(), behind(-0.2)).volume, 0);
  EXPECT_EQ(query.states().size(), query.level());
  EXPECT_EQ(query.level(), 120U);
}

TEST(PublicApi, AQueryOutlivesItsToolAndScenesTheirClouds) {
  vpm::Query kept(tool());
  std::optional<vpm::Tool> temporary =
      vpm::build_tool(vpm::pack(cube(), {.spheres = 120}), {.levels = {40}, .calibrate = true});
  vpm::Query query(*temporary);
  temporary.reset();
  std::optional<vpm::PointCloud> cloud = vpm::PointCloud::from_depth(wall_image(), kCamera);
  const vpm::Scene scene(*cloud);
  cloud.reset();
  EXPECT_EQ(query.run(scene, behind(0.03)), kept.run(wall(), behind(0.03)));
}

TEST(PublicApi, JobsHaveTheBitsOfSinglePoses) {
  const vpm::Tool large = vpm::build_tool(vpm::pack(cube(), {.spheres = 60}));
  const std::vector<vpm::Tool> tools{tool(), large};
  vpm::Query together(tools), first(tool()), second(large);
  std::vector<vpm::Job> jobs;
  for (int k = 0; k < 40; ++k) jobs.push_back({behind(0.01 * (k - 20)), k % 3 == 0 ? 1U : 0U});
  std::vector<vpm::Result> results(jobs.size());
  const vpm::Scene scene = wall();
  together.run(scene, jobs, results);
  for (std::size_t k = 0; k < jobs.size(); ++k)
    EXPECT_EQ(results[k], (jobs[k].tool == 0 ? first : second).run(scene, jobs[k].pose)) << k;
}

TEST(PublicApi, ThreadsShareToolAndScene) {
  const vpm::Scene scene = wall();
  constexpr int kPoses = 50;
  const auto answers = [&] {
    vpm::Query query(tool());
    std::vector<vpm::Result> results;
    for (int k = 0; k < kPoses; ++k) results.push_back(query.run(scene, behind(0.004 * (k - 25))));
    return results;
  };
  const std::vector<vpm::Result> expected = answers();
  std::vector<vpm::Result> of_thread[2];
  std::thread one([&] { of_thread[0] = answers(); }), other([&] { of_thread[1] = answers(); });
  one.join();
  other.join();
  EXPECT_EQ(of_thread[0], expected);
  EXPECT_EQ(of_thread[1], expected);
}

TEST(PublicApi, AnotherQueryAnswersForAnotherThread) {
  const vpm::Scene scene = wall();
  for (const vpm::Measure measure : {vpm::Measure::refined, vpm::Measure::paper}) {
    vpm::QueryOptions options;
    options.measure = measure;
    options.level = 40;
    options.stiffness = 300;
    vpm::Query first(tool(), options);
    vpm::LevelRequest request;
    options.level = 0;
    request.for_scene = true;
    vpm::LevelQuery levels(tool(), options, request, scene, behind(0));
    std::vector<vpm::Result> expected, at_level;
    for (int k = 0; k < 40; ++k) expected.push_back(first.run(scene, behind(0.01 * k - 0.2)));
    for (int k = 0; k < 40; ++k) at_level.push_back(levels.run(scene, behind(0.01 * k - 0.2)));
    std::vector<std::thread> threads;
    for (int t = 0; t < 3; ++t) {
      threads.emplace_back([&, query = first.another(), level = levels.another()]() mutable {
        EXPECT_EQ(query.level(), 40U);
        EXPECT_EQ(level.level(), levels.finest_level());
        for (std::size_t k = 0; k < expected.size(); ++k) {
          const vpm::Pose pose = behind(0.01 * static_cast<double>(k) - 0.2);
          EXPECT_EQ(query.run(scene, pose), expected[k]);
          EXPECT_EQ(level.run(scene, pose), at_level[k]);
          EXPECT_EQ(query.collides(scene, pose), vpm::collides(expected[k]));
          EXPECT_EQ(level.collides(scene, pose), vpm::collides(at_level[k]));
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
  }
}

TEST(PublicApi, AnotherQueryRemembersNoPose) {
  const vpm::Scene scene = wall();
  vpm::Query moving(tool(), {.coherent = true});
  double remembered = 0;
  for (int k = 0; k < 60; ++k) remembered = moving.run(scene, behind(0.01 * k)).volume;
  ASSERT_GT(remembered, 0);  // wholly behind the wall, since it came through it
  vpm::Query other = moving.another();
  EXPECT_EQ(other.run(scene, behind(0.59)).volume, 0);
  EXPECT_EQ(moving.run(scene, behind(0.59)).volume, remembered);
}

TEST(PublicApi, AStreamOfImagesHasTheBitsOfClouds) {
  vpm::DepthStream stream({kCamera.intrinsics, kSide, kSide, std::nullopt});
  vpm::Query query(tool());
  const std::vector<float> image = wall_image();
  std::copy(image.begin(), image.end(), stream.metres().begin());
  const vpm::Scene scene = stream.prepare({});
  EXPECT_EQ(scene.bodies().front().points(), image.size());
  EXPECT_EQ(query.run(scene, behind(0.02)), query.run(wall(), behind(0.02)));
  EXPECT_EQ(error_of([&] { stream.counts(); })->kind(), vpm::ErrorKind::invalid_argument);
}

TEST(PublicApi, FilesComeBackTheSame) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("vpm-api-" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  const std::string tool_file = folder / "tool.vpmg", cloud_file = folder / "wall.vpmc";
  tool().write(tool_file);
  const vpm::PointCloud cloud = vpm::PointCloud::from_depth(wall_image(), kCamera);
  cloud.write(cloud_file);
  vpm::Query query(vpm::Tool::read(tool_file)), original(tool());
  EXPECT_EQ(query.run(vpm::Scene(vpm::PointCloud::read(cloud_file)), behind(0.01)),
            original.run(vpm::Scene(cloud), behind(0.01)));
  std::filesystem::remove_all(folder);
}

// Returns what a check says of this tool before the wall; "" for nothing.
std::string doubt_of(const vpm::Tool& asked, const std::vector<vpm::Pose>& poses) {
  const vpm::PointCloud cloud = vpm::PointCloud::from_depth(wall_image(), kCamera);
  const vpm::Scene scene(cloud);
  vpm::Query query(asked);
  vpm::SetupCheck check(asked, cloud);
  for (const vpm::Pose& pose : poses) check.see(pose, query.run(scene, pose));
  const vpm::Remarks remarks = check.remarks();
  EXPECT_LE(remarks.size(), 1U);
  return remarks.empty() ? "" : remarks.front().text;
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != text.npos;
}

TEST(PublicApi, ACheckSaysWhatIsDoubted) {
  EXPECT_EQ(doubt_of(tool(), {behind(0.02), behind(-0.2)}), "");
  EXPECT_EQ(doubt_of(tool(), {}), "");
  const vpm::Tool millimetres = vpm::build_tool(vpm::pack(cube(false, 1000), {.spheres = 20}));
  EXPECT_TRUE(has(doubt_of(millimetres, {}), "give `scale` 0.001"));
  vpm::Pose far = behind(0);
  far.translation = {1000 * far.translation.x, 1000 * far.translation.y, 1000 * far.translation.z};
  EXPECT_TRUE(has(doubt_of(tool(), {far}), "x, y, z of the poses divided by 1000"));
  vpm::SetupCheck check(tool(), vpm::PointCloud::from_depth(wall_image(), kCamera));
  EXPECT_EQ(error_of([&] { check.see({}, {}, 1); })->kind(), vpm::ErrorKind::invalid_argument);
  EXPECT_EQ(error_of([] {
              vpm::SetupCheck(std::span<const vpm::Tool>(),
                              vpm::PointCloud::from_depth(wall_image(), kCamera));
            })->kind(),
            vpm::ErrorKind::invalid_argument);
}

// File of the wall, whose values are `unit` metres each.
class WallFile {
 public:
  explicit WallFile(float unit)
      : path_(std::filesystem::temp_directory_path() /
              ("vpm-api-wall-" + std::to_string(::getpid()) + ".pfm")) {
    std::ofstream file(path_, std::ios::binary);
    file << "Pf\n" << kSide << ' ' << kSide << "\n-1.0\n";
    for (const float depth : wall_image()) {
      const float value = depth / unit;
      file.write(reinterpret_cast<const char*>(&value), sizeof value);
    }
  }
  ~WallFile() { std::filesystem::remove(path_); }
  WallFile(const WallFile&) = delete;
  WallFile& operator=(const WallFile&) = delete;

  std::string path() const { return path_; }

 private:
  std::filesystem::path path_;
};

TEST(PublicApi, AnImportSaysWhatIsDoubtedAndTakesTheCure) {
  const WallFile file(0.001F);
  vpm::ImportParameters parameters;
  parameters.intrinsics = kCamera.intrinsics;
  vpm::Remarks remarks;
  vpm::import_cloud(file.path(), parameters, &remarks);
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_TRUE(remarks.front().is_warning);
  EXPECT_TRUE(has(remarks.front().text, "`depth_scale`")) << remarks.front().text;
  parameters.depth_scale = 1000;
  remarks.clear();
  const vpm::Scene scene(vpm::import_cloud(file.path(), parameters, &remarks));
  EXPECT_TRUE(remarks.empty());
  vpm::Query query(tool());
  EXPECT_NEAR(query.run(scene, behind(0.02)).volume, query.run(wall(), behind(0.02)).volume, 1e-8);
}

TEST(PublicApi, AnImageInMemoryIsImportedAsAFileIs) {
  std::vector<std::uint16_t> counts(std::size_t{kSide} * kSide, 1000);
  std::vector<float> metres(counts.size(), 1);
  for (std::size_t k = 700; k < 760; ++k) counts[k] = 1250, metres[k] = 1.25F;
  const vpm::ImportParameters parameters{.intrinsics = kCamera.intrinsics};
  vpm::Remarks remarks;
  const auto volume_of = [](const vpm::PointCloud& cloud) {
    return vpm::Query(tool()).run(vpm::Scene(cloud), behind(0.02)).volume;
  };
  const double expected = volume_of(vpm::PointCloud::from_depth(metres, kCamera));
  EXPECT_EQ(volume_of(vpm::import_depth(counts, kSide, kSide, parameters, &remarks)), expected);
  EXPECT_EQ(volume_of(vpm::import_depth(metres, kSide, kSide, parameters, &remarks)), expected);
  EXPECT_TRUE(remarks.empty());
  // What a file's import says of counts and of floats, it says of these.
  const std::vector<float> millimetres(counts.begin(), counts.end());
  vpm::import_depth(millimetres, kSide, kSide, parameters, &remarks);
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_TRUE(has(remarks.front().text, "`depth_scale`")) << remarks.front().text;
  EXPECT_TRUE(error_of([&] { vpm::import_depth(counts, kSide, kSide + 1, parameters); }));
  EXPECT_TRUE(error_of([&] { vpm::import_depth(counts, 0, 0, parameters); }));
  EXPECT_TRUE(error_of([&] { vpm::import_depth(counts, kSide, kSide, {}); }));  // no intrinsics
  EXPECT_TRUE(error_of(
      [&] { vpm::import_depth(std::vector<float>(counts.size()), kSide, kSide, parameters); }));
}

TEST(PublicApi, AnImportRefusesParametersOutOfRange) {
  const WallFile file(1);
  const auto kind_of = [&](const auto& change) {
    vpm::ImportParameters parameters;
    parameters.intrinsics = kCamera.intrinsics;
    change(parameters);
    const auto error = error_of([&] { vpm::import_cloud(file.path(), parameters); });
    return error ? std::optional(error->kind()) : std::nullopt;
  };
  const auto refused = vpm::ErrorKind::refused, argument = vpm::ErrorKind::invalid_argument;
  EXPECT_EQ(kind_of([](auto&) {}), std::nullopt);
  EXPECT_EQ(kind_of([](auto& p) { p.depth_scale = 0; }), argument);
  EXPECT_EQ(kind_of([](auto& p) { p.depth_scale = -1000; }), argument);
  EXPECT_EQ(kind_of([](auto& p) { p.range = {2, 1}; }), argument);
  EXPECT_EQ(kind_of([](auto& p) { p.decode = "turned"; }), argument);
  EXPECT_EQ(kind_of([](auto& p) { p.decode = "rotated"; }), argument);  // it has no 16 bits
  EXPECT_EQ(kind_of([](auto& p) { p.range = {2, 3}; }), refused);       // nothing is left
  EXPECT_EQ(kind_of([](auto& p) { p.invalid = {1}; }), refused);
}

TEST(PublicApi, AnImportTakesOtherAxes) {
  const WallFile file(1);
  vpm::ImportParameters parameters;
  parameters.intrinsics = kCamera.intrinsics;
  parameters.axes = vpm::CameraAxes::opengl;
  parameters.camera_pose = vpm::Pose{};
  const vpm::PointCloud cloud = vpm::import_cloud(file.path(), parameters);
  vpm::Query query(tool());
  const vpm::Pose turned{{}, {0, 0, -kWall}};  // a camera of OpenGL looks along -z
  EXPECT_NEAR(query.run(vpm::Scene(cloud), turned).volume_fraction, 0.5, 0.01);
  // A check knows the axes that were told, and names others.
  vpm::SetupCheck check(tool(), cloud);
  check.see({{}, {0, 0, kWall}}, {});
  const vpm::Remarks remarks = check.remarks();
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_TRUE(has(remarks.front().text, "`import_cloud` `axes` opencv")) << remarks.front().text;
}

TEST(PublicApi, ALevelIsChosenByItsCalibration) {
  const std::vector<vpm::ToolLevel> levels = tool().levels();
  ASSERT_EQ(levels.size(), 2U);
  ASSERT_TRUE(levels[0].worst_error && levels[1].worst_error);
  ASSERT_GT(*levels[0].worst_error, *levels[1].worst_error);
  const auto level_for = [&](double max_error) {
    vpm::LevelRequest request;
    request.max_error = max_error;
    vpm::LevelQuery query(tool(), {}, request, wall(), behind(0));
    query.run(wall(), behind(0));
    EXPECT_EQ(query.reason(), vpm::LevelReason::max_error);
    return query.level();
  };
  EXPECT_EQ(level_for(*levels[0].worst_error), levels[0].spheres);
  EXPECT_EQ(level_for(*levels[1].worst_error), levels[1].spheres);
}

TEST(PublicApi, LevelsAreChosenForEachOfSeveralTools) {
  const vpm::Tool large = vpm::build_tool(vpm::pack(cube(false, 2), {.spheres = 80}),
                                          {.levels = {30}, .calibrate = true});
  const std::vector<vpm::Tool> tools{tool(), large};
  vpm::LevelRequest request;
  request.max_error = std::max(*tool().levels()[0].worst_error, *large.levels()[0].worst_error);
  const vpm::Scene scene = wall();
  vpm::LevelQuery query(tools, {}, request, scene, behind(0));
  const std::vector<vpm::Job> jobs{{behind(0), 1}, {behind(0.03), 0}, {behind(0.01), 1}};
  std::vector<vpm::Result> together(jobs.size());
  query.run(scene, jobs, together);
  EXPECT_GT(query.seconds(), 0);
  for (std::size_t k = 0; k < jobs.size(); ++k) {
    EXPECT_EQ(together[k], query.run(scene, jobs[k].pose, jobs[k].tool)) << k;
    EXPECT_EQ(query.states(jobs[k].tool).size(), query.level(jobs[k].tool));
    vpm::LevelQuery alone(tools[jobs[k].tool], {}, request, scene, behind(0));
    EXPECT_EQ(together[k], alone.run(scene, jobs[k].pose)) << k;
  }
  EXPECT_EQ(query.level(0), tool().levels()[0].spheres);
  EXPECT_EQ(query.finest_level(1), large.levels()[0].spheres);
  const auto missing = error_of([&] { query.run(scene, behind(0), 2); });
  ASSERT_TRUE(missing);
  EXPECT_EQ(missing->kind(), vpm::ErrorKind::invalid_argument);
}

// A floor of points 1 cm apart resolves no spheres much smaller than that, and is flat.
TEST(PublicApi, AScenesScaleIsThatOfItsPoints) {
  const auto floor = [](double spacing) {
    std::vector<vpm::Vec3> points, normals;
    for (int x = 0; x < 40; ++x)
      for (int y = 0; y < 40; ++y) points.push_back({spacing * x, spacing * y, 0});
    normals.assign(points.size(), {0, 0, 1});
    return vpm::Scene(vpm::PointCloud::from_points(points, normals));
  };
  const vpm::SceneScale coarse = vpm::scene_scale(floor(0.01), 0.1);
  EXPECT_NEAR(coarse.spacing, 0.01, 0.002);
  EXPECT_LT(coarse.noise, 1e-6);
  const vpm::SceneScale fine = vpm::scene_scale(floor(0.005), 0.1, vpm::Vec3{0.1, 0.1, 0});
  EXPECT_NEAR(fine.spacing, 0.005, 0.001);
  EXPECT_LT(fine.smallest_radius(), coarse.smallest_radius());

  const auto kind_for = [](const vpm::Scene& scene, double radius) {
    const auto error = error_of([&] { vpm::scene_scale(scene, radius); });
    return error ? std::optional(error->kind()) : std::nullopt;
  };
  for (const double radius : {0.0, -1.0, double(NAN), double(INFINITY)})
    EXPECT_EQ(kind_for(floor(0.01), radius), vpm::ErrorKind::invalid_argument) << radius;
  const vpm::Scene solids({vpm::Body(vpm::SolidBody(tool()), {})});
  EXPECT_EQ(kind_for(solids, 0.1), vpm::ErrorKind::invalid_argument);
  const vpm::Scene few(vpm::PointCloud::from_points(std::vector<vpm::Vec3>{{0, 0, 0}, {.01, 0, 0}},
                                                    std::vector<vpm::Vec3>{{0, 0, 1}, {0, 0, 1}}));
  EXPECT_EQ(kind_for(few, 0.1), vpm::ErrorKind::refused);
}

TEST(PublicApi, JobsHaveNoDeadline) {
  vpm::LevelRequest request;
  request.deadline_seconds = 1;
  const vpm::Scene scene = wall();
  vpm::LevelQuery query(tool(), {}, request, scene, behind(0));
  const std::vector<vpm::Job> jobs{{behind(0)}};
  std::vector<vpm::Result> results(1);
  const auto error = error_of([&] { query.run(scene, jobs, results); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->kind(), vpm::ErrorKind::invalid_argument);
  EXPECT_GT(query.run(scene, behind(0)).volume, 0);
}

TEST(PublicApi, ErrorsSayKindPlaceAndRemedy) {
  const auto missing = error_of([] { vpm::Tool::read("not-there.vpmg"); });
  ASSERT_TRUE(missing);
  EXPECT_EQ(missing->kind(), vpm::ErrorKind::refused);
  EXPECT_NE(std::string(missing->what()).find("not-there.vpmg"), std::string::npos);

  const auto open = error_of([] { cube(true); });
  ASSERT_TRUE(open);
  EXPECT_EQ(open->kind(), vpm::ErrorKind::refused);
  EXPECT_EQ(open->where(), "the triangles");
  EXPECT_NE(open->problem().find("the mesh is open"), std::string::npos);
  EXPECT_NE(open->hint().find("`repair`"), std::string::npos);

  const auto option = error_of([] { vpm::Query(tool(), {.stiffness = -1}); });
  ASSERT_TRUE(option);
  EXPECT_EQ(option->kind(), vpm::ErrorKind::invalid_argument);

  const auto unwritten = error_of([] { tool().write("no-such-folder/tool.vpmg"); });
  ASSERT_TRUE(unwritten);
  EXPECT_EQ(unwritten->kind(), vpm::ErrorKind::cannot_write);

  EXPECT_EQ(error_of([] { vpm::Scene(std::vector<vpm::Body>{}); })->kind(),
            vpm::ErrorKind::invalid_argument);
}

TEST(PublicApi, BodiesOfASceneAddUp) {
  const vpm::Scene one = wall();
  const vpm::Body body = one.bodies().front();
  const vpm::Scene two({body, body});
  EXPECT_EQ(two.bodies().size(), 2U);
  vpm::Query query(tool());
  const vpm::Result single = query.run(one, behind(0)), both = query.run(two, behind(0));
  EXPECT_GT(single.volume, 0);
  EXPECT_EQ(both.volume, 2 * single.volume);
  EXPECT_EQ(both.wrench.force.z, 2 * single.wrench.force.z);
}

TEST(PublicApi, AnErrorsTextIsPlaceProblemAndHint) {
  const vpm::Error error(vpm::ErrorKind::refused, "is broken", "file", "mend it");
  EXPECT_STREQ(error.what(), "file: is broken; mend it");
  EXPECT_STREQ(vpm::Error(vpm::ErrorKind::refused, "is broken").what(), "is broken");
}

TEST(PublicApi, ARunRefusesWhatItCannotAnswer) {
  vpm::Query query(tool());
  const vpm::Scene scene = wall();
  vpm::Result result;
  const auto kind_of = [&](const vpm::Job& job, std::span<vpm::Result> results) {
    const auto error = error_of([&] { query.run(scene, {&job, 1}, results); });
    return error ? std::optional(error->kind()) : std::nullopt;
  };
  EXPECT_EQ(kind_of({behind(0), 0}, {&result, 1}), std::nullopt);
  EXPECT_EQ(kind_of({behind(0), 1}, {&result, 1}), vpm::ErrorKind::invalid_argument);
  EXPECT_EQ(kind_of({behind(0), 0}, {}), vpm::ErrorKind::invalid_argument);
  EXPECT_EQ(kind_of({{{}, {std::nan(""), 0, 0}}, 0}, {&result, 1}), vpm::ErrorKind::refused);
}

TEST(PublicApi, ACoupledToolPushesBack) {
  vpm::CouplingParameters coupling{.stiffness = 500, .damping = 5, .gyration = tool().gyration()};
  coupling.mass = vpm::critical_mass(coupling.stiffness, coupling.damping);
  const vpm::Pose hand = behind(-0.05);
  vpm::VirtualCoupling held(coupling, tool().center_of_mass(), hand);
  vpm::Query query(tool(), {.stiffness = 1e4});
  vpm::Wrench felt;
  for (int k = 0; k < 200; ++k) felt = held.advance(hand, query.run(wall(), held.tool()).wrench);
  EXPECT_LT(felt.force.z, 0);
}

}  // namespace
