#include "libvpm/mesh/cut_volume.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libvpm/core/solid_angle.h"

namespace vpm {
namespace {

// The solid is the signed sum of cones from an apex over its triangles. For a plane the apex lies
// on it, so that the cut face adds nothing. For a ball the apex is its centre: a cone meets the
// ball in the cone over the part of its triangle inside, plus a sector of the ball over the rest.

double signed_solid_angle(Vec3 a, Vec3 b, Vec3 c) {  // seen from the origin
  const TriangleAngle angle(a, b, c);
  return angle.is_flat() ? 0 : angle.value();
}

// Part in the ball of radius r of the cone from the origin over the triangle (foot, a, b), which
// lies in a plane at distance `height`; signed by the sense of (a, b) about `normal`. `disk` is the
// squared radius of the disk in which the ball meets the plane.
class FacePart {
 public:
  FacePart(Vec3 normal, double height, double radius)
      : normal_(normal),
        foot_(height * normal),
        height_(height),
        radius_(radius),
        disk_(radius * radius - height * height) {}

  // Cuts the edge where it enters and leaves the disk.
  double edge(Vec3 a, Vec3 b) const {
    const Vec3 along = b - a, from = a - foot_;
    const double aa = squared_norm(along);
    if (!(aa > 0)) return 0;
    const double half = dot(from, along) / aa;
    const double rest = (disk_ - squared_norm(from - half * along)) / aa;
    if (!(disk_ > 0) || !(rest > 0)) return outside(a, b);
    const double root = std::sqrt(rest);
    const double enter = std::clamp(-half - root, 0.0, 1.0),
                 leave = std::clamp(-half + root, 0.0, 1.0);
    if (!(enter < leave)) return outside(a, b);
    const Vec3 p = a + enter * along, q = a + leave * along;
    return outside(a, p) + height_ * area(p, q) / 3 + outside(q, b);
  }

 private:
  double area(Vec3 p, Vec3 q) const { return 0.5 * dot(normal_, cross(p - foot_, q - foot_)); }
  // Returns the part over an edge outside the disk: a sector of the disk and a sector of the ball.
  double outside(Vec3 p, Vec3 q) const {
    if (height_ == 0) return 0;  // both sectors are flat
    const double ball = radius_ * radius_ * radius_ / 3;
    const double all = signed_solid_angle(foot_, p, q);
    if (!(disk_ > 0)) return ball * all;
    const Vec3 u = p - foot_, v = q - foot_;
    const double angle = std::atan2(dot(normal_, cross(u, v)), dot(u, v));
    const double seen = angle * (1 - std::abs(height_) / radius_) * (height_ < 0 ? -1 : 1);
    return height_ * disk_ * angle / 6 + ball * (all - seen);
  }

  Vec3 normal_, foot_;
  double height_, radius_, disk_;
};

// Returns the part of the cone from the origin, a point of the cutting plane, over the part of the
// triangle below that plane.
double cone_below(const std::array<Vec3, 3>& t, Vec3 normal) {
  std::array<Vec3, 4> kept;
  std::size_t count = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 a = t[k], b = t[(k + 1) % 3];
    const double da = dot(normal, a), db = dot(normal, b);
    if (da < 0) kept[count++] = a;
    if ((da < 0) != (db < 0)) kept[count++] = a + (da / (da - db)) * (b - a);
  }
  double six = 0;
  for (std::size_t k = 2; k < count; ++k) six += dot(kept[0], cross(kept[k - 1], kept[k]));
  return six / 6;
}

}  // namespace

double volume_below_plane(const Solid& solid, Vec3 normal, double offset) {
  const Vec3 apex = offset * normal;
  double sum = 0;
  for (const Triangle& t : solid.triangles) {
    sum += cone_below(
        {solid.vertices[t[0]] - apex, solid.vertices[t[1]] - apex, solid.vertices[t[2]] - apex},
        normal);
  }
  return sum;
}

double volume_in_ball(const Solid& solid, const Sphere& ball) {
  double sum = 0;
  for (const Triangle& t : solid.triangles) {
    const Vec3 a = solid.vertices[t[0]] - ball.center, b = solid.vertices[t[1]] - ball.center,
               c = solid.vertices[t[2]] - ball.center;
    const Vec3 normal = normalized_or_zero(cross(b - a, c - a));
    const FacePart part(normal, dot(normal, a), ball.radius);
    sum += part.edge(a, b) + part.edge(b, c) + part.edge(c, a);
  }
  return sum;
}

}  // namespace vpm
