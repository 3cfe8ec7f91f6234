// Tables of the results of `vpm-bench tradeoff`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libvpm/query/scene_scale.h"
#include "tools/bench/errors.h"
#include "tools/bench/report.h"

namespace vpm::bench {

struct Measured {
  std::string varied;  // spheres, normals, stride or threads
  std::string shape, scene, noise, measure, method;
  int window = 0, stride = 0, threads = 0;
  std::uint32_t spheres = 0;
  double median_us = 0;  // time of a query
  Errors errors;
};

// Result of --max-error: the largest error of a pose, and the largest mean error of a scene.
struct Kept {
  std::string shape;
  double asked = 0;
  std::uint32_t spheres = 0;
  double worst = 0, mean = 0;
};

// Result of --deadline-us along a path into contact and back.
struct Deadline {
  std::string shape, scene, noise;
  double asked_us = 0;
  std::size_t queries = 0, kept = 0;
  std::uint32_t coarsest = 0, finest = 0;  // spheres of the levels that were used
};

// Error and time of one level of the usual packing in one case.
struct Fixed {
  std::uint32_t spheres = 0;
  double median_us = 0, volume_mean = 0;
};

// Result of --for-scene: a level of the usual packing and a packing made for the scene, beside all
// levels of the usual packing.
struct Fitted {
  std::string shape, scene, noise;
  SceneScale scale;
  std::uint32_t level = 0, packed = 0;  // spheres
  Errors level_errors, packed_errors;
  double level_us = 0, packed_us = 0;
  std::vector<Fixed> fixed;
};

struct TradeoffSettings {
  bool quick = false;
  std::vector<std::uint32_t> levels;
  int poses = 0;
  std::size_t cases = 0;
};

// Returns the indices of the points that no other point beats in both coordinates, sorted by x.
std::vector<std::size_t> pareto_front(const std::vector<double>& x, const std::vector<double>& y);

// Returns the index where a falling curve turns: the point furthest below the straight line between
// its ends, in logarithms. `x` ascends; all values are positive; there is at least one point.
std::size_t knee(const std::vector<double>& x, const std::vector<double>& y);

Report tradeoff_report(const TradeoffSettings& settings, const std::vector<Measured>& measured,
                       const std::vector<Kept>& kept, const std::vector<Deadline>& deadlines,
                       const std::vector<Fitted>& fitted);

}  // namespace vpm::bench
