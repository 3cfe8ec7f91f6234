// Random poses of tools in each scene at several point spacings, to find leaks.
//
// A leak is an error above kLeak of the tool's volume. The truth is a count of places in the tool;
// places that no camera can know count for neither side (sight.h).
#pragma once

#include <vpm/query_types.h>

#include <cstdint>
#include <vector>

#include "libvpm/device/device.h"
#include "libvpm/synthetic/render.h"
#include "libvpm/synthetic/scenes.h"
#include "tools/bench/penetration_case.h"
#include "tools/bench/statistics.h"

namespace vpm::bench {

inline constexpr double kLeak = 0.02;  // in parts of the tool's volume

struct RandomPoses {
  MeanAndWorst error[2];  // indexed by Measure::refined, Measure::paper
  int leaks[2] = {};
  int poses = 0, paper_poses = 0;
};

// Returns the scene's camera with the same field of view and points `spacing` metres apart at 1 m.
Camera camera_of_spacing(double spacing);

// Runs `poses` poses with 0 to 60 % of the tool inside, the same for the same seed; tools take
// turns. The surface is rendered without noise and normals are estimated from the image. `shadows`
// is for the refined measure. The measure as printed runs at every eighth pose only, since it takes
// most of the time.
RandomPoses run_random_poses(const synthetic::Scene& scene,
                             const std::vector<const PackedSolid*>& tools, std::uint32_t level,
                             int poses, std::uint64_t seed, Shadows shadows, const Device& device);

// Returns the k-th of random poses: any rotation, at a place with a bell-shaped distribution around
// the scenes' middle. `reach` is the tool's, m.
Pose random_pose(std::uint64_t seed, std::uint64_t k, double reach);

}  // namespace vpm::bench
