#include "libvpm/graph/solid_faces.h"

#include <algorithm>
#include <cmath>

namespace vpm {

// A triangle near a centroid, relative to it.
struct SolidFaces::Near {
  Vec3 a, b, c;
  Vec3 place;         // the triangle's nearest
  Vec3 normal;        // of its plane, out of the solid
  double height = 0;  // of its plane above the centroid
};

namespace {

// Least distance of a centroid from the surface, and least extent along the axis, in moment radii,
// of a piece that gets a shape. What is thinner is rounding of what cells are sampled to.
constexpr double kThinnest = 1e-3;
// How far about a centroid triangles are looked for, in moment radii: shapes reach no further.
constexpr double kLook = 1.75;
// Cosine of the axis and the direction to a triangle below which that is opposite to the face, and
// limits how far the shape goes away from it.
constexpr double kOpposite = -0.7;
// Sine squared below which a plane is at a right angle to the axis.
constexpr double kRightAngle = 1e-9;
// Cosine of the axis and the normal of a triangle above which they belong to one smooth face. There
// a shape may stick out by so much of the solid's radius, since a shape that is thin enough to stay
// below a curved face has not its piece's second moment.
constexpr double kSmooth = 0.7, kExcess = 5e-4;
constexpr int kBisections = 30;

// Returns the squared extent across the axis, `most` at most, with which an ellipsoid about the
// origin, whose extent along the axis is `end`, does not reach a triangle.
double most_beside(Vec3 a, Vec3 b, Vec3 c, Vec3 axis, double end, double most) {
  const auto fits = [&](double across) {
    const auto to_ball = [&](Vec3 p) {
      const Vec3 along = dot(axis, p) * axis;
      return along + end / across * (p - along);
    };
    return norm(closest_point_on_triangle({}, to_ball(a), to_ball(b), to_ball(c))) >= end;
  };
  double low = 0, high = std::sqrt(most);
  if (!(high > 0) || fits(high)) return most;
  for (int k = 0; k < kBisections; ++k) {
    const double middle = 0.5 * (low + high);
    (fits(middle) ? low : high) = middle;
  }
  return low * low;
}

}  // namespace

SolidFaces::SolidFaces(const Solid& boundary, double radius)
    : boundary_(boundary),
      tree_(boundary.vertices, boundary.triangles),
      excess_(kExcess * radius) {}

// Lists the triangles within a radius of a centroid.
std::vector<SolidFaces::Near> SolidFaces::about(Vec3 centroid, double radius) const {
  std::vector<std::uint32_t> found(64);
  std::size_t count = tree_.around(centroid, radius, found);
  while (count > found.size()) {
    found.resize(2 * found.size());
    count = tree_.around(centroid, radius, found);
  }
  std::vector<Near> all;
  for (std::size_t k = 0; k < count; ++k) {
    const TriangleBvh::Corners& corners = tree_.corners()[found[k]];
    Near near{corners.a - centroid, corners.b - centroid, corners.c - centroid, {}, {}};
    near.place = closest_point_on_triangle({}, near.a, near.b, near.c);
    near.normal = normalized_or_zero(cross(near.b - near.a, near.c - near.a));
    near.height = dot(near.normal, near.a);
    if (norm(near.place) < radius) all.push_back(near);
  }
  return all;
}

// True if a triangle's outer side is the one that a direction leads to.
bool SolidFaces::faces(std::uint32_t triangle, Vec3 direction) const {
  const auto& [i, j, k] = boundary_.triangles[triangle];
  const Vec3 a = boundary_.vertices[i];
  return dot(cross(boundary_.vertices[j] - a, boundary_.vertices[k] - a), direction) > 0;
}

// Returns the squared extent across the axis, `most` at most, with which a shape does not reach a
// triangle: since it stays below the triangle's plane, or since it stays away from the triangle.
double SolidFaces::most_across(const FaceExtents& face, const Near& near, double most) const {
  const double cosine = dot(near.normal, face.axis), sine2 = 1 - cosine * cosine,
               end = cosine * (cosine > 0 ? face.toward : face.away);
  const double excess = cosine > kSmooth ? excess_ : 0, height = near.height + excess;
  double below = height >= std::fabs(end) ? most : 0;
  if (height > 0 && sine2 > kRightAngle) below = (height * height - end * end) / sine2;
  if (below >= most) return most;
  const double lowest =
      std::min({dot(face.axis, near.a), dot(face.axis, near.b), dot(face.axis, near.c)});
  const double rest = (lowest >= 0 ? face.toward : face.away) - excess;
  if (!(rest > 0)) return most;
  const double away =
      std::sqrt(most_beside(near.a, near.b, near.c, face.axis, rest, most)) + excess;
  return std::min(most, std::max(below, away * away));
}

std::optional<FaceExtents> SolidFaces::beside(Vec3 centroid, double radius,
                                              const Moment& moment) const {
  const SurfacePoint nearest = tree_.closest(centroid, radius);
  if (nearest.triangle == SurfacePoint::kNone || !(nearest.distance > kThinnest * radius))
    return std::nullopt;
  FaceExtents face{(nearest.point - centroid) / nearest.distance, nearest.distance, HUGE_VAL};
  if (!faces(nearest.triangle, face.axis)) return std::nullopt;  // the centroid lies outside
  const std::vector<Near> all = about(centroid, kLook * radius);
  for (const Near& near : all) {
    const double distance = norm(near.place);
    if (dot(near.place, face.axis) < kOpposite * distance)
      face.away = std::min(face.away, distance);
  }
  const double variance =
      std::min(moment.along(face.axis), most_variance_at_face(face.toward, face.away));
  face.along = std::sqrt(5 * variance);
  if (!(face.along > kThinnest * radius)) return std::nullopt;
  face.toward = std::min(face.toward, face.along);
  face.away = std::min(face.away, face.along);
  double squared = (3 * radius * radius - 5 * variance) / 2;  // five variances across
  for (const Near& near : all) squared = most_across(face, near, squared);
  face.across = std::sqrt(std::max(squared, 0.0));
  return face;
}

}  // namespace vpm
