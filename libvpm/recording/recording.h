// A recording of a depth camera: files of frames, each with its time and the pose of its camera.
//
// Three layouts are known; the first that fits is taken:
//   list         a text file of "time file" lines (TUM RGB-D: depth.txt; associations.txt with four
//                columns, of which those of the depth image count), given itself or in the folder
//   named times  files called after their time in seconds: 1305031102.160407.png
//   numbered     files with a number in their name: frame-000460.depth.png (7-Scenes). They have no
//                clock: their numbers over the frame rate are their times, 0 for the first
// Of a folder count images (.png, .exr) and clouds (.pcd, .ply); where names hold "depth", only
// those.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "libvpm/cloud/camera.h"

namespace vpm {

struct RecordedFrame {
  double time = 0;  // s
  std::string path;
  std::optional<Pose> camera;  // to the world; none: what the file says, or the identity
  bool is_lost = false;        // the recording has poses of cameras, but none for this frame
};

struct Recording {
  std::vector<RecordedFrame> frames;  // by ascending time
  bool has_clock = true;    // times are of a clock that a path may share; numbered frames have none
  std::size_t missing = 0;  // gaps between numbers, and files that the list names but are not there
  std::string camera_source;  // where the poses come from, for notes; "" where from nowhere
  std::optional<Intrinsics> intrinsics;  // of camera-intrinsics.txt (3x3) in the folder
  double largest_deviation = 0;          // of a camera's rotation before it was normalised
};

struct RecordingOptions {
  double frame_rate = 30;  // of numbered frames, per second
  // Poses of the camera: TUM text, interpolated at the frames' times, or one pose for each frame.
  // Otherwise `camera`, for all frames. Otherwise NAME.pose.txt beside each frame (4x4; NAME is the
  // frame's without its ending, or what comes before the first dot where it is no time), or
  // groundtruth.txt in the folder.
  std::string camera_poses;
  std::optional<Pose> camera;
};

// A frame further than this from the first or last pose of a camera's path has no pose: half of a
// frame at 25 Hz, as TUM's tools have it.
inline constexpr double kPoseTolerance = 0.02;  // s

// `path`: a folder, or a list. Throws Error(refused): nothing there, no frame, names that are no
// times, what is wrong in a list or in camera_poses. A .pose.txt that is missing or no pose only
// loses its frame.
Recording read_recording(const std::string& path, const RecordingOptions& options);

}  // namespace vpm
