#include "tools/bench/peak_memory.h"

#include <fstream>
#include <string>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace vpm::bench {

void reset_peak_memory() {
#ifdef __GLIBC__
  malloc_trim(0);  // what earlier work has freed would count
#endif
  std::ofstream("/proc/self/clear_refs") << "5";
}

double peak_memory_mb() {
  constexpr double kKibibyte = 1024e-6;  // in MB
  std::ifstream in("/proc/self/status");
  for (std::string line; std::getline(in, line);)
    if (line.rfind("VmHWM:", 0) == 0) return kKibibyte * std::stod(line.substr(6));
  return 0;
}

}  // namespace vpm::bench
