// The units of a level, and chunks of them, as a device classifies them.
#pragma once

#include <span>
#include <vector>

#include "libvpm/backend/cuda/views.h"

namespace vpm::cuda {

template <class SomeUnit>
struct ChunkedUnits {
  std::vector<SomeUnit> units;
  std::vector<Chunk> chunks;
};

class LevelUnits {
 public:
  LevelUnits(const ToolModel& tool, const Level& level, const ShareClusters& clusters);

  const std::vector<BlockMass>& block_masses() const { return block_masses_; }
  // Cluster by cluster.
  ChunkedUnits<Unit> chunked() const;
  // For WarpChunks. `wide_count`: how many chunks of wide units.
  ChunkedUnits<WarpUnit> chunked_for_warps(std::uint32_t& wide_count) const;

 private:
  void add_units(std::uint32_t share, std::vector<WarpUnit>& units) const;
  std::vector<WarpUnit> units_of(const ShareCluster& cluster) const;

  const ToolModel& tool_;
  const Level& level_;
  const ShareClusters& clusters_;
  std::vector<BlockMass> block_masses_;
};

}  // namespace vpm::cuda
