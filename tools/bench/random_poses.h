// Ten thousand random poses per scene and point spacing: does anything ever leak?
//
// A leak is an error above kLeak of the tool. Truth is a count of places in the tool; what no
// camera can know counts for neither side (sight.h).
#pragma once

#include <cstdint>
#include <vector>

#include "libvpm/device/device.h"
#include "libvpm/query/shadows.h"
#include "libvpm/synthetic/scenes.h"
#include "tools/bench/penetration_case.h"
#include "tools/bench/statistics.h"

namespace vpm::bench {

inline constexpr double kLeak = 0.02;

struct RandomPoses {
  MeanAndWorst error[2];  // of Measure::refined, Measure::paper
  int leaks[2] = {};
  int poses = 0, paper_poses = 0;
};

// The scene's camera with the same field of view, but points `spacing` metres apart at 1 m.
Camera camera_of_spacing(double spacing);

// `poses` poses with 0 to 60 % of the tool inside; the same for the same seed. The surface is
// rendered without noise, normals are estimated from the image. Each tool takes its turn. `shadows`
// are those of the refined measure. The measure as printed looks at every eighth pose only: it
// takes most of the time.
RandomPoses run_random_poses(const synthetic::Scene& scene,
                             const std::vector<const PackedSolid*>& tools, std::uint32_t level,
                             int poses, std::uint64_t seed, Shadows shadows, const Device& device);

}  // namespace vpm::bench
