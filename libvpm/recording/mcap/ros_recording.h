// Finds depth images and poses in recordings of ROS 2 in MCAP. A recording is a file, or a folder
// of files .mcap. Functions throw Error(refused), naming the recording and what it has, if it has
// not what is asked, and what mcap::File throws.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/import/intrinsics_file.h"

namespace vpm::mcap {

struct Frame {
  double time = 0;   // s, of the message's header; that of its recording where the header has none
  std::string name;  // the time with all digits
  // Returns the image as a file that import_scan() reads. Thread-safe. Throws Error(refused) for a
  // damaged message.
  std::function<std::vector<std::byte>()> read;
};

struct Frames {
  std::vector<Frame> frames;        // ascending by time
  std::string topic, camera_frame;  // the frame of TF that the images name
  bool is_camera_placed = false;    // true if TF has poses of that frame
  std::string camera_info;          // the topic beside theirs that intrinsics come from
  std::optional<IntrinsicsFile> intrinsics;
  std::string no_intrinsics;  // why there are none
  Remarks remarks;
};

// Returns the images of `topic`, or of the only topic of depth images if that is empty.
Frames read_frames(const std::string& recording, const std::string& topic);

// Names poses in a recording. `poses` is one of these: a topic of PoseStamped, which begins with
// "/"; "" for the only such topic; a frame of TF, "tool0", whose poses are told in the frame that
// has no parent; or two frames, "world:tool0", the second in the first.
struct PosesName {
  std::string recording, poses;
};

// Returns what a text names such as "rec.mcap:/topic"; empty if it begins with no recording.
std::optional<PosesName> poses_name(const std::string& text);

struct Poses {
  // "time tx ty tz qx qy qz qw", ascending by the times of the headers; one line without a time for
  // a pose that never changes. Of several poses with one time the first.
  std::string lines;
  std::string world;  // the frame that they are in
  Remarks remarks;
};
Poses read_poses(const PosesName& name);

}  // namespace vpm::mcap
