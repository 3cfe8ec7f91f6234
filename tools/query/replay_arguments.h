// Options of recorded frames.
#pragma once

#include <optional>
#include <string>

#include "tools/common/import_arguments.h"

namespace vpm::tools {

struct ReplayArguments {
  std::string frames, trajectory, camera_poses;
  std::optional<double> rate;  // steps per second; kRate if not given
  double frame_rate = 30;      // frames per second, for frames that have numbers but no times
  double frame_latency = 0;    // s
  bool align_starts = false, repeat_frames = false, realtime = false;
  ImportArguments import;

  static constexpr double kRate = 1000;
};

// Adds the options to `app`, which writes their values to `arguments`.
void declare(CLI::App& app, ReplayArguments& arguments);

}  // namespace vpm::tools
