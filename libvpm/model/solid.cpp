#include "libvpm/model/solid.h"

#include <algorithm>
#include <limits>
#include <span>

#include "libvpm/file/checksum.h"

namespace vpm {
namespace {

Vec3 box_center(const std::vector<Vec3>& points) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  Vec3 low{kInf, kInf, kInf}, high{-kInf, -kInf, -kInf};
  for (const Vec3& p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return points.empty() ? Vec3{} : low + 0.5 * (high - low);
}

}  // namespace

MassProperties mass_properties(const Solid& solid) {
  const Vec3 origin = box_center(solid.vertices);
  double six_volumes = 0;
  Vec3 moment;
  for (const Triangle& t : solid.triangles) {
    const Vec3 a = solid.vertices[t[0]] - origin, b = solid.vertices[t[1]] - origin,
               c = solid.vertices[t[2]] - origin;
    const double six_volume =
        dot(a, cross(b, c));  // six times the volume of tetrahedron (origin, a, b, c)
    six_volumes += six_volume;
    moment += six_volume * (a + b + c);
  }
  if (six_volumes == 0) return {0, origin};
  return {six_volumes / 6, origin + moment / (4 * six_volumes)};
}

double bounding_radius(const Solid& solid, Vec3 from) {
  double largest = 0;
  for (const Vec3& p : solid.vertices) largest = std::max(largest, squared_norm(p - from));
  return std::sqrt(largest);
}

std::string content_hash(const Solid& solid) {
  const std::array<std::uint64_t, 2> counts{solid.vertices.size(), solid.triangles.size()};
  return file::content_hash({std::as_bytes(std::span(counts)),
                             std::as_bytes(std::span(solid.vertices)),
                             std::as_bytes(std::span(solid.triangles))});
}

}  // namespace vpm
