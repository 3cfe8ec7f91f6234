// Finds connected components with many threads at once, as a forest in which every root is the
// smallest member of its tree. Roots are hooked below smaller ones with compare-and-swap, so the
// components do not depend on the order of threads.
#pragma once

#include <cstdint>
#include <cuda/atomic>

namespace vpm::cuda {

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

}  // namespace vpm::cuda
