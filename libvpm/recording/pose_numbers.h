// Reads the numbers of a pose from a line of text, and makes poses of numbers.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "libvpm/core/pose.h"

namespace vpm {

inline constexpr std::size_t kQuaternionPose = 7, kTimedPose = 8, kThreeRows = 12, kMatrix = 16,
                             kMatrixRow = 4;
inline constexpr std::size_t kAnglesPose = 6;  // of a position and three angles, which is not read
inline constexpr const char* kAnglesHint =
    "write tx ty tz qx qy qz qw, the last four by SciPy's Rotation.from_euler(...) or "
    "from_rotvec(...), with as_quat()";

// Returns the numbers of a line, separated by blanks, single commas or semicolons. Throws a refusal
// that names the column of anything else.
std::vector<double> numbers_of_line(const std::string& line);

// Returns the pose of a matrix by rows, 4x4 or without the last of them. Throws a refusal with the
// text `otherwise` for other counts and last rows, and one that says so for a matrix by columns.
Pose from_matrix(std::vector<double> m, const std::string& otherwise, double* deviation);

// Returns the pose of 7 numbers, or of a matrix by rows.
Pose from_untimed(const std::vector<double>& numbers, double* deviation);

// True if the 4x4 numbers are a matrix by columns with a translation, which is their last row.
bool is_by_columns(const std::vector<double>& m);

}  // namespace vpm
