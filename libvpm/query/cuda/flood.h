// The second step of a query: the flood, and the sum of what it reaches.
//
// Shares that the flood may pass are joined where the graph has an edge, and with the entry where a
// cut share lets the flood in. What is joined with the entry is inside. The team meets between
// joining and adding up; where another surface may hide something, which is rare, more often.
#pragma once

#include "libvpm/query/cuda/shares.h"
#include "libvpm/query/cuda/union_find.h"

namespace vpm::cuda {

// Shares of a level that one block floods in its own memory.
inline constexpr std::uint32_t kFloodShares = 3072;
struct FloodShared {
  std::uint32_t words[kFloodShares], parents[kFloodShares + 1];
};

template <class Surface, class Team>
class Flood {
 public:
  // `near` may be null: otherwise the level has no more than kFloodShares.
  __device__ Flood(const LevelView& level, const Surface& surface, const Pose& to_surface,
                   const RefinedSpace& space, unsigned turn, RefinedCounters& counters, Team& team,
                   FloodShared* near)
      : level_(level),
        surface_(surface),
        to_surface_(to_surface),
        space_(space),
        notes_(space.notes[turn % 2]),
        counters_(counters),
        team_(team),
        words_(near != nullptr ? near->words : notes_.words),
        flood_(near != nullptr ? near->parents : space.parents) {
    if (near != nullptr) bring_near();
  }

  // This thread's part of the result. All threads of the team.
  __device__ RawResult run() {
    const bool hidden = read(counters_.hidden) > 0;
    if (hidden || read(counters_.unsure) > 0) {
      list_cut();
      team_.sync();
    }
    if (hidden) {
      decide_hidden();
      team_.sync();
    }
    for (std::uint32_t e = team_.thread(); e < level_.edge_count; e += team_.threads())
      join(level_.edges[e]);
    const unsigned pieces = read(counters_.hidden_pieces);
    for (std::uint32_t k = team_.threads() - 1 - team_.thread(); k < pieces; k += team_.threads())
      add_hidden_piece(space_.hidden[k]);
    team_.sync();
    return add_up_shares();
  }

 private:
  using Measure = CellMeasure<Surface>;

  __device__ void bring_near() {
    for (std::uint32_t i = threadIdx.x; i < level_.count; i += blockDim.x) {
      words_[i] = notes_.words[i];
      flood_.reset(i + 1);
    }
    if (threadIdx.x == 0) flood_.reset(0);
    __syncthreads();
  }
  __device__ Vec3 center(std::uint32_t i) const { return to_surface_ * level_.centers[i]; }
  __device__ CutShare cut_share(std::uint32_t cut) const {
    return {notes_.planes[cut], center(cut), level_.reach[cut]};
  }
  __device__ bool is_inside(std::uint32_t i, std::uint32_t word) const {
    return is_passable(word) && flood_.root(i + 1) == 0;
  }

  __device__ void join(const Edge& edge) const;
  __device__ void enter(std::uint32_t cut, std::uint32_t sphere) const;
  __device__ __noinline__ bool lies_behind(std::uint32_t cut, std::uint32_t sphere) const;
  __device__ __noinline__ void add_hidden_piece(const HiddenPiece& hidden) const;
  __device__ __noinline__ void list_cut();
  __device__ __noinline__ void decide_hidden();
  __device__ std::uint32_t nearest_cut(const Tile& tile, std::uint32_t sphere) const;
  __device__ RawResult add_up_shares() const;
  __device__ __noinline__ ToolSum sum_of_share(const Tile& warp, std::uint32_t sphere,
                                               std::uint32_t word) const;

  const LevelView& level_;
  const Surface& surface_;
  const Pose& to_surface_;
  const RefinedSpace& space_;
  const ShareNotes& notes_;
  RefinedCounters& counters_;
  Team& team_;
  std::uint32_t* words_;
  UnionFind flood_;  // node 0 is the entry, node i + 1 share i
};

template <class Surface, class Team>
__device__ void Flood<Surface, Team>::join(const Edge& edge) const {
  const std::uint32_t a = words_[edge.larger], b = words_[edge.smaller];
  if (is_passable(a) && is_passable(b))
    flood_.join(edge.larger + 1, edge.smaller + 1);
  else if ((a & kCut) != 0 && is_passable(b))
    enter(edge.larger, edge.smaller);
  else if ((b & kCut) != 0 && is_passable(a))
    enter(edge.smaller, edge.larger);
}

template <class Surface, class Team>
__device__ void Flood<Surface, Team>::enter(std::uint32_t cut, std::uint32_t i) const {
  if (lies_near_sheet(space_.gaps[i], level_.reach[cut], level_.reach[i]) || lies_behind(cut, i))
    flood_.join(0, i + 1);
}

template <class Surface, class Team>
__device__ bool Flood<Surface, Team>::lies_behind(std::uint32_t cut, std::uint32_t i) const {
  return cut_share(cut).height(center(i)) < 0;
}

// The planes of divided shares are known now. A piece that counts has already made its share
// partial where nothing of it is cut.
template <class Surface, class Team>
__device__ void Flood<Surface, Team>::add_hidden_piece(const HiddenPiece& hidden) const {
  const std::uint32_t i = hidden.share, k = hidden.piece & ~HiddenPiece::kIsBlock;
  const CellView view = level_.cell(i);
  const Measure measure(surface_, to_surface_, level_.tool_reach, view);
  CellResult result;
  result.plane = notes_.planes[i];
  measure.add_piece((hidden.piece & HiddenPiece::kIsBlock) != 0 ? piece_of(level_.block_masses[k])
                                                                : piece_of(level_.samples[k]),
                    Measure::Pass::hidden, result);
  add_atomically(result.sum, notes_.sums[i]);
}

template <class Surface, class Team>
__device__ void Flood<Surface, Team>::list_cut() {
  for (std::uint32_t i = team_.thread(); i < level_.count; i += team_.threads()) {
    if ((words_[i] & kCut) != 0) space_.cut[atomicAdd(&counters_.cut, 1U)] = i;
  }
}

// Ties go to the smaller index. level_.count where nothing is cut.
template <class Surface, class Team>
__device__ std::uint32_t Flood<Surface, Team>::nearest_cut(const Tile& tile,
                                                           std::uint32_t i) const {
  const Vec3 from = level_.spheres[i].center;
  double best_squared = HUGE_VAL;
  std::uint32_t best = level_.count;
  const auto take = [&](double squared, std::uint32_t j) {
    if (squared > best_squared || (squared == best_squared && j >= best)) return;
    best_squared = squared;
    best = j;
  };
  const unsigned count = read(counters_.cut);
  for (unsigned k = tile.lane; k < count; k += tile.width) {
    const std::uint32_t j = space_.cut[k];
    take(squared_norm(level_.spheres[j].center - from), j);
  }
  for (unsigned other = tile.width / 2; other > 0; other /= 2) {
    const double squared = __shfl_xor_sync(tile.mask, best_squared, other, tile.width);
    take(squared, __shfl_xor_sync(tile.mask, best, other, tile.width));
  }
  return best;
}

// Of the shares that another surface may hide, those before the nearest cut share's plane are
// closed to the flood.
template <class Surface, class Team>
__device__ void Flood<Surface, Team>::decide_hidden() {
  const Tile warp(32);
  for (std::uint32_t i = team_.thread() / 32; i < level_.count; i += team_.threads() / 32) {
    const std::uint32_t word = words_[i];
    if (!may_be_inside(word) || (word & kHidden) == 0) continue;
    const std::uint32_t cut = nearest_cut(warp, i);
    if (cut < level_.count && warp.leads() && lies_behind(cut, i)) words_[i] = word & ~kHidden;
  }
}

template <class Surface, class Team>
__device__ RawResult Flood<Surface, Team>::add_up_shares() const {
  RawResult result;
  const Tile warp(32);
  for (std::uint32_t first = team_.thread() - warp.lane; first < level_.count;
       first += team_.threads()) {
    const std::uint32_t i = first + warp.lane;
    const std::uint32_t word = i < level_.count ? words_[i] : 0;
    const bool cut = (word & kCut) != 0, inside = is_inside(i, word);
    ToolSum sum;
    if (cut || inside) sum = notes_.sums[i];
    if ((word & kCountsPoints) != 0) result.points += notes_.points[i];
    for (unsigned rest = __ballot_sync(~0U, inside && (word & kUnsure) != 0); rest != 0;
         rest &= rest - 1) {
      const auto lane = static_cast<unsigned>(__ffs(static_cast<int>(rest)) - 1);
      const ToolSum all = sum_of_share(warp, first + lane, warp.from(word, lane));
      if (warp.lane == lane) sum = all;
    }
    // The flood also passes through the hidden.
    if (!cut && sum.volume.value == 0) continue;
    notes_.words[i] = word | kCounted;
    result.sum.add(sum);
    ++(cut ? result.boundary : result.inside);
  }
  return result;
}

// An inside share of which pieces are far behind the surface: the nearest cut share vouches for
// them, or they do not count.
template <class Surface, class Team>
__device__ ToolSum Flood<Surface, Team>::sum_of_share(const Tile& warp, std::uint32_t i,
                                                      std::uint32_t word) const {
  const CutShare cut = cut_share(nearest_cut(warp, i));
  const auto nearest = [&] { return cut; };
  const CellView view = level_.cell(i);
  const Measure measure(surface_, to_surface_, level_.tool_reach, view);
  const bool whole = (word & kWhole) != 0;
  const bool compact = whole && is_compact(view.reach, level_.tool_reach);
  ToolSum sum;
  if (compact && warp.leads()) measure.add_reached(nearest, piece_of(level_.share_masses[i]), sum);
  for (std::uint32_t b = view.begin; b < view.end && !compact; ++b) {
    const CellBlock block = view.blocks[b];
    const Side side = whole ? Side::behind : measure.side_of(block);
    if (side == Side::free) continue;
    const bool sampled = side == Side::mixed;
    const std::uint32_t count = sampled ? block.end - block.begin : 1;
    for (std::uint32_t s = warp.lane; s < count; s += warp.width) {
      measure.add_reached(
          nearest, sampled ? piece_of(view.samples[block.begin + s]) : piece_of(view.masses[b]),
          sum);
    }
  }
  __syncwarp();
  add_up(warp, sum);
  return sum;
}

}  // namespace vpm::cuda
