// Tool model: everything a query needs to know of the tool, for each level of detail. Specified in
// formats/tool-model.md.
//
// Coordinates are those of the mesh, in metres; volumes in m^3. Immutable after construction; safe
// to share between threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "libvpm/file/provenance.h"
#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm {

// Undirected graph of spheres in compressed rows; neighbours ascend, and no sphere neighbours
// itself.
struct SphereGraph {
  std::vector<std::uint32_t> begin;      // row offsets; spheres + 1 entries
  std::vector<std::uint32_t> neighbors;  // holds each edge in both directions
};

// Wrapped inner-sphere tree: a node's sphere encloses all packing spheres below it.
struct HierarchyNode {
  Sphere bound;
  // Children: nodes, or entries of `leaves` if children_are_leaves is 1.
  std::uint32_t begin = 0, end = 0;
  std::uint32_t children_are_leaves = 0;
  std::uint32_t reserved = 0;
};
struct Hierarchy {
  std::vector<HierarchyNode> nodes;   // root first; children follow their parent
  std::vector<std::uint32_t> leaves;  // sphere indices, each once
};

// Uniform grid over the bounding box of the spheres; lists the spheres that intersect each grid
// cell. x runs fastest.
struct PointLocationGrid {
  Vec3 low;         // corner of grid cell (0, 0, 0)
  double cell = 0;  // edge length of a grid cell, m
  std::uint32_t nx = 0, ny = 0, nz = 0;
  std::vector<std::uint32_t> begin;    // row offsets; nx*ny*nz + 1 entries
  std::vector<std::uint32_t> spheres;  // ascend within a grid cell
};

// The Voronoi cell of a sphere (additively weighted, clipped to the solid) is the set of points of
// the solid that are nearer to that sphere's surface than to any other's. Cells are cut into
// blocks, and blocks into samples: compact pieces with centroid, volume and size. Each run of
// kNeighborSamples samples, counted from a block's first, is a spatial cluster.
inline constexpr std::uint32_t kNeighborSamples = 4;
struct CellBlock {
  // Ball that encloses the block, relative to ToolModel::center_of_mass.
  Vec3f center;
  float radius = 0;
  std::uint32_t begin = 0, end = 0;  // range of samples
};
struct CellSample {
  Vec3f center;  // centroid, relative to ToolModel::center_of_mass
  // Radius of the ball with the same second moment: sqrt(5/3 * mean squared distance).
  float radius = 0;
  double weight = 0;  // volume of the piece / volume of the solid
};

// Shape of a sample that lies nearer to a face of the solid than its radius, so that the ball would
// stick out: two halves of ellipsoids about an axis, which meet at the sample's centre. It is right
// to second order like the ball, and stays within the solid. Lengths in metres.
struct SampleFace {
  std::uint32_t sample = 0;  // index
  Vec3f axis;                // unit vector from the centre to the nearest place of the surface
  float toward = 0;          // extent along the axis, at most `along`
  float away = 0;            // extent against it, at most `along`
  float along = 0;           // radius of the ball with the piece's variance along the axis
  float across = 0;          // extent across the axis
};
// Most of them in a level. A query keeps the number of a sample's lane in a float32 (SampleFaces),
// which is exact up to 2^24, and each face may need a row of four lanes.
inline constexpr std::size_t kMostFaces = std::size_t{1} << 22;
// Returns the largest variance along its axis, m^2, that such a shape may have: with more, its
// density would be negative in the middle.
inline double most_variance_at_face(double toward, double away) {
  const double near = toward < away ? toward : away, far = toward < away ? away : toward;
  return near * (near / 2 < far / 3 ? near / 2 : far / 3);
}

struct Level {
  double epsilon = 0;  // largest gap along an edge that is not a bridge, m
  std::uint32_t bridges = 0, components_before = 0;
  std::uint32_t sphere_count = 0;  // the level has the first sphere_count spheres
  SphereGraph graph;
  Hierarchy hierarchy;
  PointLocationGrid grid;
  // Volume of each cell, m^3; they sum to the solid's volume.
  std::vector<double> cell_volume;
  std::vector<Vec3> cell_centroid;
  // Largest distance of a cell's points from its sphere's centre, m.
  std::vector<double> cell_radius;
  // Row offsets: blocks of each cell; spheres + 1 entries.
  std::vector<std::uint32_t> block_begin;
  std::vector<CellBlock> blocks;
  std::vector<CellSample> samples;  // weights sum to 1
  std::vector<SampleFace> faces;    // ascending by sample; samples without one are balls
};

// Distribution of |volume - truth| / volume of the solid over cuts by planes and balls at all
// depths.
struct LevelError {
  double mean = 0, p95 = 0, worst = 0;
};

struct ToolModel {
  double volume = 0;       // volume of the solid, m^3
  Vec3 center_of_mass;     // centre of mass of the solid; blocks and samples are relative to it
  double radius = 0;       // largest distance of the solid from center_of_mass, m
  std::string solid_hash;  // content_hash of the solid
  std::vector<Sphere> spheres;          // largest first
  std::vector<Level> levels;            // at least one, ascending by sphere_count
  std::vector<LevelError> calibration;  // one entry per level, or empty if not measured
  // Closed triangles that bound the solid, each once, in the mesh's frame; empty if not kept.
  // Overlaps with other solids need them.
  Solid surface;
  file::Provenance provenance;

  // Returns the level with this many spheres, or the finest for 0. Throws Error(invalid_argument)
  // that lists the levels if there is none.
  const Level& level(std::uint32_t sphere_count) const;
};

// Returns why a surface is none of the tool whose volume, centre of mass and radius the model has;
// empty if it is one.
std::string defect_of_surface(const Solid& surface, const ToolModel& model);

// Throws Error(refused) if the model breaks a rule stated above; the message names the first
// defect. Queries of a valid model index without checks and always end. Reading and writing files
// call this.
void validate(const ToolModel& model, const std::string& name);

// Reads a tool model from a file, from standard input ("-"), or from bytes. Throws Error(refused)
// if it breaks a rule of formats/tool-model.md.
ToolModel read_tool_model(const std::string& path);
ToolModel parse_tool_model(std::vector<std::byte> bytes, const std::string& name);

// Reads the mesh that a tool model's file keeps for views; empty where it keeps none. No query
// needs it. Throws Error(refused) like read_tool_model.
Solid read_display_mesh(const std::string& path);

// Writes a tool model, and a mesh for views where there is one, atomically or to standard output
// ("-"). The mesh is kept in floats about the centre of mass. Throws Error(cannot_write).
void write_tool_model(const std::string& path, const ToolModel& model, const Solid& mesh = {});

}  // namespace vpm
