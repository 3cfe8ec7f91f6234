#include "libvpm/backend/cpu/volume_variance.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "libvpm/backend/cpu/cell_samples.h"
#include "libvpm/measure/contact_patch.h"
#include "libvpm/scene/mean_plane.h"
#include "libvpm/scene/points/disk_windows.h"
#include "libvpm/scene/surface_noise.h"

namespace vpm {
namespace {

// Deviations, measured by `vpm-bench accuracy`, and by `vpm-bench intervals` for edges, where the
// truth is known (measure/README.md):
// by how much a cut sample errs, in parts of its volume, since it is no ball;
constexpr double kOfSample = 0.031;
// by how much the surface lies off the planes of blocks, of what its mean height over each differs
// from the plane: by itself in each block, and where all blocks are curved alike;
constexpr double kOfPlane = 0.8, kOfPlanes = 0.8;
// by how much that mean height errs, which is of five places, in parts of how far the surface bends
// off its tangent plane in a block;
constexpr double kOfBend = 0.125;
// and by how much the cross-section of an edge errs between points, which do not lie on it, and
// which noise moves across it, in squares of their sampling radius.
constexpr double kOfEdge = 0.25;
// Most, in radii of a block, by which that mean height may be off the tangent plane: it is .1 in a
// ball as small as the block, and noise adds to it; beyond there is an edge, which has no mean
// plane.
constexpr double kMostBend = 0.4;

// Sums over the blocks of cut cells, which the surface cuts as a plane nearly.
template <class Surface>
class VarianceSum {
 public:
  VarianceSum(const PoseWork<Surface>& work, const ToolModel& tool)
      : work_(work), tool_volume_(tool.volume), noise_(work.surface) {}

  bool tells() const { return noise_.tells(); }
  void add_cell(std::uint32_t row) {
    const CellView cell = work_.level.cell(row);
    for (std::uint32_t b = cell.begin; b < cell.end; ++b) add_block(cell, cell.blocks[b]);
  }
  // Returns the variance, in squares of the tool's volume.
  double variance() const {
    const double planes = kOfPlanes * off_planes_, bend = kOfBend * bend_, edge = kOfEdge * edge_;
    const double of_surface = noise_.variance() + kOfPlane * kOfPlane * squared_off_planes_ +
                              planes * planes + bend * bend + edge * edge;
    const double per_volume = 1 / tool_volume_;
    return of_surface * per_volume * per_volume + kOfSample * kOfSample * squared_weights_;
  }

 private:
  void add_block(const CellView& cell, const CellBlock& block) {
    const Vec3 center = work_.to_surface * widen(block.center);
    const SurfaceSample at = work_.surface.sample(center);
    if (!at.known || !(std::fabs(at.distance) < double{block.radius})) return;
    const double area = add_noise(cell, block, at);
    if (!(area > 0)) return;
    // The other side of a plate or slot errs by itself.
    if constexpr (requires { work_.surface.other_side(at); })
      if (const std::optional<TangentPlane> back = work_.surface.other_side(at))
        add_noise(cell, block, {true, back->distance(center), back->normal, back->foot, at.point});
    TangentPlane mean;
    if (!mean_of_five(work_.surface, center, double{block.radius}, kAreDisks ? kAlike : 0,
                      SampleTogether{}, mean)) {
      if constexpr (kAreDisks) add_edge(at.point, area / block.radius);
      return;
    }
    const double bend = dot(at.normal, mean.foot - at.foot);
    if (!(std::fabs(bend) <= kMostBend * double{block.radius})) return;
    bend_ += area * bend;
    const auto classified = work_.measure_of(cell).classify_block(block);
    if (classified.found != BlockClass::cut) return;
    const double off = area * -classified.plane.distance(mean.foot);
    off_planes_ += off;
    squared_off_planes_ += off * off;
  }
  // Adds the error of an edge of this length, m, near a point. All edges are taken to err alike.
  void add_edge(std::uint32_t point, double length) {
    const double radius = work_.surface.radii.of_points[point];  // its sampling radius, m
    edge_ += radius * radius * length;
  }
  // Adds the noise of the surface where its plane at a sample cuts a block. Returns that area, m^2.
  double add_noise(const CellView& cell, const CellBlock& block, const SurfaceSample& at) {
    const double area = area_of(cell, block, {{at.normal, at.foot}, work_.to_surface});
    if (area > 0) noise_.add(at, area);
    return area;
  }
  // Returns the area, m^2, in which a plane cuts a block's samples, and notes these.
  double area_of(const CellView& cell, const CellBlock& block, const ClipPlane& plane) {
    double area = 0;  // in parts of the tool's volume, 1/m
    for (std::uint32_t k = block.begin; k < block.end; ++k) {
      const ToolPiece sample = piece_of(cell.samples[k], cell.faces);
      const double distance = plane.distance(sample.at);
      if (side_of_piece(sample.shape, distance, plane.normal) != PlaneSide::cut) continue;
      area += sample.weight * sample.shape.section_of_cut(distance, plane.normal);
      squared_weights_ += sample.weight * sample.weight;
    }
    return tool_volume_ * area;
  }

  static constexpr bool kAreDisks = std::is_same_v<Surface, DiskSurface>;

  const PoseWork<Surface>& work_;
  double tool_volume_;  // m^3
  NoiseSum<Surface> noise_;
  double off_planes_ = 0, squared_off_planes_ = 0;  // m^3, m^6
  double bend_ = 0, edge_ = 0;                      // m^3
  double squared_weights_ = 0;                      // of cut samples, in squares of the tool
};

template <class Surface>
std::optional<double> variance_of(const PoseWork<Surface>& work, const ToolModel& tool) {
  VarianceSum<Surface> sum(work, tool);
  if (!sum.tells()) return std::nullopt;
  for (const std::uint32_t row : work.states.cut) sum.add_cell(row);
  return sum.variance();
}

}  // namespace

std::optional<double> volume_variance(const PoseWork<DepthSurface>& work, const ToolModel& tool) {
  return variance_of(work, tool);
}
std::optional<double> volume_variance(const PoseWork<DiskSurface>& work, const ToolModel& tool) {
  return variance_of(work, tool);
}
std::optional<double> volume_variance(const PoseWork<RigSurface>& work, const ToolModel& tool) {
  return variance_of(work, tool);
}

}  // namespace vpm
