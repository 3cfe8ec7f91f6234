#include <vpm/version.h>

namespace vpm {

const char* version() noexcept {
  return VPM_VERSION;
}

}  // namespace vpm
