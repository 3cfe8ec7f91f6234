// The room that is left in a solid: an octree of cells with upper bounds of the clearance, in
// blocks that know the spheres around them.
//
// The clearance d(x) = min(distance to the mesh, min_i |x - c_i| - r_i) changes by at most |x - y|
// between two points, so d(centre) + half diagonal bounds it over a cell. A cell that cannot hold a
// sphere of the radius looked for sleeps; the others are cut finer until their size is a fraction
// of that radius. No resolution is fixed beforehand: thin parts cost cells only where they are.
//
// Cells are grouped in blocks, the cubes of one octree level (2 to 4 times as wide as the radius
// looked for). A block lists every sphere within reach of it, so that a clearance costs one lookup.
#pragma once

#include <cstdint>
#include <vector>

#include "libvpm/model/sphere.h"
#include "libvpm/packing/block_index.h"
#include "libvpm/packing/clearance.h"
#include "libvpm/packing/max_min_step.h"
#include "libvpm/packing/solid_distance.h"

namespace vpm {

class Space {
 public:
  // Nothing smaller than `smallest` (> 0) will be looked for. Of more than `most_blocks` those with
  // the least room are left out. Keeps a reference to `solid`. Frame: the unit cube of `solid`.
  Space(const SolidDistance& solid, double smallest, std::size_t most_blocks);

  // No sphere larger than this fits anywhere, up to what local searches have missed and what was
  // left out.
  float bound() const;

  bool left_out() const { return left_out_; }  // some blocks

  // Prepares for searches of radius `radius` and above: blocks are cut to its size. Radii must not
  // grow from call to call.
  void focus(double radius);

  float bound(std::uint32_t block) const { return bounds_[block]; }

  // Blocks that may still hold a sphere of this radius, ascending.
  std::vector<std::uint32_t> promising(double radius) const;
  bool is_promising(std::uint32_t block, double radius) const { return bounds_[block] >= radius; }

  // Appends local maxima of the clearance above the block with at least `radius`, cut to `cap`;
  // they may overlap. The block stays promising while one of them may still be placed. Changes only
  // what belongs to the block, so that different blocks may be searched in parallel.
  void search(std::uint32_t number, double radius, double cap, std::vector<Sphere>& found);

  // Clearance of a point in the solid where it is below `within`. kind == none and value == the
  // smaller of `within` and the reach where nothing is nearer; value < 0 where no room is left
  // around the point.
  Clearance clearance(Vec3 x, double within = 2) const;

  // Takes a sphere out of the room; appends the blocks around it to `touched`. Clearances know of
  // it from now on, bounds and searches once the blocks are updated.
  void place(const Sphere& sphere, std::vector<std::uint32_t>& touched);
  void update(const std::vector<std::uint32_t>& blocks);  // all different

  Vec3 closest_on_triangle(std::uint32_t triangle, Vec3 x) const {
    return solid_.closest_on(triangle, x);
  }
  const std::vector<Sphere>& spheres() const { return spheres_; }

 private:
  enum class Side : std::uint8_t { unknown, inside, outside };
  struct Cell {
    float x, y, z;       // centre: exact, a multiple of 2^-24
    float d;             // at least the clearance of the centre were it inside
    float mesh;          // the mesh is at least this far from the centre
    float bound;         // no larger sphere is centred in the cell
    std::uint8_t level;  // edge length 2^-level
    Side side;           // of the centre
    Side parent;         // of the centre of the cell that this one was cut from
    bool measured;       // d is exact, up to the reach
    bool exact;          // `triangle` is nearest to the centre; otherwise it was to a parent's
    bool thick;          // holds no thin part: see thin_part.h
    std::uint32_t triangle;
    Vec3 center() const { return {x, y, z}; }
  };
  struct Block {
    std::vector<std::uint32_t> spheres;
    std::size_t taken = 0;  // so many of them are known to cells and maxima
    std::vector<Cell> cells;
    std::vector<Sphere> maxima;  // local maxima met by searches of a larger radius
  };

  void split_blocks();
  void leave_out(std::vector<BlockIndex::Coordinates>& coordinates);
  void split(const Cell& cell, const std::vector<std::uint32_t>& near,
             std::vector<Cell>& parts) const;
  SurfacePoint nearest_on_mesh(const Cell& cell, double within) const;
  void estimate(Cell& cell, const std::vector<std::uint32_t>& near) const;
  void measure(Cell& cell) const;
  void bound_thin_part(Cell& cell) const;
  void refine(const Block& block, double radius, double cap, std::vector<Cell>& leaves,
              std::vector<Cell>& rest) const;
  double local_maximum(Block& block, const Cell& leaf, double radius, double cap) const;
  double joint_bound(Cell& cell, const std::vector<std::uint32_t>& near,
                     std::vector<LinearBound>& bounds) const;
  Side side_of(const Cell& cell, const std::vector<std::uint32_t>& near) const;
  static void settle(Cell& cell, Side side);
  static double farthest(const Cell& cell, const Sphere& from);
  void take_from(Block& block, const Sphere& sphere) const;
  static float block_bound(const Block& block);

  const SolidDistance& solid_;
  float smallest_;
  std::size_t most_blocks_;
  bool left_out_ = false;
  std::vector<Sphere> spheres_;
  int level_ = 0;     // of the blocks
  double reach_ = 2;  // clearances in a block are exact up to this; the cube's diagonal is shorter
  BlockIndex index_;
  std::vector<Block> blocks_;
  std::vector<float> bounds_;  // largest cell bound per block
};

}  // namespace vpm
