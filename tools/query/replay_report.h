#pragma once

#include <nlohmann/json.hpp>

#include "libvpm/recording/frame_feed.h"
#include "libvpm/recording/loop_clock.h"

namespace vpm::tools {

// "replay" of formats/schemas/query-stats.json, but for what the loop knows. `wall`: s that the
// loop took; `deadline`: s.
nlohmann::json replay_report(const LoopClock& clock, double rate, double wall, double deadline);

// Its "frames".
nlohmann::json frames_report(const Recording& recording, const FrameCounts& counts);

}  // namespace vpm::tools
