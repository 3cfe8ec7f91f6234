// Defines what a query notes of cells on a device: a word of bits each, sums, and what later steps
// need.
#pragma once

#include <algorithm>

#include "libvpm/backend/cuda/team.h"
#include "libvpm/backend/cuda/views.h"
#include "libvpm/measure/flood_rules.h"
#include "libvpm/measure/flood_state.h"

namespace vpm::cuda {

// Holds one entry per cell. All are 0 at the start of a query: many threads add to them.
struct CellNotes {
  std::uint32_t* words = nullptr;
  std::uint32_t* points = nullptr;  // number of the cloud's points in the sphere
  ToolSum* sums = nullptr;
  ContactPlane* planes = nullptr;  // mean planes in cut cells

  // Clears the part of the entries that a block range owns. Call from all its threads.
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

// Holds the plane that cuts a flat block.
struct FlatBlock {
  ClipPlane plane;
  Vec3 center;
};

// Holds a piece further behind the surface than the tool's radius, and what it adds if the plane of
// a cut cell supports it.
struct FarPiece {
  Vec3 at, foot;  // the piece and the foot of its surface sample, surface frame, m
  ToolSum sum;
  std::uint32_t cell = 0;
};

// Holds the sizes of one query's memory: those of the largest level that it is used with.
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

// Holds a planar cluster that the surface cuts.
struct PlanarCluster {
  ClipPlane plane;
  float least_inverse_depth;  // least in the cluster, 1/m
};

// Points into the memory of one query.
struct RefinedSpace {
  CellNotes notes[2];                // this query's and, cleared by it, the next one's, alternating
  double* gaps = nullptr;            // squared_gap() of cells that may be inside, m^2
  std::uint32_t* parents = nullptr;  // count + 1: the entry, then cells
  std::uint32_t* cut = nullptr;      // rows of the cut cells, where they are needed
  FarPiece* far = nullptr;
  FlatBlock* flats = nullptr;                // planes of each thread block's lists of flat tasks
  PlanarCluster* planar_clusters = nullptr;  // those that a thread block classifies
};

// Counts what a query lists; all 0 at its start.
struct RefinedCounters {
  unsigned hidden = 0;  // cells
  unsigned far = 0;     // pieces
  unsigned cut = 0;     // cells, as far as they are listed
};

// Counts a cell as boundary or inside if the bits just added to its word say so.
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
// Reads the counters by one thread for all of its block: many readers of one place would wait for
// each other.
__device__ inline RefinedCounters read_for_block(const RefinedCounters& counters) {
  __shared__ RefinedCounters found;
  __syncthreads();
  if (threadIdx.x == 0) found = {read(counters.hidden), read(counters.far), 0};
  __syncthreads();
  return found;
}

}  // namespace vpm::cuda
