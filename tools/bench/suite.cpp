#include "tools/bench/suite.h"

#include "libvpm/core/error.h"

namespace vpm::bench {

Report run_suite(const std::string& name, const SuiteOptions& options) {
  if (name == "accuracy") return run_accuracy(options);
  if (name == "extremes") return run_extremes(options);
  if (name == "timing") return run_timing(options);
  if (name == "tradeoff") return run_tradeoff(options);
  if (name == "packing") return run_packing(options);
  if (name == "replay") return run_replay(options);
  if (name == "scaling") return run_scaling(options);
  throw Error(
      ErrorKind::usage,
      (name.empty() ? std::string("name a suite") : "there is no suite '" + name + "'") +
          "; the suites are accuracy, extremes, packing, replay, scaling, timing, tradeoff");
}

}  // namespace vpm::bench
