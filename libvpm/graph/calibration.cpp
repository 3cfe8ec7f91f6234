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
#include "libvpm/scene/depth/depth_sampler.h"
#include "libvpm/scene/mean_plane.h"

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

// Cut of the solid, about its centre of mass: the part of it below a plane, or in a ball.
struct Cut {
  TangentPlane plane;
  Sphere ball;  // radius 0 if the cut is by the plane
  double truth = 0;

  bool is_by_plane() const { return !(ball.radius > 0); }
  // Samples the cutting surface as a query does that of a body.
  SurfaceSample sample(Vec3 x) const {
    if (is_by_plane()) return {true, plane.distance(x), plane.normal, plane.foot};
    const Vec3 from_center = x - ball.center, away = normalized_or_zero(from_center);
    return {true, norm(from_center) - ball.radius, away, ball.center + ball.radius * away};
  }
  // Returns the plane that a query takes for a block about x: the tangent plane.
  TangentPlane plane_of_block(Vec3 x) const {
    if (is_by_plane()) return plane;
    const SurfaceSample on_surface = sample(x);
    return {on_surface.normal, on_surface.foot};
  }
  // Finds the plane that a query takes for a planar cluster about x. Returns false if it takes
  // those of blocks instead.
  bool find_plane(Vec3 x, double radius, TangentPlane& mean) const {
    mean = plane;
    return is_by_plane() ||
           mean_of_five(*this, x, radius, DepthSampler::kSmoothCosine, SampleInTurn{}, mean);
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
    const double offset =
        along_face ? high - depth * depth * depth * (high - low) : low + depth * (high - low);
    cuts[k].plane = {normal, offset * normal};
    if (k >= kCalibrationCuts) cuts[k].ball = {(offset - radius) * normal, radius};
  }
  return cuts;
}

double fraction_inside(const NumberedSamples& numbered, const CellBlock& block,
                       const TangentPlane& plane) {
  double sum = 0;
  for (std::uint32_t k = block.begin; k < block.end; ++k) {
    const CellSample& s = numbered.samples[k];
    bool is_cut = false;
    sum += weight_behind(shape_of(s, numbered.faces()), plane.normal,
                         plane.distance(widen(s.center)), double{s.weight}, is_cut);
  }
  return sum;
}

double fraction_inside(const ToolModel& model, const Level& level, const CellClusters& clusters,
                       const NumberedSamples& numbered, const Cut& cut) {
  double sum = 0;
  for (const CellCluster& cluster : clusters.clusters) {
    TangentPlane mean;
    const bool is_planar = may_be_planar(cluster.radius, model.radius) &&
                           cut.find_plane(cluster.center, cluster.radius, mean);
    for (std::uint32_t k = cluster.begin; k < cluster.end; ++k) {
      const std::uint32_t i = clusters.cells[k];
      for (std::uint32_t b = level.block_begin[i]; b < level.block_begin[i + 1]; ++b) {
        const CellBlock& block = level.blocks[b];
        sum += fraction_inside(numbered, block,
                               is_planar ? mean : cut.plane_of_block(widen(block.center)));
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
  std::vector<NumberedSamples> samples;
  for (const Level& level : model.levels) {
    clusters.push_back(cluster_cells(model, level));
    samples.push_back(numbered_samples(level));
  }
  std::vector<std::vector<double>> errors(model.levels.size(), std::vector<double>(cuts.size()));
  parallel_for(cuts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      Cut& cut = cuts[k];
      const Vec3 normal = cut.plane.normal;
      cut.truth = cut.is_by_plane()
                      ? volume_below_plane(centered, normal, dot(normal, cut.plane.foot))
                      : volume_in_ball(centered, cut.ball);
      for (std::size_t l = 0; l < model.levels.size(); ++l) {
        const double inside = fraction_inside(model, model.levels[l], clusters[l], samples[l], cut);
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
