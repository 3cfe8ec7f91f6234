// Recording of a depth camera: files of frames, each with its time and camera pose.
//
// Tries four layouts in this order:
//   list         a text file of "time file" lines (TUM RGB-D: depth.txt; associations.txt with four
//                columns, of which the depth image's are used), given itself or in the folder
//   named times  files called after their time: 1305031102.160407.png (s), or a number of 13 digits
//                or more in their names: depth_1403636579763555584.png (ns since 1970)
//   numbered     files with a number in their names: frame-000460.depth.png (7-Scenes). Their times
//                are the numbers divided by the frame rate, from 0 for the first
//   MCAP         a recording of ROS 2, given itself or its folder: the images of one topic
// In a folder, frames are images (.png, .exr, .tif, .tiff, .pgm, .pfm, .npy) and clouds (.pcd,
// .ply, .vpmc); if some names contain "depth", only those.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/cloud/camera.h"
#include "libvpm/import/intrinsics_file.h"
#include "libvpm/import/remark.h"
#include "libvpm/recording/timed_path.h"

namespace vpm {

struct RecordedFrame {
  double time = 0;   // s
  std::string path;  // of MCAP FILE/TIME, which is no file
  // Camera to world. Without it the frame's file decides, or the identity.
  std::optional<Pose> camera;
  // True if the recording has camera poses, but none for this frame.
  bool is_lost = false;
  std::function<std::vector<std::byte>()> read = {};  // of MCAP: returns the image as a file
  // The number of the recording among those that joined() was given: 0 if this is the only one.
  std::size_t source = 0;
  // Intrinsics of its camera; without them those of the import's options count.
  std::optional<Intrinsics> intrinsics{};
};

// Returns the bytes of the frame's file. Thread-safe. Throws Error(refused) if they cannot be read.
std::vector<std::byte> bytes_of(const RecordedFrame& frame);
// Returns the name of the frame's file without its folder and ending; of MCAP its time.
std::string stem_of(const RecordedFrame& frame);

struct Recording {
  std::vector<RecordedFrame> frames;  // ascending by time
  // True if times are of a clock that a path may share; false for numbered frames.
  bool has_clock = true;
  // Number of gaps between numbers, or of listed files that do not exist.
  std::size_t missing = 0;
  std::string camera_source;  // source of the camera poses, for notes; may be empty
  // Read from camera-intrinsics.txt (3x3) in the folder, or from the camera_info of MCAP.
  std::optional<IntrinsicsFile> intrinsics;
  std::string intrinsics_source;  // what they were read from
  std::string no_intrinsics;      // why MCAP gives none
  Remarks remarks;                // about MCAP
  // Lines of the camera's path that were skipped for numbers that are not finite or only zeros, and
  // that were dropped since they give the line before again.
  std::size_t camera_undefined = 0, camera_doubled = 0;
  std::optional<PoseGap> camera_gap;  // improbable time without a camera pose, if frames lie in it
  double largest_deviation = 0;       // largest of the camera rotations, before normalisation
  std::size_t sources = 1;            // cameras that took the frames
};

// Returns the recordings of several cameras, on one clock, as one. Its frames name their source, by
// its number in the list. Throws Error(refused) if some have a clock and others numbers.
Recording joined(std::vector<Recording> recordings);

// True if the frame is a .vpmc file, which holds its camera and that camera's pose.
bool is_ready_cloud(const RecordedFrame& frame);

struct RecordingOptions {
  double frame_rate = 30;  // frames per second of numbered frames
  // File of camera poses: TUM text, interpolated at the frames' times, or one pose per frame. If
  // empty, `camera` holds for all frames. Without that, poses are read from NAME.pose.txt beside
  // each frame (4x4; NAME is the frame's name without its ending, or up to the first dot if it is
  // no time), from ../pose/NAME.txt or ../poses/NAME.txt, or from groundtruth.txt in the folder.
  // Of MCAP: what ros_recording.h names, or without that TF, if it has the images'
  // frame.
  std::string camera_poses;
  std::optional<Pose> camera;
  std::string topic = {};  // of MCAP: that of the depth images; if empty, the only one
  std::string world = {};  // of MCAP: the world's frame of TF; if empty, the one without parent
};

// A frame further than this from the ends of a camera's path has no pose: half a frame at 25 Hz, as
// in TUM's tools.
inline constexpr double kPoseTolerance = 0.02;  // seconds

// Reads the recording at `path`, a folder, a list or an MCAP. Throws Error(refused) if there is no
// frame, a name is no time, the list or camera_poses is faulty, or no frame lies in the time of
// those. A .pose.txt that is missing or no pose only loses its frame, unless all are.
Recording read_recording(const std::string& path, const RecordingOptions& options);

}  // namespace vpm
