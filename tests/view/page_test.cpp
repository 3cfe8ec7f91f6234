#include "libvpm/view/page.h"

#include <gtest/gtest.h>

#include "libvpm/core/error.h"
#include "libvpm/synthetic/render.h"
#include "libvpm/synthetic/scenes.h"
#include "libvpm/synthetic/shapes.h"
#include "tests/refusal.h"

namespace vpm::view {
namespace {

class PageTest : public testing::Test {
 protected:
  void SetUp() override {
    if (kPageHead.empty()) GTEST_SKIP() << "this build has no drawing library";
  }
};

// Returns what is between the page's own text, which is the same for all pages.
std::string data_of(const Page& page) {
  const std::string html = page.html();
  return html.substr(kPageHead.size(), html.size() - kPageHead.size() - kPageTail.size());
}

TEST(Page, SaysWhereThereIsNoDrawingLibrary) {
  if (!kPageHead.empty()) GTEST_SKIP() << "this build has it";
  EXPECT_EQ(test::kind_of_fault(check_available), ErrorKind::unavailable);
}

TEST_F(PageTest, NamesAreDataAndNeverMarkup) {
  const std::string name = "</script><script>alert(1)</script><!--\xFF";
  Page page("vpm-query", name);
  page.add_fact(name, name);
  page.add_note(name);
  page.add_body(name, {}, 1, std::vector<Pose>(1));
  const std::string data = data_of(page);
  EXPECT_EQ(data.find('<'), std::string::npos);
  const Json document = Json::parse(data);
  EXPECT_EQ(document["title"], "</script><script>alert(1)</script><!--\xEF\xBF\xBD");
  EXPECT_EQ(document["notes"][0], document["title"]);
}

TEST_F(PageTest, LoadsNothingAndEvaluatesNothing) {
  EXPECT_NE(kPageHead.find("default-src 'none'"), std::string_view::npos);
  EXPECT_EQ(kPageHead.find("unsafe-eval"), std::string_view::npos);
  EXPECT_NE(kPageTail.find("The MIT License"), std::string_view::npos);
}

TEST_F(PageTest, AnEmptyPageIsAPage) {
  const Json document = Json::parse(data_of(Page("vpm-query", "nothing")));
  EXPECT_TRUE(document["layers"].empty());
  EXPECT_GT(document["radius"], 0);
}

// The size that a page of the main job may have: a 640 x 480 frame, 1000 spheres, 200 poses.
TEST_F(PageTest, AFrameAThousandSpheresAndTwoHundredPosesAreBelowFiveMegabytes) {
  const synthetic::Scene scene = synthetic::make_scene("inverted-ball");
  const DepthImage depth = synthetic::render(*scene.surface, scene.camera);
  ASSERT_EQ(depth.depth.size(), 640U * 480);
  constexpr std::size_t kSteps = 200;
  const std::vector<Sphere> spheres(1000, Sphere{{0.1, 0.2, 0.3}, 0.01});
  std::vector<std::uint8_t> bits;
  for (std::size_t k = 0; k < kSteps; ++k)
    append_bits(std::vector<std::uint8_t>(spheres.size(), 1), bits);
  Page page("vpm-query", "tool in scene");
  const std::size_t body = page.add_body("tool", {}, 0.1, std::vector<Pose>(kSteps));
  page.add_spheres({.name = "spheres", .spheres = spheres, .body = body, .states = bits});
  const Solid solid = synthetic::make_icosphere(0.1, 6);  // 81920 triangles, simplified
  page.add_mesh({.name = "mesh", .color = "#808080", .solid = &solid, .body = body});
  for (int column = 0; column < 7; ++column)
    page.add_column({"number", "m3", 3, std::vector<float>(3 * kSteps), body});
  const ImageView image{&depth, scene.camera};
  page.add_image("surface", {&image, 1}, {});
  EXPECT_LT(page.html().size(), 5'000'000U);
}

TEST_F(PageTest, RemovedPixelsAreToldFromThoseNotMeasured) {
  const DepthImage depth{3, 2, {1, 0, -0.0F, -0.0F, 2, 0}};
  const ImageView image{&depth, {{1, 1, 1, 1}, 3, 2, {}}};
  Page page("vpm-query", "removed");
  page.add_image("surface", {&image, 1}, {});
  EXPECT_EQ(Json::parse(data_of(page))["layers"][0]["images"][0]["removed"]["data"],
            "AgAAAAMAAAA=");  // 2 and 3
}

TEST_F(PageTest, ImagesOfAMillionPixelsAreThinned) {
  DepthImage depth{1250, 800, std::vector<float>(1'000'000, 1.5F)};
  const ImageView image{&depth, {{1000, 1000, 625, 400}, 1250, 800, {}}};
  Page page("vpm-query", "large");
  page.add_image("surface", {&image, 1}, {});
  const Json document = Json::parse(data_of(page));
  const Json& shown = document["layers"][0]["images"][0];
  EXPECT_EQ(shown["step"], 2);
  EXPECT_EQ(shown["width"], 625);
  EXPECT_EQ(shown["intrinsics"], Json({500, 500, 312.5, 200}));
  EXPECT_EQ(document["facts"][0][1], "one pixel in 2 each way");
}

TEST_F(PageTest, StraysDoNotStretchTheDepths) {
  DepthImage depth{100, 100, std::vector<float>(10'000, 1.0F)};
  depth.depth[7] = 1e30F;
  depth.depth[8] = 0;
  const ImageView image{&depth, {{100, 100, 50, 50}, 100, 100, {}}};
  Page page("vpm-query", "stray");
  page.add_image("surface", {&image, 1}, {});
  const Json document = Json::parse(data_of(page));
  EXPECT_LT(document["layers"][0]["images"][0]["high"], 10);
  EXPECT_LT(document["radius"], 10);
}

TEST_F(PageTest, FarScenesAreShownAboutTheirOrigin) {
  const Vec3 origin{4e6, 5e6, 100};
  Page page("vpm-query", "far");
  page.set_origin(origin);
  page.add_body("tool", {}, 0.1, std::vector<Pose>{{{}, origin + Vec3{0, 0, 1}}});
  const Json document = Json::parse(data_of(page));
  EXPECT_NEAR(document["center"][0].get<double>(), 0, 1e-8);
  EXPECT_NEAR(document["center"][2].get<double>(), 1, 1e-8);
}

}  // namespace
}  // namespace vpm::view
