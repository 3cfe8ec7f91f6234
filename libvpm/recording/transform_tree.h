// Poses of frames in others, as TF of ROS tells them: each frame has one parent, in which it stands
// still or moves.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "libvpm/core/pose.h"

namespace vpm {

// Poses of a frame in another one.
struct FrameMotion {
  std::string lines;  // by pose_line(), ascending by time; one without a time if it never changes
  std::string world;  // the other frame
};

class TransformTree {
 public:
  // Adds a pose of a frame in its parent at a time, ns; of several with one time the first counts.
  // A frame of which all poses are fixed stands still at the last of them.
  void add(const std::string& frame, const std::string& parent, const Pose& pose,
           std::uint64_t time, bool is_fixed);

  // Returns the poses in `world`, or in the frame without a parent if that is empty: at the times
  // of all links between them, each interpolated, as far as all have poses. Throws Error(refused),
  // naming `place`, if the frames are not connected, go round in a circle, or have several parents.
  FrameMotion motion(const std::string& frame, const std::string& world,
                     const std::string& place) const;

 private:
  struct Link {
    std::string parent, other_parent;  // the other one is empty, if all is well
    bool is_fixed = true;
    std::map<std::uint64_t, Pose> poses;  // by time, ns
  };

  // Returns the frame and those above it.
  std::vector<std::string> ancestry(const std::string& frame, const std::string& place) const;

  std::map<std::string, Link> links_;  // by the frame whose pose they are
};

}  // namespace vpm
