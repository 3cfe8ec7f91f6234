// Finishes a query after the first step: where a camera has seen the surface, by the planes of cut
// cells; among points without a camera, by the flood.
#pragma once

#include <cstdint>
#include <cuda/atomic>

#include "libvpm/backend/cuda/cell_notes.h"

namespace vpm::cuda {

// Finds connected components with many threads at once, as a forest in which every root is the
// smallest member of its tree. Roots are hooked below smaller ones with compare-and-swap, so the
// components do not depend on the order of threads.
class UnionFind {
 public:
  __device__ explicit UnionFind(std::uint32_t* parents) : parents_(parents) {}

  __device__ std::uint32_t root(std::uint32_t node) const {
    std::uint32_t at = node, parent = load(at);
    while (parent != at) {
      const std::uint32_t above = load(parent);
      if (above != parent) store(at, above);  // halves the path; any ancestor will do
      at = parent;
      parent = above;
    }
    return at;
  }

  // Joins a[k] with b[k] for all k; equal pairs are allowed. All walk to their roots at once, since
  // each step waits for memory.
  template <unsigned kPairs>
  __device__ void join(const std::uint32_t (&a)[kPairs], const std::uint32_t (&b)[kPairs]) const {
    Walk walks[kPairs][2];
#pragma unroll
    for (unsigned k = 0; k < kPairs; ++k) {
      walks[k][0] = {a[k], a[k]};
      walks[k][1] = {b[k], b[k]};
    }
    bool changes = true;
    while (changes) {
      std::uint32_t parents[kPairs][2];
#pragma unroll
      for (unsigned k = 0; k < kPairs; ++k) {
        if (walks[k][0].at == walks[k][1].at) continue;
        parents[k][0] = load(walks[k][0].at);
        parents[k][1] = load(walks[k][1].at);
      }
      changes = false;
#pragma unroll
      for (unsigned k = 0; k < kPairs; ++k) {
        Walk &one = walks[k][0], &other = walks[k][1];
        if (one.at == other.at) continue;
        if (parents[k][0] == one.at && parents[k][1] == other.at) {
          const std::uint32_t low = min(one.at, other.at), high = max(one.at, other.at);
          if (atomicCAS(parents_ + high, high, low) == high) one.at = other.at;
        } else {
          go(one, parents[k][0]);
          go(other, parents[k][1]);
        }
        changes |= one.at != other.at;
      }
    }
  }

 private:
  struct Walk {
    std::uint32_t last, at;
  };
  __device__ void go(Walk& walk, std::uint32_t parent) const {
    if (parent == walk.at) return;
    if (walk.last != walk.at) store(walk.last, parent);  // as in root()
    walk = {walk.at, parent};
  }

  // Uses atomics, since other threads write meanwhile.
  using Parent = ::cuda::atomic_ref<std::uint32_t, ::cuda::thread_scope_device>;
  __device__ std::uint32_t load(std::uint32_t node) const {
    return Parent(parents_[node]).load(::cuda::memory_order_relaxed);
  }
  __device__ void store(std::uint32_t node, std::uint32_t parent) const {
    Parent(parents_[node]).store(parent, ::cuda::memory_order_relaxed);
  }

  std::uint32_t* parents_;
};

// Stands for a block's shared memory where a step needs none.
struct NoShared {};

// Finishes a query where a camera has seen the surface. The first step has added what is behind it
// by no more than the tool radius; pieces further behind count if the plane of a cut cell supports
// them.
template <class Surface, class Team>
class CameraVisibility {
 public:
  using Shared = NoShared;  // memory of a block

  __device__ CameraVisibility(const LevelView& level, const Surface&, const Pose& to_surface,
                              const RefinedSpace& space, unsigned turn, RefinedCounters& counters,
                              Team& team, Shared&)
      : notes_(space.notes[turn % 2]),
        counters_(counters),
        team_(team),
        cut_(level, to_surface, space, notes_, counters, team) {}

  // True if the first step has left `far` pieces.
  __device__ static bool has_more(unsigned far) { return far > 0; }
  // Returns what this thread adds to the first step's result, and takes what counts from `unseen`,
  // that of the pose. Call from all threads of the team.
  __device__ ThreadResult run(UnseenSum& unseen) {
    ThreadResult result;
    const unsigned far = read_for_block(counters_).far;
    if (far > 0) {
      cut_.list();
      team_.sync();
      cut_.add_far(
          far, [](std::uint32_t) { return true; }, [](std::uint32_t) { return false; },
          [&](const FarPiece& far_piece) {
            result.sum.add(far_piece.sum);
            add_term(unseen.unseen.value, -far_piece.weight.value);
            if (counts(far_piece.sum))
              count_cell(atomicOr(&notes_.words[far_piece.cell], cell_bit::counted),
                         cell_bit::counted, result);
          });
    }
    return result;
  }

 private:
  const CellNotes& notes_;
  RefinedCounters& counters_;
  Team& team_;
  CutCells<Team> cut_;
};

// Most cells of a level that one block floods in its own memory.
inline constexpr std::uint32_t kFloodCells = 3072;
inline constexpr std::uint32_t kFloodEdges = 4096;  // most of its edges
__host__ __device__ inline bool is_small(const LevelView& level) {
  return level.count <= kFloodCells && level.edge_count <= kFloodEdges;
}

// Holds a small level's flood in a block's shared memory.
struct FloodShared {
  std::uint32_t words[kFloodCells];
  // From the front lie the passages, edges between two cells that the flood may pass; from the back
  // the entries, edges by which it may enter, with the cut cell as `larger`.
  Edge edges[kFloodEdges];
  unsigned passages, entries;  // numbers of both
};
// Holds what a block needs: its own flood, or the list of noted cells.
union FloodBlock {
  FloodShared shared;
  NotedList noted;
};

// Floods among points without a camera, and sums what the flood reaches.
//
// In a block's own memory the flood goes from cell to cell until nothing changes. Otherwise cells
// that the flood may pass are joined where the graph has an edge, and with the entry where a cut
// cell lets the flood in. What is joined with the entry is inside, and other cells that the body
// encloses. The team meets between joining and adding up; where another surface may hide something,
// which is rare, more often.
template <class Surface, class Team>
class Flood {
 public:
  using Shared = FloodBlock;

  __device__ Flood(const LevelView& level, const Surface& surface, const Pose& to_surface,
                   const RefinedSpace& space, unsigned turn, RefinedCounters& counters, Team& team,
                   FloodBlock& block)
      : level_(level),
        surface_(surface),
        to_surface_(to_surface),
        space_(space),
        notes_(space.notes[turn % 2]),
        counters_(counters),
        team_(team),
        shared_(block.shared),
        in_shared_(Team::kIsBlock && is_small(level)),
        words_(in_shared_ ? block.shared.words : notes_.words),
        flood_(space.parents),
        noted_(level, notes_, team, block.noted),
        cut_(level, to_surface, space, notes_, counters, team) {
    if (in_shared_) bring_to_shared();
  }

  // True always: the flood comes after the first step.
  __device__ static bool has_more(unsigned) { return true; }
  // Returns this thread's part of the result, and adds to `unseen`, that of the pose, what is
  // unknown. Call from all threads of the team.
  __device__ ThreadResult run(UnseenSum& unseen) {
    const RefinedCounters found = read_for_block(counters_);
    if (found.hidden > 0 || found.far > 0) {
      cut_.list();
      team_.sync();
    }
    if (found.hidden > 0) {
      decide_hidden();
      team_.sync();
    }
    if (in_shared_)
      flood_in_shared();
    else
      join_cells();
    team_.sync();
    if (may_enclose(surface_)) {
      take_enclosed();
      team_.sync();
    }
    if (found.far > 0) {
      cut_.add_far(
          found.far, [&](std::uint32_t i) { return is_inside(i, words_[i]); },
          [&](std::uint32_t i) { return (words_[i] & cell_bit::enclosed) != 0; },
          [&](const FarPiece& piece) { add_atomically(piece.sum, notes_.sums[piece.cell]); });
      team_.sync();
    }
    const ThreadResult result = add_up_cells();
    if constexpr (TellsUnknown<Surface>) {
      team_.sync();
      add_unknown(unseen.unseen);
    }
    return result;
  }

 private:
  static constexpr unsigned kEdges = 4;  // edges per thread at once: their reads wait together

  // Copies the words of all cells to the block's memory.
  __device__ void bring_to_shared() {
    if (threadIdx.x == 0) shared_.passages = shared_.entries = 0;
    for (std::uint32_t i = threadIdx.x; i < level_.count; i += blockDim.x)
      words_[i] = notes_.words[i];
    __syncthreads();
  }
  __device__ Vec3 center(std::uint32_t i) const { return to_surface_ * level_.centers[i]; }
  __device__ bool is_inside(std::uint32_t i, std::uint32_t word) const {
    if ((word & cell_bit::enclosed) != 0) return true;
    return in_shared_ ? (word & cell_bit::reached) != 0
                      : is_passable(word) && flood_.root(i + 1) == 0;
  }

  // Edges that a thread handles together, and the words of their cells.
  struct Edges {
    Edge edges[kEdges];
    std::uint32_t words[kEdges]
                       [2];  // words of the larger and the smaller cell; 0 where there is no edge
  };
  // Calls visit(edges) for all edges of the level, spread over the threads of the team.
  template <class Visit>
  __device__ void for_edges(const Visit& visit) const {
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
  // Calls join(k, i, j) for edges between cells that the flood may pass, enter(k, cut, i) for edges
  // by which it may enter.
  template <class Join, class Enter>
  __device__ static void visit_edges(const Edges& together, const Join& join, const Enter& enter) {
#pragma unroll
    for (unsigned k = 0; k < kEdges; ++k) {
      const std::uint32_t i = together.edges[k].larger, j = together.edges[k].smaller;
      const std::uint32_t word_of_i = together.words[k][0], word_of_j = together.words[k][1];
      if (is_passable(word_of_i) && is_passable(word_of_j))
        join(k, i, j);
      else if ((word_of_i & cell_bit::cut) != 0 && is_passable(word_of_j))
        enter(k, i, j);
      else if ((word_of_j & cell_bit::cut) != 0 && is_passable(word_of_i))
        enter(k, j, i);
    }
  }

  // Joins the cells of a large level: goes over the cells that have a word, and over the edges from
  // each to smaller cells, which are few.
  __device__ void join_cells() {
    const auto join_ends = [&](const Edges& together) {
      std::uint32_t one[kEdges] = {}, other[kEdges] = {};
      visit_edges(
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
    noted_.for_each([&](std::uint32_t i, std::uint32_t word) {
      if (!is_passable(word) && (word & cell_bit::cut) == 0) return;
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

  // Floods in the block's memory: lists the edges that matter, then goes over all of them in rounds
  // until none changes anything.
  __device__ void flood_in_shared() {
    for_edges([&](const Edges& together) {
      visit_edges(
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
      if (enters(entry.larger, entry.smaller)) atomicOr(&words_[entry.smaller], cell_bit::reached);
    }
    bool changes = true;
    while (__syncthreads_or(changes) != 0) {
      constexpr unsigned kMost = kFloodEdges / kThreads;
      static_assert(kMost <= 32);
      unsigned changed_edges = 0;  // one bit per edge of this thread
#pragma unroll 4
      for (unsigned n = 0; n < kMost; ++n) {
        const unsigned k = threadIdx.x + n * blockDim.x;
        if (k >= passages) break;
        const Edge edge = shared_.edges[k];
        changed_edges |=
            ((words_[edge.larger] ^ words_[edge.smaller]) & cell_bit::reached) != 0 ? 1U << n : 0U;
      }
      __syncthreads();
      changes = changed_edges != 0;
      for (; changed_edges != 0; changed_edges &= changed_edges - 1) {
        const Edge edge =
            shared_.edges[threadIdx.x + (__ffs(static_cast<int>(changed_edges)) - 1) * blockDim.x];
        atomicOr(&words_[edge.larger], cell_bit::reached);
        atomicOr(&words_[edge.smaller], cell_bit::reached);
      }
    }
  }

  __device__ bool enters(std::uint32_t cut, std::uint32_t i) const {
    return vpm::enters(space_.gaps[i], level_.cell_radius[cut], level_.cell_radius[i],
                       [&] { return lies_behind(cut, i); });
  }

  __device__ __noinline__ bool lies_behind(std::uint32_t cut, std::uint32_t i) const {
    return cut_.at(cut).is_behind(center(i));
  }

  // Decides about cells that another surface may hide: one behind the plane of the nearest cut cell
  // is not hidden, so the flood may pass it.
  __device__ __noinline__ void decide_hidden() {
    const Subwarp warp(32);
    for (std::uint32_t i = team_.thread() / 32; i < level_.count; i += team_.threads() / 32) {
      const std::uint32_t word = words_[i];
      if (!may_be_inside(word) || (word & cell_bit::hidden) == 0) continue;
      const std::uint32_t cut = cut_.nearest_to(warp, i);
      if (cut < level_.count && warp.leads() && passes(true, [&] { return lies_behind(cut, i); }))
        words_[i] = word & ~cell_bit::hidden;
    }
  }

  // Marks the cells that no flood has reached and that the body encloses.
  __device__ __noinline__ void take_enclosed() {
    for (std::uint32_t i = team_.thread(); i < level_.count; i += team_.threads()) {
      const std::uint32_t word = words_[i];
      if (!may_be_inside(word) || is_inside(i, word)) continue;
      const TaskBall& cluster = level_.cluster_balls[i];
      const Vec3 middle = to_surface_ * cluster.center;
      const bool as_one = is_enclosed_as_one(surface_, middle, cluster.radius);
      if (encloses(surface_, as_one ? middle : center(i))) words_[i] = word | cell_bit::enclosed;
    }
  }

  // Returns this thread's part of the sum over all cells that count.
  __device__ ThreadResult add_up_cells() {
    ThreadResult result;
    const auto add = [&](std::uint32_t i, std::uint32_t word) {
      if ((word & cell_bit::cut) != 0 || may_be_inside(word)) add_cell(i, word, result);
    };
    if (in_shared_ || level_.count <= team_.threads()) {
      for (std::uint32_t i = team_.thread(); i < level_.count; i += team_.threads())
        add(i, words_[i]);
    } else {
      // Reads the words anew, since the list has those from before the flood.
      noted_.for_each([&](std::uint32_t i, std::uint32_t) { add(i, words_[i]); });
    }
    return result;
  }

  // Adds a cell that counts: a cut one, or one with a volume that the flood has reached. The flood
  // also passes cells of which nothing counts.
  __device__ void add_cell(std::uint32_t i, std::uint32_t word, ThreadResult& result) const {
    const bool cut = (word & cell_bit::cut) != 0;
    const ToolSum sum = notes_.sums[i];
    if (!cut && !(is_inside(i, word) && counts(sum))) return;
    notes_.words[i] = word | cell_bit::counted;
    result.sum.add(sum);
    ++(cut ? result.boundary : result.inside);
  }

  // Adds the cells of which nothing counts and nobody knows whether they are inside, as
  // UnknownCells on the CPU does. A thread takes a cluster.
  __device__ __noinline__ void add_unknown(ToolSum::Sum& unknown) const {
    const ClustersView& clusters = level_.clusters;
    ToolSum::Sum sum;
    for (std::uint32_t k = team_.thread(); k < clusters.count; k += team_.threads()) {
      const CellCluster& cluster = clusters.all[k];
      ToolSum::Sum rest;
      bool any_counts = false;
      for (std::uint32_t row = cluster.begin; row < cluster.end; ++row) {
        const std::uint32_t i = clusters.cells[row];
        const bool counts = (notes_.words[i] & cell_bit::counted) != 0;
        any_counts |= counts;
        if (!counts) rest.add(level_.cell_masses[i].weight);
      }
      if (rest.value != 0 && is_unknown(cluster, any_counts)) sum.add(rest);
    }
    if (sum.value != 0) add_term(unknown.value, sum.value);
  }
  // True if it is unknown whether the cells of a cluster that do not count are inside.
  __device__ bool is_unknown(const CellCluster& cluster, bool any_counts) const {
    const auto classify = [&](const CellCluster& ball) {
      return surface_.classify_ball(to_surface_ * ball.center, ball.radius);
    };
    for (const GroupTreeNode* node = level_.clusters.tree;;) {
      if (cluster.begin >= node->ball.end) {
        node = level_.clusters.tree + node->next;
        continue;
      }
      const auto in_ball = classify(node->ball);
      if (in_ball.side == Side::no_surface) return surface_.is_unknown(in_ball);
      if (node->group != GroupTreeNode::kNone) break;
      ++node;
    }
    return !any_counts && surface_.is_unknown(classify(cluster));
  }

  const LevelView& level_;
  const Surface& surface_;
  const Pose& to_surface_;
  const RefinedSpace& space_;
  const CellNotes& notes_;
  RefinedCounters& counters_;
  Team& team_;
  FloodShared& shared_;
  bool in_shared_;
  std::uint32_t* words_;
  UnionFind flood_;  // node 0 is the entry, node i + 1 cell i
  NotedCells<Team> noted_;
  CutCells<Team> cut_;
};

}  // namespace vpm::cuda
