#include <vpm/robot.h>

#include <cmath>

#include "libvpm/api/handle_access.h"
#include "libvpm/core/error.h"
#include "libvpm/core/pose.h"
#include "libvpm/mesh/mesh_check.h"
#include "libvpm/model/sphere.h"
#include "libvpm/synthetic/shapes.h"

namespace vpm {
namespace {

constexpr int kSides = 96;           // of a cylinder's polygon
constexpr int kSphereDivisions = 4;  // of an icosahedron: 5120 triangles

void append(Solid& all, const Solid& one, const Pose& pose, Vec3 scale) {
  const auto first = static_cast<std::uint32_t>(all.vertices.size());
  for (const Vec3& p : one.vertices)
    all.vertices.push_back(pose * Vec3{scale.x * p.x, scale.y * p.y, scale.z * p.z});
  const bool is_mirrored = scale.x * scale.y * scale.z < 0;
  for (const auto& [a, b, c] : one.triangles)
    all.triangles.push_back(is_mirrored ? Triangle{first + a, first + c, first + b}
                                        : Triangle{first + a, first + b, first + c});
}

// Returns an upright prism with kSides sides whose polygon has corners at radius 1; its length
// is 1.
Solid prism() {
  Solid solid;
  for (const double z : {-0.5, 0.5})
    for (int k = 0; k < kSides; ++k) {
      const double angle = 2 * kPi * k / kSides;
      solid.vertices.push_back({std::cos(angle), std::sin(angle), z});
    }
  constexpr std::uint32_t kCount = kSides;
  for (std::uint32_t k = 0; k < kCount; ++k) {
    const std::uint32_t next = (k + 1) % kCount;
    solid.triangles.push_back({k, next, kCount + next});
    solid.triangles.push_back({k, kCount + next, kCount + k});
    if (k == 0 || next == 0) continue;
    solid.triangles.push_back({0, next, k});
    solid.triangles.push_back({kCount, kCount + k, kCount + next});
  }
  return solid;
}

// Returns by how much a polyhedron whose corners are at radius 1 grows to be as asked: `nearest` is
// the least distance of its faces, and `part` its part of the round shape's measure, to the power
// `dimension` of the radius.
double growth(RoundShape round, double nearest, double part, int dimension) {
  if (round == RoundShape::outside) return 1 / nearest;
  return round == RoundShape::same_volume ? std::pow(part, -1.0 / dimension) : 1;
}

Solid ball() {
  return synthetic::make_icosphere(1, kSphereDivisions);
}

double nearest_face(const Solid& solid) {
  double nearest = 1;
  for (const auto& [i, j, k] : solid.triangles) {
    const Vec3 a = solid.vertices[i], normal = cross(solid.vertices[j] - a, solid.vertices[k] - a);
    nearest = std::min(nearest, dot(normal, a) / norm(normal));
  }
  return nearest;
}

void append_round(Solid& all, const CollisionShape& shape, RoundShape round) {
  if (shape.kind == CollisionShape::Kind::cylinder) {
    constexpr double kAngle = 2 * kPi / kSides;
    const double radius =
        shape.size.x * growth(round, std::cos(kAngle / 2), std::sin(kAngle) / kAngle, 2);
    return append(all, prism(), shape.to_link, {radius, radius, shape.size.z});
  }
  const Solid unit = ball();
  const double part = mass_properties(unit).volume / volume(Sphere{{}, 1});
  const double radius = shape.size.x * growth(round, nearest_face(unit), part, 3);
  append(all, unit, shape.to_link, {radius, radius, radius});
}

void append_mesh(Solid& all, const CollisionShape& shape, const SolidOptions& options,
                 std::vector<std::string>& notes) {
  SolidOptions unscaled = options;
  unscaled.scale = 1;
  const CheckedSolid checked = make_solid(read_mesh(shape.mesh), unscaled);
  append(all, checked.solid, shape.to_link, shape.size);
  for (const auto* said : {&checked.notes, &checked.warnings})
    for (const std::string& text : *said) notes.push_back(shape.mesh + ": " + text);
}

}  // namespace

SolidMesh link_solid(const Robot& robot, std::size_t number, RoundShape round,
                     const SolidOptions& options) {
  const RobotLink& link = robot.links.at(number);
  if (link.shapes.empty())
    throw Error(ErrorKind::invalid_argument, "link '" + link.name + "' has no collision geometry");
  Solid all;
  std::vector<std::string> notes;
  for (const CollisionShape& shape : link.shapes) {
    switch (shape.kind) {
      case CollisionShape::Kind::box:
        append(all, synthetic::make_box(shape.size.x, shape.size.y, shape.size.z), shape.to_link,
               {1, 1, 1});
        break;
      case CollisionShape::Kind::mesh:
        append_mesh(all, shape, options, notes);
        break;
      default:
        append_round(all, shape, round);
    }
  }
  RawMesh mesh;
  mesh.name = "link '" + link.name + "'";
  mesh.vertices = std::move(all.vertices);
  for (const Triangle& triangle : all.triangles) mesh.add_triangle(triangle);
  CheckedSolid checked = make_solid(mesh, {.scale = 1});
  notes.insert(notes.end(), checked.notes.begin(), checked.notes.end());
  checked.notes = std::move(notes);
  return HandleAccess::make<SolidMesh>(std::move(checked));
}

}  // namespace vpm
