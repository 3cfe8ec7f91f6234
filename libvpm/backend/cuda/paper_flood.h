// Runs the measure as printed with many threads, with the bits of PaperMeasure in any order of
// threads. libvpm/measure/README.md numbers its steps.
#pragma once

#include "libvpm/backend/cuda/cell_notes.h"
#include "libvpm/backend/cuda/points.h"
#include "libvpm/measure/paper_contact.h"

namespace vpm::cuda {

// Describes one level of a tool as this measure takes it.
struct PaperLevel {
  // Limits the neighbours of a sphere that a subwarp visits; large spheres have thousands.
  static constexpr std::uint32_t kMostNeighbors = 64;

  std::uint32_t count = 0;
  const Sphere* spheres = nullptr;
  const std::uint32_t* graph_begin = nullptr;
  const std::uint32_t* neighbors = nullptr;
  const std::uint32_t* hubs = nullptr;  // spheres with more than kMostNeighbors
  std::uint32_t hub_count = 0;
  GridView grid;
  ToolMeasures tool;
  double spheres_reach = 0;  // bounding radius of all spheres about the centre of mass, m
};

// Points to the memory of one query. Words and contacts that the lists do not name are 0.
struct PaperSpace {
  // Marks a boundary sphere. Other words are 0 outside, or the front that reached a sphere.
  static constexpr std::uint32_t kBoundary = 0xffffffffU;

  std::uint32_t* words = nullptr;
  PaperContact* contacts = nullptr;
  Vec3* normals = nullptr;            // valid for boundary and inside spheres
  std::uint32_t* boundary = nullptr;  // a list, in any order
  std::uint32_t* inside = nullptr;    // front after front, each in any order
};

// Counts a query's finds; 0 at the start.
struct PaperCounters {
  unsigned points = 0, boundary = 0;
  unsigned fronts[3] = {};  // sizes of a front, the next one, and the one after, in rotation
  unsigned inside = 0;      // written when the flood is done
};

// Resets `space` after the query that `counters` are of. A thread takes entries first, first +
// step, ...
__device__ inline void clear(const PaperSpace& space, const PaperCounters& counters,
                             std::uint32_t first, std::uint32_t step) {
  for (std::uint32_t k = first; k < counters.boundary; k += step) {
    const std::uint32_t i = space.boundary[k];
    space.words[i] = 0;
    space.contacts[i] = PaperContact{};
  }
  for (std::uint32_t k = first; k < counters.inside; k += step) space.words[space.inside[k]] = 0;
}

// Gathers the points of spheres (steps 1 and 2) in a block's range, by all its threads.
__device__ inline void gather(const PaperLevel& level, const PointsView& points,
                              const PoseFrame& frame, BlockRange part, const PaperSpace& space,
                              PaperCounters& counters) {
  for_points(
      points, frame, level.spheres_reach, part, [&](std::uint32_t index, Vec3 point, bool active) {
        bool inside = false;
        if (active) {
          const Vec3 x = frame.to_tool * point;
          for_spheres_at(level.grid, level.spheres, x, [&](std::uint32_t i) {
            inside = true;
            const Vec3 n = frame.to_tool.rotation * widen(points.normals[index]);
            PaperContact::of_point(level.spheres[i], x, n).add_to(space.contacts[i], add_term);
            if (atomicExch(&space.words[i], PaperSpace::kBoundary) == 0)
              space.boundary[atomicAdd(&counters.boundary, 1U)] = i;
          });
        }
        const unsigned found = __ballot_sync(~0U, inside);
        if (found != 0 && threadIdx.x % 32 == 0) atomicAdd(&counters.points, __popc(found));
      });
}

// Lays out a block's shared memory while it passes a hub.
struct HubShared {
  static constexpr unsigned kAtOnce = 32 * 32;  // neighbours: each lane of a warp counts 32
  static constexpr unsigned kOfThread = kAtOnce / kPaperThreads;

  std::uint32_t hubs[kPaperThreads];
  unsigned hub_count;
  unsigned counts[kAtOnce / 32];
  double terms[3][kAtOnce];
  double sums[3];
};

// Runs steps 3 to 6. All points must be gathered and the team synchronised.
template <class Team>
class PaperFlood {
 public:
  __device__ PaperFlood(const PaperLevel& level, const PaperSpace& space, PaperCounters& counters,
                        Team& team, HubShared& shared)
      : level_(level), space_(space), counters_(counters), team_(team), shared_(shared) {}

  // Returns this thread's part of the result. Call from all threads of the team.
  __device__ RawResult run() {
    enter();
    // Synchronises the team between fronts: each reads the one before and claims the next.
    for (front_ = 1;; ++front_) {
      team_.sync();
      const unsigned size = read(counters_.fronts[front_ % 3]);
      if (size == 0) break;
      pass_front(size);
      begin_ += size;
    }
    if (team_.thread() == 0) counters_.inside = begin_;
    add_up();
    return result_;
  }

 private:
  static constexpr unsigned kWidth = 8;  // threads that visit a sphere's neighbours together

  __device__ std::uint32_t degree(std::uint32_t i) const {
    return level_.graph_begin[i + 1] - level_.graph_begin[i];
  }

  // Runs steps 3 and 4 with a subwarp for each boundary sphere, or a block if it is a hub.
  __device__ void enter() {
    const Subwarp subwarp(kWidth);
    const unsigned count = read(counters_.boundary);
    for (unsigned k = team_.thread() / kWidth; k < count; k += team_.threads() / kWidth) {
      const std::uint32_t i = space_.boundary[k];
      const Vec3 normal = space_.contacts[i].mean_normal();
      if (subwarp.leads()) {
        space_.normals[i] = normal;
        add_boundary(level_.tool, level_.spheres[i], space_.contacts[i], normal, result_.sum);
        ++result_.boundary;
      }
      const std::uint32_t end = level_.graph_begin[i + 1];
      if (degree(i) > PaperLevel::kMostNeighbors) continue;
      for (std::uint32_t n = level_.graph_begin[i] + subwarp.lane; n - subwarp.lane < end;
           n += kWidth) {
        const std::uint32_t j = n < end ? level_.neighbors[n] : i;
        claim(subwarp,
              read(space_.words[j]) == 0 && lets_in(level_.spheres[i], normal, level_.spheres[j]),
              j);
      }
    }
    for_hubs(PaperSpace::kBoundary, [&](std::uint32_t i) { enter_from_hub(i); });
  }

  // Runs step 5 for one front with a subwarp for each sphere, or a block if it is a hub.
  __device__ void pass_front(unsigned size) {
    if (team_.thread() == 0) counters_.fronts[(front_ + 2) % 3] = 0;
    next_ = begin_ + size;
    const Subwarp subwarp(kWidth);
    for (unsigned k = team_.thread() / kWidth; k < size; k += team_.threads() / kWidth) {
      const std::uint32_t j = space_.inside[begin_ + k];
      if (degree(j) > PaperLevel::kMostNeighbors) continue;
      const Vec3 normal = pass(subwarp, j);
      if (subwarp.leads()) space_.normals[j] = normal;
    }
    for_hubs(front_, [&](std::uint32_t j) { pass_hub(j); });
  }

  // Claims the sphere's neighbours and returns its normal, summed in the order of neighbours.
  __device__ Vec3 pass(const Subwarp& subwarp, std::uint32_t j) {
    const std::uint32_t end = level_.graph_begin[j + 1];
    Vec3 normal;
    for (std::uint32_t n = level_.graph_begin[j] + subwarp.lane; n - subwarp.lane < end;
         n += kWidth) {
      const std::uint32_t i = n < end ? level_.neighbors[n] : j;  // itself: neither 0 nor before
      const std::uint32_t word = read(space_.words[i]);
      const bool gives = gives_normal(word, i, j);
      const Vec3 theirs = gives ? space_.normals[i] : Vec3{};
      claim(subwarp, word == 0, i);
      for (unsigned rest = subwarp.which(gives); rest != 0; rest &= rest - 1) {
        const unsigned from = __ffs(static_cast<int>(rest)) - 1;
        normal += subwarp.from(theirs, from);
      }
    }
    return normalized_or_zero(normal);
  }

  // Adds to the next front those spheres of a subwarp that nobody has claimed yet.
  __device__ void claim(const Subwarp& subwarp, bool wants, std::uint32_t i) {
    const bool claimed = wants && atomicCAS(&space_.words[i], 0U, front_ + 1) == 0;
    const unsigned all = subwarp.which(claimed);
    if (all == 0) return;
    const unsigned slot = subwarp.take_slots(counters_.fronts[(front_ + 1) % 3], all);
    if (claimed) space_.inside[next_ + slot] = i;
  }

  // True if sphere i gives its normal to sphere j: a boundary sphere to those that it lets in, a
  // sphere of the front before to later ones.
  __device__ bool gives_normal(std::uint32_t word, std::uint32_t i, std::uint32_t j) const {
    if (front_ > 1) return word == front_ - 1;
    return word == PaperSpace::kBoundary &&
           lets_in(level_.spheres[i], space_.normals[i], level_.spheres[j]);
  }

  // Calls pass(hub) for the hubs with this word, each from all threads of one block.
  template <class Pass>
  __device__ void for_hubs(std::uint32_t word, const Pass& pass) {
    const BlockRange part = team_.block();
    for (std::uint32_t first = part.part; first < level_.hub_count;
         first += part.parts * blockDim.x) {
      const std::uint32_t h = first + threadIdx.x * part.parts;
      const std::uint32_t hub = h < level_.hub_count ? level_.hubs[h] : 0;
      const bool found = h < level_.hub_count && read(space_.words[hub]) == word;
      if (__syncthreads_or(found) == 0) continue;
      if (threadIdx.x == 0) shared_.hub_count = 0;
      __syncthreads();
      if (found) shared_.hubs[atomicAdd(&shared_.hub_count, 1U)] = hub;
      __syncthreads();
      for (unsigned k = 0; k < shared_.hub_count; ++k) pass(shared_.hubs[k]);
      __syncthreads();
    }
  }

  __device__ void enter_from_hub(std::uint32_t i) {
    const Subwarp warp(32);
    const Vec3 normal = space_.contacts[i].mean_normal();
    const std::uint32_t end = level_.graph_begin[i + 1];
    for (std::uint32_t n = level_.graph_begin[i] + threadIdx.x; n - warp.lane < end;
         n += blockDim.x) {
      const std::uint32_t j = n < end ? level_.neighbors[n] : i;
      claim(warp,
            read(space_.words[j]) == 0 && lets_in(level_.spheres[i], normal, level_.spheres[j]), j);
    }
  }

  // Does what pass() does for many neighbours at once. Normals to be added are put side by side in
  // order, and a thread for each axis adds them.
  __device__ void pass_hub(std::uint32_t j) {
    const Subwarp warp(32);
    const unsigned group = threadIdx.x / 32 * HubShared::kOfThread;  // in groups of 32 neighbours
    const std::uint32_t end = level_.graph_begin[j + 1];
    double sum = 0;
    for (std::uint32_t first = level_.graph_begin[j]; first < end; first += HubShared::kAtOnce) {
      Vec3 theirs[HubShared::kOfThread];
      unsigned givers[HubShared::kOfThread];
      std::uint32_t spheres[HubShared::kOfThread], words[HubShared::kOfThread];
#pragma unroll
      for (unsigned k = 0; k < HubShared::kOfThread; ++k) {
        const std::uint32_t n = first + 32 * (group + k) + warp.lane;
        spheres[k] = n < end ? level_.neighbors[n] : j;
        words[k] = read(space_.words[spheres[k]]);
      }
#pragma unroll
      for (unsigned k = 0; k < HubShared::kOfThread; ++k) {
        const bool gives = gives_normal(words[k], spheres[k], j);
        if (gives) theirs[k] = space_.normals[spheres[k]];
        givers[k] = warp.which(gives);
        if (warp.leads()) shared_.counts[group + k] = __popc(givers[k]);
        claim(warp, words[k] == 0, spheres[k]);
      }
      __syncthreads();
      const unsigned upto = Warp::sum_upto(shared_.counts[warp.lane]);
#pragma unroll
      for (unsigned k = 0; k < HubShared::kOfThread; ++k) {
        const unsigned slot =
            warp.from(upto, group + k) - __popc(givers[k]) + warp.before(givers[k]);
        if ((givers[k] >> warp.lane & 1) == 0) continue;
        shared_.terms[0][slot] = theirs[k].x;
        shared_.terms[1][slot] = theirs[k].y;
        shared_.terms[2][slot] = theirs[k].z;
      }
      const unsigned count = warp.from(upto, 31);
      __syncthreads();
      if (threadIdx.x < 3) {
#pragma unroll 8
        for (unsigned t = 0; t < count; ++t) sum += shared_.terms[threadIdx.x][t];
      }
    }
    if (threadIdx.x < 3) shared_.sums[threadIdx.x] = sum;
    __syncthreads();
    if (threadIdx.x == 0)
      space_.normals[j] = normalized_or_zero({shared_.sums[0], shared_.sums[1], shared_.sums[2]});
  }

  // Runs step 6 for inside spheres; boundary spheres were added in enter().
  __device__ void add_up() {
    for (unsigned k = team_.thread(); k < begin_; k += team_.threads()) {
      const std::uint32_t j = space_.inside[k];
      add_inside(level_.tool, level_.spheres[j], space_.normals[j], result_.sum);
      ++result_.inside;
    }
  }

  const PaperLevel& level_;
  const PaperSpace& space_;
  PaperCounters& counters_;
  Team& team_;
  HubShared& shared_;
  // Holds the front's number, and where its spheres and the next front's begin in the list.
  std::uint32_t front_ = 0, begin_ = 0, next_ = 0;
  RawResult result_;
};

}  // namespace vpm::cuda
