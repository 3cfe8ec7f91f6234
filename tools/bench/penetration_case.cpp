#include "tools/bench/penetration_case.h"

#include <algorithm>

#include "libvpm/core/error.h"
#include "libvpm/graph/build_tool_model.h"
#include "libvpm/packing/packer.h"
#include "libvpm/synthetic/shapes.h"

namespace vpm::bench {
namespace {

struct Extent {
  double low = HUGE_VAL, high = -HUGE_VAL;
};

Extent extent_along_z(const Solid& solid, const Rotation& rotation) {
  Extent extent;
  for (const Vec3& v : solid.vertices) {
    const double z = dot(rotation.row2, v);
    extent = {std::min(extent.low, z), std::max(extent.high, z)};
  }
  return extent;
}

// z of the tool's origin at the first contact, by bisection: deeper poses penetrate more.
double contact_z(const synthetic::TrueSolid& tool, const Rotation& rotation,
                 const synthetic::Surface& surface) {
  constexpr int kHalvings = 30;
  constexpr double kCoarse = 1e-4;  // tolerance: only whether there is contact matters here
  double clear = 1 - 3 * tool.reach(), deep = 1 + tool.reach();
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (clear + deep);
    const Pose pose{rotation, {0, 0, middle}};
    (tool.penetration(pose, surface, kCoarse).volume > 1e-9 * tool.mass().volume ? deep : clear) =
        middle;
  }
  return deep;
}

}  // namespace

Solid make_shape(const std::string& name) {
  constexpr double kSize = 0.2;  // metres
  if (name == "cube") return synthetic::make_cube(kSize);
  if (name == "tetrahedron") return synthetic::make_tetrahedron(kSize);
  if (name == "octahedron") return synthetic::make_octahedron(kSize);
  if (name == "torus") return synthetic::make_torus(0.35 * kSize, 0.15 * kSize, 64, 32);
  throw Error(ErrorKind::usage, "there is no shape '" + name + "'");
}

ToolModel make_tool(const Solid& solid, std::size_t spheres) {
  PackOptions options;
  options.spheres = spheres;
  Packing packing;
  packing.spheres = pack(solid, options).spheres;
  packing.solid = solid;
  return build_tool_model(packing, GraphOptions{});
}

std::vector<Pose> make_path(const synthetic::TrueSolid& tool, const Rotation& rotation,
                            const synthetic::Surface& surface, int poses) {
  const Extent extent = extent_along_z(tool.solid(), rotation);
  const double height = extent.high - extent.low, contact = contact_z(tool, rotation, surface);
  std::vector<Pose> path;
  for (int k = 0; k < poses; ++k) {
    const double s = static_cast<double>(k) / (poses - 1);
    path.push_back({rotation, {0, 0, contact + height * (s * (kDeepest + kClear) - kClear)}});
  }
  return path;
}

std::vector<synthetic::Penetration> truth_along(const synthetic::TrueSolid& tool,
                                                const std::vector<Pose>& path,
                                                const synthetic::Surface& surface) {
  std::vector<synthetic::Penetration> truth;
  for (const Pose& pose : path) truth.push_back(tool.penetration(pose, surface));
  return truth;
}

}  // namespace vpm::bench
