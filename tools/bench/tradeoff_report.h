// What `vpm-bench tradeoff` measured, as tables.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libvpm/query/scene_scale.h"
#include "tools/bench/errors.h"
#include "tools/bench/report.h"

namespace vpm::bench {

struct Measured {
  std::string varied;  // spheres, normals, stride, threads
  std::string shape, scene, noise, measure, method;
  int window = 0, stride = 0, threads = 0;
  std::uint32_t spheres = 0;
  double median_us = 0;  // of a query
  Errors errors;
};

// What --max-error chose: the largest error of a pose, and the largest mean of a scene.
struct Kept {
  std::string shape;
  double asked = 0;
  std::uint32_t spheres = 0;
  double worst = 0, mean = 0;
};

// Queries with --deadline-us along a path into contact and back.
struct Deadline {
  std::string shape, scene, noise;
  double asked_us = 0;
  std::size_t queries = 0, kept = 0;
  std::uint32_t coarsest = 0, finest = 0;  // spheres of the levels used
};

// A level of the usual packing in one case.
struct Fixed {
  std::uint32_t spheres = 0;
  double median_us = 0, volume_mean = 0;
};

// What --for-scene chose: a level of the usual packing, and a packing of its own; beside them all
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

// Indices of the points that no other beats in both coordinates, by x.
std::vector<std::size_t> pareto_front(const std::vector<double>& x, const std::vector<double>& y);

// Where a falling curve turns: the point furthest below the straight line between its ends, in
// logarithms. `x` ascends; all positive; at least one point.
std::size_t knee(const std::vector<double>& x, const std::vector<double>& y);

Report tradeoff_report(const TradeoffSettings& settings, const std::vector<Measured>& measured,
                       const std::vector<Kept>& kept, const std::vector<Deadline>& deadlines,
                       const std::vector<Fitted>& fitted);

}  // namespace vpm::bench
