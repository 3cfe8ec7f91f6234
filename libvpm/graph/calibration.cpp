#include "libvpm/graph/calibration.h"

#include <algorithm>
#include <cmath>

#include "libvpm/backend/cell_clusters.h"
#include "libvpm/core/box.h"
#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"
#include "libvpm/measure/tool_piece.h"
#include "libvpm/mesh/cut_volume.h"
#include "libvpm/mesh/outer_surface.h"
#include "libvpm/scene/body.h"
#include "libvpm/scene/depth/depth_surface.h"

namespace vpm {
namespace {

constexpr double kHigh = 0.95;  // quantile that LevelError::p95 holds

// Pseudo-random numbers, the same on every platform (SplitMix64).
class Numbers {
 public:
  double uniform() {  // 0 <= x < 1
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15ULL;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ z >> 27) * 0x94d049bb133111ebULL;
    return static_cast<double>((z ^ z >> 31) >> 11) * 0x1p-53;
  }
  Vec3 direction() {
    for (;;) {
      const double x = 2 * uniform() - 1, y = 2 * uniform() - 1, z = 2 * uniform() - 1;
      const double squared = x * x + y * y + z * z;
      if (squared > 0.01 && squared <= 1) return 1 / std::sqrt(squared) * Vec3{x, y, z};
    }
  }

 private:
  std::uint64_t state_ = 0;
};

// Normals of a solid's triangles, picked with a probability proportional to area.
class FaceNormals {
 public:
  explicit FaceNormals(const Solid& solid) {
    double area = 0;
    for (const Triangle& t : solid.triangles) {
      const Vec3 a = solid.vertices[t[0]];
      normals_.push_back(cross(solid.vertices[t[1]] - a, solid.vertices[t[2]] - a));
      area_.push_back(area += norm(normals_.back()));
    }
  }
  Vec3 pick(double part) const {
    const auto found = std::upper_bound(area_.begin(), area_.end(), part * area_.back());
    return normalized_or_zero(normals_[static_cast<std::size_t>(found - area_.begin())]);
  }

 private:
  std::vector<Vec3> normals_;
  std::vector<double> area_;  // cumulative
};

// Cut of the solid, about its centre of mass: a plane with the cut-off part below it, or a ball
// that contains that part.
struct Cut {
  Vec3 normal;
  double offset = 0;
  Sphere ball;  // radius 0 if the cut is a plane
  double truth = 0;

  // Returns the plane that a query would fit to a planar cluster about x: the mean of samples at
  // its middle and around it (DepthSurface::mean_plane). For radius 0 that is the tangent plane, as
  // for single blocks.
  Cut plane_at(Vec3 x, double radius) const {
    if (!(ball.radius > 0)) return *this;
    const Vec3 away = normalized_or_zero(x - ball.center);
    const double rim = DepthSurface::kRim * radius;
    const double lower = ball.radius / std::sqrt(ball.radius * ball.radius + rim * rim);
    return {away, dot(away, ball.center) + 0.2 * (1 + 4 * lower) * ball.radius, {}, truth};
  }
};

double longest_side(const Solid& solid) {
  Box box;
  for (const Vec3& v : solid.vertices) box.add(v);
  return std::max({box.size().x, box.size().y, box.size().z});
}

std::vector<Cut> make_cuts(const Solid& solid) {
  const FaceNormals faces(solid);
  const double radius = kCalibrationBall * longest_side(solid);
  Numbers numbers;
  std::vector<Cut> cuts(2 * kCalibrationCuts);
  for (std::size_t k = 0; k < cuts.size(); ++k) {
    const bool along_face = k % 2 == 1;
    const Vec3 normal = along_face ? faces.pick(numbers.uniform()) : numbers.direction();
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const Vec3& v : solid.vertices) {
      low = std::min(low, dot(normal, v));
      high = std::max(high, dot(normal, v));
    }
    const double depth = numbers.uniform();
    cuts[k].normal = normal;
    cuts[k].offset =
        along_face ? high - depth * depth * depth * (high - low) : low + depth * (high - low);
    if (k >= kCalibrationCuts) cuts[k].ball = {(cuts[k].offset - radius) * normal, radius};
  }
  return cuts;
}

double fraction_inside(const Level& level, const CellBlock& block, const Cut& plane) {
  double sum = 0;
  for (std::uint32_t k = block.begin; k < block.end; ++k) {
    const CellSample& s = level.samples[k];
    const double distance = dot(plane.normal, widen(s.center)) - plane.offset;
    bool is_cut = false;
    sum += weight_behind(BallShape<double>{s.radius}, plane.normal, distance, double{s.weight},
                         is_cut);
  }
  return sum;
}

double fraction_inside(const ToolModel& model, const Level& level, const CellClusters& clusters,
                       const Cut& cut) {
  double sum = 0;
  for (const CellCluster& cluster : clusters.clusters) {
    const bool is_planar = may_be_planar(cluster.reach, model.radius);
    const Cut of_plane = cut.plane_at(cluster.center, cluster.reach);
    for (std::uint32_t k = cluster.begin; k < cluster.end; ++k) {
      const std::uint32_t i = clusters.cells[k];
      for (std::uint32_t b = level.block_begin[i]; b < level.block_begin[i + 1]; ++b) {
        const CellBlock& block = level.blocks[b];
        sum += fraction_inside(level, block,
                               is_planar ? of_plane : cut.plane_at(widen(block.center), 0));
      }
    }
  }
  return sum;
}

LevelError summarise(std::vector<double> errors) {
  std::sort(errors.begin(), errors.end());
  LevelError all;
  for (const double error : errors) all.mean += error / static_cast<double>(errors.size());
  all.p95 = errors[static_cast<std::size_t>(kHigh * static_cast<double>(errors.size()))];
  all.worst = errors.back();
  return all;
}

}  // namespace

std::vector<LevelError> calibrate(const ToolModel& model, const Solid& solid) {
  if (content_hash(solid) != model.solid_hash) {
    refuse("the tool model was not made of this solid", {}, "calibrate it with its own packing");
  }
  Solid centered = solid;
  for (Vec3& v : centered.vertices) v -= model.center_of_mass;
  centered = enclosed_surface(centered);
  std::vector<Cut> cuts = make_cuts(centered);
  std::vector<CellClusters> clusters;
  for (const Level& level : model.levels) clusters.push_back(cluster_cells(model, level));
  std::vector<std::vector<double>> errors(model.levels.size(), std::vector<double>(cuts.size()));
  parallel_for(cuts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      Cut& cut = cuts[k];
      cut.truth = cut.ball.radius > 0 ? volume_in_ball(centered, cut.ball)
                                      : volume_below_plane(centered, cut.normal, cut.offset);
      for (std::size_t l = 0; l < model.levels.size(); ++l) {
        const double inside = fraction_inside(model, model.levels[l], clusters[l], cut);
        errors[l][k] = std::abs(inside - cut.truth / model.volume);
      }
    }
  });
  std::vector<LevelError> calibration;
  calibration.reserve(errors.size());
  for (std::vector<double>& of_level : errors)
    calibration.push_back(summarise(std::move(of_level)));
  return calibration;
}

}  // namespace vpm
