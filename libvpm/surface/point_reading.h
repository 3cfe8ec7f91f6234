#pragma once

#include "libvpm/include/vpm/camera.h"
