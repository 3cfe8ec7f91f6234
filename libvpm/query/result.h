#pragma once

#include "libvpm/core/vec3.h"
#include "libvpm/include/vpm/query_types.h"
