// Hash table from integer cube coordinates to block numbers.
#pragma once

#include <bit>
#include <cstdint>
#include <utility>
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
  void assign(std::vector<Coordinates> blocks) {
    blocks_ = std::move(blocks);
    slots_.assign(std::bit_ceil(2 * blocks_.size() + 1), kNone);
    const std::uint64_t mask = slots_.size() - 1;
    for (std::uint32_t b = 0; b < size(); ++b) {
      std::uint64_t slot = scatter(blocks_[b].key()) & mask;
      while (slots_[slot] != kNone) slot = (slot + 1) & mask;
      slots_[slot] = b;
    }
  }

  std::uint32_t find(Coordinates c) const {
    const std::uint64_t mask = slots_.size() - 1;
    const std::uint64_t key = c.key();
    for (std::uint64_t slot = scatter(key) & mask; slots_[slot] != kNone;
         slot = (slot + 1) & mask) {
      if (blocks_[slots_[slot]].key() == key) return slots_[slot];
    }
    return kNone;
  }
  Coordinates operator[](std::uint32_t block) const { return blocks_[block]; }
  std::uint32_t size() const { return static_cast<std::uint32_t>(blocks_.size()); }

  // Spreads keys evenly over all 64-bit numbers.
  static std::uint64_t scatter(std::uint64_t key) {
    key *= 0x9e3779b97f4a7c15u;  // 2^64 / golden ratio: Fibonacci hashing
    return key ^ (key >> 32);
  }

 private:
  std::vector<Coordinates> blocks_;
  // Size is a power of two; at most half full.
  std::vector<std::uint32_t> slots_;
};

}  // namespace vpm
