#include "tools/query/mode.h"

namespace vpm::tools {

Mode mode_of(const Arguments& a) {
  if (a.tools.size() > 1) return Mode::several_tools;
  if (!a.replay.frames.empty()) return Mode::frames;
  if (!a.coupling.empty()) return Mode::coupling;
  if (a.batch > 1) return Mode::batches;
  return Mode::poses;
}

}  // namespace vpm::tools
