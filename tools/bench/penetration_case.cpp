#include "tools/bench/penetration_case.h"

#include <algorithm>

#include "libvpm/core/error.h"
#include "libvpm/graph/build_tool_model.h"
#include "libvpm/packing/packer.h"
#include "libvpm/synthetic/shapes.h"
#include "tools/bench/sight.h"

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

// Returns the least z of the tool's origin at which more than `part` of the tool is inside, by
// bisection, since deeper poses penetrate more; `deep` if there is none.
double z_of_volume(const synthetic::TrueSolid& tool, const Pose& start,
                   const synthetic::Surface& surface, double part, double clear, double deep) {
  constexpr int kHalvings = 30;
  constexpr double kCoarse = 1e-4;  // tolerance, fraction of the range
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (clear + deep);
    const Pose pose{start.rotation, {start.translation.x, start.translation.y, middle}};
    (tool.penetration(pose, surface, kCoarse).volume > part * tool.mass().volume ? deep : clear) =
        middle;
  }
  return deep;
}

double contact_z(const synthetic::TrueSolid& tool, const Pose& start,
                 const synthetic::Surface& surface) {
  return z_of_volume(tool, start, surface, 1e-9, 1 - 3 * tool.radius(), 1 + tool.radius());
}

std::vector<Pose> between(const Pose& start, double first, double last, int poses) {
  std::vector<Pose> path;
  for (int k = 0; k < poses; ++k) {
    const double s = static_cast<double>(k) / (poses - 1);
    path.push_back(
        {start.rotation, {start.translation.x, start.translation.y, first + s * (last - first)}});
  }
  return path;
}

}  // namespace

Solid make_shape(const std::string& name) {
  constexpr double kSize = 0.2;  // metres
  if (name == "cube") return synthetic::make_cube(kSize);
  if (name == "tetrahedron") return synthetic::make_tetrahedron(kSize);
  if (name == "octahedron") return synthetic::make_octahedron(kSize);
  if (name == "torus") return synthetic::make_torus(0.35 * kSize, 0.15 * kSize, 64, 32);
  if (name == "twisted-torus")
    return synthetic::make_twisted_torus(0.35 * kSize, 0.2 * kSize, 3, 96);
  throw Error(ErrorKind::invalid_argument, "there is no shape '" + name + "'");
}

ToolModel make_tool(const Solid& solid, const std::vector<std::uint32_t>& levels) {
  PackOptions options;
  options.spheres = *std::max_element(levels.begin(), levels.end());
  Packing packing;
  packing.spheres = pack(solid, options).spheres;
  packing.solid = solid;
  GraphOptions graph_options;
  graph_options.levels = levels;
  return build_tool_model(packing, graph_options);
}

PackedSolid make_packed(const std::string& shape, const std::vector<std::uint32_t>& levels,
                        std::size_t places) {
  const Solid solid = make_shape(shape);
  return {synthetic::TrueSolid(solid), make_tool(solid, levels), places_in(solid, places)};
}

Rotation turned() {
  return rotation_from_quaternion({0.18, -0.37, 0.29, std::sqrt(1 - 0.2534)});
}

std::vector<Pose> make_path(const synthetic::TrueSolid& tool, const Rotation& rotation,
                            const synthetic::Surface& surface, int poses) {
  const Extent extent = extent_along_z(tool.solid(), rotation);
  const double height = extent.high - extent.low;
  const double contact = contact_z(tool, {rotation, {}}, surface);
  return between({rotation, {}}, contact - kClear * height, contact + kDeepest * height, poses);
}

std::vector<Pose> make_sweep(const synthetic::TrueSolid& tool, const Pose& start,
                             const synthetic::Surface& surface, int poses) {
  const Extent extent = extent_along_z(tool.solid(), start.rotation);
  const double contact = contact_z(tool, start, surface);
  const double deepest = contact + kDeepest * (extent.high - extent.low);
  return between(start, contact, z_of_volume(tool, start, surface, kFullest, contact, deepest),
                 poses);
}

std::vector<synthetic::Penetration> truth_along(const synthetic::TrueSolid& tool,
                                                const std::vector<Pose>& path,
                                                const synthetic::Surface& surface) {
  std::vector<synthetic::Penetration> truth;
  truth.reserve(path.size());
  for (const Pose& pose : path) truth.push_back(tool.penetration(pose, surface));
  return truth;
}

}  // namespace vpm::bench
