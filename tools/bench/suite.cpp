#include "tools/bench/suite.h"

#include <algorithm>

#include "libvpm/core/error.h"

namespace vpm::bench {
namespace {

struct Suite {
  const char* name;
  Report (*run)(const SuiteOptions& options);
  bool takes_device = false;
};

constexpr Suite kSuites[] = {{"accuracy", run_accuracy},     {"extremes", run_extremes},
                             {"packing", run_packing},       {"replay", run_replay},
                             {"scaling", run_scaling, true}, {"timing", run_timing},
                             {"tradeoff", run_tradeoff}};

const Suite* find_suite(const std::string& name) {
  const auto found = std::ranges::find(kSuites, name, &Suite::name);
  return found == std::end(kSuites) ? nullptr : found;
}

}  // namespace

std::string suite_names(bool on_device) {
  std::string names;
  for (const Suite& suite : kSuites) {
    if (suite.takes_device || !on_device)
      names += (names.empty() ? "" : ", ") + std::string(suite.name);
  }
  return names;
}

bool takes_device(const std::string& name) {
  const Suite* const suite = find_suite(name);
  return suite != nullptr && suite->takes_device;
}

Report run_suite(const std::string& name, const SuiteOptions& options) {
  const Suite* const suite = find_suite(name);
  if (suite == nullptr) {
    throw Error(ErrorKind::usage,
                (name.empty() ? std::string("name a suite") : "there is no suite '" + name + "'") +
                    "; the suites are " + suite_names());
  }
  if (options.device.is_cuda() && !suite->takes_device) {
    throw Error(ErrorKind::unavailable,
                name + " computes on the CPU only (on a device: " + suite_names(true) +
                    "); use --device cpu, or leave the option out");
  }
  return suite->run(options);
}

}  // namespace vpm::bench
