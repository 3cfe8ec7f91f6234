// The second step of a query: the flood, and the sum of what it reaches.
//
// In a block's own memory the flood goes from share to share until nothing changes. Otherwise,
// shares that the flood may pass are joined where the graph has an edge, and with the entry where a
// cut share lets the flood in. What is joined with the entry is inside. The team meets between
// joining and adding up; where another surface may hide something, which is rare, more often.
#pragma once

#include "libvpm/query/cuda/shares.h"
#include "libvpm/query/cuda/union_find.h"

namespace vpm::cuda {

// Shares with a word: most of a large level have none.
struct NotedShares {
  static constexpr unsigned kRoom = 4096;

  std::uint32_t shares[kRoom], words[kRoom];
  unsigned count;
};

// Shares of a level that one block floods in its own memory.
inline constexpr std::uint32_t kFloodShares = 3072;
inline constexpr std::uint32_t kFloodEdges = 4096;  // of such a level
struct FloodShared {
  std::uint32_t words[kFloodShares];
  Edge edges[kFloodEdges];     // from the front: between shares that the flood may pass
  unsigned passages, entries;  // from the back: by which it may enter
};
// What a block needs for one way or the other.
union FloodBlock {
  FloodShared shared;
  NotedShares noted;
};

template <class Surface, class Team>
class Flood {
 public:
  // `in_shared`: the level has no more than kFloodShares and kFloodEdges.
  __device__ Flood(const LevelView& level, const Surface& surface, const Pose& to_surface,
                   const RefinedSpace& space, unsigned turn, RefinedCounters& counters, Team& team,
                   FloodBlock& block, bool in_shared)
      : level_(level),
        surface_(surface),
        to_surface_(to_surface),
        space_(space),
        notes_(space.notes[turn % 2]),
        counters_(counters),
        team_(team),
        shared_(block.shared),
        noted_(block.noted),
        in_shared_(in_shared),
        words_(in_shared ? block.shared.words : notes_.words),
        flood_(space.parents) {
    if (in_shared) bring_to_shared();
  }

  // This thread's part of the result. All threads of the team.
  __device__ RawResult run() {
    const RefinedCounters found = read_for_block(counters_);
    const bool unsure = found.unsure > 0;
    if (found.hidden > 0 || unsure) {
      list_cut();
      team_.sync();
    }
    if (found.hidden > 0) {
      decide_hidden();
      team_.sync();
    }
    for (std::uint32_t k = team_.threads() - 1 - team_.thread(); k < found.hidden_pieces;
         k += team_.threads())
      add_hidden_piece(space_.hidden[k]);
    if (in_shared_)
      flood_in_shared();
    else
      join_shares();
    team_.sync();
    RawResult result = add_up_shares();
    if (unsure) add_up_unsure(result);
    return result;
  }

 private:
  using Measure = CellMeasure<Surface>;
  static constexpr unsigned kEdges = 4;  // of a thread at once: their reads wait together

  __device__ void bring_to_shared() {
    if (threadIdx.x == 0) shared_.passages = shared_.entries = 0;
    for (std::uint32_t i = threadIdx.x; i < level_.count; i += blockDim.x)
      words_[i] = notes_.words[i];
    __syncthreads();
  }
  __device__ Vec3 center(std::uint32_t i) const { return to_surface_ * level_.centers[i]; }
  __device__ CutShare cut_share(std::uint32_t cut) const {
    return {notes_.planes[cut], center(cut), level_.reach[cut]};
  }
  __device__ bool is_inside(std::uint32_t i, std::uint32_t word) const {
    return in_shared_ ? (word & kReached) != 0 : is_passable(word) && flood_.root(i + 1) == 0;
  }

  struct Edges {
    Edge edges[kEdges];
    std::uint32_t words[kEdges][2];  // of larger and smaller; 0 where there is no edge
  };
  // Calls visit(edges) for all of them.
  template <class Visit>
  __device__ void for_edges(const Visit& visit) const;
  // Calls join(k, i, j) for those between shares that the flood may pass, enter(k, cut, i) for
  // those by which it may enter.
  template <class Join, class Enter>
  __device__ static void look_at(const Edges& together, const Join& join, const Enter& enter);
  // Calls visit(i, word) for the shares that have a word, dealt out to the threads of the team.
  template <class Visit>
  __device__ void for_noted_shares(const Visit& visit);
  __device__ void join_shares();
  __device__ void flood_in_shared();
  __device__ bool enters(std::uint32_t cut, std::uint32_t sphere) const;
  __device__ __noinline__ bool lies_behind(std::uint32_t cut, std::uint32_t sphere) const;
  __device__ void add_hidden_piece(const HiddenPiece& hidden) const;
  __device__ __noinline__ void list_cut();
  __device__ __noinline__ void decide_hidden();
  __device__ std::uint32_t nearest_cut(const Tile& tile, std::uint32_t sphere) const;
  __device__ RawResult add_up_shares();
  __device__ void add_share(std::uint32_t sphere, std::uint32_t word, ToolSum sum,
                            RawResult& result) const;
  __device__ __noinline__ void add_up_unsure(RawResult& result) const;
  __device__ ToolSum sum_of_share(const Tile& warp, std::uint32_t sphere, std::uint32_t word) const;

  const LevelView& level_;
  const Surface& surface_;
  const Pose& to_surface_;
  const RefinedSpace& space_;
  const ShareNotes& notes_;
  RefinedCounters& counters_;
  Team& team_;
  FloodShared& shared_;
  NotedShares& noted_;
  bool in_shared_;
  bool lists_all_ = false;  // noted_ lists all shares of this block that have a word
  std::uint32_t* words_;
  UnionFind flood_;  // node 0 is the entry, node i + 1 share i
};

template <class Surface, class Team>
template <class Visit>
__device__ void Flood<Surface, Team>::for_edges(const Visit& visit) const {
  for (std::uint32_t first = team_.thread(); first < level_.edge_count;
       first += kEdges * team_.threads()) {
    Edges together;
#pragma unroll
    for (unsigned k = 0; k < kEdges; ++k) {
      const std::uint32_t e = first + k * team_.threads();
      together.edges[k] = level_.edges[e < level_.edge_count ? e : first];
    }
#pragma unroll
    for (unsigned k = 0; k < kEdges; ++k) {
      const bool is_one = first + k * team_.threads() < level_.edge_count;
      together.words[k][0] = is_one ? words_[together.edges[k].larger] : 0;
      together.words[k][1] = is_one ? words_[together.edges[k].smaller] : 0;
    }
    visit(together);
  }
}

template <class Surface, class Team>
template <class Join, class Enter>
__device__ void Flood<Surface, Team>::look_at(const Edges& together, const Join& join,
                                              const Enter& enter) {
#pragma unroll
  for (unsigned k = 0; k < kEdges; ++k) {
    const std::uint32_t i = together.edges[k].larger, j = together.edges[k].smaller;
    const std::uint32_t word_of_i = together.words[k][0], word_of_j = together.words[k][1];
    if (is_passable(word_of_i) && is_passable(word_of_j))
      join(k, i, j);
    else if ((word_of_i & kCut) != 0 && is_passable(word_of_j))
      enter(k, i, j);
    else if ((word_of_j & kCut) != 0 && is_passable(word_of_i))
      enter(k, j, i);
  }
}

// Blocks take shares side by side in turns, and list those that have a word. Where one list holds
// all, it serves again.
template <class Surface, class Team>
template <class Visit>
__device__ void Flood<Surface, Team>::for_noted_shares(const Visit& visit) {
  constexpr unsigned kTogether = 8;  // words whose reads wait together
  const Part part = team_.block();
  const unsigned step = part.parts * blockDim.x, begin = part.part * blockDim.x;
  const Tile warp(32);
  const auto visit_all = [&] {
    for (unsigned k = threadIdx.x; k < noted_.count; k += blockDim.x)
      visit(noted_.shares[k], noted_.words[k]);
  };
  if (lists_all_) {
    visit_all();
    return;
  }
  lists_all_ = true;
  for (std::uint32_t first = begin; first < level_.count;) {
    lists_all_ &= first == begin;
    __syncthreads();
    if (threadIdx.x == 0) noted_.count = 0;
    __syncthreads();
    bool has_room = true;
    for (; has_room && first < level_.count; first += kTogether * step) {
      std::uint32_t words[kTogether];
#pragma unroll
      for (unsigned k = 0; k < kTogether; ++k) {
        const std::uint32_t i = first + k * step + threadIdx.x;
        words[k] = i < level_.count ? notes_.words[i] : 0;
      }
#pragma unroll
      for (unsigned k = 0; k < kTogether; ++k) {
        const unsigned found = __ballot_sync(~0U, words[k] != 0);
        unsigned slot = 0;
        if (warp.leads() && found != 0) slot = atomicAdd(&noted_.count, __popc(found));
        slot = warp.from(slot, 0) + __popc(found & ((1U << warp.lane) - 1));
        if (words[k] == 0) continue;
        noted_.shares[slot] = first + k * step + threadIdx.x;
        noted_.words[slot] = words[k];
      }
      __syncthreads();
      has_room = noted_.count + kTogether * blockDim.x <= NotedShares::kRoom;
      __syncthreads();
    }
    visit_all();
  }
}

// Of a large level, edges are looked at from the shares that have a word: each from its larger
// index, of which a share has few.
template <class Surface, class Team>
__device__ void Flood<Surface, Team>::join_shares() {
  const auto join_ends = [&](const Edges& together) {
    std::uint32_t one[kEdges] = {}, other[kEdges] = {};
    look_at(
        together,
        [&](unsigned k, std::uint32_t i, std::uint32_t j) { one[k] = i + 1, other[k] = j + 1; },
        [&](unsigned k, std::uint32_t cut, std::uint32_t i) {
          if (enters(cut, i)) one[k] = i + 1;
        });
    flood_.join(one, other);
  };
  if (level_.edge_count <= kEdges * team_.threads()) {
    for_edges(join_ends);
    return;
  }
  for_noted_shares([&](std::uint32_t i, std::uint32_t word) {
    if (!is_passable(word) && (word & kCut) == 0) return;
    const std::uint32_t end = level_.edge_begin[i + 1];
    for (std::uint32_t e = level_.edge_begin[i]; e < end; e += kEdges) {
      Edges together;
#pragma unroll
      for (unsigned k = 0; k < kEdges; ++k)
        together.edges[k] = {i, level_.edges[e + k < end ? e + k : e].smaller};
#pragma unroll
      for (unsigned k = 0; k < kEdges; ++k) {
        together.words[k][0] = word;
        together.words[k][1] = e + k < end ? words_[together.edges[k].smaller] : 0;
      }
      join_ends(together);
    }
  });
}

// Edges that matter are listed first; in each round the flood passes all of them.
template <class Surface, class Team>
__device__ void Flood<Surface, Team>::flood_in_shared() {
  for_edges([&](const Edges& together) {
    look_at(
        together,
        [&](unsigned, std::uint32_t i, std::uint32_t j) {
          shared_.edges[atomicAdd(&shared_.passages, 1U)] = {i, j};
        },
        [&](unsigned, std::uint32_t cut, std::uint32_t i) {
          shared_.edges[kFloodEdges - 1 - atomicAdd(&shared_.entries, 1U)] = {cut, i};
        });
  });
  __syncthreads();
  const unsigned entries = shared_.entries, passages = shared_.passages;
  for (unsigned k = threadIdx.x; k < entries; k += blockDim.x) {
    const Edge entry = shared_.edges[kFloodEdges - 1 - k];
    if (enters(entry.larger, entry.smaller)) atomicOr(&words_[entry.smaller], kReached);
  }
  bool changes = true;
  while (__syncthreads_or(changes) != 0) {
    constexpr unsigned kMost = kFloodEdges / kThreads;
    unsigned crossed = 0;  // a bit for each edge of this thread
#pragma unroll 4
    for (unsigned n = 0; n < kMost; ++n) {
      const unsigned k = threadIdx.x + n * blockDim.x;
      if (k >= passages) break;
      const Edge edge = shared_.edges[k];
      crossed |= ((words_[edge.larger] ^ words_[edge.smaller]) & kReached) != 0 ? 1U << n : 0U;
    }
    __syncthreads();
    changes = crossed != 0;
    for (; crossed != 0; crossed &= crossed - 1) {
      const Edge edge =
          shared_.edges[threadIdx.x + (__ffs(static_cast<int>(crossed)) - 1) * blockDim.x];
      atomicOr(&words_[edge.larger], kReached);
      atomicOr(&words_[edge.smaller], kReached);
    }
  }
}

template <class Surface, class Team>
__device__ bool Flood<Surface, Team>::enters(std::uint32_t cut, std::uint32_t i) const {
  return lies_near_sheet(space_.gaps[i], level_.reach[cut], level_.reach[i]) || lies_behind(cut, i);
}

template <class Surface, class Team>
__device__ bool Flood<Surface, Team>::lies_behind(std::uint32_t cut, std::uint32_t i) const {
  return cut_share(cut).height(center(i)) < 0;
}

// The planes are known now. A piece that counts has already made its share partial where nothing of
// it is cut.
template <class Surface, class Team>
__device__ void Flood<Surface, Team>::add_hidden_piece(const HiddenPiece& hidden) const {
  const std::uint32_t i = hidden.share;
  const Measure measure(surface_, to_surface_, level_.tool_reach,
                        {.center = level_.centers[i], .reach = level_.reach[i]});
  typename Measure::PieceLook look;
  look.x = hidden.at;
  look.reading.foot = hidden.foot;
  if (measure.is_vouched_for(look, notes_.planes[i])) add_atomically(hidden.sum, notes_.sums[i]);
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
__device__ RawResult Flood<Surface, Team>::add_up_shares() {
  RawResult result;
  const auto add = [&](std::uint32_t i, std::uint32_t word) {
    if ((word & kCountsPoints) != 0) result.points += notes_.points[i];
    if ((word & kCut) != 0 || (may_be_inside(word) && (word & kUnsure) == 0))
      add_share(i, word, notes_.sums[i], result);
  };
  if (in_shared_ || level_.count <= team_.threads()) {
    for (std::uint32_t i = team_.thread(); i < level_.count; i += team_.threads())
      add(i, words_[i]);
  } else {
    for_noted_shares(add);
  }
  return result;
}

// A share counts if it is cut, or the flood reaches it; the flood also passes through the hidden.
template <class Surface, class Team>
__device__ void Flood<Surface, Team>::add_share(std::uint32_t i, std::uint32_t word, ToolSum sum,
                                                RawResult& result) const {
  const bool cut = (word & kCut) != 0;
  if (!cut && (!is_inside(i, word) || sum.volume.value == 0)) return;
  notes_.words[i] = word | kCounted;
  result.sum.add(sum);
  ++(cut ? result.boundary : result.inside);
}

template <class Surface, class Team>
__device__ void Flood<Surface, Team>::add_up_unsure(RawResult& result) const {
  const Tile warp(32);
  for (std::uint32_t i = team_.thread() / 32; i < level_.count; i += team_.threads() / 32) {
    const std::uint32_t word = words_[i];
    if ((word & kUnsure) == 0 || !is_inside(i, word)) continue;
    const ToolSum sum = sum_of_share(warp, i, word);
    if (warp.leads()) add_share(i, word, sum, result);
  }
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
  const bool compact = whole && is_compact(view.reach, level_.tool_reach.length);
  ToolSum sum;
  if (compact && warp.leads())
    measure.add_reached(nearest, piece_of(level_.share_masses[i], view), sum);
  for (std::uint32_t b = view.begin; b < view.end && !compact; ++b) {
    const CellBlock block = view.blocks[b];
    const Side side = whole ? Side::behind : measure.side_of(block);
    if (side == Side::free) continue;
    const bool sampled = side == Side::mixed;
    const std::uint32_t count = sampled ? block.end - block.begin : 1;
    for (std::uint32_t s = warp.lane; s < count; s += warp.width) {
      measure.add_reached(
          nearest,
          sampled ? piece_of(view.samples[block.begin + s]) : piece_of(view.masses[b], block), sum);
    }
  }
  __syncwarp();
  add_up(warp, sum);
  return sum;
}

}  // namespace vpm::cuda
