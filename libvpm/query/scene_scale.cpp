#include "libvpm/query/scene_scale.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"
#include "libvpm/query/quadric_fit.h"

namespace vpm {
namespace {

constexpr std::size_t kPatches = 64;  // places on the surface that are sampled
// Number of nearest points that give spacing and, as the residual of a paraboloid, noise.
constexpr std::size_t kNearest = 32;
// Radius, in tool radii, of the patch that gives curvature, and the most points of it. Over a
// smaller patch the noise of a depth camera bends more than the scene.
constexpr double kPatchRadius = 0.25;
constexpr std::size_t kPatchPoints = 512;
constexpr double kSameSide = 0.5;  // least cosine to the patch's normal; others are another surface
constexpr double kMostCurved = 0.9;  // quantile over the patches

double quantile(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

struct Patch {
  double spacing = 0;
  std::optional<QuadricFit> fine, broad;
};

class PatchReader {
 public:
  PatchReader(const AnyBody& cloud, std::vector<std::uint32_t> near, double tool_radius)
      : positions_(cloud.positions()),
        normals_(cloud.normals()),
        near_(std::move(near)),
        radius_(kPatchRadius * tool_radius) {}

  std::size_t patches() const { return std::min(kPatches, near_.size()); }

  Patch read(std::size_t k) const {
    const std::uint32_t seed = near_[(2 * k + 1) * near_.size() / (2 * patches())];
    const Vec3 place = widen(positions_[seed]), normal = widen(normals_[seed]);
    std::vector<std::pair<double, std::uint32_t>> found;
    for (const std::uint32_t i : near_) {
      if (dot(widen(normals_[i]), normal) < kSameSide) continue;
      found.emplace_back(squared_norm(widen(positions_[i]) - place), i);
    }
    Patch patch;
    if (found.size() < kNearest) return patch;
    std::nth_element(found.begin(), found.begin() + kNearest - 1, found.end());
    const double squared = found[kNearest - 1].first;
    patch.spacing = std::sqrt(squared * kPi / kNearest);
    patch.fine = fit(found, squared, place, normal);
    patch.broad = fit(found, std::max(squared, radius_ * radius_), place, normal);
    return patch;
  }

 private:
  std::optional<QuadricFit> fit(const std::vector<std::pair<double, std::uint32_t>>& found,
                                double within, Vec3 place, Vec3 normal) const {
    std::vector<std::uint32_t> members;
    for (const auto& [squared, i] : found) {
      if (squared <= within) members.push_back(i);
    }
    std::sort(members.begin(), members.end());
    const std::size_t stride = (members.size() + kPatchPoints - 1) / kPatchPoints;
    std::vector<Vec3> points;
    for (std::size_t m = 0; m < members.size(); m += stride)
      points.push_back(widen(positions_[members[m]]));
    return fit_quadric(points, place, normal);
  }

  const std::vector<Vec3f>&positions_, &normals_;
  std::vector<std::uint32_t> near_;
  double radius_;
};

template <class Points>
std::vector<std::uint32_t> points_near(const Points& cloud, Vec3 place, double distance) {
  std::vector<std::uint32_t> near;
  const Vec3 at = place - cloud.origin();
  cloud.for_ranges_in_ball(at, distance, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t i = begin; i < end; ++i) {
      if (squared_norm(widen(cloud.positions()[i]) - at) <= distance * distance) near.push_back(i);
    }
  });
  std::sort(near.begin(), near.end());
  return near;
}

}  // namespace

double SceneScale::smallest_radius() const {
  constexpr double kCovers = 0.70710678118654752;  // in spacings: radius that covers a square grid
  constexpr double kDeviations = 2;
  return std::max(kCovers * spacing, kDeviations * noise);
}

double SceneScale::largest_radius() const {
  if (!(curvature > 0)) return std::numeric_limits<double>::infinity();
  return std::max(smallest_radius(), std::sqrt(2 * smallest_radius() / curvature));
}

SceneScale scene_scale(const AnyBody& cloud, double tool_radius, std::optional<Vec3> place) {
  const std::size_t points = cloud.positions().size();
  if (points < kFewestPoints) {
    refuse("the cloud has " + std::to_string(points) + " points", {},
           "its scale can be told from " + std::to_string(kFewestPoints) + " on");
  }
  std::vector<std::uint32_t> near;
  if (place)
    near = cloud.visit([&](const auto& body) {
      return points_near(body.prepared(), *place, kNear * tool_radius);
    });
  if (near.size() < kFewestPoints) {
    near.resize(points);
    for (std::size_t i = 0; i < points; ++i) near[i] = static_cast<std::uint32_t>(i);
  }
  const PatchReader reader(cloud, std::move(near), tool_radius);
  std::vector<Patch> patches(reader.patches());
  parallel_for(patches.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) patches[k] = reader.read(k);
  });
  std::vector<double> spacing, noise, curvature;
  for (const Patch& patch : patches) {
    if (patch.spacing > 0) spacing.push_back(patch.spacing);
    if (patch.fine) noise.push_back(patch.fine->residual);
    if (patch.broad) curvature.push_back(patch.broad->curvature);
  }
  if (spacing.empty()) refuse("the cloud's points lie too scattered to tell its scale");
  return {quantile(spacing, 0.5), quantile(noise, 0.5), quantile(curvature, kMostCurved)};
}

SceneScale scene_scale(std::span<const AnyBody> scene, double tool_radius,
                       std::optional<Vec3> place) {
  SceneScale finest = scene_scale(scene.front(), tool_radius, place);
  for (const AnyBody& body : scene.subspan(1)) {
    const SceneScale scale = scene_scale(body, tool_radius, place);
    if (scale.smallest_radius() < finest.smallest_radius()) finest = scale;
  }
  return finest;
}

std::size_t level_for_scene(const ToolModel& tool, const SceneScale& scale) {
  std::size_t level = 0;
  for (std::size_t k = 0; k < tool.levels.size(); ++k) {
    const Sphere& smallest = tool.spheres[tool.levels[k].sphere_count - 1];
    if (smallest.radius >= scale.smallest_radius()) level = k;
  }
  if (tool.calibration.size() != tool.levels.size()) return level;
  const double reached = tool.calibration[level].mean;
  for (std::size_t k = 0; k < level; ++k) {
    if (tool.calibration[k].mean <= kNoBetter * reached) return k;
  }
  return level;
}

}  // namespace vpm
