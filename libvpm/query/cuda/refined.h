// The refined measure by a team of threads: the same functions, and so the same bits, as
// libvpm/query/measure_refined.cpp.
//
// 1. Each share is classified by one thread; those that may count are measured by a tile of
//    threads, also those of which only the flood will decide: most are inside.
// 2. Shares that the flood may pass are joined where the graph has an edge, and with the entry
//    where a cut share lets the flood in.
// 3. What is joined with the entry is inside.
#pragma once

#include "libvpm/query/cuda/points.h"
#include "libvpm/query/cuda/team.h"
#include "libvpm/query/cuda/union_find.h"
#include "libvpm/query/cuda/views.h"
#include "libvpm/query/passage.h"

namespace vpm::cuda {

// What is known of a share; flags may be added to `partial` and `whole`.
enum ShareKind : std::uint8_t {
  kFree,
  kCut,
  kPartial,
  kWhole,
  kMixed,  // to be measured
  kOpen,   // its centre decides
};
inline constexpr std::uint8_t kKindMask = 0x07;
inline constexpr std::uint8_t kHidden = 0x10;  // by a surface that may be another one
inline constexpr std::uint8_t kUnsure = 0x20;  // parts of it need the nearest cut share's plane

__device__ inline bool may_be_inside(std::uint8_t kind) {
  return (kind & kKindMask) == kPartial || (kind & kKindMask) == kWhole;
}
__device__ inline bool is_passable(std::uint8_t kind) {
  return may_be_inside(kind) && (kind & kHidden) == 0;
}

// Memory of one query.
struct RefinedSpace {
  std::uint8_t* kinds = nullptr;     // of each sphere
  double* gaps = nullptr;            // squared_gap of shares that may be inside
  ToolSum* sums = nullptr;           // of measured shares
  ContactPlane* planes = nullptr;    // of cut shares
  std::uint32_t* parents = nullptr;  // count + 1: the entry, then spheres
  std::uint32_t* work = nullptr;     // spheres to be measured, by parts of the team
  std::uint32_t* cut = nullptr;      // cut spheres, where anything is hidden
  SphereState* states = nullptr;
};

// Counters of a team; 0 at the start.
struct RefinedCounters {
  unsigned hidden = 0;  // > 0: some share needs the nearest cut one
  unsigned cut = 0;
};

template <class Surface, class Team>
class RefinedQuery {
 public:
  __device__ RefinedQuery(const LevelView& level, const Surface& surface, const PoseFrame& frame,
                          const RefinedSpace& space, RefinedCounters& counters, Team& team)
      : level_(level),
        surface_(surface),
        frame_(frame),
        space_(space),
        counters_(counters),
        team_(team),
        share_(team.spheres()),
        flood_(space.parents) {}

  // This thread's part of the result's sum and counts; `points` apart. Blocks without spheres need
  // not call it.
  __device__ RawResult run() {
    list_work();
    measure_work();
    team_.sync();
    if (volatile_load(counters_.hidden) > 0) decide_hidden();
    join_work();
    team_.sync();
    if (volatile_load(counters_.hidden) > 0) measure_unsure();
    return add_up_work();
  }

 private:
  // This block's spheres are part, part + parts, ...; its list of work has room for them all.
  __device__ std::uint32_t work_begin() const {
    const std::uint32_t rest = level_.count % share_.parts;
    return share_.part * (level_.count / share_.parts) + min(share_.part, rest);
  }
  __device__ std::uint32_t work(std::uint32_t k) const { return space_.work[work_begin() + k]; }
  __device__ static unsigned volatile_load(const unsigned& value) {
    return *static_cast<const volatile unsigned*>(&value);
  }
  __device__ Vec3 center(std::uint32_t i) const { return frame_.to_surface * level_.centers[i]; }
  __device__ CutShare cut_share(std::uint32_t cut) const {
    return {space_.planes[cut], center(cut), level_.reach[cut]};
  }
  __device__ CellMeasure<Surface> measure_of(const CellView& view) const {
    return {surface_, frame_.to_surface, level_.tool_reach, view};
  }

  __device__ void list_work();
  __device__ void measure_work();
  __device__ void measure(const Tile& tile, std::uint32_t sphere);
  __device__ std::uint8_t measure_mixed(const Tile& tile, std::uint32_t sphere,
                                        const CellView& view);
  __device__ std::uint8_t measure_candidate(const Tile& tile, std::uint32_t sphere,
                                            const CellView& view, std::uint8_t kind);
  template <class Visit>
  __device__ void for_pieces(const Tile& tile, const CellMeasure<Surface>& measure,
                             const CellView& view, bool whole, const Visit& visit) const;
  __device__ void decide_hidden();
  __device__ std::uint32_t nearest_cut(const Tile& tile, std::uint32_t sphere) const;
  __device__ void join_work();
  __device__ void join(std::uint32_t sphere, std::uint8_t kind, std::uint32_t neighbor) const;
  __device__ void measure_unsure();
  __device__ RawResult add_up_work() const;

  const LevelView& level_;
  const Surface& surface_;
  const PoseFrame& frame_;
  const RefinedSpace& space_;
  RefinedCounters& counters_;
  Team& team_;
  Share share_;
  UnionFind flood_;  // node 0 is the entry, node i + 1 sphere i
  std::uint32_t listed_ = 0;
};

template <class Surface, class Team>
__device__ void RefinedQuery<Surface, Team>::list_work() {
  __shared__ unsigned listed;
  __syncthreads();
  if (threadIdx.x == 0) {
    listed = 0;
    if (share_.part == 0) flood_.reset(0);
  }
  __syncthreads();
  for (std::uint32_t i = share_.part + threadIdx.x * share_.parts; i < level_.count;
       i += blockDim.x * share_.parts) {
    const Side side = surface_.side_of_ball(center(i), level_.reach[i]);
    space_.kinds[i] = side == Side::free     ? kFree
                      : side == Side::behind ? kWhole
                      : side == Side::uncut  ? kOpen
                                             : kMixed;
    space_.states[i] = SphereState::outside;
    if (side != Side::free) space_.work[work_begin() + atomicAdd(&listed, 1U)] = i;
  }
  __syncthreads();
  listed_ = listed;
}

template <class Surface, class Team>
__device__ void RefinedQuery<Surface, Team>::measure_work() {
  const Tile tile(level_.lanes_per_share);
  for (std::uint32_t k = tile.index(); k < listed_; k += tile.count()) measure(tile, work(k));
}

template <class Surface, class Team>
__device__ void RefinedQuery<Surface, Team>::measure(const Tile& tile, std::uint32_t i) {
  const CellView view = level_.cell(i);
  std::uint8_t kind = space_.kinds[i];
  if (kind == kMixed) kind = measure_mixed(tile, i, view);
  if (kind != kFree && kind != kCut) kind = measure_candidate(tile, i, view, kind);
  if (!tile.leads()) return;
  space_.kinds[i] = kind;
  flood_.reset(i + 1);
}

// Visits the pieces of a share, each by one thread of the tile: blocks that the surface does not
// pass as one piece, the others sample by sample; blocks only, where the share is `whole`.
template <class Surface, class Team>
template <class Visit>
__device__ void RefinedQuery<Surface, Team>::for_pieces(const Tile& tile,
                                                        const CellMeasure<Surface>& measure,
                                                        const CellView& view, bool whole,
                                                        const Visit& visit) const {
  for (std::uint32_t first = view.begin; first < view.end; first += tile.width) {
    const std::uint32_t b = first + tile.lane, end = min(first + tile.width, view.end);
    Side side = Side::free;
    if (b < end) side = whole ? Side::behind : measure.side_of(view.blocks[b]);
    const std::uint32_t from = whole ? first : view.blocks[first].begin;
    const std::uint32_t to = whole ? end : view.blocks[end - 1].end;
    for (std::uint32_t piece = from; piece < to; piece += tile.width) {
      const std::uint32_t at = piece + tile.lane;
      const bool exists = at < to;
      const std::uint32_t block = whole ? at : exists ? level_.block_of[at] : first;
      const Side of_block =
          static_cast<Side>(tile.from(static_cast<int>(side), exists ? block - first : 0));
      if (!exists || of_block == Side::free) continue;
      const bool sampled = of_block == Side::mixed;
      if (!sampled && !whole && at != view.blocks[block].begin) continue;
      visit(sampled ? piece_of(view.samples[at]) : piece_of(view.masses[block]));
    }
  }
}

template <class Surface, class Team>
__device__ std::uint8_t RefinedQuery<Surface, Team>::measure_mixed(const Tile& tile,
                                                                   std::uint32_t i,
                                                                   const CellView& view) {
  using Measure = CellMeasure<Surface>;
  const Measure measure = measure_of(view);
  CellResult result;
  bool hidden = false;
  for_pieces(tile, measure, view, false, [&](const SharePiece& piece) {
    hidden |= measure.add_piece(piece, Measure::Pass::seen, result);
  });
  tile.add_up(result.plane);
  if (tile.any(hidden)) {
    for_pieces(tile, measure, view, false, [&](const SharePiece& piece) {
      measure.add_piece(piece, Measure::Pass::hidden, result);
    });
  }
  tile.add_up(result.sum);
  if (result.plane.count > 0 && tile.leads()) {
    space_.sums[i] = result.sum;
    space_.planes[i] = result.plane;
  }
  return result.plane.count > 0 ? kCut : result.sum.volume.value > 0 ? kPartial : kFree;
}

// A share that is not cut, measured as if the flood reached it.
template <class Surface, class Team>
__device__ std::uint8_t RefinedQuery<Surface, Team>::measure_candidate(const Tile& tile,
                                                                       std::uint32_t i,
                                                                       const CellView& view,
                                                                       std::uint8_t kind) {
  const Vec3 at = center(i);
  const Reading reading = surface_.read(at);
  if (kind == kOpen) {
    if (!(reading.known && reading.distance < 0)) return kFree;
    kind = kWhole;
  }
  const CellMeasure<Surface> measure = measure_of(view);
  ToolSum sum;
  bool unsure = false;
  const auto nearest = [&] {
    unsure = true;
    return CutShare{};
  };
  for_pieces(tile, measure, view, kind == kWhole,
             [&](const SharePiece& piece) { measure.add_reached(nearest, piece, sum); });
  tile.add_up(sum);
  unsure = tile.any(unsure);
  const double gap = squared_gap(at, reading);
  const bool hidden = is_hidden_share(gap, level_.tool_reach);
  if (tile.leads()) {
    space_.sums[i] = sum;
    space_.gaps[i] = gap;
    if (hidden || unsure) atomicAdd(&counters_.hidden, 1U);
  }
  return static_cast<std::uint8_t>(kind | (hidden ? kHidden : 0) | (unsure ? kUnsure : 0));
}

// Ties go to the smaller index.
template <class Surface, class Team>
__device__ std::uint32_t RefinedQuery<Surface, Team>::nearest_cut(const Tile& tile,
                                                                  std::uint32_t i) const {
  const Vec3 from = level_.spheres[i].center;
  double best_squared = HUGE_VAL;
  std::uint32_t best = level_.count;
  const auto take = [&](double squared, std::uint32_t j) {
    if (squared > best_squared || (squared == best_squared && j > best)) return;
    best_squared = squared;
    best = j;
  };
  const unsigned count = volatile_load(counters_.cut);
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

// Of the shares that another surface may hide, those before the nearest cut share's plane are out
// of sight, and closed to the flood.
template <class Surface, class Team>
__device__ void RefinedQuery<Surface, Team>::decide_hidden() {
  for (std::uint32_t k = threadIdx.x; k < listed_; k += blockDim.x) {
    if (space_.kinds[work(k)] == kCut) space_.cut[atomicAdd(&counters_.cut, 1U)] = work(k);
  }
  team_.sync();
  const Tile tile(32);
  for (std::uint32_t k = tile.index(); k < listed_; k += tile.count()) {
    const std::uint32_t i = work(k);
    const std::uint8_t kind = space_.kinds[i];
    if (!may_be_inside(kind) || (kind & kHidden) == 0) continue;
    const std::uint32_t cut = nearest_cut(tile, i);
    if (cut == level_.count || !tile.leads()) continue;
    if (cut_share(cut).height(center(i)) < 0)
      space_.kinds[i] = static_cast<std::uint8_t>(kind & ~kHidden);
  }
  team_.sync();
}

template <class Surface, class Team>
__device__ void RefinedQuery<Surface, Team>::join_work() {
  constexpr unsigned kLanesPerRow = 8;  // rows of the graph have about that many neighbours
  const Tile tile(kLanesPerRow);
  for (std::uint32_t k = tile.index(); k < listed_; k += tile.count()) {
    const std::uint32_t i = work(k);
    const std::uint8_t kind = space_.kinds[i];
    if (kind != kCut && !is_passable(kind)) continue;
    for (std::uint32_t e = level_.edge_begin[i] + tile.lane; e < level_.edge_begin[i + 1];
         e += tile.width)
      join(i, kind, level_.neighbors[e]);
  }
}

template <class Surface, class Team>
__device__ void RefinedQuery<Surface, Team>::join(std::uint32_t i, std::uint8_t kind,
                                                  std::uint32_t j) const {
  if (!is_passable(space_.kinds[j])) return;
  if (kind != kCut) {
    if (j < i) flood_.join(i + 1, j + 1);
  } else if (lies_near_sheet(space_.gaps[j], level_.reach[i], level_.reach[j]) ||
             cut_share(i).height(center(j)) < 0) {
    flood_.join(0, j + 1);
  }
}

template <class Surface, class Team>
__device__ void RefinedQuery<Surface, Team>::measure_unsure() {
  const Tile tile(level_.lanes_per_share);
  for (std::uint32_t k = tile.index(); k < listed_; k += tile.count()) {
    const std::uint32_t i = work(k);
    const std::uint8_t kind = space_.kinds[i];
    if (!is_passable(kind) || (kind & kUnsure) == 0 || flood_.root(i + 1) != 0) continue;
    const CutShare cut = cut_share(nearest_cut(tile, i));
    const CellView view = level_.cell(i);
    const CellMeasure<Surface> measure = measure_of(view);
    ToolSum sum;
    const auto nearest = [&] { return cut; };
    for_pieces(tile, measure, view, (kind & kKindMask) == kWhole,
               [&](const SharePiece& piece) { measure.add_reached(nearest, piece, sum); });
    tile.add_up(sum);
    if (tile.leads()) space_.sums[i] = sum;
  }
  __syncthreads();
}

template <class Surface, class Team>
__device__ RawResult RefinedQuery<Surface, Team>::add_up_work() const {
  RawResult result;
  for (std::uint32_t k = threadIdx.x; k < listed_; k += blockDim.x) {
    const std::uint32_t i = work(k);
    const std::uint8_t kind = space_.kinds[i];
    if (kind == kCut) {
      space_.states[i] = SphereState::boundary;
      result.sum.add(space_.sums[i]);
      ++result.boundary;
    } else if (is_passable(kind) && flood_.root(i + 1) == 0 && space_.sums[i].volume.value != 0) {
      space_.states[i] = SphereState::inside;
      result.sum.add(space_.sums[i]);
      ++result.inside;
    }
  }
  return result;
}

}  // namespace vpm::cuda
