// Statistics of a run through recorded frames.
#pragma once

#include <nlohmann/json.hpp>

#include "libvpm/recording/frame_feed.h"
#include "libvpm/recording/loop_clock.h"
#include "libvpm/recording/recording.h"

namespace vpm::tools {

// Returns the parts of the field "replay" (formats/schemas/query-stats.json) that the clock knows.
// `wall` is the time that the loop took and `deadline` that of a step, both in seconds.
nlohmann::json replay_report(const LoopClock& clock, double rate, double wall, double deadline);

// Returns the field "frames" of the field "replay".
nlohmann::json frames_report(const Recording& recording, const FrameCounts& counts);

}  // namespace vpm::tools
