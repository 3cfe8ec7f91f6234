// Room left in a solid: an octree of cells with upper bounds of the clearance (cell_room.h),
// grouped in blocks that know the spheres around them.
//
// Cells that cannot hold a sphere of the sought radius rest; others are cut until their size is a
// fraction of that radius. No resolution is fixed beforehand, so thin parts cost cells only where
// they are.
//
// Blocks are the leaves of a coarser octree. Those that may hold a sphere of the sought radius are
// 2 to 4 times as wide as it; others rest as they are, whatever their width: the shell between a
// sphere and the faces around it would be billions of blocks. Each lists all spheres within its
// list distance, so that a clearance costs one lookup.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/core/vec3.h"
#include "libvpm/model/sphere.h"
#include "libvpm/packing/block_tree.h"
#include "libvpm/packing/cell_room.h"
#include "libvpm/packing/solid_distance.h"

namespace vpm {

// Triangle of the mesh, or sphere placed so far, by index.
struct Obstacle {
  enum class Kind : std::uint8_t { none, triangle, sphere };
  Kind kind = Kind::none;
  std::uint32_t index = 0;
  friend constexpr bool operator==(const Obstacle&, const Obstacle&) = default;
};

// SeparationBound of a point: radius of the largest sphere about it inside the solid and outside
// the spheres placed so far, with the obstacle that limits it.
struct SeparationBound {
  double value = 0;
  Obstacle nearest;
  // Unit vector from the nearest point of the obstacle; zero if there is none.
  Vec3 away;
};

class Space {
 public:
  // Prepares the cube of `solid` for radii of at least `smallest` (> 0). If there are more than
  // `most_blocks` blocks, those with the least room are left out. Keeps a reference to `solid`. All
  // coordinates are in its unit frame.
  Space(const SolidDistance& solid, double smallest, std::size_t most_blocks);
  ~Space();  // by all threads: a million spheres have some three million blocks
  Space(const Space&) = delete;
  Space& operator=(const Space&) = delete;

  // Returns an upper bound on the radius of spheres that fit anywhere, except in blocks left out
  // and where local searches missed a maximum.
  float bound() const;

  // Returns an upper bound on the radius of spheres that fit in blocks left out; 0 if none were.
  float left_out() const { return left_out_; }

  // Prepares for searches of at least `radius`: returns blocks, ascending, that may still hold such
  // a sphere, and cuts them to its size. None are left if it returns none. Of more than `most` it
  // takes those with the most room, of equal ones some spread over the solid: a plate has millions.
  // Radii must not grow from call to call.
  std::vector<std::uint32_t> focus(double radius, std::size_t most);
  bool is_promising(std::uint32_t block, double radius) const { return bounds_[block] >= radius; }

  // Appends local maxima of the clearance above the block with at least `radius`, cut to `cap`;
  // they may overlap. Stops when it has ascended to `most` such maxima. The block stays promising
  // while one of them may still be placed, or while a part of it is not searched. Changes only the
  // block's own data, so that different blocks may be searched in parallel.
  void search(std::uint32_t number, double radius, double cap, std::size_t most,
              std::vector<Sphere>& found);

  // Returns the clearance of a point in the solid if it is below `within`. Otherwise kind is none
  // and the value is at most `within`, less where the block lists no farther spheres. The value is
  // negative if the point has no room.
  SeparationBound separation(Vec3 x, double within = 2) const;

  // Places spheres and returns the blocks around them, ascending, that may be searched. Clearances
  // know them at once, bounds and searches after update() of these; others take them in focus().
  std::vector<std::uint32_t> place(std::span<const Sphere> spheres);
  void update(const std::vector<std::uint32_t>& blocks);  // needs distinct blocks

  Vec3 closest_on_triangle(std::uint32_t triangle, Vec3 x) const {
    return solid_.closest_on(triangle, x);
  }
  const std::vector<Sphere>& spheres() const { return spheres_; }

 private:
  using Cell = CellRoom::Cell;
  using Side = CellRoom::Side;
  struct Block {
    ListedSpheres listed;   // clearances are exact up to its distance
    std::size_t taken = 0;  // number of spheres known to cells and maxima
    std::vector<Cell> cells = {};
    // Local maxima found by searches of a larger radius.
    std::vector<Sphere> maxima = {};
  };
  // Eighths of a block.
  struct Parts {
    std::vector<Block> blocks;
    unsigned kept = 0;  // a bit for each eighth that is in `blocks`, in their order
  };

  // Lists of a search.
  struct Scratch {
    std::vector<Cell> leaves, rest, pending;
    std::vector<LinearBound> planes;
  };

  std::vector<std::uint32_t> promising(double radius) const;
  bool is_cut(std::uint32_t block) const;
  std::vector<std::uint32_t> blocks_around(const Sphere& sphere) const;
  void keep_most_room(std::vector<std::uint32_t>& blocks, std::size_t most) const;
  std::vector<std::uint32_t> split_blocks(const std::vector<std::uint32_t>& wide);
  Parts split_block(std::uint32_t number);
  void split_cells(Block& block, int level, std::vector<Cell>& cells) const;
  void leave_out();
  void keep(const std::vector<std::uint32_t>& blocks);
  void refine(Block& block, double radius, double cap, Scratch& scratch) const;
  double local_maximum(Block& block, const Cell& leaf, double radius, double cap) const;
  void take_new(Block& block) const;
  static float block_bound(const Block& block);

  const SolidDistance& solid_;
  float smallest_;
  std::size_t most_blocks_;
  float left_out_ = 0;
  double focus_ = HUGE_VAL;  // radius last searched for
  std::vector<Sphere> spheres_;
  CellRoom room_;
  BlockTree tree_;
  std::vector<Block> blocks_;
  std::vector<float> bounds_;  // largest cell bound of each block
};

}  // namespace vpm
