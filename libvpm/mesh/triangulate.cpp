#include <algorithm>
#include <cmath>

#include "libvpm/core/error.h"
#include "libvpm/mesh/mesh_reader.h"

namespace vpm {
namespace {

// Limits corners, since ear clipping takes quadratic time; no honest file has more.
constexpr std::size_t kMaxCorners = 4096;

struct Point2 {
  double x = 0, y = 0;
};

// Returns twice the signed area of the triangle a, b, c.
double turn(Point2 a, Point2 b, Point2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Returns Newell's normal, which averages a polygon that is not quite flat.
Vec3 newell_normal(const std::vector<Vec3>& corners) {
  Vec3 normal;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec3 a = corners[k] - corners[0], b = corners[(k + 1) % corners.size()] - corners[0];
    normal += cross(a, b);
  }
  return normal;
}

// Drops the axis along which the polygon's projection is largest, keeping its orientation.
std::vector<Point2> project(const std::vector<Vec3>& corners, Vec3 normal) {
  const double ax = std::abs(normal.x), ay = std::abs(normal.y), az = std::abs(normal.z);
  std::vector<Point2> flat(corners.size());
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec3 p = corners[k] - corners[0];
    if (ax >= ay && ax >= az) {
      flat[k] = normal.x > 0 ? Point2{p.y, p.z} : Point2{p.z, p.y};
    } else if (ay >= az) {
      flat[k] = normal.y > 0 ? Point2{p.z, p.x} : Point2{p.x, p.z};
    } else {
      flat[k] = normal.z > 0 ? Point2{p.x, p.y} : Point2{p.y, p.x};
    }
  }
  return flat;
}

bool is_ear(const std::vector<Point2>& flat, const std::vector<std::size_t>& ring, std::size_t at) {
  const std::size_t count = ring.size();
  const std::size_t before = ring[(at + count - 1) % count], here = ring[at],
                    after = ring[(at + 1) % count];
  if (!(turn(flat[before], flat[here], flat[after]) > 0)) return false;
  return std::none_of(ring.begin(), ring.end(), [&](std::size_t other) {
    return other != before && other != here && other != after &&
           turn(flat[before], flat[here], flat[other]) >= 0 &&
           turn(flat[here], flat[after], flat[other]) >= 0 &&
           turn(flat[after], flat[before], flat[other]) >= 0;
  });
}

// Cuts ears in the plane of the polygon. The rest without an ear (degenerate, crossing) becomes a
// fan. `emit` takes positions within the polygon.
template <class Emit>
void clip_ears(const std::vector<Vec3>& corners, Emit emit) {
  const std::vector<Point2> flat = project(corners, newell_normal(corners));
  std::vector<std::size_t> ring(corners.size());
  for (std::size_t k = 0; k < ring.size(); ++k) ring[k] = k;
  std::size_t at = 0, tried = 0;
  while (ring.size() > 3 && tried < ring.size()) {
    if (at >= ring.size()) at = 0;
    if (is_ear(flat, ring, at)) {
      emit(ring[(at + ring.size() - 1) % ring.size()], ring[at], ring[(at + 1) % ring.size()]);
      ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(at));
      tried = 0;
    } else {
      ++at;
      ++tried;
    }
  }
  for (std::size_t k = 2; k < ring.size(); ++k) emit(ring[0], ring[k - 1], ring[k]);
}

}  // namespace

std::vector<Triangle> triangulate(const RawMesh& mesh) {
  std::vector<Triangle> triangles;
  triangles.reserve(mesh.corners.size() - 2 * mesh.polygon_count());
  std::vector<Vec3> corners;
  std::size_t begin = 0;
  for (const std::size_t end : mesh.polygon_end) {
    const std::uint32_t* const index = mesh.corners.data() + begin;
    if (end - begin == 3) {
      triangles.push_back({index[0], index[1], index[2]});
    } else {
      if (end - begin > kMaxCorners) {
        refuse("a polygon has " + std::to_string(end - begin) + " corners", mesh.name,
               "cut it into triangles");
      }
      corners.clear();
      for (std::size_t k = begin; k < end; ++k) corners.push_back(mesh.vertices[mesh.corners[k]]);
      clip_ears(corners, [&](std::size_t a, std::size_t b, std::size_t c) {
        triangles.push_back({index[a], index[b], index[c]});
      });
    }
    begin = end;
  }
  return triangles;
}

}  // namespace vpm
