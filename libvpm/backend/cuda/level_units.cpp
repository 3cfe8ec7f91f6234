#include "libvpm/backend/cuda/level_units.h"

#include <algorithm>

namespace vpm::cuda {
namespace {

// Some units of a cluster, so many to a chunk.
template <class SomeUnit>
void add_chunks(const ShareCluster& cluster, std::span<const WarpUnit> some, std::size_t at_once,
                ChunkedUnits<SomeUnit>& out) {
  for (; !some.empty(); some = some.subspan(std::min(at_once, some.size()))) {
    const std::span<const WarpUnit> these = some.first(std::min(at_once, some.size()));
    const auto begin = static_cast<std::uint32_t>(out.units.size());
    out.units.insert(out.units.end(), these.begin(), these.end());
    out.chunks.push_back(
        {{cluster.center, cluster.reach}, begin, begin + static_cast<std::uint32_t>(these.size())});
  }
}
// The same, with room for whole chunks.
void add_whole_chunks(const ShareCluster& cluster, std::span<const WarpUnit> some,
                      std::size_t at_once, ChunkedUnits<WarpUnit>& out) {
  if (some.empty()) return;
  add_chunks(cluster, some, at_once, out);
  WarpUnit nothing = some.front();
  nothing.flags = 0;
  out.units.resize(out.chunks.back().begin + at_once, nothing);
}

}  // namespace

LevelUnits::LevelUnits(const ToolModel& tool, const Level& level, const ShareClusters& clusters)
    : tool_(tool), level_(level), clusters_(clusters), block_masses_(vpm::block_masses(level)) {}

void LevelUnits::add_units(std::uint32_t share, std::vector<WarpUnit>& units) const {
  const Sphere& sphere = tool_.spheres[share];
  const Vec3 center = sphere.center - tool_.center_of_mass;
  const double reach = level_.share_reach[share];
  const std::uint32_t begin = level_.block_begin[share], end = level_.block_begin[share + 1];
  WarpUnit unit;
  unit.balls[Unit::of_share] = {center, reach};
  unit.balls[Unit::of_sphere] = {center, sphere.radius};
  unit.share_mass = clusters_.masses[share];
  unit.share = share;
  if (is_compact(reach, tool_.reach)) unit.flags |= Unit::is_compact;
  const std::size_t head = units.size();
  if (begin == end) units.push_back(unit);
  for (std::uint32_t b = begin; b < end; ++b) {
    const CellBlock& block = level_.blocks[b];
    units.push_back(unit);
    WarpUnit& of_block = units.back();
    of_block.balls[Unit::of_block] = {widen(block.center), block.radius};
    of_block.block_mass = block_masses_[b];
    of_block.block = b;
    of_block.begin = block.begin;
    of_block.end = block.end;
    of_block.flags |= Unit::has_block;
  }
  units[head].flags |= Unit::is_head;
}

std::vector<WarpUnit> LevelUnits::units_of(const ShareCluster& cluster) const {
  std::vector<WarpUnit> units;
  for (std::uint32_t k = cluster.begin; k < cluster.end; ++k) add_units(clusters_.shares[k], units);
  return units;
}

ChunkedUnits<Unit> LevelUnits::chunked() const {
  ChunkedUnits<Unit> all;
  for (const ShareCluster& cluster : clusters_.clusters)
    add_chunks(cluster, units_of(cluster), Chunk::kUnits, all);
  return all;
}

ChunkedUnits<WarpUnit> LevelUnits::chunked_for_warps(std::uint32_t& wide_count) const {
  ChunkedUnits<WarpUnit> all, narrow;
  for (const ShareCluster& cluster : clusters_.clusters) {
    std::vector<WarpUnit> units = units_of(cluster);
    const auto is_wide = [](const Unit& u) { return u.end - u.begin > WarpChunks::kNarrow; };
    const auto first_narrow = std::stable_partition(units.begin(), units.end(), is_wide);
    add_whole_chunks(cluster, {units.begin(), first_narrow}, WarpChunks::kWideUnits, all);
    add_whole_chunks(cluster, {first_narrow, units.end()}, Chunk::kUnits, narrow);
  }
  wide_count = static_cast<std::uint32_t>(all.chunks.size());
  const auto before = static_cast<std::uint32_t>(all.units.size());
  all.units.insert(all.units.end(), narrow.units.begin(), narrow.units.end());
  for (const Chunk& chunk : narrow.chunks)
    all.chunks.push_back({chunk.ball, before + chunk.begin, before + chunk.end});
  return all;
}

}  // namespace vpm::cuda
