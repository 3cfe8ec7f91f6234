#include <vpm/robot.h>

#include <cmath>

#include "libvpm/core/error.h"
#include "libvpm/core/pose.h"

namespace vpm {
namespace {

// Limits in files are rounded, and values that were clamped to them may be, too.
constexpr double kLimitRounding = 1e-9;

// Largest value of a joint, rad or m: that of places; an angle as large is not known to a turn.
constexpr double kMostValue = 0x1p40;

// Returns the value of every joint, by its number; 0 of fixed ones.
std::vector<double> all_values(const Robot& robot, std::span<const double> values) {
  if (values.size() != robot.movable.size())
    throw Error(ErrorKind::invalid_argument, std::to_string(values.size()) + " values for " +
                                                 std::to_string(robot.movable.size()) +
                                                 " movable joints");
  std::vector<double> all(robot.joints.size(), 0);
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (!(std::abs(values[k]) <= kMostValue))
      throw Error(ErrorKind::invalid_argument, "the value of joint '" +
                                                   robot.joints[robot.movable[k]].name +
                                                   "' is not finite, or beyond 2^40");
    all[robot.movable[k]] = values[k];
  }
  for (std::size_t k = 0; k < all.size(); ++k) {
    // A joint may follow one that follows another; read_robot() refuses those in a circle.
    double multiplier = 1, offset = 0;
    std::size_t leader = k;
    for (; robot.joints[leader].mimics; leader = *robot.joints[leader].mimics) {
      offset += multiplier * robot.joints[leader].offset;
      multiplier *= robot.joints[leader].multiplier;
    }
    if (leader != k) all[k] = multiplier * all[leader] + offset;
  }
  return all;
}

Pose motion(const RobotJoint& joint, double value) {
  switch (joint.kind) {
    case RobotJoint::Kind::revolute:
    case RobotJoint::Kind::continuous:
      return {rotation_from_vector(value * joint.axis), {}};
    case RobotJoint::Kind::prismatic:
      return {{}, value * joint.axis};
    case RobotJoint::Kind::fixed:
      break;
  }
  return {};
}

}  // namespace

std::vector<Pose> link_poses(const Robot& robot, std::span<const double> values, const Pose& base) {
  const std::vector<double> all = all_values(robot, values);
  std::vector<Pose> poses(robot.links.size(), base);
  for (std::size_t k = 0; k < robot.joints.size(); ++k) {
    const RobotJoint& joint = robot.joints[k];
    poses[joint.child] = poses[joint.parent] * joint.origin * motion(joint, all[k]);
  }
  return poses;
}

std::vector<std::size_t> beyond_limits(const Robot& robot, std::span<const double> values) {
  const std::vector<double> all = all_values(robot, values);
  std::vector<std::size_t> beyond;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (all[k] < robot.joints[k].lower - kLimitRounding ||
        all[k] > robot.joints[k].upper + kLimitRounding)
      beyond.push_back(k);
  return beyond;
}

}  // namespace vpm
