#include "libvpm/recording/pose_line.h"

#include <cstdio>

#include "libvpm/file/text.h"

namespace vpm {

std::string seconds_text(std::uint64_t nanoseconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%lu.%09lu", nanoseconds / kNanosecondsPerSecond,
                nanoseconds % kNanosecondsPerSecond);
  return text;
}

double in_seconds(std::uint64_t nanoseconds) {
  return *file::to_number(seconds_text(nanoseconds));
}

std::string pose_line(const std::string& time, std::span<const double> numbers) {
  std::string line = time;
  char text[32];
  for (const double number : numbers)
    line.append(text, std::snprintf(text, sizeof text, " %.17g", number));
  return line + "\n";
}

}  // namespace vpm
