// Asks the measure and its peers the same poses, in turn in one process: errors, jitter, memory and
// time, one row for each setting of each peer.
#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/bench/peers/peer.h"
#include "tools/bench/sight.h"
#include "tools/bench/suite.h"

namespace vpm::bench {

// What is true at a pose. Where no camera can know it, or nobody has a truth, there is no wrench.
struct PeerTruth {
  double volume = 0;  // m^3
  Unseen unseen;      // by which the volume may differ, fractions of the tool's
  bool has_wrench = false;
  Wrench wrench;
};

// A peer at one setting. Settings of one peer stand together, coarsest first.
struct Contender {
  std::string peer, setting;
  std::unique_ptr<Peer> asked;
  // Whether its force has a unit of its own: then it is multiplied by the factor that fits the
  // truth best (least squares over all poses), which no user has, but which flatters.
  bool is_scaled = false;
  const std::vector<PeerTruth>* truth = nullptr;  // one of each pose, of the peer's own energy
};

// `frame` counts from 0; the same one gives the same scene. Contenders are the same for all frames.
using ContendersOf = std::function<std::vector<Contender>(std::size_t frame)>;

struct Contest {
  std::string kind, name;         // kind: walls, clutter, recorded or pairs
  double volume = 0, radius = 0;  // that errors are relative to: of the tool, or the smaller solid
  std::vector<Pose> poses;
  ContendersOf contenders;
  // Memory of a field of all that the tool may meet, such as a voxmap made beforehand has; 0: that
  // of the contenders is one.
  std::size_t whole_field = 0;
  // Of the scene of `contenders(k)`, k > 0: the same with other noise. None: no jitter is told.
  std::size_t noisy_frames = 0;
  std::vector<Pose> still;  // poses at which the force is followed over these frames
};

// Budgets for a query, us: of each peer the finest setting whose median is within one is marked.
inline constexpr double kBudgets[] = {100, 1000};
// Contacts above which a force is the mean of all times this number (McNeely et al. 1999).
inline constexpr std::size_t kContactsSummed = 10;

// Adds a row for each contender to `rows`. Errors of the volume are relative to Contest::volume, as
// are those of forces; those of torques to volume times radius. NaN, which JSON writes as null,
// stands for what a peer does not tell.
void run_contest(const Contest& contest, const SuiteOptions& options, nlohmann::json& rows);

// The kinds of scenes. Each calls `run` for its contests, one after the other.
using RunContest = std::function<void(const Contest&)>;
void contests_of_depth(const SuiteOptions& options, const RunContest& run);
void contests_of_pairs(const SuiteOptions& options, const RunContest& run);

}  // namespace vpm::bench
