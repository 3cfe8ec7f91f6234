#include "libvpm/packing/fill_quality.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "libvpm/core/parallel.h"
#include "libvpm/graph/sphere_bvh.h"
#include "libvpm/mesh/outer_surface.h"

namespace vpm {
namespace {

void add_outer(SecondMoments& m, double weight, Vec3 v) {
  m[0] += weight * v.x * v.x;
  m[1] += weight * v.y * v.y;
  m[2] += weight * v.z * v.z;
  m[3] += weight * v.x * v.y;
  m[4] += weight * v.x * v.z;
  m[5] += weight * v.y * v.z;
}

// Returns the Frobenius norm of the inertia tensor tr(C) 1 - C of second moments C.
double norm_of_inertia(const SecondMoments& c) {
  const double x = c[1] + c[2], y = c[0] + c[2], z = c[0] + c[1];
  return std::sqrt(x * x + y * y + z * z + 2 * (c[3] * c[3] + c[4] * c[4] + c[5] * c[5]));
}

}  // namespace

SecondMoments second_moments(const Solid& solid) {
  const Vec3 origin = mass_properties(solid).center_of_mass;
  SecondMoments sum{};
  for (const auto& [i, j, k] : solid.triangles) {
    const Vec3 a = solid.vertices[i] - origin, b = solid.vertices[j] - origin,
               c = solid.vertices[k] - origin;
    // Six times the volume of tetrahedron (origin, a, b, c).
    const double six_volumes = dot(a, cross(b, c));
    for (const Vec3 v : {a, b, c, a + b + c}) add_outer(sum, six_volumes / 120, v);
  }
  return sum;
}

InertiaError::InertiaError(const Solid& solid) {
  const Solid surface = enclosed_surface(solid);
  const MassProperties mass = mass_properties(surface);
  center_ = mass.center_of_mass;
  solid_ = second_moments(surface);
  for (double& m : solid_) m /= mass.volume;
}

void InertiaError::add(const Sphere& sphere) {
  const double v = volume(sphere), own = v * sphere.radius * sphere.radius / 5;
  add_outer(spheres_, v, sphere.center - center_);
  for (std::size_t k = 0; k < 3; ++k) spheres_[k] += own;
  volume_ += v;
}

double InertiaError::value() const {
  if (!(volume_ > 0)) return 1;
  SecondMoments difference{};
  for (std::size_t k = 0; k < difference.size(); ++k)
    difference[k] = spheres_[k] / volume_ - solid_[k];
  return norm_of_inertia(difference) / norm_of_inertia(solid_);
}

namespace {

constexpr std::size_t kSamples = 50000;
// Roberts' sequence, the two-dimensional golden ratio, spreads any number of points evenly.
constexpr double kRoberts1 = 0.7548776662466927, kRoberts2 = 0.5698402909980532;

// Returns points spread evenly over the surface's area.
std::vector<Vec3> samples_of(const Solid& solid) {
  std::vector<double> area_up_to;
  double area = 0;
  for (const auto& [a, b, c] : solid.triangles) {
    area += 0.5 * norm(cross(solid.vertices[b] - solid.vertices[a],
                             solid.vertices[c] - solid.vertices[a]));
    area_up_to.push_back(area);
  }
  std::vector<Vec3> points;
  std::size_t t = 0;
  for (std::size_t k = 0; k < kSamples; ++k) {
    const double at = area * (static_cast<double>(k) + 0.5) / kSamples;
    while (t + 1 < area_up_to.size() && area_up_to[t] < at) ++t;
    double u = kRoberts1 * static_cast<double>(k), v = kRoberts2 * static_cast<double>(k);
    u -= std::floor(u);
    v -= std::floor(v);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const auto [a, b, c] = solid.triangles[t];
    const Vec3 from = solid.vertices[a];
    points.push_back(from + u * (solid.vertices[b] - from) + v * (solid.vertices[c] - from));
  }
  return points;
}

std::vector<double> gaps_of(const std::vector<Vec3>& points, const SphereBvh& bvh, Vec3 origin,
                            double unit) {
  std::vector<double> gaps(points.size());
  constexpr std::size_t kTogether = 256;
  parallel_for(points.size(), kTogether, [&](std::size_t begin, std::size_t end) {
    std::uint32_t nearest = 0;
    for (std::size_t k = begin; k < end; ++k) {
      const Vec3 p = (points[k] - origin) / unit;
      nearest = bvh.nearest_surface(p, nearest);
      gaps[k] = unit * std::max(surface_distance(p, bvh.spheres()[nearest]), 0.0);
    }
  });
  return gaps;
}

}  // namespace

SurfaceGap surface_gap(const Solid& solid, const std::vector<Sphere>& spheres) {
  // Scales to coordinates of magnitude 1, which SphereBvh needs.
  const Vec3 origin = spheres.front().center;
  const double unit = bounding_radius(solid, origin);
  std::vector<Sphere> scaled;
  scaled.reserve(spheres.size());
  for (const Sphere& s : spheres) scaled.push_back({(s.center - origin) / unit, s.radius / unit});
  const SphereBvh bvh(scaled);

  std::vector<double> gaps = gaps_of(samples_of(solid), bvh, origin, unit);
  const std::vector<double> at_vertices = gaps_of(solid.vertices, bvh, origin, unit);
  std::sort(gaps.begin(), gaps.end());
  SurfaceGap result;
  for (const double gap : gaps) result.mean += gap / kSamples;
  result.p95 = gaps[kSamples * 95 / 100];
  result.largest = std::max(gaps.back(), *std::max_element(at_vertices.begin(), at_vertices.end()));
  return result;
}

}  // namespace vpm
