// A long replay of queries. It makes all inputs by IEEE operations alone, so its bytes must be the
// same from every compiler, flag and machine.
#pragma once

#include <cstddef>
#include <vector>

#include "libvpm/device/device.h"

namespace vpm::testing {

// Makes clouds of noisy images of three scenes by both estimators of normals, with and without
// their camera, and moves two tools through each by both measures: 2016 queries, computed on
// `device`. Returns the bytes of the clouds, of every result and of the spheres' states. Takes
// about two seconds.
std::vector<std::byte> replay(const Device& device = {});

}  // namespace vpm::testing
