#include "libvpm/recording/frame_tree.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"
#include "libvpm/recording/timed_path.h"

namespace vpm {
namespace {

double seconds_of(std::int64_t nanoseconds) {
  return 1e-9 * static_cast<double>(nanoseconds);
}

TimedPath path_of(const std::map<std::int64_t, Pose>& poses) {
  std::vector<double> times;
  std::vector<Pose> at;
  for (const auto& [time, pose] : poses) {
    times.push_back(seconds_of(time));
    at.push_back(pose);
  }
  return {std::move(times), std::move(at)};
}

}  // namespace

void FrameTree::add(const std::string& frame, const std::string& parent, std::int64_t time,
                    const Pose& pose, bool is_fixed) {
  Link& link = links_[frame];
  if (!link.poses.empty() && link.parent != parent)
    refuse("TF puts the frame " + file::shown(frame) + " into two others, " +
               file::shown(link.parent) + " and " + file::shown(parent),
           {}, "give the poses in a file");
  link.parent = parent;
  link.is_fixed = link.is_fixed && is_fixed;
  link.poses.emplace(time, pose);
}

std::vector<std::string> FrameTree::frames() const {
  std::vector<std::string> frames;
  for (const auto& [frame, link] : links_) frames.push_back(frame);
  return frames;
}

std::vector<std::string> FrameTree::ancestry(const std::string& frame) const {
  std::vector<std::string> frames{frame};
  for (auto link = links_.find(frame); link != links_.end(); link = links_.find(frames.back())) {
    if (frames.size() > links_.size())
      refuse("the frames of TF go round in a circle, at " + file::shown(frame), {},
             "give the poses in a file");
    frames.push_back(link->second.parent);
  }
  return frames;
}

FrameMotion FrameTree::motion(const std::string& frame, const std::string& world) const {
  if (!has(frame) && frame != world)
    refuse("TF has no poses of the frame " + file::shown(frame) + "; it has those of " +
               file::listed(frames()),
           {}, "name one of these, or a topic of poses");
  std::vector<std::string> up = ancestry(frame);
  FrameMotion motion{{}, {}, world.empty() ? up.back() : world};
  std::vector<std::string> down = ancestry(motion.world);
  if (up.back() != down.back())
    refuse("TF does not connect the frames " + file::shown(frame) + " and " +
               file::shown(motion.world) + "; it has poses of " + file::listed(frames()),
           {}, "name two of these, or give the poses in a file");
  while (!up.empty() && !down.empty() && up.back() == down.back()) {
    up.pop_back();
    down.pop_back();
  }
  std::set<std::int64_t> times;
  std::int64_t from = std::numeric_limits<std::int64_t>::min(), to = -(from + 1);
  const auto paths_of = [&](const std::vector<std::string>& names) {
    std::vector<std::pair<Pose, std::optional<TimedPath>>> paths;  // still, or moving
    for (const std::string& name : names) {
      const Link& link = links_.at(name);
      const auto& [first, last] = std::pair(*link.poses.begin(), *link.poses.rbegin());
      paths.emplace_back(last.second, std::nullopt);
      if (link.is_fixed) continue;
      paths.back().second = path_of(link.poses);
      for (const auto& [time, pose] : link.poses) times.insert(time);
      from = std::max(from, first.first);
      to = std::min(to, last.first);
    }
    return paths;
  };
  const auto below = paths_of(up), above = paths_of(down);
  const auto pose_at = [](const auto& paths, double time) {
    Pose pose;
    for (const auto& [still, moving] : paths) pose = (moving ? moving->at(time) : still) * pose;
    return pose;
  };
  for (const std::int64_t time : times)
    if (time >= from && time <= to) motion.times.push_back(time);
  if (times.empty()) motion.poses.push_back(relative_to(pose_at(above, 0), pose_at(below, 0)));
  for (const std::int64_t time : motion.times)
    motion.poses.push_back(
        relative_to(pose_at(above, seconds_of(time)), pose_at(below, seconds_of(time))));
  return motion;
}

}  // namespace vpm
