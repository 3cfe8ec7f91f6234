// The parts of `vpm-bench replay`: what a haptic loop pays for each query and for each frame. Each
// adds its rows, {"part": ..., ...}, to the report. Those that take SuiteOptions query on the
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
  std::vector<std::uint32_t> levels;  // ascending; those to be timed
  std::uint32_t soak_level = 0;       // a quick one: memory and drift do not depend on it
};

// Seconds of each call, after `warm_up` calls that do not count.
Durations timed(int calls, int warm_up, const std::function<void(int call)>& body);

// One query of a prepared frame, cold and warm, beside what is written by hand; a tilted wall with
// Kinect noise, 5 % of the tool inside; 1 and 2 threads, beside a device 1.
void time_queries(const ReplayTool& tool, const SuiteOptions& options, Report& report);

// Coherent poses beside the same poses seen alone; steps of 0.5 mm, 1 thread.
void time_coherence(const ReplayTool& tool, bool quick, Report& report);

// A cloud with twice the points, all those added out of the tool's reach; 1 thread.
void time_points_outside(const ReplayTool& tool, const SuiteOptions& options, Report& report);

// From the raw depth image to the prepared cloud; 1 and 2 threads.
void time_frames(bool quick, Report& report);

// A recording against a path of the tool of 5 s and more, at 1 kHz: latencies, the volume's profile
// and the time of each frame for each level. `folder`: of the recording; it must tell its camera.
// The path goes along the surface that the first frame shows in its middle, in and out of it. On
// the CPU its poses are coherent ones.
void run_stream(const ReplayTool& tool, const std::string& folder, const SuiteOptions& options,
                Report& report);

// 10^6 queries over the frames of the recording, each frame prepared anew every time: memory and
// results must stay what they were. Sets report.failure where they do not.
void run_soak(const ReplayTool& tool, const std::string& folder, const SuiteOptions& options,
              Report& report);

}  // namespace vpm::bench
