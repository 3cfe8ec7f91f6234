// Connected components by many threads at once: a forest in which every root is the smallest member
// of its tree. Roots are hooked below smaller ones with compare-and-swap, so the components do not
// depend on the order of the threads.
#pragma once

#include <cstdint>
#include <cuda/atomic>

namespace vpm::cuda {

class UnionFind {
 public:
  __device__ explicit UnionFind(std::uint32_t* parents) : parents_(parents) {}

  __device__ void reset(std::uint32_t node) const { parents_[node] = node; }

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

  __device__ void join(std::uint32_t a, std::uint32_t b) const {
    for (;;) {
      a = root(a), b = root(b);
      if (a == b) return;
      if (a < b) {
        const std::uint32_t swap = a;
        a = b;
        b = swap;
      }
      if (atomicCAS(parents_ + a, a, b) == a) return;
    }
  }

 private:
  // Other threads write meanwhile.
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
