// Errors of a measure along a path, relative to the tool, where the truth can be known.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "libvpm/query/result.h"
#include "libvpm/synthetic/truth.h"
#include "tools/bench/sight.h"
#include "tools/bench/statistics.h"

namespace vpm::bench {

// A force direction means something from this part of the tool's volume on.
inline constexpr double kForceMatters = 0.01;
// Force and torque are compared where less than this part of what is inside has a depth that no
// camera can know.
inline constexpr double kDepthKnown = 0.01;

// Volumes in parts of the tool's, torques in parts of volume times reach, angles in degrees. `jump`
// is how much the volume moves between neighbouring poses beyond what the truth, and what is not
// known, moves.
struct Errors {
  MeanAndWorst volume, jump, force, direction, torque;
};

// How far a volume is from what it may be: between the truth less what of it cannot be known to be
// inside, and the truth plus what cannot be known to be free. Parts of the tool's volume.
double volume_error(double volume, double truth, const Unseen& unseen);

Errors compare(const std::vector<Result>& measured,
               const std::vector<synthetic::Penetration>& truth, const std::vector<Unseen>& unseen,
               const synthetic::TrueSolid& tool);

nlohmann::json to_json(const Errors& errors);

// Over the cases of a group: mean of means, worst of worsts.
struct GroupErrors {
  MeanAndWorst volume, jump, direction, torque;  // of each case: mean
  MeanAndWorst volume_worst, direction_worst, torque_worst;
  void add(const Errors& errors);
};

}  // namespace vpm::bench
