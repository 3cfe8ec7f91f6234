#include "libvpm/mesh/surface_distance.h"

#include <algorithm>
#include <cmath>

#include "libvpm/core/parallel.h"
#include "libvpm/mesh/triangle_bvh.h"

namespace vpm {
namespace {

// Limits the samples along an edge, for triangles as large as the mesh.
constexpr double kMostSteps = 2000;

// Returns the largest distance over a triangular lattice on one triangle.
double farthest(Vec3 a, Vec3 b, Vec3 c, const TriangleBvh& to, double spacing) {
  const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)});
  const int steps = static_cast<int>(std::clamp(std::ceil(longest / spacing), 1.0, kMostSteps));
  double worst = 0;
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; i + j <= steps; ++j) {
      const Vec3 p = a + (static_cast<double>(i) / steps) * (b - a) +
                     (static_cast<double>(j) / steps) * (c - a);
      worst = std::max(worst, to.closest(p).distance);
    }
  }
  return worst;
}

}  // namespace

double farthest_from_surface(const Solid& from, const Solid& to, double spacing) {
  const TriangleBvh bvh(to.vertices, to.triangles);
  std::vector<double> worst(from.triangles.size());
  constexpr std::size_t kTogether = 16;
  parallel_for(worst.size(), kTogether, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto [a, b, c] = from.triangles[k];
      worst[k] = farthest(from.vertices[a], from.vertices[b], from.vertices[c], bvh, spacing);
    }
  });
  return worst.empty() ? 0 : *std::max_element(worst.begin(), worst.end());
}

}  // namespace vpm
