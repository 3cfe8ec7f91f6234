#include <cmath>
#include <cstdio>
#include <limits>

#include "libvpm/cloud/scattered_points.h"
#include "libvpm/graph/build_tool_model.h"
#include "libvpm/synthetic/render.h"
#include "libvpm/synthetic/shapes.h"
#include "tools/bench/extremes.h"
#include "tools/bench/penetration_case.h"

namespace vpm::bench {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr double kTight = 1e-6;    // for answers that are exact up to rounding
constexpr double kSampled = 5e-3;  // for answers limited by the cell samples of few spheres

const ToolModel& cube_of_64() {
  static const ToolModel tool = build_tool_model(lattice_packing(4), {});
  return tool;
}
const ToolModel& cube_of_1() {
  static const ToolModel tool = build_tool_model(lattice_packing(1), {});
  return tool;
}

// Returns the fraction of the unit ball's volume, in the cube of edge 2, that lies below height z.
double ball_part(double z) {
  const double height = 1 + z;
  return kPi * height * height * (3 - height) / 3 / 8;
}

// Returns `side`^2 points on the plane at this height, over the tool.
Cloud floor_of(int side, double height) {
  std::vector<Vec3f> positions;
  for (int i = 0; i < side * side; ++i) {
    const auto along = [&](int k) { return 3.0 * (k + 0.5) / side - 1.5; };
    positions.push_back(narrow({along(i % side), along(i / side), height}));
  }
  const std::size_t count = positions.size();
  return plane_points(std::move(positions), std::vector<Vec3f>(count, Vec3f{0, 0, 1}));
}

// Returns `side`^2 points within half a unit of the axis, at half the sphere's lower radius.
Cloud points_in_one_sphere(int side) {
  Cloud cloud = floor_of(side, -0.5);
  for (Vec3f& p : cloud.positions) p = {p.x / 3, p.y / 3, p.z};
  return cloud;
}

Cloud repeated(std::size_t count, Vec3f at, Vec3f normal) {
  return plane_points(std::vector<Vec3f>(count, at), std::vector<Vec3f>(count, normal));
}

void add_points(std::vector<ExtremeCase>& cases, const Device& device, bool quick) {
  const auto add = [&](const std::string& name, const std::function<Deviation()>& run,
                       bool refused = false) {
    cases.push_back({"points", name, refused, run});
  };
  const Vec3f up{0, 0, 1};
  const auto refined = [device](const ToolModel& tool, const Cloud& cloud, double truth,
                                double bound) {
    return Deviation{ask(device, tool, cloud, Measure::refined), truth, bound};
  };
  const auto paper = [device](const ToolModel& tool, const Cloud& cloud, double truth) {
    return Deviation{ask(device, tool, cloud, Measure::paper), truth, kTight};
  };
  add("none", [=] { return refined(cube_of_64(), {}, 0, 0); });
  add("none, paper", [=] { return paper(cube_of_64(), {}, 0); });
  add("one", [=] { return refined(cube_of_64(), repeated(1, {}, up), 0.5, kSampled); });
  add("two", [=] {
    return refined(cube_of_64(), plane_points({{0, 0, 0}, {0.3f, 0, 0}}, {up, up}), 0.5, kSampled);
  });
  add("a thousand at one place",
      [=] { return refined(cube_of_64(), repeated(1000, {}, up), 0.5, kSampled); });
  add("a million on a plane",
      [=] { return refined(cube_of_64(), floor_of(1000, 0.3), 0.65, kSampled); });
  const int side = quick ? 500 : 3163;
  add(quick ? "250 000 in one sphere" : "ten million in one sphere",
      [=] { return paper(cube_of_1(), points_in_one_sphere(side), ball_part(-0.5)); });
  if (!quick) {
    add("ten million in one sphere, refined",
        [=] { return refined(cube_of_1(), points_in_one_sphere(side), 0.25, 0.02); });
  }
  add(
      "more than 2^24", [=] { return paper(cube_of_1(), floor_of(4097, 0), 0); }, true);
  add("on a sphere's surface", [=] { return paper(cube_of_1(), repeated(1, {0, 0, -1}, up), 0); });
  add("on a sphere's centre",
      [=] { return paper(cube_of_1(), repeated(1, {}, up), ball_part(0)); });
  add("on a sphere's centre, refined",
      [=] { return refined(cube_of_1(), repeated(1, {}, up), 0.5, kSampled); });
  add("planes tangent to spheres", [=] { return paper(cube_of_64(), floor_of(50, -1), 0); });
  add("planes tangent to spheres and to a face, refined",
      [=] { return refined(cube_of_64(), floor_of(50, -1), 0, 2e-2); });
  add(
      "too far apart to count in float32 from one origin",
      [=] {
        return Deviation{double(cloud_of_scattered_points({{}, {1e300, 0, 0}},
                                                          {{0, 0, 1}, {0, 0, 1}}, {}, "points")
                                    .size()),
                         0, 0};
      },
      true);
}

void add_normals(std::vector<ExtremeCase>& cases, const Device& device) {
  const auto add = [&](const std::string& name, Vec3f normal, bool refused) {
    cases.push_back({"normals", name, refused, [=] {
                       return Deviation{
                           ask(device, cube_of_1(), repeated(3, {}, normal), Measure::refined), 0.5,
                           kSampled};
                     }});
  };
  add("zero", {0, 0, 0}, true);
  add("not normalised", {0, 0, 2}, true);
  add("shortest float", {0, 0, 1e-45f}, true);
  add("not a number", {0, kNan, 1}, true);
  add("unit within float32", {0.36f, 0.48f, 0.8f}, false);
  for (const Measure measure : {Measure::refined, Measure::paper}) {
    cases.push_back(
        {"normals",
         std::string("opposite at one place") + (measure == Measure::paper ? ", paper" : ""), false,
         [=] {
           const Cloud cloud = plane_points({{}, {}}, {{0, 0, 1}, {0, 0, -1}});
           const double truth = measure == Measure::paper ? ball_part(0) : 0.5;
           return Deviation{ask(device, cube_of_1(), cloud, measure), truth, kSampled};
         }});
  }
  cases.push_back({"normals", "zero and not a number among scattered points: left out", false, [] {
                     const Cloud cloud = cloud_of_scattered_points(
                         {{}, {0.1, 0, 0}, {0, 0.1, 0}, {5, 5, 5}, {6, 6, 6}},
                         {{0, 0, 3}, {0, 0, 1e-9}, {0, 0, 1}, {}, {0, 0, double(kNan)}}, {},
                         "points");
                     return Deviation{double(cloud.size()), 3, 0};
                   }});
}

// Queries a cube of 0.2 depths, half of it behind a wall at that depth, in an image of 160 x 120
// pixels.
Deviation half_behind(const Device& device, const DepthImage& image, const Camera& camera,
                      const Pose& pose, double edge, double truth) {
  Packing packing = lattice_packing(4);
  for (Sphere& s : packing.spheres) s = {0.5 * edge * s.center, 0.5 * edge * s.radius};
  for (Vec3& v : packing.solid.vertices) v = 0.5 * edge * v;
  const ToolModel tool = build_tool_model(packing, {});
  return {ask(device, tool, make_cloud(image, camera, {}), Measure::refined, pose), truth,
          kSampled};
}

DepthImage flat(const Camera& camera, float depth) {
  return {camera.width, camera.height,
          std::vector<float>(std::size_t{camera.width} * camera.height, depth)};
}

void add_images(std::vector<ExtremeCase>& cases, const Device& device) {
  const Camera camera = small_camera();
  const auto add = [&](const std::string& name, const std::function<Deviation()>& run) {
    cases.push_back({"images", name, false, run});
  };
  for (const float depth : {1e-6f, 65.0f, 1e-20f, 1e20f}) {
    char name[40];
    std::snprintf(name, sizeof name, "depth %g m", double{depth});
    add(name, [=] {
      return half_behind(device, flat(camera, depth), camera, {{}, {0, 0, double{depth}}},
                         0.2 * depth, 0.5);
    });
  }
  add("nothing measured", [=] {
    return half_behind(device, flat(camera, 0), camera, {{}, {0, 0, 1}}, 0.2, 0);
  });
  add("depths that have no inverse", [=] {
    return half_behind(device, flat(camera, 1e-40f), camera, {{}, {0, 0, 1}}, 0.2, 0);
  });
  add("one valid pixel", [=] {
    DepthImage image = flat(camera, 0);
    image.depth[image.index(80, 60)] = 1;
    Deviation d = half_behind(device, image, camera, {{}, {0, 0, 1}}, 0.2, 0);
    // The far face is known along one ray only, half of which is behind. `side` is the pixel's
    // width there in edges of the cube.
    const double side = 1.1 / 131.25 / 0.2;
    d.bound = 4 * side * side;
    return d;
  });
  add("the tool in the image's corner", [=] {
    const double edge = 0.04;  // 5 pixels: the border cuts every window
    return half_behind(device, flat(camera, 1), camera, {{}, {-0.57, -0.42, 1}}, edge, 0.5);
  });
  add("origin at 10^7 m", [=] {
    const Vec3 far{1e7, -1e7, 1e7};
    Camera moved = camera;
    moved.to_world.translation = far;
    const Deviation here =
        half_behind(device, flat(camera, 1), camera, {{}, {0, 0, 1.03}}, 0.2, 0.5);
    const Deviation there =
        half_behind(device, flat(moved, 1), moved, {{}, far + Vec3{0, 0, 1.03}}, 0.2, 0);
    return Deviation{there.value, here.value, kTight};
  });
}

}  // namespace

Packing lattice_packing(int n) {
  Packing packing;
  packing.solid = synthetic::make_cube(2);
  const double radius = 1.0 / n;
  for (int i = 0; i < n * n * n; ++i) {
    const int row = i / n % n, layer = i / (n * n);
    const Vec3 cell{double(i % n), double(row), double(layer)};
    packing.spheres.push_back({2 * radius * (cell + Vec3{0.5, 0.5, 0.5}) - Vec3{1, 1, 1}, radius});
  }
  return packing;
}

std::vector<ExtremeCase> extreme_clouds(const Device& device, bool quick) {
  std::vector<ExtremeCase> cases;
  add_points(cases, device, quick);
  add_normals(cases, device);
  add_images(cases, device);
  return cases;
}

}  // namespace vpm::bench
