// Options of vpm-normals.
#pragma once

#include <cstddef>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "libvpm/import/import_cloud.h"
#include "tools/common/import_arguments.h"
#include "tools/common/program.h"
#include "tools/common/removal.h"

namespace vpm::tools {

struct Arguments {
  std::string depth, output, report, export_path, view;
  std::string topic, at;            // of a recording in MCAP; which image
  std::string camera_poses;         // of a recording
  double frame_rate = 30;           // frames per second of a recording whose names have numbers
  std::vector<std::string> remove;  // solids, each FILE or FILE@POSE
  std::string remove_margin;
  ImportArguments import;
};

// Solids of --remove, at their poses, and their margin.
struct RemovedSolids {
  Removal removal;
  RemovalMargin margin;

  RemovedSolids(const Program& program, const Arguments& arguments);
  void say(const Program& program) const { removal.say(program, words_of(margin)); }
};

// Reads the solids of --remove, if there are any, and has `options` take them out of each image.
std::unique_ptr<RemovedSolids> remove_solids(const Program& program, const Arguments& arguments,
                                             ImportOptions& options);

// Returns who made a cloud of these bytes with these options, for its file. The names of files in
// the options are replaced by the numbers that they stand for.
nlohmann::json provenance_of(const Program& program, const ImportOptions& options,
                             std::span<const std::byte> bytes);

// True if the input is a recording: a folder, or a list of frames whose output is a folder.
bool is_recording(const Arguments& arguments);

// Throws Error if the camera is placed twice.
void check_camera(const Arguments& arguments);

// The file that becomes a cloud: its name and bytes.
struct Source {
  std::string name;
  std::vector<std::byte> bytes;
};

// Reads the input that is no recording, or one image of a recording in MCAP, with whose camera and
// time `options` are completed, which is noted. Throws Error where it cannot.
Source source_of(const Program& program, const Arguments& arguments, ImportOptions& options);

// Makes a cloud of each frame of a recording, in the folder of the output. A frame that cannot be
// used is left out with a warning. Throws Error if none can be used, if an option is given that
// says nothing of recordings, and, without --force, if the folder is not empty.
void run_recording(const Program& program, const Arguments& arguments);

}  // namespace vpm::tools
