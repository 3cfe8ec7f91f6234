// Options of vpm-query.
#pragma once

#include <vpm/query_types.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/common/import_arguments.h"
#include "tools/common/program.h"
#include "tools/query/kept_lines.h"

namespace vpm::tools {

// Values of the options of recorded frames.
struct ReplayArguments {
  std::vector<std::string> frames, topic, camera_poses;  // a recording, or one for each camera
  std::string remove, remove_margin;  // a file of solids, and how far they may be off
  std::optional<double> rate;         // steps per second; kRate if not given
  double frame_rate = 30;    // frames per second, for frames that have numbers but no times
  double frame_latency = 0;  // s
  bool align_starts = false, repeat_frames = false, realtime = false;
  ImportArguments import;

  static constexpr double kRate = 1000;
};

// Values of the options, in the units that --help names.
struct Arguments {
  std::vector<std::string> tools;
  std::vector<std::string> solids;  // each FILE or FILE@POSE
  std::string pairs, unit, repair;  // of an assembly
  std::string urdf, joints, srdf;   // of a robot
  std::vector<std::string> packages;
  std::size_t contacts = 0;          // of each pose or pair; 0: none are told
  std::optional<double> fail_above;  // m^3; of an assembly in the cube of its unit
  std::vector<std::string> clouds;   // one, or depth images of several cameras
  bool registers = false;            // these cameras are moved until their images agree
  std::string pose;
  std::vector<std::string> poses;  // one file, or one for each tool
  std::string measure = "refined", shadows = "near";
  std::uint32_t level = 0;
  std::string max_error;
  std::optional<double> deadline_us, stiffness;
  bool for_scene = false, coherent = false, raw_points = false, bodies = false, interval = false;
  std::string coupling;
  bool collides = false, collides_only = false;
  double unseen_limit = kUnseenLimit;
  std::size_t batch = 1;
  bool serve = false, resume = false;
  ReplayArguments replay;
  std::string output = "-", spheres_out, stats, view;
};

// Adds the options to `app`, which writes their values to `arguments`.
void declare(CLI::App& app, Arguments& arguments);

// Returns what becomes of the lines that an interrupted run left.
Leftover leftover_of(const Arguments& arguments, const CommonOptions& common);

// Throws Error(invalid_argument) if two inputs are standard input, or an output's name is refused.
void check_names(const Arguments& arguments, const CommonOptions& common);

}  // namespace vpm::tools
