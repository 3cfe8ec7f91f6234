// What a query notes of the shares: one word each, sums, and what later steps need.
#pragma once

#include <algorithm>

#include "libvpm/backend/cuda/team.h"
#include "libvpm/backend/cuda/views.h"
#include "libvpm/measure/flood_rules.h"
#include "libvpm/measure/flood_state.h"

namespace vpm::cuda {

// Of each share. All are 0 at the start of a query: many threads add to them.
struct CellNotes {
  std::uint32_t* words = nullptr;
  std::uint32_t* points = nullptr;  // of the cloud, in the sphere
  ToolSum* sums = nullptr;
  ContactPlane* planes = nullptr;  // of cut shares

  // By a part of the threads.
  __device__ void clear(const LevelView& level, BlockRange part) const {
    constexpr unsigned kTogether = 4;  // words whose reads wait together
    const std::uint32_t step = part.parts * blockDim.x;
    for (std::uint32_t first = part.part * blockDim.x + threadIdx.x; first < level.count;
         first += kTogether * step) {
      std::uint32_t noted[kTogether];
#pragma unroll
      for (unsigned k = 0; k < kTogether; ++k)
        noted[k] = first + k * step < level.count ? words[first + k * step] : 0;
#pragma unroll
      for (unsigned k = 0; k < kTogether; ++k) {
        const std::uint32_t i = first + k * step;
        if (i < level.count) points[i] = 0;
        if (noted[k] == 0) continue;
        words[i] = 0;
        if ((noted[k] & (cell_bit::partial | cell_bit::whole | cell_bit::summed)) != 0)
          sums[i] = ToolSum{};
        if ((noted[k] & cell_bit::cut) != 0) planes[i] = ContactPlane{};
      }
    }
  }
};

// The plane that crosses a flat block.
struct FlatBlock {
  ClipPlane plane;
  Vec3 center;
};

// A piece further behind the surface than the tool's reach, and what it adds where the plane of a
// cut share vouches for it.
struct FarPiece {
  Vec3 at, foot;  // that the surface showed there
  ToolSum sum;
  std::uint32_t cell = 0;
};

// What the memory of one query has room for: the largest level that it is used with.
struct TeamRoom {
  std::size_t cells = 0, pieces = 0;

  TeamRoom() = default;
  explicit TeamRoom(const LevelView& level) : cells(level.count), pieces(level.piece_count) {}
  bool holds(const TeamRoom& other) const { return cells >= other.cells && pieces >= other.pieces; }
  TeamRoom with(const TeamRoom& other) const {
    TeamRoom both;
    both.cells = std::max(cells, other.cells);
    both.pieces = std::max(pieces, other.pieces);
    return both;
  }
};

// A patch that the surface crosses as one plane.
struct PlanarCluster {
  ClipPlane plane;
  float least_inverse_depth;  // of the surface there
};

// Memory of one query.
struct RefinedSpace {
  CellNotes notes[2];                // of this query and, cleared by it, of the next: by turns
  double* gaps = nullptr;            // squared_gap of shares that may be inside
  std::uint32_t* parents = nullptr;  // count + 1: the entry, then shares
  std::uint32_t* cut = nullptr;      // the cut shares, where they are needed
  FarPiece* far = nullptr;
  FlatBlock* flats = nullptr;                // of each thread block's lists of flat tasks
  PlanarCluster* planar_clusters = nullptr;  // those at which a thread block looks
};

// Counters of a query; 0 at the start.
struct RefinedCounters {
  unsigned hidden = 0;  // shares
  unsigned far = 0;     // pieces
  unsigned cut = 0;     // shares, as far as they are listed
};

// Counts a share to whose word bits were added that say so.
__device__ inline void count_cell(std::uint32_t before, std::uint32_t bits, RawResult& result) {
  const auto is_inside = [](std::uint32_t word) {
    return (word & cell_bit::counted) != 0 && (word & cell_bit::cut) == 0 ? 1U : 0U;
  };
  result.boundary += (bits & ~before & cell_bit::cut) != 0 ? 1 : 0;
  result.inside += is_inside(before | bits) - is_inside(before);
}

__device__ inline unsigned read(const unsigned& counter) {
  return *const_cast<const volatile unsigned*>(&counter);
}
// By one thread for all of its block: so many at one place would wait for each other.
__device__ inline RefinedCounters read_for_block(const RefinedCounters& counters) {
  __shared__ RefinedCounters found;
  __syncthreads();
  if (threadIdx.x == 0) found = {read(counters.hidden), read(counters.far), 0};
  __syncthreads();
  return found;
}

}  // namespace vpm::cuda
