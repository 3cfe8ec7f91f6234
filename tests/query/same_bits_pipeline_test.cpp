// Scales a scene by a power of two from the mesh to the wrench: packing, graph, normals and query
// give the same digits, and only exponents change.

#include <gtest/gtest.h>

#include <cmath>

#include "libvpm/cloud/normals.h"
#include "libvpm/core/parallel.h"
#include "libvpm/graph/build_tool_model.h"
#include "libvpm/packing/packer.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/synthetic/render.h"
#include "libvpm/synthetic/shapes.h"
#include "tests/query/expect_equal.h"

namespace vpm {
namespace {

Rotation turned() {
  return rotation_from_quaternion({0.18, -0.37, 0.29, std::sqrt(1 - 0.2534)});
}

ToolModel make_tool(double scale) {
  Packing packing;
  packing.solid = synthetic::make_octahedron(0.2);
  for (Vec3& v : packing.solid.vertices) v = scale * (turned() * v);
  PackOptions options;
  options.spheres = 80;
  packing.spheres = pack(packing.solid, options).spheres;
  return build_tool_model(packing, {});
}

// Scales depths by a power of two, which changes the exponents of float32 only.
DepthImage scaled(DepthImage image, double scale) {
  for (float& depth : image.depth) depth *= static_cast<float>(scale);
  return image;
}

class Pipeline {
 public:
  Pipeline()
      : camera_(synthetic::default_camera()),
        image_(synthetic::render(*synthetic::make_inverted_ball({0, 0, 0.7}, 0.3), camera_)) {}

  // Returns results of both measures, with both estimators of normals, with and without the camera.
  std::vector<Result> run(double scale) const {
    const ToolModel tool = make_tool(scale);
    std::vector<Result> results;
    for (const NormalMethod method : {NormalMethod::inverse_depth, NormalMethod::pca}) {
      NormalOptions normals;
      normals.method = method;
      const Cloud cloud = make_cloud(scaled(image_, scale), camera_, normals);
      query_all(tool, AnyBody(cloud), scale, results);
      query_all(tool, AnyBody(without_camera(cloud)), scale, results);
    }
    return results;
  }

 private:
  static void query_all(const ToolModel& tool, const AnyBody& cloud, double scale,
                        std::vector<Result>& results) {
    for (const Measure measure : {Measure::refined, Measure::paper}) {
      QueryOptions options;
      options.measure = measure;
      ToolQuery query(tool, options);
      for (int k = 0; k < 4; ++k)
        results.push_back(query.run(cloud, {turned(), scale * Vec3{0.01, -0.02, 0.9 + 0.04 * k}}));
    }
  }

  Camera camera_;
  DepthImage image_;
};

void expect_same(const std::vector<Result>& a, const std::vector<Result>& b, double scale) {
  ASSERT_EQ(a.size(), b.size());
  double moved = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    SCOPED_TRACE(k);
    testing::expect_equal(a[k], b[k], scale);
    moved += a[k].volume;
  }
  EXPECT_GT(moved, 0);
}

TEST(SameBitsOfThePipeline, ForPowersOfTwo) {
  const Pipeline pipeline;
  const std::vector<Result> plain = pipeline.run(1);
  for (const int exponent : {-40, -13, 40}) {
    const double scale = std::ldexp(1.0, exponent);
    expect_same(plain, pipeline.run(scale), scale);
  }
}

TEST(SameBitsOfThePipeline, ForAnyNumberOfThreads) {
  const Pipeline pipeline;
  const std::vector<Result> all = pipeline.run(1);
  for (const int threads : {1, 5}) {
    set_thread_count(threads);
    expect_same(all, pipeline.run(1), 1);
  }
  set_thread_count(0);
}

}  // namespace
}  // namespace vpm
