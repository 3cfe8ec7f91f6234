// assembly-time: how long the pairs of a large assembly take, beside a loop over all pairs.
//
//   assembly-time [PARTS_PER_SIDE]    10, if it is not given: 1000 parts
//
// The parts are tori of 2000 triangles, each of its own size and turn, in a grid whose neighbours
// overlap. Prints times, medians of five runs, and what either way misses as JSON. Exit status 1 if
// the two ways differ.
#include <vpm/device.h>
#include <vpm/solid.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <nlohmann/json.hpp>
#include <random>
#include <vector>

#include "libvpm/api/handle_access.h"
#include "libvpm/core/pose.h"
#include "libvpm/solid/solid_surface.h"
#include "libvpm/synthetic/shapes.h"

namespace vpm {
namespace {

constexpr double kRing = 0.03, kTube = 0.01;  // m
constexpr OverlapOptions kVolumeOnly{.with_force = false};

template <class Job>
double seconds_of(const Job& job) {
  const auto start = std::chrono::steady_clock::now();
  job();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Returns the medians of five runs: of the time, and of the time of all processors together.
nlohmann::ordered_json medians_of_five(const auto& job) {
  std::vector<double> seconds, processors;
  for (int k = 0; k < 5; ++k) {
    const std::clock_t start = std::clock();
    seconds.push_back(seconds_of(job));
    processors.push_back(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  std::ranges::sort(seconds);
  std::ranges::sort(processors);
  return {{"seconds", seconds[2]}, {"processor_seconds", processors[2]}};
}

// Returns the parts, of which neighbours along x, y and z overlap by up to a twentieth of the tube.
std::vector<Part> assembly(int per_side) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> turn(0, 6.28), size(1, 1.01);
  const double aside = 1.95 * (kRing + kTube), above = 1.95 * kTube;
  std::vector<Part> parts;
  for (int z = 0; z < per_side; ++z)
    for (int y = 0; y < per_side; ++y)
      for (int x = 0; x < per_side; ++x) {
        const double scale = size(random);
        const Solid torus = synthetic::make_torus(scale * kRing, scale * kTube, 40, 25);
        parts.push_back({HandleAccess::make<SolidBody>(SolidSurface(torus, false)),
                         {exact_rotation(rotation_from_vector({0, 0, turn(random)})),
                          {aside * x, aside * y, above * z}}});
      }
  return parts;
}

// Asks all pairs of parts, as a program does that has no boxes.
std::vector<OverlappingPair> by_a_loop(const std::vector<Part>& parts) {
  std::vector<OverlappingPair> found;
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (std::size_t j = i + 1; j < parts.size(); ++j) {
      const Overlap shared = overlap(parts[i].solid, parts[i].to_world, parts[j].solid,
                                     parts[j].to_world, kVolumeOnly);
      if (shared.volume > 0) found.push_back({i, j, shared, {}});
    }
  return found;
}

// Returns how many pairs of the first list the second has not, or with other bits.
std::size_t missed(const std::vector<OverlappingPair>& all,
                   const std::vector<OverlappingPair>& found) {
  return static_cast<std::size_t>(std::ranges::count_if(all, [&](const OverlappingPair& pair) {
    return std::ranges::none_of(found, [&](const OverlappingPair& other) {
      return pair.first == other.first && pair.second == other.second &&
             pair.overlap == other.overlap;
    });
  }));
}

int run(int per_side) {
  std::vector<Part> parts;
  nlohmann::ordered_json report;
  const double prepare_seconds = seconds_of([&] { parts = assembly(per_side); });
  report["parts"] = parts.size();
  report["triangles"] = parts.front().solid.triangles();
  report["prepare_seconds"] = prepare_seconds;
  std::vector<OverlappingPair> found;
  for (const int threads : {1, 2}) {
    set_thread_count(threads);
    report["threads " + std::to_string(threads)] =
        medians_of_five([&] { found = overlapping_pairs(parts); });
  }
  const std::clock_t start = std::clock();
  const std::vector<OverlappingPair> all = by_a_loop(parts);
  report["loop over all pairs"] = {
      {"processor_seconds", static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC}};
  report["pairs"] = found.size();
  report["missed"] = missed(all, found);
  report["false"] = missed(found, all);
  std::cout << report.dump(2) << '\n';
  return report["missed"] == 0 && report["false"] == 0 ? 0 : 1;
}

}  // namespace
}  // namespace vpm

int main(int argc, char** argv) {
  return vpm::run(argc > 1 ? std::max(std::atoi(argv[1]), 2) : 10);
}
