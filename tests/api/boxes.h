// Boxes and faults, by the public headers alone.
#pragma once

#include <gtest/gtest.h>
#include <vpm/error.h>
#include <vpm/solid.h>

#include <array>
#include <cstdint>
#include <vector>

namespace vpm::test {

// Returns a closed box between two corners, m.
inline SolidMesh box(Vec3 low, Vec3 high) {
  std::vector<Vec3> corners;
  for (int k = 0; k < 8; ++k)
    corners.push_back({(k & 1) != 0 ? high.x : low.x, (k & 2) != 0 ? high.y : low.y,
                       (k & 4) != 0 ? high.z : low.z});
  const std::vector<std::array<std::uint32_t, 3>> triangles{
      {0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return SolidMesh::from_triangles(corners, triangles, {.scale = 1});
}

// Returns the kind of error that a call throws, and fails the test if it throws none.
ErrorKind kind_of(const auto& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.kind();
  }
  ADD_FAILURE() << "nothing is thrown";
  return {};
}

}  // namespace vpm::test
