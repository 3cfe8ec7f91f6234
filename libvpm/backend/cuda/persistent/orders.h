// How a kernel that stands by is told of the next pose, without a launch.
//
// The host writes an order into its own memory. A warp of one block looks there and passes it on to
// the other blocks in the device's memory: of the block that was the last to be done with the order
// before, which so needs not be told that all are.
#pragma once

#include "libvpm/backend/cuda/answer.h"
#include "libvpm/backend/cuda/views.h"

namespace vpm::cuda {

struct Order {
  const void* launch = nullptr;  // the query's arguments, on the device
  Pose to_surface;               // of PoseFrame
  std::uint32_t turn = 0;        // of the query
  std::uint32_t waits_us = 0;    // for the next order
  std::uint32_t leaves = 0;      // not 0: instead of a query
  std::uint32_t unused[3] = {};
};

// A word for each lane of a warp.
struct OrderWords {
  static constexpr unsigned kWords = 32;
  static_assert(sizeof(Order) == kWords * sizeof(std::uint32_t));

  NumberedWord words[kWords] = {};
};

// What a kernel that stands by sees of its orders.
struct OrdersView {
  static constexpr unsigned kCopies = 4;  // so that not all blocks look at one place

  OrderWords* given = nullptr;      // by the host, in its memory
  OrderWords* passed_on = nullptr;  // by the block that leads, kCopies
  unsigned* left = nullptr;         // in the host's memory: the order at which the kernel left
};

class Orders {
 public:
  // `order`: in the block's shared memory.
  __device__ Orders(const OrdersView& view, unsigned first, Order& order)
      : view_(view), first_(first), order_(order) {}

  // By all threads of all blocks: the order of this number, or one to leave if the host gives none
  // in time. One block leads: some block at first, then the last to be done with the order before.
  // What was done for that order is seen then; so is what came to the device's memory by transfers
  // and kernels that had ended when the host gave this one, since nothing older is kept nearer than
  // there.
  __device__ void receive(unsigned number, bool leads) {
    if (threadIdx.x < 32) {
      if (leads)
        pass_on(number, wait_for_host(number));
      else
        take(wait_for_leader(number));
    }
    __syncthreads();
  }

 private:
  static constexpr std::uint64_t kFirstWait = 10'000'000;  // ns; the order was given already

  // Returns this lane's word of the order, when all have come or it is too late. `look(word)`.
  template <class BallClass, class IsLate>
  __device__ static NumberedWord wait(OrderWords& order, unsigned number, const BallClass& in_ball,
                                      const IsLate& is_late) {
    constexpr unsigned kLeaves = offsetof(Order, leaves) / sizeof(std::uint32_t);
    for (;;) {
      const NumberedWord mine = in_ball(order.words[threadIdx.x]);
      if (__all_sync(~0U, number_of(mine) == number) != 0) return mine;
      if (__any_sync(~0U, is_late()) != 0) return numbered(number, threadIdx.x == kLeaves ? 1 : 0);
    }
  }
  // What the block that leads has seen is seen then.
  __device__ NumberedWord wait_for_leader(unsigned number) const {
    using Word = ::cuda::atomic_ref<NumberedWord, ::cuda::thread_scope_device>;
    return wait(
        view_.passed_on[blockIdx.x % OrdersView::kCopies], number,
        [](NumberedWord& word) { return Word(word).load(::cuda::memory_order_acquire); },
        [] { return false; });
  }
  __device__ NumberedWord wait_for_host(unsigned number) const {
    const std::uint64_t most =
        number == first_ ? kFirstWait : std::uint64_t{order_.waits_us} * 1000;
    fence();  // for what this block has seen to be passed on too; now, while nobody waits
    const std::uint64_t begin = now();
    return wait(
        *view_.given, number, [](const NumberedWord& word) { return look_at(word); },
        [&] { return now() - begin > most; });
  }
  __device__ void take(NumberedWord mine) {
    __syncwarp();  // who has read the order before is done
    reinterpret_cast<std::uint32_t*>(&order_)[threadIdx.x] = value_of(mine);
  }
  __device__ void pass_on(unsigned number, NumberedWord mine) {
    for (unsigned copy = 0; copy < OrdersView::kCopies; ++copy)
      put(mine, view_.passed_on[copy].words[threadIdx.x]);
    take(mine);
    __syncwarp();
    if (order_.leaves != 0 && threadIdx.x == 0)
      *static_cast<volatile unsigned*>(view_.left) = number;
  }

  const OrdersView& view_;
  unsigned first_;
  Order& order_;
};

// Copies into a block's shared memory, by all its threads.
template <class T>
__device__ void copy_words(const T& from, T& to) {
  static_assert(sizeof(T) % sizeof(std::uint64_t) == 0);
  for (unsigned k = threadIdx.x; k < sizeof(T) / sizeof(std::uint64_t); k += blockDim.x)
    reinterpret_cast<std::uint64_t*>(&to)[k] = reinterpret_cast<const std::uint64_t*>(&from)[k];
}

}  // namespace vpm::cuda
