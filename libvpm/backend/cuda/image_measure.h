// The first step of a query where a camera has seen the surface, of a level that has no more chunks
// than a launch has warps: each takes one (units, blocks of the shares of one cluster), and waits
// for no other.
#pragma once

#include "libvpm/backend/cuda/image_task_group.h"

namespace vpm::cuda {

// All of a small level, by all warps of a launch, a chunk each.
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

  // Whether there are enough.
  __device__ static bool is_for(const LevelView& level, BlockRange part) {
    return level.of_warps.count > 0 && level.of_warps.count <= part.parts * (blockDim.x / 32);
  }
  // Returns what this thread has added up.
  __device__ RawResult run() {
    measure_chunk<TaskSums>();
    return sums_.found();
  }
  // Notes the planes of cut shares, which run() leaves out. Seldom needed.
  __device__ void note_planes() { measure_chunk<ContactPlane>(); }

 private:
  // Neighbours go to different blocks: they often take long together.
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
