#include "tools/query/gone_options.h"

#include "libvpm/core/error.h"

namespace vpm::tools {
namespace {

struct GoneOption {
  const char* name;
  const char* reason;
};

constexpr GoneOption kGone[] = {
    {"--reuse", "a coarser --level trades accuracy for speed"},
    {"--standby-us", "a device no longer stands by between poses, and results are the same"},
};

}  // namespace

void declare_gone_options(CLI::App& app) {
  for (const GoneOption& gone : kGone) {
    const auto refuse_it = [gone](const std::string&) {
      throw Error(ErrorKind::invalid_argument,
                  std::string(gone.name) + " is gone: leave it out; " + gone.reason);
    };
    app.add_option_function<std::string>(gone.name, refuse_it)->group("");
  }
}

}  // namespace vpm::tools
