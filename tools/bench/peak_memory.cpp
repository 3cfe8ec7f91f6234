#include "tools/bench/peak_memory.h"

#include <fstream>
#include <string>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace vpm::bench {
namespace {

// Returns freed memory to the system, which would otherwise count.
void give_back_freed() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

double status_mb(const std::string& key) {
  constexpr double kKibibyte = 1024e-6;  // in MB
  std::ifstream in("/proc/self/status");
  for (std::string line; std::getline(in, line);)
    if (line.rfind(key, 0) == 0) return kKibibyte * std::stod(line.substr(key.size()));
  return 0;
}

}  // namespace

void reset_peak_memory() {
  give_back_freed();
  std::ofstream("/proc/self/clear_refs") << "5";
}

double peak_memory_mb() {
  return status_mb("VmHWM:");
}

double resident_memory_mb() {
  give_back_freed();
  return status_mb("VmRSS:");
}

}  // namespace vpm::bench
