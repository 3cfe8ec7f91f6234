// Choice of the measure, beside its answer (vpm/result.h).
#pragma once

#include "libvpm/core/vec3.h"
#include "libvpm/include/vpm/result.h"

namespace vpm {

enum class Measure { refined, paper };

}  // namespace vpm
