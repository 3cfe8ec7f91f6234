// Order of the numbers in a file of poses, where a line of names tells it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/core/pose.h"

namespace vpm {

// Columns of numbers, from 0.
struct PoseColumns {
  std::size_t count = 0;
  std::optional<std::size_t> time;
  bool has_nanoseconds = false;             // otherwise time_stamp.h tells
  std::array<std::size_t, 3> position{};    // x, y, z
  std::array<std::size_t, 4> quaternion{};  // x, y, z, w
};

// Returns the columns that a line names, such as "# timestamp tx ty tz qw qx qy qz" or the header
// of EuRoC's ground truth; empty if it does not name all seven numbers of a pose.
std::optional<PoseColumns> columns_of_header(const std::string& line);

// Returns time (if there is one), position and quaternion x, y, z, w of a line with these columns.
// A line with one number more has its time in front. Throws Error(refused) for other counts.
std::vector<double> in_usual_order(const std::vector<double>& numbers, const PoseColumns& columns);

}  // namespace vpm
