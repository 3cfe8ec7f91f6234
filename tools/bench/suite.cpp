#include "tools/bench/suite.h"

#include <algorithm>
#include <functional>

#include "libvpm/core/error.h"

namespace vpm::bench {
namespace {

// Options that only some suites take.
enum Option : unsigned { kAll = 1, kMeshes = 2, kData = 4, kSeed = 16, kOccluded = 32 };

// Where a suite's queries are computed.
enum class Place { cpu, either, device };

struct Suite {
  const char* name;
  Report (*run)(const SuiteOptions& options);
  unsigned options = 0;
  Place place = Place::cpu;
};

constexpr Suite kSuites[] = {
    {"accuracy", run_accuracy, kAll | kData | kSeed | kOccluded, Place::either},
    {"cameras", run_cameras, 0, Place::either},
    {"extremes", run_extremes, 0, Place::either},
    {"intervals", run_intervals},
    {"packing", run_packing, kAll | kMeshes},
    {"pairs", run_pairs, kMeshes, Place::either},
    {"peers", run_peers, kMeshes | kData},
    {"replay", run_replay, kData, Place::either},
    {"scaling", run_scaling, kAll, Place::device},
    {"timing", run_timing, kData},
    {"tradeoff", run_tradeoff, 0, Place::either}};

const Suite* find_suite(const std::string& name) {
  const auto found = std::ranges::find(kSuites, name, &Suite::name);
  return found == std::end(kSuites) ? nullptr : found;
}

std::string names_of(const std::function<bool(const Suite&)>& is_meant) {
  std::string names;
  for (const Suite& suite : kSuites)
    if (is_meant(suite)) names += (names.empty() ? "" : ", ") + std::string(suite.name);
  return names;
}

// An option that is passed over would be taken for one that has changed nothing.
void check_options(const Suite& suite, const SuiteOptions& given) {
  const auto check = [&](bool is_given, Option option, const std::string& name) {
    if (is_given && (suite.options & option) == 0) {
      throw Error(ErrorKind::invalid_argument,
                  std::string(suite.name) + " takes no " + name + ", which is for " +
                      names_of([&](const Suite& other) { return (other.options & option) != 0; }) +
                      "; leave it out");
    }
  };
  check(given.all, kAll, "--all");
  check(!given.meshes.empty(), kMeshes, "--meshes");
  check(!given.data.empty(), kData, "--data");
  check(given.noise_seed != SuiteOptions::kUsualNoise, kSeed, "--noise-seed");
  check(given.shadows == Shadows::solid, kOccluded, "--shadows");
}

}  // namespace

std::string suite_names(bool on_device) {
  return names_of([&](const Suite& suite) { return suite.place != Place::cpu || !on_device; });
}

bool is_suite(const std::string& name) {
  return find_suite(name) != nullptr;
}

bool needs_device(const std::string& name) {
  const Suite* const suite = find_suite(name);
  return suite != nullptr && suite->place == Place::device;
}

Report run_suite(const std::string& name, const SuiteOptions& options) {
  const Suite* const suite = find_suite(name);
  if (suite == nullptr) {
    throw Error(ErrorKind::invalid_argument,
                (name.empty() ? std::string("name a suite") : "there is no suite '" + name + "'") +
                    "; the suites are " + suite_names());
  }
  if (options.device.is_cuda() && suite->place == Place::cpu) {
    throw Error(ErrorKind::unavailable,
                name + " computes on the CPU only (on a device: " + suite_names(true) +
                    "); use --device cpu, or leave the option out");
  }
  check_options(*suite, options);
  Report report = suite->run(options);
  if (options.device.is_cuda()) report.settings["device"] = device_name(options.device);
  return report;
}

}  // namespace vpm::bench
