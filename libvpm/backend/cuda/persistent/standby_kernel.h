// The kernel that stands by for single poses of the refined measure in depth images. For
// refined_measure.cu.
#pragma once

#include "libvpm/backend/cuda/persistent/orders.h"
#include "libvpm/backend/cuda/refined_kernels.h"

namespace vpm::cuda {
namespace {

// Answers one query after another (orders.h), until none comes.
__global__ void __launch_bounds__(kThreads, kFewBlocks)
    stand_by_kernel(const __grid_constant__ OrdersView view, unsigned first) {
  using Launch = RefinedLaunch<DepthSurface>;
  __shared__ BlockShared<DepthSurface> shared;
  __shared__ Launch launch;
  __shared__ Order order;
  __shared__ PoseFrame frame;
  Orders orders(view, first, order);
  bool leads = blockIdx.x == 0;
  for (unsigned number = first;; ++number) {
    orders.receive(number, leads);
    if (order.leaves != 0) return;
    if (threadIdx.x == 0) frame.to_surface = order.to_surface;
    copy_words(*static_cast<const Launch*>(order.launch), launch);
    __syncthreads();
    GridTeam team(&launch.totals->arrived);
    leads = answer_pose<Arguments::shared>(launch, frame, order.turn, team, shared);
  }
}

}  // namespace
}  // namespace vpm::cuda
