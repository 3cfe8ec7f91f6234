// Poses of frames in others, as TF of ROS tells them: each frame has one parent, in which it stands
// still or moves.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "libvpm/core/pose.h"

namespace vpm {

// Poses of a frame in another one, ascending by time.
struct FrameMotion {
  std::vector<std::int64_t> times;  // ns; empty for one pose that never changes
  std::vector<Pose> poses;
  std::string world;  // the other frame
};

class FrameTree {
 public:
  // Adds a pose of `frame` in `parent` at a time, ns; of several with one time the first counts. A
  // frame of which all poses are fixed stands still at the last of them. Throws Error(refused) for
  // a second parent.
  void add(const std::string& frame, const std::string& parent, std::int64_t time, const Pose& pose,
           bool is_fixed);

  bool has(const std::string& frame) const { return links_.contains(frame); }
  std::vector<std::string> frames() const;  // those that have a parent

  // Returns the poses in `world`, or in the frame without a parent if that is empty: at the times
  // of all links between them, each interpolated, as far as all have poses. Throws Error(refused)
  // if the frames are not connected, or go round in a circle.
  FrameMotion motion(const std::string& frame, const std::string& world) const;

 private:
  struct Link {
    std::string parent;
    bool is_fixed = true;
    std::map<std::int64_t, Pose> poses;  // by time, ns
  };
  using Chain = std::vector<const Link*>;

  // Returns the frame and those above it.
  std::vector<std::string> ancestry(const std::string& frame) const;

  std::map<std::string, Link> links_;  // by the frame whose pose they are
};

}  // namespace vpm
