#pragma once

#include "libvpm/core/pose.h"
#include "libvpm/include/vpm/query_types.h"
