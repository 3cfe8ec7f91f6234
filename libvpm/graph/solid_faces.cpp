#include "libvpm/graph/solid_faces.h"

#include <algorithm>
#include <cmath>

namespace vpm {
namespace {

// Least extent along the axis, in moment radii, of a piece that gets a shape. Thinner ones are
// within the rounding to which cells are sampled.
constexpr double kThinnest = 1e-3;
// How far about a centroid triangles are looked for, in moment radii: shapes reach no further.
constexpr double kLook = 1.75;
// Cosine of the axis and the direction to a triangle, below which the triangle is opposite to the
// face and limits how far the shape reaches away from the face.
constexpr double kOpposite = -0.7;
// Sine squared below which a plane is at a right angle to the axis.
constexpr double kRightAngle = 1e-9;
// Relative difference up to which two triangles are equally near: it covers rounding.
constexpr double kSamePlace = 1e-9;
// Cosine of the axis and the normal of a triangle, above which the triangle and the nearest one
// belong to one smooth face; and how far a shape may stick out of such a face, in parts of the
// solid's radius. A shape thin enough to stay wholly below a curved face would have less than its
// piece's second moment.
constexpr double kSmooth = 0.7, kExcess = 5e-4;

// A triangle near a centroid, relative to it.
struct NearTriangle {
  Vec3 place;       // its nearest
  double distance;  // of that
  Vec3 normal;      // of its plane, out of the solid
  double height;    // of its plane above the centroid
};

// Returns the triangles of the solid that come nearer to a piece's centroid than this radius.
std::vector<NearTriangle> triangles_about(const TriangleBvh& tree, Vec3 centroid, double radius) {
  std::vector<std::uint32_t> found(64);
  std::size_t count = tree.around(centroid, radius, found);
  while (count > found.size()) {
    found.resize(2 * found.size());
    count = tree.around(centroid, radius, found);
  }
  std::vector<NearTriangle> all;
  for (std::size_t k = 0; k < count; ++k) {
    const TriangleBvh::Corners& t = tree.corners()[found[k]];
    const Vec3 place = closest_point_on_triangle(centroid, t.a, t.b, t.c) - centroid,
               normal = normalized_or_zero(cross(t.b - t.a, t.c - t.a));
    if (norm(place) < radius)
      all.push_back({place, norm(place), normal, dot(normal, t.a - centroid)});
  }
  return all;
}

// Returns the nearest triangle, or null if there is none. Where several share the nearest place, on
// an edge or a corner, it is the one whose plane is furthest from the centroid, since the centroid
// may lie in the planes of others, or on the wrong side of them.
const NearTriangle* nearest_of(const std::vector<NearTriangle>& all) {
  const NearTriangle* best = nullptr;
  for (const NearTriangle& near : all) {
    if (best == nullptr || near.distance < (1 - kSamePlace) * best->distance ||
        (near.distance <= (1 + kSamePlace) * best->distance &&
         std::fabs(near.height) > std::fabs(best->height)))
      best = &near;
  }
  return best;
}

// Returns the largest squared extent across the axis, up to `most`, with which a shape does not
// reach a triangle: either it stays below the triangle's plane, or within the ball about the
// centroid that touches the triangle. Triangles that face nearly as the axis does are of the face
// that the piece lies beside; it may reach `excess` further than these.
double most_across(const NearTriangle& near, Vec3 axis, double toward, double away, double excess,
                   double most) {
  const double cosine = dot(near.normal, axis), sine2 = 1 - cosine * cosine,
               end = cosine * (cosine > 0 ? toward : away);
  if (!(cosine > kSmooth)) excess = 0;
  const double height = near.height + excess;
  double below = height >= std::fabs(end) ? most : 0;
  if (height > 0 && sine2 > kRightAngle) below = (height * height - end * end) / sine2;
  const double beside = near.distance + excess;
  if (dot(near.place, axis) >= 0 || away <= beside) below = std::max(below, beside * beside);
  return std::clamp(below, 0.0, most);
}

float round_down(double value) {
  const float rounded = static_cast<float>(value);
  return double{rounded} > value ? std::nextafter(rounded, 0.0F) : rounded;
}

}  // namespace

SolidFaces::SolidFaces(const Solid& boundary, double radius)
    : tree_(boundary.vertices, boundary.triangles), excess_(kExcess * radius) {}

std::optional<SampleFace> SolidFaces::beside(Vec3& centroid, double radius,
                                             const Moment& moment) const {
  const double least = kThinnest * radius;
  std::vector<NearTriangle> all = triangles_about(tree_, centroid, kLook * radius);
  const NearTriangle* nearest = nearest_of(all);
  if (nearest == nullptr || nearest->distance >= radius) return std::nullopt;
  if (nearest->height <= least) {
    centroid += nearest->place - 2 * least * nearest->normal;
    all = triangles_about(tree_, centroid, kLook * radius);
    nearest = nearest_of(all);
  }
  if (nearest == nullptr || nearest->height <= 0) return std::nullopt;
  const Vec3 axis = nearest->place / nearest->distance;
  double toward = nearest->distance, away = HUGE_VAL;
  for (const NearTriangle& near : all)
    if (dot(near.place, axis) < kOpposite * near.distance) away = std::min(away, near.distance);
  const double variance = std::min(moment.along(axis), most_variance_at_face(toward, away)),
               along = std::sqrt(5 * variance);
  if (!(along > least)) return std::nullopt;
  toward = std::min(toward, along);
  away = std::min(away, along);
  double across = std::max(0.0, 1.5 * radius * radius - 2.5 * variance);  // five variances
  for (const NearTriangle& near : all)
    across = most_across(near, axis, toward, away, excess_, across);
  return SampleFace{0,
                    narrow(axis),
                    round_down(toward),
                    round_down(away),
                    static_cast<float>(along),
                    round_down(std::sqrt(across))};
}

}  // namespace vpm
