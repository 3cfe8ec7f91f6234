#pragma once

#include "libvpm/include/vpm/query_types.h"
