#include "libvpm/graph/build_tool_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/graph/cell_pieces.h"
#include "libvpm/graph/hierarchy.h"
#include "libvpm/graph/point_location_grid.h"
#include "libvpm/graph/sphere_graph.h"
#include "libvpm/mesh/outer_surface.h"
#include "libvpm/mesh/topology.h"
#include "libvpm/mesh/weld.h"

namespace vpm {
namespace {

constexpr double kEpsilonPart = 0.1;  // part of the smallest radius, as in the paper
// Number of segments of the gap: enough for the cell of a single sphere, and for the whole at few
// spheres.
constexpr double kPiecesPerSphere = 1000, kMinPieces = 2e6, kMaxPieces = 3e7;

// Normalised coordinates: magnitude 1 about the solid's centre. The unit is a power of two, so that
// scaling a packing by one changes no digit.
struct Frame {
  Vec3 origin;
  double unit = 1;
  Vec3 to(Vec3 p) const { return (p - origin) / unit; }
  Vec3 from(Vec3 p) const { return origin + unit * p; }
  double cubed() const { return unit * unit * unit; }
};

Frame frame_of(const Solid& solid) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3 low{kInfinity, kInfinity, kInfinity}, high = -low;
  for (const Vec3& v : solid.vertices) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  const Vec3 extent = high - low;
  return {low + 0.5 * extent,
          std::ldexp(1.0, std::ilogb(std::max({extent.x, extent.y, extent.z})))};
}

struct Normalized {
  Frame frame;
  Solid solid, boundary;
  MassProperties mass;
  std::vector<Sphere> spheres;
};

Normalized normalize(const Packing& packing, const Solid& boundary, const MassProperties& mass) {
  Normalized n{frame_of(packing.solid), packing.solid, boundary, mass, packing.spheres};
  for (Solid* const solid : {&n.solid, &n.boundary})
    for (Vec3& v : solid->vertices) v = n.frame.to(v);
  for (Sphere& s : n.spheres) s = {n.frame.to(s.center), s.radius / n.frame.unit};
  n.mass = {mass.volume / n.frame.cubed(), n.frame.to(mass.center_of_mass)};
  return n;
}

// Returns the number of edges that a triangle has in one direction and none in the other.
std::size_t count_open_edges(const Solid& solid) {
  std::size_t open = 0;
  for_edges(sorted_sides(solid.vertices.size(), solid.triangles),
            [&](std::span<const TriangleSide> sides) {
              std::int64_t balance = 0;
              for (const TriangleSide& side : sides) balance += side.forward ? 1 : -1;
              open += static_cast<std::size_t>(std::abs(balance));
            });
  return open;
}

void check(const Packing& packing, const GraphOptions& options) {
  if (packing.spheres.empty()) refuse("the packing has no spheres", {}, "pack the mesh again");
  if (const std::size_t open = count_open_edges(packing.solid))
    refuse("the packing's solid is open: " + std::to_string(open) +
               " edges belong to triangles on one side only",
           {}, "pack the mesh again");
  double before = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < packing.spheres.size(); ++i) {
    const Sphere& s = packing.spheres[i];
    if (!is_finite(s.center) || !(s.radius > 0) || !(s.radius <= before) ||
        !std::isfinite(s.radius)) {
      refuse("sphere " + std::to_string(i) +
                 " of the packing is not finite, or larger than the one before it",
             {}, "pack the mesh again");
    }
    before = s.radius;
  }
  if (!(options.epsilon >= 0) || !std::isfinite(options.epsilon)) {
    throw Error(ErrorKind::invalid_argument, "epsilon must be a positive length in metres");
  }
  if (std::count(options.levels.begin(), options.levels.end(), 0u) > 0) {
    throw Error(ErrorKind::invalid_argument, "a level needs at least one sphere");
  }
}

// Returns the levels' sphere counts, ascending and distinct, none above the whole packing, which is
// the last.
std::vector<std::uint32_t> level_counts(const GraphOptions& options, std::uint32_t spheres) {
  std::vector<std::uint32_t> counts = options.levels;
  for (std::uint32_t& count : counts) count = std::min(count, spheres);
  counts.push_back(spheres);
  std::sort(counts.begin(), counts.end());
  counts.erase(std::unique(counts.begin(), counts.end()), counts.end());
  return counts;
}

void fill_graph(const SphereBvh& bvh, const Frame& frame, Level& level) {
  const SphereGraph edges = epsilon_edges(bvh, level.epsilon / frame.unit);
  std::vector<std::uint32_t> component;
  level.components_before = connected_components(edges, component);
  const std::vector<SpherePair> bridges = shortest_bridges(bvh, edges);
  level.bridges = static_cast<std::uint32_t>(bridges.size());
  level.graph = with_edges(edges, bridges);
}

VoronoiQuality fill_cells(const Normalized& n, const SolidFaces& faces, const SphereBvh& bvh,
                          Level& level) {
  const double pieces = std::clamp(kPiecesPerSphere * level.sphere_count, kMinPieces, kMaxPieces);
  VoronoiCells cells = find_voronoi_cells(n.solid, n.mass, bvh, std::cbrt(n.mass.volume / pieces));
  for (std::size_t i = 0; i < level.sphere_count; ++i) {
    level.cell_volume.push_back(n.frame.cubed() * cells.volume[i]);
    level.cell_centroid.push_back(n.frame.from(cells.centroid[i]));
    level.cell_radius.push_back(n.frame.unit * cells.radius[i]);
  }
  const double size = std::cbrt(n.mass.volume) / samples_per_length(level.sphere_count);
  CutCells all = cut_cells(bvh.spheres(), cells, faces, size, n.mass.center_of_mass, n.frame.unit,
                           n.mass.volume);
  level.block_begin = std::move(all.block_begin);
  level.blocks = std::move(all.blocks);
  level.samples = std::move(all.samples);
  // Balls that are so many are so small that they hardly stick out.
  if (all.faces.size() <= kMostFaces) level.faces = std::move(all.faces);
  return cells.quality;
}

// Keeps the boundary with equal vertices joined. Leaves it out where its pieces do not close, as of
// some meshes that cross themselves.
void keep_surface(Solid boundary, ToolModel& model) {
  weld(boundary.vertices, 0, boundary.triangles);
  drop_unused(boundary.vertices, boundary.triangles);
  if (defect_of_surface(boundary, model).empty()) model.surface = std::move(boundary);
}

}  // namespace

double samples_per_length(std::uint32_t spheres) {
  constexpr double kSpheresOfFinest = 1000;
  return std::clamp(kMaxSamplesPerLength * std::cbrt(spheres / kSpheresOfFinest),
                    kMinSamplesPerLength, kMaxSamplesPerLength);
}

ToolModel build_tool_model(const Packing& packing, const GraphOptions& options,
                           std::vector<VoronoiQuality>* quality) {
  check(packing, options);
  const Solid boundary = packing.is_boundary ? packing.solid : enclosed_surface(packing.solid);
  const MassProperties mass = mass_properties(boundary);
  if (!(mass.volume > 0)) refuse("the packing's solid has no volume", {}, "pack the mesh again");
  const Normalized n = normalize(packing, boundary, mass);

  ToolModel model;
  model.volume = mass.volume;
  model.center_of_mass = mass.center_of_mass;
  model.radius = bounding_radius(packing.solid, mass.center_of_mass);
  model.solid_hash = content_hash(packing.solid);
  model.spheres = packing.spheres;
  if (options.surface) keep_surface(boundary, model);
  const SolidFaces faces(n.boundary, model.radius / n.frame.unit);
  const auto counts = level_counts(options, static_cast<std::uint32_t>(packing.spheres.size()));
  for (const std::uint32_t count : counts) {
    Level level;
    level.sphere_count = count;
    level.epsilon =
        options.epsilon > 0 ? options.epsilon : kEpsilonPart * packing.spheres[count - 1].radius;
    const SphereBvh bvh(std::span(n.spheres).first(count));
    const std::span<const Sphere> spheres = std::span(packing.spheres).first(count);
    fill_graph(bvh, n.frame, level);
    level.hierarchy = build_hierarchy(spheres);
    level.grid = build_point_location_grid(spheres);
    const VoronoiQuality found = fill_cells(n, faces, bvh, level);
    if (quality != nullptr) quality->push_back(found);
    model.levels.push_back(std::move(level));
    if (options.progress) {
      options.progress(static_cast<double>(model.levels.size()) /
                       static_cast<double>(counts.size()));
    }
  }
  return model;
}

}  // namespace vpm
