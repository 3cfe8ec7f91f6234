// The parts of `vpm-bench replay`: the costs of a haptic loop for each query and each frame. Each
// part adds its rows, {"part": ..., ...}, to the report. Parts that take SuiteOptions query on the
// suite's device.
#pragma once

#include <chrono>
#include <functional>
#include <vector>

#include "libvpm/model/solid.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/recording/loop_clock.h"
#include "tools/bench/report.h"
#include "tools/bench/suite.h"

namespace vpm::bench {

struct ReplayTool {
  Solid solid;
  ToolModel model;
  std::vector<std::uint32_t> levels;  // ascending; the levels to be timed
  std::uint32_t soak_level = 0;       // a fast level: memory and drift do not depend on it
};

// Returns the seconds of each call, after `warm_up` calls that are not counted.
Durations timed(int calls, int warm_up, const std::function<void(int call)>& body);

// Returns the seconds that a call takes.
double seconds_of(const std::function<void()>& body);

// Times a query of a prepared frame, with warm and cold caches, beside hand-written alternatives.
// The scene is a tilted wall with Kinect noise, 5 % of the tool inside. Uses 1 and 2 threads, or 1
// beside a device.
void time_queries(const ReplayTool& tool, const SuiteOptions& options, Report& report);

// Times single queries at random poses in clutter, each level beside the distance grid of the tool
// in the same run, and batches of such poses on a device: things on a table with noise and holes,
// and the images in the suite's data that are known by name. 1 thread.
void time_clutter(const ReplayTool& tool, const SuiteOptions& options, Report& report);

// Times coherent poses beside the same poses on their own; steps of 0.5 mm, 1 thread.
void time_coherence(const ReplayTool& tool, const SuiteOptions& options, Report& report);

// Times a cloud with twice the points, all added ones beyond the tool radius; 1 thread.
void time_points_outside(const ReplayTool& tool, const SuiteOptions& options, Report& report);

// Times the way from the raw depth image to the prepared cloud; 1 and 2 threads.
void time_frames(const SuiteOptions& options, Report& report);

// Runs a path of the tool of 5 s or more through a recording at 1 kHz and reports, for each level,
// latencies, the volume's profile and the time of each frame. `folder` is the recording's; it must
// hold the camera's intrinsics. The path goes along the surface in the middle of the first frame,
// in and out of it. On the CPU poses are coherent.
void run_stream(const ReplayTool& tool, const std::string& folder, const SuiteOptions& options,
                Report& report);

// Runs 10^6 queries over the frames of the recording, each frame prepared anew every time. Memory
// and results must stay what they were; sets report.failure otherwise.
void run_soak(const ReplayTool& tool, const std::string& folder, const SuiteOptions& options,
              Report& report);

}  // namespace vpm::bench
