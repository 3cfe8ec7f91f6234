// A long replay of queries whose every input is made here, by IEEE operations alone, so that its
// bytes must be the same from every compiler, flag and machine.
#pragma once

#include <cstddef>
#include <vector>

namespace vpm::testing {

// Noisy images of three scenes become clouds by both estimators of normals, with and without their
// camera; two tools move through each, by both measures: 2016 queries. The bytes are those of the
// clouds, of every result and of the spheres' states. Takes about two seconds.
std::vector<std::byte> replay();

}  // namespace vpm::testing
