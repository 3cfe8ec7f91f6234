// The steps of the measure as printed, numbered as in libvpm/query/README.md, by many threads: the
// bits of PaperMeasure, whatever their order.
#pragma once

#include "libvpm/query/cuda/points.h"
#include "libvpm/query/cuda/shares.h"
#include "libvpm/query/paper_contact.h"

namespace vpm::cuda {

// One level of a tool, as this measure sees it.
struct PaperLevel {
  std::uint32_t count = 0;
  const Sphere* spheres = nullptr;
  const std::uint32_t* graph_begin = nullptr;
  const std::uint32_t* neighbors = nullptr;
  GridView grid;
  ToolMeasures tool;
  double spheres_reach = 0;  // no point of a sphere is further from the centre of mass
};

// Memory of one query. Words and contacts are 0 at the start; the lists say which are not.
struct PaperSpace {
  // In `words`: 0 outside, the front that reached an inside sphere (1 is the entry), or this.
  static constexpr std::uint32_t kBoundary = 0xffffffffU;

  std::uint32_t* words = nullptr;
  PaperContact* contacts = nullptr;
  Vec3* normals = nullptr;            // of boundary and inside spheres
  std::uint32_t* boundary = nullptr;  // a list, in any order
  std::uint32_t* inside = nullptr;    // front after front, each in any order
};

// Counters of a query; 0 at the start.
struct PaperCounters {
  unsigned points = 0, boundary = 0;
  unsigned fronts[3] = {};  // sizes of a front, the next one, and the one after, by turns
  unsigned inside = 0;      // written by the flood when it is done
};

// By a part of the threads: makes `space` as it was before the query that `counters` are of.
__device__ inline void clear(const PaperSpace& space, const PaperCounters& counters,
                             std::uint32_t first, std::uint32_t step) {
  for (std::uint32_t k = first; k < counters.boundary; k += step) {
    const std::uint32_t i = space.boundary[k];
    space.words[i] = 0;
    space.contacts[i] = PaperContact{};
  }
  for (std::uint32_t k = first; k < counters.inside; k += step) space.words[space.inside[k]] = 0;
}

__device__ inline void add_term(std::int64_t& sum, std::int64_t term) {
  atomicAdd(reinterpret_cast<unsigned long long*>(&sum), static_cast<unsigned long long>(term));
}

// Steps 1 and 2 for a part of the points, by all threads of a block.
__device__ inline void gather(const PaperLevel& level, const PointsView& points,
                              const PoseFrame& frame, Part part, const PaperSpace& space,
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

// Steps 3 to 6, after all points are gathered and the team has met.
template <class Team>
class PaperFlood {
 public:
  // `width`: threads that go through a sphere's neighbours together.
  __device__ PaperFlood(const PaperLevel& level, const PaperSpace& space, PaperCounters& counters,
                        Team& team, unsigned width)
      : level_(level), space_(space), counters_(counters), team_(team), tile_(width) {}

  // This thread's part of the result. All threads of the team.
  __device__ RawResult run() {
    enter();
    // A front reads the words and normals of the one before and claims the next: the team meets
    // between.
    for (front_ = 1;; ++front_) {
      team_.sync();
      const unsigned size = read(counters_.fronts[front_ % 3]);
      if (size == 0) break;
      pass_front(size);
      begin_ += size;
    }
    if (team_.thread() == 0) counters_.inside = begin_;
    return result_;
  }

 private:
  __device__ unsigned first() const { return team_.thread() / tile_.width; }
  __device__ unsigned step() const { return team_.threads() / tile_.width; }

  // Of the threads of a tile, those for which `value` holds: the first thread is bit 0.
  __device__ unsigned ballot(bool value) const {
    return (__ballot_sync(tile_.mask, value) & tile_.mask) >> (threadIdx.x % 32 - tile_.lane);
  }
  // By one thread: the sphere is in the next front, if nobody has claimed it yet.
  __device__ void claim(std::uint32_t j, std::uint32_t after) {
    if (atomicCAS(&space_.words[j], 0U, front_ + 1) != 0) return;
    space_.inside[after + atomicAdd(&counters_.fronts[(front_ + 1) % 3], 1U)] = j;
  }

  __device__ void enter();
  __device__ void pass_front(unsigned size);
  __device__ Vec3 pass(std::uint32_t j, std::uint32_t after);
  __device__ bool gives_normal(std::uint32_t word, std::uint32_t i, std::uint32_t j) const;

  const PaperLevel& level_;
  const PaperSpace& space_;
  PaperCounters& counters_;
  Team& team_;
  Tile tile_;
  std::uint32_t front_ = 0, begin_ = 0;  // where its spheres begin in the list
  RawResult result_;
};

// Steps 3 and 4: a tile for each boundary sphere.
template <class Team>
__device__ void PaperFlood<Team>::enter() {
  const unsigned count = read(counters_.boundary);
  for (unsigned k = first(); k < count; k += step()) {
    const std::uint32_t i = space_.boundary[k];
    const Sphere s = level_.spheres[i];
    const Vec3 normal = space_.contacts[i].mean_normal();
    if (tile_.leads()) {
      space_.normals[i] = normal;
      add_boundary(level_.tool, s, space_.contacts[i], normal, result_.sum);
      ++result_.boundary;
    }
    for (std::uint32_t n = level_.graph_begin[i] + tile_.lane; n < level_.graph_begin[i + 1];
         n += tile_.width) {
      const std::uint32_t j = level_.neighbors[n];
      if (read(space_.words[j]) == 0 && lets_in(s, normal, level_.spheres[j])) claim(j, 0);
    }
  }
}

// Step 5 for one front: a tile for each of its spheres.
template <class Team>
__device__ void PaperFlood<Team>::pass_front(unsigned size) {
  if (team_.thread() == 0) counters_.fronts[(front_ + 2) % 3] = 0;
  for (unsigned k = first(); k < size; k += step()) {
    const std::uint32_t j = space_.inside[begin_ + k];
    const Vec3 normal = pass(j, begin_ + size);
    if (!tile_.leads()) continue;
    space_.normals[j] = normal;
    add_inside(level_.tool, level_.spheres[j], normal, result_.sum);
    ++result_.inside;
  }
}

// Claims what the sphere leads to, `after` the end of this front in the list, and returns its
// normal: normals are added in the order of the neighbours.
template <class Team>
__device__ Vec3 PaperFlood<Team>::pass(std::uint32_t j, std::uint32_t after) {
  const std::uint32_t end = level_.graph_begin[j + 1];
  Vec3 normal;
  for (std::uint32_t n = level_.graph_begin[j]; n < end; n += tile_.width) {
    const bool active = n + tile_.lane < end;
    const std::uint32_t i = active ? level_.neighbors[n + tile_.lane] : j;
    const std::uint32_t word = read(space_.words[i]);
    if (word == 0) claim(i, after);
    const bool gives = active && gives_normal(word, i, j);
    const Vec3 theirs = gives ? space_.normals[i] : Vec3{};
    for (unsigned rest = ballot(gives); rest != 0; rest &= rest - 1) {
      const unsigned from = __ffs(static_cast<int>(rest)) - 1;
      normal +=
          Vec3{tile_.from(theirs.x, from), tile_.from(theirs.y, from), tile_.from(theirs.z, from)};
    }
  }
  return normalized_or_zero(normal);
}

// An entered sphere takes the normals of the boundary spheres that let it in, a later one those of
// the front before.
template <class Team>
__device__ bool PaperFlood<Team>::gives_normal(std::uint32_t word, std::uint32_t i,
                                               std::uint32_t j) const {
  if (front_ > 1) return word == front_ - 1;
  return word == PaperSpace::kBoundary &&
         lets_in(level_.spheres[i], space_.normals[i], level_.spheres[j]);
}

}  // namespace vpm::cuda
