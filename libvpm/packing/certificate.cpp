#include "libvpm/packing/certificate.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "libvpm/core/parallel.h"
#include "libvpm/mesh/triangle_bvh.h"
#include "libvpm/mesh/winding_number.h"

namespace vpm {
namespace {

constexpr std::size_t kSpheresPerTask = 64;

double largest(const std::vector<double>& values) {
  return values.empty() ? -std::numeric_limits<double>::infinity()
                        : *std::max_element(values.begin(), values.end());
}

double protrusion(const Solid& solid, const std::vector<Sphere>& spheres) {
  const TriangleBvh bvh(solid.vertices, solid.triangles);
  const WindingNumber winding(bvh);
  std::vector<double> beyond(spheres.size());
  parallel_for(spheres.size(), kSpheresPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Sphere& s = spheres[i];
      const double distance = bvh.closest(s.center).distance;
      beyond[i] = s.radius + (winding.inside(s.center) ? -distance : distance);
    }
  });
  return largest(beyond);
}

// Sweep along x: every pair whose x intervals meet, and each sphere's next one along the sweep, so
// that there is a gap to tell where nothing overlaps.
double overlap(const std::vector<Sphere>& spheres) {
  std::vector<Sphere> sorted = spheres;
  std::sort(sorted.begin(), sorted.end(), [](const Sphere& a, const Sphere& b) {
    return a.center.x - a.radius < b.center.x - b.radius;
  });
  std::vector<double> common(sorted.size(), -std::numeric_limits<double>::infinity());
  parallel_for(sorted.size(), kSpheresPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Sphere& s = sorted[i];
      for (std::size_t j = i + 1; j < sorted.size(); ++j) {
        const Sphere& t = sorted[j];
        if (t.center.x - t.radius > s.center.x + s.radius && j > i + 1) break;
        common[i] = std::max(common[i], s.radius + t.radius - norm(s.center - t.center));
      }
    }
  });
  return largest(common);
}

}  // namespace

Certificate certify(const Solid& solid, const std::vector<Sphere>& spheres) {
  double extent = 0, farthest = 0;
  const Vec3 first = solid.vertices.empty() ? Vec3{} : solid.vertices.front();
  Vec3 low = first, high = first;
  for (const Vec3 p : solid.vertices) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    farthest = std::max({farthest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  extent = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  Certificate certificate;
  certificate.tolerance = std::max(kCertificateTolerance * extent,
                                   16 * std::numeric_limits<double>::epsilon() * farthest);
  certificate.max_protrusion = protrusion(solid, spheres);
  certificate.max_overlap = overlap(spheres);
  certificate.holds = certificate.max_protrusion <= certificate.tolerance &&
                      certificate.max_overlap <= certificate.tolerance;
  return certificate;
}

}  // namespace vpm
