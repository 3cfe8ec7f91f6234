#include "tools/bench/suite.h"

#include "libvpm/core/error.h"

namespace vpm::bench {

Report run_suite(const std::string& name, const SuiteOptions& options) {
  if (name == "accuracy") return run_accuracy(options);
  if (name == "timing") return run_timing(options);
  throw Error(ErrorKind::usage,
              (name.empty() ? std::string("name a suite") : "there is no suite '" + name + "'") +
                  "; the suites are accuracy, timing");
}

}  // namespace vpm::bench
