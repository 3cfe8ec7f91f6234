// A long replay of queries whose every input is made here, by IEEE operations alone, so that its
// bytes must be the same from every compiler, flag and machine.
#pragma once

#include <cstddef>
#include <vector>

#include "libvpm/device/device.h"

namespace vpm::testing {

// Noisy images of three scenes become clouds by both estimators of normals, with and without their
// camera; two tools move through each, by both measures: 2016 queries. The bytes are those of the
// clouds, of every result and of the spheres' states. Takes about two seconds. `device`: of the
// queries.
std::vector<std::byte> replay(const Device& device = {});

}  // namespace vpm::testing
