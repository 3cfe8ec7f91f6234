#pragma once

#include "libvpm/core/pose.h"
#include "libvpm/include/vpm/virtual_coupling.h"
