#pragma once

#include <optional>
#include <vector>

#include "libvpm/recording/timed_path.h"

namespace vpm::tools {

// Calls ask(poses) with batches of poses: the first pose, then all poses of the reader, if there is
// one. The last batch may be smaller.
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
