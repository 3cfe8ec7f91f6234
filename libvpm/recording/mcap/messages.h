// Reads messages of ROS 2 (sensor_msgs, geometry_msgs, tf2_msgs) in plain CDR. All functions throw
// Damage for messages that contradict themselves.
#pragma once

#include <string>
#include <vector>

#include "libvpm/import/intrinsics_file.h"
#include "libvpm/recording/mcap/byte_cursor.h"

namespace vpm::mcap {

inline constexpr const char* kImage = "sensor_msgs/msg/Image";
inline constexpr const char* kCompressedImage = "sensor_msgs/msg/CompressedImage";
inline constexpr const char* kCameraInfo = "sensor_msgs/msg/CameraInfo";
inline constexpr const char* kPoseStamped = "geometry_msgs/msg/PoseStamped";
inline constexpr const char* kTransforms = "tf2_msgs/msg/TFMessage";

struct Header {
  std::uint64_t time = 0;  // ns, on the clock of who wrote it; 0 if it was not set
  std::string frame;       // of TF
};

// Tells of an image all but its pixels. The coding is how its message names what a pixel holds:
// "16UC1", or "16UC1; compressedDepth png".
struct ImageKind {
  Header header;
  std::string coding;
};
ImageKind read_image_kind(const std::string& type, Bytes message);
// True if images of the coding may hold depths.
bool is_of_depths(const std::string& type, const std::string& coding);
// Returns the image as a file that import_scan() reads: an array of NumPy, or what the message of a
// compressed image holds.
std::vector<std::byte> image_file(const std::string& type, Bytes message);

// Returns the intrinsics of a camera_info, as parse_intrinsics() takes them from its YAML, for the
// image that its region of interest and its binning leave. Throws as that does.
IntrinsicsFile read_camera_info(Bytes message, const std::string& name);

struct StampedPose {
  Header header;
  std::string child;            // of TF: the frame whose pose in header.frame it is
  std::vector<double> numbers;  // tx, ty, tz, qx, qy, qz, qw; not checked
};
StampedPose read_pose(Bytes message);
std::vector<StampedPose> read_transforms(Bytes message);

}  // namespace vpm::mcap
