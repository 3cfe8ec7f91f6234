#include "libvpm/graph/voronoi_cells.h"

#include <algorithm>
#include <cmath>

#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"

namespace vpm {
namespace {

// Relative excess of the spheres' volume over the solid's that rounding explains.
constexpr double kVolumeTolerance = 1e-9;
constexpr std::size_t kGrain = 256;

// Neumaier's sum: many equal terms round the same way, and volumes must sum to 1e-12.
class CompensatedSum {
 public:
  void add(double term) {
    const double sum = sum_ + term;
    lost_ += std::abs(sum_) >= std::abs(term) ? (sum_ - sum) + term : (term - sum) + sum_;
    sum_ = sum;
  }
  double value() const { return sum_ + lost_; }

 private:
  double sum_ = 0, lost_ = 0;
};

// Scaled gap of one sphere, about its centre.
struct GapPart {
  double volume = 0;
  Vec3 moment;
};

GapPart gap_of(const VoronoiCells& cells, Vec3 center, std::size_t i) {
  GapPart part;
  CompensatedSum sum;
  for (const GapSegment& s : cells.gap.of(i)) {
    const double v = cells.gap_scale * cells.gap.volume(s);
    sum.add(v);
    part.moment += v * (s.center - center);
  }
  part.volume = sum.value();
  return part;
}

double bounding_radius_of(const VoronoiCells& cells, const Sphere& sphere, std::size_t i) {
  double radius = sphere.radius;
  for (const GapSegment& s : cells.gap.of(i)) {
    const Vec3 apart = s.center - sphere.center, half = cells.gap.half_extent(s);
    radius = std::max(radius, norm({std::abs(apart.x) + half.x, std::abs(apart.y) + half.y,
                                    std::abs(apart.z) + half.z}));
  }
  return radius;
}

Vec3 centroid_deficit(std::span<const Sphere> spheres, const MassProperties& mass,
                      const VoronoiCells& cells) {
  Vec3 deficit;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    deficit += cells.volume[i] * (mass.center_of_mass - cells.centroid[i]);
  }
  return deficit;
}

void sum_cells(std::span<const Sphere> spheres, VoronoiCells& cells) {
  parallel_for(spheres.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const GapPart part = gap_of(cells, spheres[i].center, i);
      cells.volume[i] = volume(spheres[i]) + part.volume;
      cells.centroid[i] = spheres[i].center + part.moment / cells.volume[i];
      cells.radius[i] = bounding_radius_of(cells, spheres[i], i);
    }
  });
}

}  // namespace

VoronoiCells find_voronoi_cells(const Solid& solid, const MassProperties& mass,
                                const SphereBvh& bvh, double spacing) {
  const std::span<const Sphere> spheres = bvh.spheres();
  CompensatedSum ball_sum;
  for (const Sphere& s : spheres) ball_sum.add(volume(s));
  const double balls = ball_sum.value();
  if (balls > mass.volume * (1 + kVolumeTolerance)) {
    refuse("the spheres hold " + std::to_string(balls / mass.volume) +
               " times the volume of the solid, so they overlap or leave it",
           {}, "pack the mesh again");
  }
  const double gap_volume = std::max(0.0, mass.volume - balls);

  VoronoiCells cells{find_gap_segments(solid, bvh, spacing), 0, {}, {}, {}, {}};
  CompensatedSum sampled_sum;
  for (const GapSegment& s : cells.gap.segments) sampled_sum.add(cells.gap.volume(s));
  const double sampled = sampled_sum.value();
  if (!(sampled > 0) && gap_volume > kVolumeTolerance * mass.volume) {
    refuse("no point was found between the spheres and the surface of the solid, although " +
               std::to_string(100 * gap_volume / mass.volume) + " % of it lies there",
           {}, "is it turned inside out? pack the mesh again");
  }
  cells.gap_scale = sampled > 0 ? gap_volume / sampled : 0;

  cells.volume.resize(spheres.size());
  cells.centroid.resize(spheres.size());
  cells.radius.resize(spheres.size());
  sum_cells(spheres, cells);
  const Vec3 deficit = centroid_deficit(spheres, mass, cells);
  cells.quality.gap_fraction = gap_volume / mass.volume;
  cells.quality.volume_error = (sampled - gap_volume) / mass.volume;
  cells.quality.centroid_error = norm(deficit) / mass.volume / std::cbrt(mass.volume);
  // Shifts the gap so that the first moment is exact. The shift corrects sampling error and is
  // shorter than a segment, unless `mass` belongs to another solid; then it is left out.
  const Vec3 shift = gap_volume > 0 ? deficit / gap_volume : Vec3{};
  if (norm(shift) < spacing) {
    for (GapSegment& s : cells.gap.segments) s.center += shift;
    sum_cells(spheres, cells);
  }
  double sum = 0;
  for (const double v : cells.volume) sum += v;
  cells.quality.volume_sum_error = std::abs(sum - mass.volume) / mass.volume;
  return cells;
}

}  // namespace vpm
