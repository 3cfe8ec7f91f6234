// A part of an image, made by the query that reads it first: the steps of cloud_take.h,
// cloud_prepare.h and cloud_settle.h, between which the blocks of one launch meet. Only what
// DepthSurface reads is made, not the points.
#pragma once

#include "libvpm/surface/cuda/cloud_points.h"
#include "libvpm/surface/cuda/cloud_surface.h"
#include "libvpm/surface/cuda/cloud_take.h"

namespace vpm::cuda {

// An image, and all that is needed to make a cloud of it.
struct CloudSource {
  DepthSource image;
  TakenDepths taken;
  CloudRecipe recipe;
  CloudCounters* counters = nullptr;
  CloudAnswer* answer = nullptr;

  // What a camera's pose changes.
  VPM_HD void look_from(const Rotation& camera_to_world) {
    recipe.camera.to_world.rotation = camera_to_world;
    recipe.to_camera = relative_to({camera_to_world, {}}, {}).rotation;
  }
};

// Pixels of an image, whole tiles: what a query needs, and what of it was made before.
struct NewPart {
  PixelRectangle wanted, made;
  std::uint32_t sequence = 0;  // of the answer that says what came of them
};

// Whether these normals are among those that queries make themselves.
inline bool is_made_by_queries(const NormalOptions& normals) {
  return normals.method == NormalMethod::inverse_depth && normals.window / 2 == kUsualRadius;
}

// By all blocks of a launch, each of SmallTile's threads; all that was made is seen then.
template <class Team>
class PartWork {
  using Points = TileWork<InverseDepthNormals<TileFrame<SmallTile, kUsualRadius>>>;
  using Surface = SettleWork<SmallTile>;

 public:
  // Memory of a block.
  union Shared {
    alignas(16) unsigned char points[Points::bytes(kUsualRadius)];
    alignas(16) unsigned char surface[sizeof(Surface::Shared)];
  };

  __device__ PartWork(const CloudSource& source, const NewPart& part, Team& team, Shared& shared)
      : source_(source),
        settled_{part.wanted, part.made},
        prepared_(pixels_to_prepare(source.recipe, settled_)),
        taken_(pixels_to_take(source.recipe, settled_)),
        sequence_(part.sequence),
        team_(team),
        shared_(shared) {}

  __device__ void run() {
    take();
    team_.sync();
    prepare();
    if (team_.arrive() && threadIdx.x == 0)
      answer_with(*source_.counters, source_.answer, sequence_);
    team_.wait();
    settle();
    team_.sync();
  }

 private:
  // Groups side by side by the lanes of a warp; warps of all blocks, before more of one.
  __device__ void take() const {
    const TakenDepths taken{nullptr, source_.taken.inverse};
    const TakeWork<4, true> work(source_.image, taken, taken_, source_.recipe.camera.width);
    const unsigned warp = threadIdx.x / 32 * gridDim.x + blockIdx.x;
    const unsigned thread = warp * 32 + threadIdx.x % 32, threads = gridDim.x * blockDim.x;
    for (unsigned group = thread; group < work.groups(); group += threads) work.take(group);
    if (!is_empty(settled_.made)) return;
    clear_coarse_tiles(source_.recipe.room, source_.recipe.camera, thread, threads);
    if (thread == 0) source_.counters->points = source_.counters->doubtful = 0;
  }

  __device__ void prepare() const {
    __shared__ unsigned gated, doubtful;
    if (threadIdx.x == 0) doubtful = 0;
    for_tiles(prepared_, [&](int tile) {
      const Points work(source_.recipe, prepared_, tile, shared_.points);
      if (work.is_done()) return;
      if (threadIdx.x == 0) gated = 0;
      find_normals(work, gated);
      work.see_pixels(doubtful);
    });
    if (threadIdx.x == 0) count(0, doubtful, *source_.counters);
  }

  __device__ void settle() const {
    auto& shared = *reinterpret_cast<typename Surface::Shared*>(shared_.surface);
    for_tiles(settled_, [&](int tile) {
      const Surface work(source_.recipe, settled_, tile, shared);
      if (!work.is_done()) settle_tile(work, source_.recipe.points);
    });
  }

  // This block's.
  template <class Visit>
  __device__ static void for_tiles(const StepPixels& pixels, const Visit& visit) {
    const int count = pixels.tile_count<SmallTile>();
    for (int tile = static_cast<int>(blockIdx.x); tile < count;
         tile += static_cast<int>(gridDim.x)) {
      visit(tile);
      __syncthreads();
    }
  }

  const CloudSource& source_;
  StepPixels settled_, prepared_, taken_;
  unsigned sequence_;
  Team& team_;
  Shared& shared_;
};

}  // namespace vpm::cuda
