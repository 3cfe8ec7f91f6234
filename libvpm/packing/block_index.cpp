#include "libvpm/packing/block_index.h"

#include <bit>
#include <utility>

namespace vpm {

std::uint64_t BlockIndex::scatter(std::uint64_t key) {
  key *= 0x9e3779b97f4a7c15u;  // 2^64 / golden ratio: Fibonacci hashing
  return key ^ (key >> 32);
}

void BlockIndex::assign(std::vector<Coordinates> blocks) {
  blocks_ = std::move(blocks);
  slots_.assign(std::bit_ceil(2 * blocks_.size() + 1), kNone);
  const std::uint64_t mask = slots_.size() - 1;
  for (std::uint32_t b = 0; b < size(); ++b) {
    std::uint64_t slot = scatter(blocks_[b].key()) & mask;
    while (slots_[slot] != kNone) slot = (slot + 1) & mask;
    slots_[slot] = b;
  }
}

std::uint32_t BlockIndex::find(Coordinates c) const {
  const std::uint64_t mask = slots_.size() - 1;
  const std::uint64_t key = c.key();
  for (std::uint64_t slot = scatter(key) & mask; slots_[slot] != kNone; slot = (slot + 1) & mask) {
    if (blocks_[slots_[slot]].key() == key) return slots_[slot];
  }
  return kNone;
}

}  // namespace vpm
