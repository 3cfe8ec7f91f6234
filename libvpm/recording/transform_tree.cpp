#include "libvpm/recording/transform_tree.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"
#include "libvpm/recording/pose_line.h"
#include "libvpm/recording/timed_path.h"

namespace vpm {
namespace {

constexpr const char* kCure = "name frames that it connects, or give the poses in a file";

// Returns the pose of a frame in another that is as many links above it.
Pose pose_at(const std::vector<TimedPath>& links, double time) {
  Pose pose;
  for (const TimedPath& link : links) pose = link.at(time) * pose;
  return pose;
}

// Returns the path through the poses; of a frame that stands still, the last of them.
TimedPath path_of(const std::map<std::uint64_t, Pose>& poses, bool is_fixed) {
  std::vector<double> times;
  std::vector<Pose> at;
  for (auto pose = is_fixed ? std::prev(poses.end()) : poses.begin(); pose != poses.end(); ++pose) {
    times.push_back(in_seconds(pose->first));
    at.push_back(pose->second);
  }
  return {std::move(times), std::move(at)};
}

}  // namespace

void TransformTree::add(const std::string& frame, const std::string& parent, const Pose& pose,
                        std::uint64_t time, bool is_fixed) {
  Link& link = links_[frame];
  if (!link.poses.empty() && link.parent != parent) link.other_parent = link.parent;
  link.parent = parent;
  link.is_fixed = link.is_fixed && is_fixed;
  link.poses.emplace(time, pose);
}

std::vector<std::string> TransformTree::ancestry(const std::string& frame,
                                                 const std::string& place) const {
  std::vector<std::string> frames{frame};
  for (auto link = links_.find(frame); link != links_.end(); link = links_.find(frames.back())) {
    const auto& [parent, other, is_fixed, poses] = link->second;
    if (!other.empty())
      refuse("TF puts the frame " + file::shown(frames.back()) + " into two others, " +
                 file::shown(parent) + " and " + file::shown(other),
             place, kCure);
    if (frames.size() > links_.size())
      refuse("TF puts the frame " + file::shown(parent) + " into itself", place, kCure);
    frames.push_back(parent);
  }
  return frames;
}

FrameMotion TransformTree::motion(const std::string& frame, const std::string& world,
                                  const std::string& place) const {
  std::vector<std::string> below = ancestry(frame, place);
  FrameMotion motion{"", world.empty() ? below.back() : world};
  std::vector<std::string> above = ancestry(motion.world, place);
  if (below.back() != above.back() || frame == motion.world) {
    std::vector<std::string> frames;
    for (const auto& [name, link] : links_) frames.push_back(name);
    refuse("TF does not tell the pose of the frame " + file::shown(frame) +
               (world.empty() ? "" : " in " + file::shown(world)) + "; it has poses of " +
               (frames.empty() ? "none" : file::listed(frames)),
           place, kCure);
  }
  while (!below.empty() && !above.empty() && below.back() == above.back()) {
    below.pop_back();
    above.pop_back();
  }
  std::set<std::uint64_t> times;
  std::uint64_t from = 0, to = UINT64_MAX;
  const auto paths_of = [&](const std::vector<std::string>& names) {
    std::vector<TimedPath> paths;
    for (const std::string& name : names) {
      const Link& link = links_.at(name);
      paths.push_back(path_of(link.poses, link.is_fixed));
      if (link.is_fixed) continue;
      for (const auto& [time, pose] : link.poses) times.insert(time);
      from = std::max(from, link.poses.begin()->first);
      to = std::min(to, link.poses.rbegin()->first);
    }
    return paths;
  };
  const std::vector<TimedPath> up = paths_of(below), down = paths_of(above);
  const auto add = [&](const std::string& text, double time) {
    const Pose pose = relative_to(pose_at(down, time), pose_at(up, time));
    const Quaternion q = quaternion_from_rotation(pose.rotation);
    const Vec3& t = pose.translation;
    motion.lines += pose_line(text, std::array{t.x, t.y, t.z, q.x, q.y, q.z, q.w});
  };
  if (times.empty()) add("", 0);
  for (const std::uint64_t time : times)
    if (time >= from && time <= to) add(seconds_text(time), in_seconds(time));
  return motion;
}

}  // namespace vpm
