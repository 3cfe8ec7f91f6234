#pragma once

#include <optional>
#include <vector>

#include "libvpm/recording/timed_path.h"

namespace vpm::tools {

// Calls ask(poses) for so many poses at once, from the first on all of the reader, if there is one;
// the last may be fewer.
template <class Ask>
void in_batches(std::optional<Pose> next, std::optional<PoseReader>& reader, std::size_t at_once,
                const Ask& ask) {
  std::vector<Pose> poses;
  for (; next; next = reader ? reader->next() : std::nullopt) {
    poses.push_back(*next);
    if (poses.size() < at_once) continue;
    ask(poses);
    poses.clear();
  }
  if (!poses.empty()) ask(poses);
}

}  // namespace vpm::tools
