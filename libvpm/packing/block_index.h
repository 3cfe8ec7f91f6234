// Hash table from integer cube coordinates to block numbers.
#pragma once

#include <cstdint>
#include <vector>

#include "libvpm/core/vec3.h"

namespace vpm {

class BlockIndex {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  struct Coordinates {
    std::uint32_t x = 0, y = 0, z = 0;  // each below 2^21
    std::uint64_t key() const {
      return (std::uint64_t{x} << 42) | (std::uint64_t{y} << 21) | std::uint64_t{z};
    }
  };

  // Numbers the given distinct blocks by their order.
  void assign(std::vector<Coordinates> blocks);

  std::uint32_t find(Coordinates c) const;
  Coordinates operator[](std::uint32_t block) const { return blocks_[block]; }
  std::uint32_t size() const { return static_cast<std::uint32_t>(blocks_.size()); }

  // Spreads keys evenly over all 64-bit numbers.
  static std::uint64_t scatter(std::uint64_t key);

 private:
  std::vector<Coordinates> blocks_;
  // Size is a power of two; at most half full.
  std::vector<std::uint32_t> slots_;
};

}  // namespace vpm
