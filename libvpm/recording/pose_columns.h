// Understands the lines of files of poses that name their columns.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace vpm {

// Returns seconds of a time that may count seconds, milli-, micro- or nanoseconds since 1970: 10^11
// s are the year 5138, and smaller ones are before 1973 in the next unit.
inline double seconds_of_stamp(double stamp) {
  if (stamp > 1e17) return 1e-9 * stamp;
  if (stamp > 1e14) return 1e-6 * stamp;
  return stamp > 1e11 ? 1e-3 * stamp : stamp;
}

// Order of the numbers in a file of poses, where a line of names tells it: columns, from 0.
struct PoseColumns {
  std::size_t count = 0;
  std::optional<std::size_t> time;
  std::optional<double> time_unit;          // s; otherwise seconds_of_stamp() tells
  std::array<std::size_t, 3> position{};    // x, y, z
  std::array<std::size_t, 4> quaternion{};  // x, y, z, w

  bool operator==(const PoseColumns&) const = default;
};

// A line that names the columns, with the orders that it may mean: the one that has as many columns
// as a line has numbers is used. None if it is not clear, or if it names angles.
struct PoseNames {
  std::size_t line = 0;
  std::string text;
  std::vector<PoseColumns> orders;
  std::optional<std::size_t> open_count;  // count of numbers that leaves the order open
  bool has_angles = false;                // where a quaternion should be
};

// Returns what a line says of the columns, such as "# timestamp tx ty tz qw qx qy qz" or the header
// of EuRoC's ground truth; empty if it says nothing of them.
std::optional<PoseNames> names_in(const std::string& line, std::size_t number);

// Returns the order of a line with so many numbers; empty if none fits, or several that differ.
std::optional<PoseColumns> fitting_order(const std::vector<PoseColumns>& orders, std::size_t count);

// Returns time (if there is one), position and quaternion x, y, z, w of a line with these names.
// Throws Error(refused) for numbers that do not fit them, unless they have the usual order anyway.
std::vector<double> in_usual_order(const std::vector<double>& numbers, const PoseNames& names);

}  // namespace vpm
