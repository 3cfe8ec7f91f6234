// What vpm asks of OpenVDB. It stands in a library of its own, libvpm_voxels.so, which is loaded
// when it is first asked: OpenVDB takes a tenth of a second to load, as long as many a command
// takes, and only repair and validation by voxels need it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "libvpm/core/vec3.h"
#include "libvpm/model/solid.h"

namespace vpm {

// Signed distances from a surface to the centres of voxels, in voxels: negative inside, clamped to
// a band.
class VoxelDistances {
 public:
  // Reads the distance of one voxel after the other, sooner where they are neighbours. Each thread
  // needs a reader of its own.
  class Reader {
   public:
    virtual ~Reader() = default;
    virtual float at(int x, int y, int z) = 0;
  };

  virtual ~VoxelDistances() = default;
  virtual std::unique_ptr<Reader> reader() const = 0;
};

// Values of a field in 8 x 8 x 8 voxels, z fastest.
struct VoxelBlock {
  static constexpr int kEdge = 8;  // of OpenVDB's leaves

  std::array<int, 3> origin{};  // the lowest voxel
  float everywhere = 0;         // the value of all, or 0 if `values` holds them
  std::array<float, kEdge * kEdge * kEdge> values{};
};

struct VoxelFaces {
  std::vector<Vec3f> points;  // in voxels
  std::vector<Triangle> triangles;
  std::vector<std::array<std::uint32_t, 4>> quads;
};

class VoxelLibrary {
 public:
  virtual ~VoxelLibrary() = default;
  // Returns the distances from triangles of points, whose coordinates are in voxels. What cannot be
  // reached from outside is inside.
  virtual std::unique_ptr<VoxelDistances> distances(std::span<const Vec3f> points,
                                                    std::span<const Triangle> triangles,
                                                    float band) const = 0;
  // Returns the surface on which a field is zero. The field is `outside` where no block is; only
  // voxels whose value is smaller in size take part.
  virtual VoxelFaces zero_surface(std::span<const VoxelBlock> blocks, float outside) const = 0;
};

// Loads the library at the first call. Throws Error(unavailable) where it is not. Thread-safe, as
// are its functions.
const VoxelLibrary& voxel_library();

// The library, and its function that returns the VoxelLibrary.
inline constexpr const char* kVoxelLibrary = "libvpm_voxels.so";
inline constexpr const char* kVoxelFunctions = "vpm_voxel_functions";

}  // namespace vpm
