#include "tests/solid/depth_truth.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "libvpm/core/box.h"

namespace vpm::test {
namespace {

using Polygon = std::vector<Vec3>;

// Convex polytope as its faces.
class Polytope {
 public:
  explicit Polytope(const Solid& convex) {
    for (const auto& [i, j, k] : convex.triangles)
      faces_.push_back({convex.vertices[i], convex.vertices[j], convex.vertices[k]});
  }

  bool is_empty() const { return faces_.size() < 4; }
  const std::vector<Polygon>& faces() const { return faces_; }

  // Keeps what lies in a half-space, whose normal may have any length.
  void cut(Vec3 n, double offset) {
    std::vector<Polygon> kept;
    Polygon cap;
    for (const Polygon& face : faces_) {
      Polygon part;
      for (std::size_t k = 0; k < face.size(); ++k) {
        const Vec3 p = face[k], q = face[(k + 1) % face.size()];
        const double at_p = dot(n, p) - offset, at_q = dot(n, q) - offset;
        if (at_p <= 0) part.push_back(p);
        if ((at_p <= 0) == (at_q <= 0)) continue;
        part.push_back(p + at_p / (at_p - at_q) * (q - p));
        cap.push_back(part.back());
      }
      if (part.size() >= 3) kept.push_back(std::move(part));
    }
    if (cap.size() >= 3) kept.push_back(ordered(std::move(cap), n));
    faces_ = std::move(kept);
  }

  // Returns volume and centroid, summed about a corner.
  MassProperties mass() const {
    if (is_empty()) return {};
    const Vec3 about = faces_[0][0];
    double six = 0;
    Vec3 moment;
    for (const Polygon& face : faces_)
      for (std::size_t k = 2; k < face.size(); ++k) {
        const Vec3 p = face[0] - about, q = face[k - 1] - about, r = face[k] - about;
        const double part = dot(p, cross(q, r));
        six += part, moment += part * (p + q + r);
      }
    if (!(six > 0)) return {};
    return {six / 6, about + moment / (4 * six)};
  }

 private:
  // Orders the corners of a face counter-clockwise about its normal.
  static Polygon ordered(Polygon face, Vec3 n) {
    Vec3 middle;
    for (const Vec3& p : face) middle += p;
    middle = middle / static_cast<double>(face.size());
    const Vec3 u = normalized_or_zero(face[0] - middle), v = cross(normalized_or_zero(n), u);
    std::ranges::sort(face, {},
                      [&](Vec3 p) { return std::atan2(dot(v, p - middle), dot(u, p - middle)); });
    return face;
  }

  std::vector<Polygon> faces_;
};

// Returns the part of `all` to which the face `k` is nearer than all other faces.
Polytope nearest_to(const Polytope& all, const std::vector<HalfSpace>& faces, std::size_t k) {
  Vec3 middle;
  std::size_t corners = 0;
  for (const Polygon& face : all.faces())
    for (const Vec3& p : face) middle += p, ++corners;
  middle = middle / static_cast<double>(corners);
  std::vector<std::size_t> order(faces.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, {},
                    [&](std::size_t j) { return faces[j].offset - dot(faces[j].n, middle); });
  Polytope part = all;
  for (const std::size_t j : order) {
    if (j == k) continue;
    part.cut(faces[j].n - faces[k].n, faces[j].offset - faces[k].offset);
    if (part.is_empty()) break;
  }
  return part;
}

// Adds `weight` times the force and torque about the origin by which the faces push out what is in
// `shared`: the integral of the nearest face's normal.
void add_push(const Polytope& shared, const std::vector<HalfSpace>& faces, double weight,
              DepthTruth& truth) {
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const MassProperties part = nearest_to(shared, faces, k).mass();
    const Vec3 f = weight * part.volume * faces[k].n;
    truth.force += f, truth.torque += cross(part.center_of_mass, f);
  }
}

double volume_of(const ConvexParts& parts) {
  double sum = 0;
  for (const ConvexPart& part : parts) sum += mass_properties(part.region).volume;
  return sum;
}

}  // namespace

ConvexParts one_part(const Solid& convex) {
  std::vector<HalfSpace> faces;
  for (const auto& [i, j, k] : convex.triangles) {
    const Vec3 p = convex.vertices[i];
    const Vec3 n = normalized_or_zero(cross(convex.vertices[j] - p, convex.vertices[k] - p));
    if (std::ranges::none_of(faces, [&](const HalfSpace& f) { return dot(f.n, n) > 1 - 1e-13; }))
      faces.push_back({n, dot(n, p)});
  }
  return {{convex, faces}};
}

ConvexParts moved(ConvexParts parts, const Pose& pose) {
  for (auto& [region, faces] : parts) {
    for (Vec3& v : region.vertices) v = pose * v;
    for (auto& [n, offset] : faces) n = pose.rotation * n, offset += dot(n, pose.translation);
  }
  return parts;
}

DepthTruth depth_truth(const ConvexParts& a, const ConvexParts& b, bool with_force) {
  const double v = volume_of(a), w = volume_of(b), of_b = w * w / (v * v + w * w);
  DepthTruth truth;
  Vec3 moment;
  std::vector<Vec3> corners;
  for (const ConvexPart& part : a)
    for (const ConvexPart& other : b) {
      Polytope shared(part.region);
      const ConvexParts region = one_part(other.region);
      for (const auto& [n, offset] : region[0].faces) shared.cut(n, offset);
      const MassProperties mass = shared.mass();
      if (!(mass.volume > 0)) continue;
      truth.volume += mass.volume, moment += mass.volume * mass.center_of_mass;
      for (const Polygon& face : shared.faces())
        corners.insert(corners.end(), face.begin(), face.end());
      if (!with_force) continue;
      add_push(shared, other.faces, of_b, truth);
      add_push(shared, part.faces, of_b - 1, truth);
    }
  if (truth.volume == 0) return truth;
  truth.centroid = moment / truth.volume;
  truth.torque -= cross(truth.centroid, truth.force);
  for (const Vec3& x : corners) truth.extent = std::max(truth.extent, norm(x - truth.centroid));
  return truth;
}

}  // namespace vpm::test
