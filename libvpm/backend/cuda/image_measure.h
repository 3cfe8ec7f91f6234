// Runs the first step of a query where a camera has seen the surface, for a level with no more task
// groups than a launch has warps: each warp takes one group and waits for no other.
#pragma once

#include "libvpm/backend/cuda/image_task_group.h"

namespace vpm::cuda {

// Measures a small level by all warps of a launch, one task group each.
class ImageMeasure {
 public:
  static constexpr unsigned kMostWarps = kMostThreads / 32;
  struct Shared {  // memory of a block
    alignas(ImageShared) unsigned char warps[kMostWarps][sizeof(ImageShared)];
  };

  __device__ ImageMeasure(const PoseWork<DepthSurface>& work, bool counts_points, Shared& shared)
      : work_(work),
        counts_points_(counts_points),
        shared_(*reinterpret_cast<ImageShared*>(shared.warps[threadIdx.x / 32])),
        sums_(work.notes) {}

  // True if the launch has enough warps for the level.
  __device__ static bool is_for(const LevelView& level, BlockRange part) {
    return level.of_warps.count > 0 && level.of_warps.count <= part.parts * (blockDim.x / 32);
  }
  // Returns the sums of this thread.
  __device__ RawResult run() {
    measure_chunk<TaskSums>();
    return sums_.found();
  }
  // Notes the planes of cut cells, which run() leaves out since few queries need them.
  __device__ void note_planes() { measure_chunk<ContactPlane>(); }

 private:
  // Deals neighbours to different blocks, since they often take long together.
  template <class Found>
  __device__ void measure_chunk() {
    const WarpTaskGroups& all = work_.level.of_warps;
    const unsigned c = threadIdx.x / 32 * work_.part.parts + work_.part.part;
    if (c >= all.count) return;
    const bool is_wide = c < all.wide_count;
    const unsigned at_once = is_wide ? WarpTaskGroups::kWideTasks : TaskGroup::kTasks;
    const WarpTask* const units = all.units +
                                  (is_wide ? 0 : all.wide_count * WarpTaskGroups::kWideTasks) +
                                  (is_wide ? c : c - all.wide_count) * at_once;
    ImageTaskGroup<Found>(work_, counts_points_, all.chunks[c].ball, units, 32 / at_once, shared_,
                          sums_)
        .measure();
  }

  const PoseWork<DepthSurface>& work_;
  bool counts_points_;
  ImageShared& shared_;
  ImageSums sums_;
};

}  // namespace vpm::cuda
