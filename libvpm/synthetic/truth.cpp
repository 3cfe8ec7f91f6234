#include "libvpm/synthetic/truth.h"

#include <algorithm>
#include <array>

#include "libvpm/core/parallel.h"

namespace vpm::synthetic {
namespace {

// Direction a of the integral of volume, parallel to no face or edge of a scene, so that G has
// kinks but no jumps.
const Vec3 kColumn = normalized_or_zero({0.1831, 0.2297, 1});

// Largest size of the pieces of triangles, relative to the bounding radius, so that no corner that
// barely dips in and no shadow of an edge falls between the points of the rule.
constexpr double kFaceSize = 1.0 / 12;
constexpr double kCrossedSize = 1.0 / 32;  // where the surface may cross the triangle
constexpr int kDeepest = 16;               // halvings: below 4^-16 of a face rounding dominates

// Number of crossed triangles that share the tolerance; the curve in which the surface cuts the
// solid passes through about this many.
constexpr double kSharers = 500;

using Corners = std::array<Vec3, 3>;

struct Integrals {
  double length = 0;  // integral of G
  double depth = 0;   // integral of min(s, 0)
  Vec3 moment;        // integral of min(s, 0) (x - C)

  Integrals& operator+=(const Integrals& o) {
    length += o.length;
    depth += o.depth;
    moment += o.moment;
    return *this;
  }
};

// Integrates over the triangles of a placed solid, one after the other.
class Cubature {
 public:
  Cubature(const Surface& surface, Vec3 center, double radius, double allowed)
      : surface_(surface), center_(center), radius_(radius), allowed_(allowed) {}

  Integrals integrate(const Corners& t) { return refine(t, rule(t), 0); }
  double error() const { return error_; }

 private:
  // Applies Radon's rule of degree 5.
  Integrals rule(const Corners& t) {
    static const double kRoot = std::sqrt(15.0);
    const double area = 0.5 * norm(cross(t[1] - t[0], t[2] - t[0]));
    Integrals sum;
    add((t[0] + t[1] + t[2]) / 3, area * 9 / 40, sum);
    for (const double sign : {-1.0, 1.0}) {
      const double near = (6 + sign * kRoot) / 21, far = 1 - 2 * near;
      const double weight = area * (155 + sign * kRoot) / 1200;
      add(near * t[0] + near * t[1] + far * t[2], weight, sum);
      add(near * t[1] + near * t[2] + far * t[0], weight, sum);
      add(near * t[2] + near * t[0] + far * t[1], weight, sum);
    }
    return sum;
  }

  void add(Vec3 x, double weight, Integrals& sum) {
    const double s = std::min(surface_.distance(x), 0.0);
    sum.length += weight * obstacle_before(x);
    sum.depth += weight * s;
    sum.moment += weight * s * (x - center_);
  }

  // Returns the length of the obstacle on the line along kColumn, from the plane before the solid
  // to x.
  double obstacle_before(Vec3 x) {
    const double back = dot(x - center_, kColumn) + radius_;
    crossings_.clear();
    surface_.crossings(x, kColumn, crossings_);
    std::erase_if(crossings_, [&](double t) { return !(t > -back && t < 0); });
    if (crossings_.empty()) return surface_.distance(x - 0.5 * back * kColumn) < 0 ? back : 0;
    std::sort(crossings_.begin(), crossings_.end());
    double length = 0, last = -back;
    crossings_.push_back(0);
    for (const double t : crossings_) {
      if (surface_.distance(x + 0.5 * (last + t) * kColumn) < 0) length += t - last;
      last = t;
    }
    return length;
  }

  Integrals refine(const Corners& t, const Integrals& whole, int depth) {
    const Vec3 ab = 0.5 * (t[0] + t[1]), bc = 0.5 * (t[1] + t[2]), ca = 0.5 * (t[2] + t[0]);
    const std::array<Corners, 4> parts{
        Corners{t[0], ab, ca}, {ab, t[1], bc}, {ca, bc, t[2]}, {bc, ca, ab}};
    std::array<Integrals, 4> of_part;
    Integrals sum;
    for (std::size_t k = 0; k < 4; ++k) sum += of_part[k] = rule(parts[k]);
    const double change =
        std::max({std::abs(sum.length - whole.length), std::abs(sum.depth - whole.depth),
                  norm(sum.moment - whole.moment) / radius_});
    if (depth >= kDeepest || (change <= allowed_ && !is_coarse(t))) {
      error_ += change;
      return sum;
    }
    Integrals refined;
    for (std::size_t k = 0; k < 4; ++k) refined += refine(parts[k], of_part[k], depth + 1);
    return refined;
  }

  bool is_coarse(const Corners& t) const {
    const Vec3 middle = (t[0] + t[1] + t[2]) / 3;
    const double radius = std::max({norm(t[0] - middle), norm(t[1] - middle), norm(t[2] - middle)});
    return radius > kFaceSize * radius_ ||
           (radius > kCrossedSize * radius_ && std::abs(surface_.distance(middle)) <= radius);
  }

  const Surface& surface_;
  Vec3 center_;
  double radius_, allowed_;
  double error_ = 0;
  std::vector<double> crossings_;
};

Penetration penetration_of(const Corners& t, Cubature& cubature) {
  const Vec3 normal = normalized_or_zero(cross(t[1] - t[0], t[2] - t[0]));
  const Integrals over = cubature.integrate(t);
  return {over.length * dot(kColumn, normal), over.depth * normal, cross(over.moment, normal), 0};
}

void add(Penetration& sum, const Penetration& part) {
  sum.volume += part.volume;
  sum.force += part.force;
  sum.torque += part.torque;
  sum.error += part.error;
}

}  // namespace

TrueSolid::TrueSolid(const Solid& solid)
    : solid_(solid),
      mass_(mass_properties(solid)),
      radius_(vpm::bounding_radius(solid, mass_.center_of_mass)) {}

Penetration TrueSolid::penetration(const Pose& pose, const Surface& surface,
                                   double tolerance) const {
  const Vec3 center = pose * mass_.center_of_mass;
  if (surface.distance(center) > radius_) return {};
  const double allowed = tolerance * mass_.volume / kSharers;
  constexpr std::size_t kTogether = 16;  // triangles per task
  std::vector<Penetration> parts((solid_.triangles.size() + kTogether - 1) / kTogether);
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t part = begin; part < end; ++part) {
      Cubature cubature(surface, center, radius_, allowed);
      const std::size_t last = std::min((part + 1) * kTogether, solid_.triangles.size());
      for (std::size_t k = part * kTogether; k < last; ++k) {
        const auto& [a, b, c] = solid_.triangles[k];
        add(parts[part], penetration_of({pose * solid_.vertices[a], pose * solid_.vertices[b],
                                         pose * solid_.vertices[c]},
                                        cubature));
      }
      parts[part].error = cubature.error();
    }
  });
  Penetration sum;
  for (const Penetration& part : parts) add(sum, part);
  return sum;
}

}  // namespace vpm::synthetic
