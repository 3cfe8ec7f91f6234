// Octree over the unit cube whose leaves are numbered blocks of any size.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "libvpm/core/vec3.h"

namespace vpm {

// Returns 2^-level from its bits; std::ldexp would be a call for every cell.
inline double edge_of_level(int level) {
  constexpr int kBias = 1023, kFraction = 52;
  return std::bit_cast<double>(static_cast<std::uint64_t>(kBias - level) << kFraction);
}

// Returns half the diagonal of a cube whose edge is 2^-level; sqrt(3) / 2 is rounded up.
inline float half_diagonal(int level) {
  return static_cast<float>(0.866025404 * edge_of_level(level));
}

class BlockTree {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  static constexpr int kMaxLevel = 20;  // coordinates have 21 bits
  // Cube with edge length 2^-level, whose low corner is (x, y, z) times that.
  struct Cube {
    std::uint32_t x = 0, y = 0, z = 0;
    int level = 0;

    Vec3 center() const { return edge_of_level(level) * Vec3{x + 0.5, y + 0.5, z + 0.5}; }
    // Returns an eighth. Bits 0, 1 and 2 of `octant` choose its upper half along x, y and z.
    Cube part(unsigned octant) const {
      return {2 * x + (octant & 1), 2 * y + ((octant >> 1) & 1), 2 * z + (octant >> 2), level + 1};
    }
    // Returns a number that spreads cubes of a level evenly over all 64-bit numbers.
    std::uint64_t scattered() const {
      std::uint64_t key = (std::uint64_t{x} << 42) | (std::uint64_t{y} << 21) | std::uint64_t{z};
      key *= 0x9e3779b97f4a7c15u;  // 2^64 / golden ratio: Fibonacci hashing
      return key ^ (key >> 32);
    }
  };

  // Starts with the unit cube as block 0.
  BlockTree() : nodes_(1), places_{{0, 0, {}}} {
    nodes_[0].fill(kNone);
    nodes_[0][0] = kBlock;
  }

  std::uint32_t size() const { return static_cast<std::uint32_t>(places_.size()); }
  const Cube& operator[](std::uint32_t block) const { return places_[block].cube; }

  // Returns the block that holds x, or kNone. Points outside the unit cube count as on its faces.
  std::uint32_t find(Vec3 x) const {
    const auto index = [](double v) {
      return static_cast<std::uint32_t>(std::clamp(v * kCubes, 0.0, kCubes - 1.0));
    };
    const std::uint32_t i = index(x.x), j = index(x.y), k = index(x.z);
    std::uint32_t entry = nodes_[0][0];
    for (int bit = kMaxLevel - 1; entry < kBlock; --bit)
      entry = nodes_[entry][((i >> bit) & 1) | ((j >> bit) & 1) << 1 | ((k >> bit) & 1) << 2];
    return entry == kNone ? kNone : entry - kBlock;
  }

  // Calls take(block) for each block whose cube has its centre nearer to x than reach(level), if so
  // has each of the larger cubes that hold it, except the unit cube.
  template <typename Reach, typename Take>
  void visit(Vec3 x, const Reach& reach, const Take& take) const {
    visit(nodes_[0][0], {}, x, reach, take);
  }

  // Cuts a block into those of its eighths that `kept` names by bits. The first keeps its number,
  // the others are appended in order. Needs at least one and a level below kMaxLevel.
  void cut(std::uint32_t block, unsigned kept) {
    const Place from = places_[block];
    const auto node = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back().fill(kNone);
    nodes_[from.node][from.octant] = node;
    bool first = true;
    for (unsigned octant = 0; octant < 8; ++octant) {
      if (!((kept >> octant) & 1)) continue;
      const Place place{node, octant, from.cube.part(octant)};
      nodes_[node][octant] = kBlock + (first ? block : size());
      if (first) {
        places_[block] = place;
      } else {
        places_.push_back(place);
      }
      first = false;
    }
  }

  // Keeps these blocks, ascending, and numbers them anew in their order.
  void keep(const std::vector<std::uint32_t>& blocks) {
    for (const Place& p : places_) nodes_[p.node][p.octant] = kNone;
    for (std::uint32_t to = 0; to < blocks.size(); ++to) {
      const Place p = places_[blocks[to]];
      places_[to] = p;
      nodes_[p.node][p.octant] = kBlock + to;
    }
    places_.resize(blocks.size());
  }

 private:
  static constexpr double kCubes = 1 << kMaxLevel;
  static constexpr std::uint32_t kBlock = 0x80000000u;
  // Children: below kBlock the number of a node, from kBlock on that of a block, or kNone. The only
  // child of the first node is the unit cube.
  using Node = std::array<std::uint32_t, 8>;
  struct Place {
    std::uint32_t node, octant;  // where the block hangs
    Cube cube;
  };

  template <typename Reach, typename Take>
  void visit(std::uint32_t entry, const Cube& cube, Vec3 x, const Reach& reach,
             const Take& take) const {
    if (entry == kNone) return;
    if (entry >= kBlock) {
      take(entry - kBlock);
      return;
    }
    // Squared distances of the eighths' centres from x along each axis, lower half first.
    const Vec3 from = cube.center() - x;
    const double quarter = edge_of_level(cube.level + 2), near = reach(cube.level + 1);
    const auto halves = [&](double v) {
      return std::array{(v - quarter) * (v - quarter), (v + quarter) * (v + quarter)};
    };
    const std::array<double, 2> x2 = halves(from.x), y2 = halves(from.y), z2 = halves(from.z);
    for (unsigned octant = 0; octant < 8; ++octant) {
      if (x2[octant & 1] + y2[(octant >> 1) & 1] + z2[octant >> 2] < near * near)
        visit(nodes_[entry][octant], cube.part(octant), x, reach, take);
    }
  }

  std::vector<Node> nodes_;
  std::vector<Place> places_;  // of every block
};

}  // namespace vpm
