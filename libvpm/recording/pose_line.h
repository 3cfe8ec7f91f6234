// Writes poses as lines that PoseReader reads, with times in seconds, exact to the nanosecond.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace vpm {

inline constexpr std::uint64_t kNanosecondsPerSecond = 1'000'000'000;

// Returns a time in seconds, with all its digits: "1700000000.123456789".
std::string seconds_text(std::uint64_t nanoseconds);

// Returns the number that this text stands for, so that a time is the same however it is given.
double in_seconds(std::uint64_t nanoseconds);

// Returns a line "time tx ty tz qx qy qz qw"; without a time if that is empty.
std::string pose_line(const std::string& time, std::span<const double> numbers);

}  // namespace vpm
