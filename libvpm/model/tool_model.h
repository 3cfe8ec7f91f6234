// A tool model: everything a query needs of the tool, for each level of detail.
// formats/tool-model.md.
//
// Frame: the mesh's own coordinates. Units: metres, m^3. Immutable after construction; safe to
// share between threads.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "libvpm/model/sphere.h"

namespace vpm {

// Undirected sphere graph in compressed rows; neighbours ascend, and no sphere is its own
// neighbour.
struct SphereGraph {
  std::vector<std::uint32_t> begin;      // spheres + 1
  std::vector<std::uint32_t> neighbors;  // both directions of every edge
};

// Wrapped inner-sphere tree: the sphere of a node encloses every packing sphere below it.
struct HierarchyNode {
  Sphere bound;
  std::uint32_t begin = 0, end = 0;  // children: nodes, or entries of `leaves`
  std::uint32_t children_are_leaves = 0;
  std::uint32_t reserved = 0;
};
struct Hierarchy {
  std::vector<HierarchyNode> nodes;   // nodes[0] is the root; children follow their parent
  std::vector<std::uint32_t> leaves;  // sphere indices
};

// Uniform grid over the box of the spheres: which spheres meet a cell. x runs fastest.
struct PointLocationGrid {
  Vec3 low;         // corner of cell (0, 0, 0)
  double cell = 0;  // edge length
  std::uint32_t nx = 0, ny = 0, nz = 0;
  std::vector<std::uint32_t> begin;    // nx*ny*nz + 1
  std::vector<std::uint32_t> spheres;  // ascending within a cell
};

// The volume share of a sphere: all points of the solid whose nearest sphere surface is this one's.
// A cell is cut into blocks and a block into samples: compact pieces of the share, each known by
// its centroid, volume and size. Samples that follow one another in a block, kNeighborSamples from
// its first one on and so forth, lie side by side.
inline constexpr std::uint32_t kNeighborSamples = 4;
struct CellBlock {
  Vec3f center;  // of a ball that encloses the block's part of the share, about
                 // ToolModel::center_of_mass
  float radius = 0;
  std::uint32_t begin = 0, end = 0;  // samples
};
struct CellSample {
  Vec3f center;  // centroid of the piece, about ToolModel::center_of_mass
  float radius =
      0;  // of the ball with the piece's second moment: sqrt(5/3 * mean squared distance)
  double weight = 0;  // volume of the piece / volume of the solid
};

struct Level {
  double epsilon = 0;  // largest gap of an edge that is not a bridge, m
  std::uint32_t bridges = 0, components_before = 0;
  std::uint32_t sphere_count = 0;  // the first sphere_count spheres of the model
  SphereGraph graph;
  Hierarchy hierarchy;
  PointLocationGrid grid;
  std::vector<double> share_volume;  // m^3; sums to the solid's volume
  std::vector<Vec3> share_centroid;
  std::vector<double>
      share_reach;  // largest distance of the share's points from the sphere's centre
  std::vector<std::uint32_t> block_begin;  // spheres + 1: blocks of each sphere's cell
  std::vector<CellBlock> blocks;
  std::vector<CellSample> samples;  // weights sum to 1
};

// |volume - truth| / volume of the solid, over cuts by planes and balls at all depths.
struct LevelError {
  double mean = 0, p95 = 0, worst = 0;
};

struct ToolModel {
  double volume = 0;            // of the solid
  Vec3 center_of_mass;          // of the solid; blocks and samples are stored about it
  double reach = 0;             // largest distance of a point of the solid from center_of_mass
  std::string solid_hash;       // content_hash of the solid
  std::vector<Sphere> spheres;  // largest first
  std::vector<Level> levels;    // ascending sphere_count, at least one
  std::vector<LevelError> calibration;  // of each level; empty where it has not been measured
  nlohmann::json provenance;

  // The level with this many spheres; the finest for 0. Throws Error(usage) listing the levels
  // there are.
  const Level& level(std::uint32_t sphere_count) const;
};

// Refuses (Error(refused)) a model that breaks a promise of the types above, naming the first
// defect: a query may index without asking and is certain to end. Reading and writing a file check
// this too.
void validate(const ToolModel& model, const std::string& name);

}  // namespace vpm
