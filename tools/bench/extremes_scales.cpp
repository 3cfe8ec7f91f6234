#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <span>

#include "libvpm/cloud/scattered_points.h"
#include "libvpm/mesh/mesh_check.h"
#include "libvpm/mesh/mesh_reader.h"
#include "libvpm/synthetic/truth.h"
#include "tools/bench/extremes.h"
#include "tools/bench/penetration_case.h"

namespace vpm::bench {
namespace {

constexpr std::uint32_t kSpheres = 300;
// Bound of a model of 300 spheres. A wrong unit, threshold or rounding anywhere would show as all
// or nothing.
constexpr double kBound = 2e-3;

// Returns the first number of SplitMix64 with this seed, 0 to 1.
double uniform(std::uint64_t seed) {
  std::uint64_t z = seed + 0x9e3779b97f4a7c15ULL;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ z >> 27) * 0x94d049bb133111ebULL;
  return static_cast<double>((z ^ z >> 31) >> 11) * 0x1p-53;
}

std::string off_text(const Solid& solid, double scale) {
  std::string text = "OFF\n" + std::to_string(solid.vertices.size()) + " " +
                     std::to_string(solid.triangles.size()) + " 0\n";
  char line[96];
  for (const Vec3& v : solid.vertices) {
    std::snprintf(line, sizeof line, "%.17g %.17g %.17g\n", scale * v.x, scale * v.y, scale * v.z);
    text += line;
  }
  for (const Triangle& t : solid.triangles) {
    std::snprintf(line, sizeof line, "3 %u %u %u\n", t[0], t[1], t[2]);
    text += line;
  }
  return text;
}

Cloud scattered(const Cloud& cloud) {
  std::vector<Vec3> positions, normals;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    positions.push_back(cloud.origin + widen(cloud.positions[i]));
    normals.push_back(widen(cloud.normals[i]));
  }
  return cloud_of_scattered_points(positions, normals, {}, "the scene");
}

// Returns the largest error of the refined volume over three depths and both kinds of cloud, as a
// fraction of the tool's volume; NaN if the results of the printed measure are not sound.
Deviation whole_pipeline(const Device& device, const std::string& shape, double scale) {
  const std::string text = off_text(make_shape(shape), scale);
  const Solid solid = make_solid(parse_mesh(std::as_bytes(std::span(text)), "tool.off")).solid;
  const ToolModel tool = make_tool(solid, {kSpheres});
  validate(tool, "tool");

  const synthetic::SurfacePtr wall = synthetic::make_wall({0, 0, scale}, {0.36, 0.48, -0.8});
  const Cloud seen = see(*wall, small_camera());
  const synthetic::TrueSolid truth(solid);
  const Rotation turned = rotation_from_quaternion({0.18, -0.37, 0.29, std::sqrt(1 - 0.2534)});
  double worst = 0;
  for (const Cloud& cloud : {seen, scattered(seen)}) {
    for (const double z : {0.93, 0.98, 1.03}) {
      const Pose pose{turned, scale * Vec3{0.01, -0.02, z}};
      const double part = truth.penetration(pose, *wall).volume / tool.volume;
      const double error = std::abs(ask(device, tool, cloud, Measure::refined, pose) - part);
      if (!(error <= worst)) worst = error;
      if (std::isnan(ask(device, tool, cloud, Measure::paper, pose)))
        worst = std::numeric_limits<double>::quiet_NaN();
    }
  }
  return {worst, 0, kBound};
}

}  // namespace

std::vector<ExtremeCase> extreme_scales(const Device& device, bool quick) {
  constexpr double kDecades = 9;
  const std::vector<std::string> shapes{"cube", "tetrahedron", "octahedron", "torus"};
  std::vector<ExtremeCase> cases;
  const auto add = [&](const std::string& shape, double exponent) {
    char name[64];
    std::snprintf(name, sizeof name, "%s at 10^%.3f m", shape.c_str(), exponent);
    cases.push_back({"scale", name, false,
                     [=] { return whole_pipeline(device, shape, std::pow(10.0, exponent)); }});
  };
  add("cube", -kDecades);
  add("tetrahedron", kDecades);
  const std::size_t count = quick ? 2 : 40;
  for (std::size_t seed = 0; seed < count; ++seed)
    add(shapes[seed % shapes.size()], kDecades * (2 * uniform(seed) - 1));
  return cases;
}

}  // namespace vpm::bench
