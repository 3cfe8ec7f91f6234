// Reads clouds of other programs.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libvpm/core/pose.h"
#include "libvpm/import/remark.h"

namespace vpm {

// Points as a file gives them, in its unit and frame. Not finite where nothing was measured.
struct PointSet {
  std::uint32_t width = 0, height = 1;  // a sensor's grid, row by row, if height > 1
  std::vector<Vec3> positions;          // width * height
  std::vector<Vec3> normals;            // as many, or none; of any length
  std::optional<Pose> viewpoint;        // frame of the points to world, if the file tells it
  Remarks remarks;                      // warnings of data that the header does not count

  bool organised() const { return height > 1; }
  // Returns a coordinate of a point: 0 to 2 are x y z of its position, 3 to 5 of its normal.
  double& at(std::size_t column, std::size_t point);
};

inline constexpr std::size_t kPointColumns = 6;
// Holds which fields of a file are x y z of positions and normals.
using PointColumns = std::array<std::optional<std::size_t>, kPointColumns>;

// Finds these among the names of a file's fields, in letters of either case: x y z, and nx ny nz or
// normal_x normal_y normal_z, of which a part is as good as none. Throws Error(refused), naming
// `name`, if a coordinate of positions is missing, or any is there twice.
PointColumns point_columns(std::span<const std::string> fields, const std::string& name);

// Largest number of points or pixels in a file: 8192 x 8192.
inline constexpr std::uint64_t kMaxPoints = std::uint64_t{1} << 26;

// Parses Point Cloud Data 0.6 or 0.7: ascii, binary, binary_compressed. Takes the point_columns()
// (float32, float64 or integers), in any order; ignores others.
// Throws Error(refused), naming `name` and the defect. Checks sizes against the file's before
// allocating.
PointSet parse_pcd(std::span<const std::byte> bytes, const std::string& name);

// Largest expansion by LZF: three bytes give up to 264.
inline constexpr std::size_t kMaxLzfRatio = 88;

// Decodes LZF (as in binary_compressed PCD) into `to`. Returns false for unsound data: a run or
// reference beyond either buffer, or a size other than to.size().
bool decode_lzf(std::span<const std::byte> from, std::span<std::byte> to);

// Parses the vertices of a PLY file (ascii, or binary of either byte order): its point_columns();
// ignores other elements and properties. Throws Error(refused), naming `name` and the
// defect. Checks counts against the file's size before allocating.
PointSet parse_ply_points(std::span<const std::byte> bytes, const std::string& name);

}  // namespace vpm
