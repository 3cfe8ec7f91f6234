// Errors of a measure along a path, relative to the tool, counted only where the truth can be
// known.
#pragma once

#include <vpm/query_types.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "libvpm/synthetic/truth.h"
#include "tools/bench/sight.h"
#include "tools/bench/statistics.h"

namespace vpm::bench {

// Smallest penetration, as a fraction of the tool's volume, at which force directions are compared.
inline constexpr double kForceMatters = 0.01;
// Largest fraction of the inside volume whose depth no camera can know; force and torque are
// compared below it.
inline constexpr double kDepthKnown = 0.01;

// Errors over one path. Volumes are fractions of the tool's, torques fractions of volume times tool
// radius, angles degrees. `jump` is how much the volume moves between neighbouring poses beyond
// what the truth and the unknown part move.
struct Errors {
  MeanAndWorst volume, jump, force, direction, torque;
};

// Returns how far `volume` lies outside of its bounds, as a fraction of the tool's volume. The
// lower bound is the truth without what cannot be known to be inside, the upper one the truth with
// what cannot be known to be free.
double volume_error(double volume, double truth, const Unseen& unseen);

Errors compare(const std::vector<Result>& measured,
               const std::vector<synthetic::Penetration>& truth, const std::vector<Unseen>& unseen,
               const synthetic::TrueSolid& tool);

nlohmann::json to_json(const Errors& errors);

// Errors over the cases of a group: the mean of their means and the worst of their worsts.
struct GroupErrors {
  MeanAndWorst volume, jump, direction, torque;  // with the mean of each case
  MeanAndWorst volume_worst, direction_worst, torque_worst;
  void add(const Errors& errors);
};

}  // namespace vpm::bench
