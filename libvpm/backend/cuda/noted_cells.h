// Visits the cells that the first step has noted, which are few in a large level.
#pragma once

#include "libvpm/backend/cuda/cell_notes.h"

namespace vpm::cuda {

// Lays out a block's shared memory.
struct NotedList {
  static constexpr unsigned kRoom = 4096;

  std::uint32_t cells[kRoom], words[kRoom];
  unsigned count;
};

template <class Team>
class NotedCells {
 public:
  __device__ NotedCells(const LevelView& level, const CellNotes& notes, const Team& team,
                        NotedList& list)
      : level_(level), notes_(notes), team_(team), list_(list) {}

  // Calls visit(i, word) for the cells with a word, spread over the threads of the team. Blocks
  // list such cells in turns of neighbouring ones. A list that holds all serves again.
  template <class Visit>
  __device__ void for_each(const Visit& visit) {
    constexpr unsigned kTogether = 8;  // loads in flight
    const BlockRange part = team_.block();
    const unsigned step = part.parts * blockDim.x, begin = part.part * blockDim.x;
    const Subwarp warp(32);
    const auto visit_all = [&] {
      for (unsigned k = threadIdx.x; k < list_.count; k += blockDim.x)
        visit(list_.cells[k], list_.words[k]);
    };
    if (lists_all_) {
      visit_all();
      return;
    }
    lists_all_ = true;
    __syncthreads();
    if (threadIdx.x == 0) list_.count = 0;
    for (std::uint32_t first = begin; first < level_.count;) {
      lists_all_ &= first == begin;
      __syncthreads();
      if (threadIdx.x == 0) list_.count = 0;
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
          if (warp.leads() && found != 0) slot = atomicAdd(&list_.count, __popc(found));
          slot = warp.from(slot, 0) + __popc(found & ((1U << warp.lane) - 1));
          if (words[k] == 0) continue;
          list_.cells[slot] = first + k * step + threadIdx.x;
          list_.words[slot] = words[k];
        }
        __syncthreads();
        has_room = list_.count + kTogether * blockDim.x <= NotedList::kRoom;
        __syncthreads();
      }
      visit_all();
    }
  }

 private:
  const LevelView& level_;
  const CellNotes& notes_;
  const Team& team_;
  NotedList& list_;
  bool lists_all_ = false;  // list_ holds all noted cells of this block
};

}  // namespace vpm::cuda
