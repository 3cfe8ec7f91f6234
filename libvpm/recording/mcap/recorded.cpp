#include "libvpm/recording/mcap/recorded.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <span>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"
#include "libvpm/recording/frame_tree.h"
#include "libvpm/recording/mcap/mcap_file.h"
#include "libvpm/recording/mcap/messages.h"

namespace vpm::mcap {
namespace {

constexpr const char* kDepths = "depth images (Image of 16UC1 or 32FC1, or compressedDepth)";
constexpr const char* kPoses = "poses (PoseStamped; of TF: FILE:FRAME)";

struct Topic {
  std::string name, kind;  // kind: its type, and what else is known of it
  bool serves = false;     // for what is asked
};

// Returns the topic `wanted`, or the only one that serves if that is empty. `words` tell what for,
// and `option` stands before its name where users give it. Throws Error(refused) if there is none.
std::string chosen(const std::vector<Topic>& topics, const std::string& wanted,
                   const std::string& words, const std::string& option,
                   const std::string& recording) {
  std::vector<std::string> serving, all;  // those that serve first
  for (const bool serves : {true, false})
    for (const Topic& topic : topics) {
      if (topic.serves != serves) continue;
      all.push_back(topic.name + " (" + topic.kind.substr(topic.kind.rfind('/') + 1) + ")");
      if (serves) serving.push_back(topic.name);
    }
  const std::string cure = serving.empty() ? "" : "give " + option + serving.front();
  const std::string has = all.empty() ? "; it has none" : "; its topics: " + file::listed(all);
  if (wanted.empty() && serving.size() == 1) return serving.front();
  if (wanted.empty() && serving.empty()) refuse("no topic of " + words + " in it" + has, recording);
  if (wanted.empty())
    refuse(
        std::to_string(serving.size()) + " topics of " + words + " in it: " + file::listed(serving),
        recording, cure + ", or another of them");
  const auto found = std::ranges::find(topics, wanted, &Topic::name);
  if (found == topics.end()) refuse("no topic " + file::shown(wanted) + has, recording, cure);
  if (!found->serves)
    refuse("its topic " + file::shown(wanted) + " is " + found->kind + ", and none of " + words,
           recording, cure);
  return wanted;
}

// Returns what the action does; its refusals name the place.
template <class Action>
auto naming(const std::string& place, const Action& action) {
  try {
    return action();
  } catch (const Error& fault) {
    throw Error(fault.kind(), fault.problem(), place, fault.hint());
  }
}

// Returns what the action does; its refusals tell what is wrong with the recording, too.
template <class Action>
auto telling(const Remarks& remarks, const Action& action) {
  try {
    return action();
  } catch (const Error& fault) {
    std::string problem = fault.problem();
    for (const Remark& remark : remarks)
      if (remark.is_warning) problem += "; " + remark.text;
    throw Error(fault.kind(), problem, fault.where(), fault.hint());
  }
}

// Shows all messages of a recording that are in CDR, and tells its topics.
template <class See>
Remarks scan(const std::string& recording, std::map<std::string, Channel>& channels, See see) {
  Remarks remarks;
  const std::vector<std::string> files = files_of(recording);
  for (const std::string& path : files) {
    const auto file = std::make_shared<const File>(path);
    const auto take = [&](const Message& message) {
      if (message.channel.encoding == "cdr") see(message, file);
    };
    const auto add = [&](const Channel& channel) { channels[channel.topic] = channel; };
    for (const Remark& remark : naming(path, [&] { return file->scan(add, take); }))
      remarks.push_back({remark.is_warning, (files.size() > 1 ? path + ": " : "") + remark.text});
  }
  return remarks;
}

struct Image {
  std::int64_t time;
  std::shared_ptr<const File> file;
  Place place;
};

struct Images {
  ImageKind first;
  std::vector<Image> all;
};

struct CameraInfo {
  std::vector<std::byte> first;
  bool changes = false;
};

// What a recording has of images and their cameras, by topic.
struct Cameras {
  std::map<std::string, Channel> channels;
  std::map<std::string, Images> images;
  std::map<std::string, CameraInfo> infos;
  std::size_t without_time = 0;

  void take(const Message& message, const std::shared_ptr<const File>& file) {
    const auto& [topic, type, encoding] = message.channel;
    if (type == "sensor_msgs/msg/CameraInfo") take_info(infos[topic], message.bytes);
    if (type != kImage && type != kCompressedImage) return;
    ImageKind kind = read_image_kind(type, message.bytes);
    without_time += kind.header.time == 0;
    const std::int64_t time = kind.header.time != 0 ? kind.header.time : message.log_time;
    Images& of_topic = images[topic];
    if (of_topic.all.empty()) of_topic.first = std::move(kind);
    of_topic.all.push_back({time, file, message.place});
  }

  static void take_info(CameraInfo& info, Bytes message) {
    constexpr std::size_t kTime = 12;  // bytes before what tells of the camera
    const Bytes first(info.first);
    if (first.empty())
      info.first.assign(message.begin(), message.end());
    else if (message.size() > kTime && first.size() > kTime)
      info.changes |= !std::ranges::equal(first.subspan(kTime), message.subspan(kTime));
  }

  std::vector<Topic> topics() const {
    std::vector<Topic> topics;
    for (const auto& [name, channel] : channels) {
      const auto found = images.find(name);
      const std::string coding = found == images.end() ? "" : found->second.first.coding;
      topics.push_back({name,
                        channel.type +
                            (channel.encoding == "cdr" ? "" : " in " + channel.encoding) +
                            (coding.empty() ? "" : " of " + file::shown(coding)),
                        is_of_depths(channel.type, coding)});
    }
    return topics;
  }
};

void add_frames(Images& images, const std::string& type, Frames& frames) {
  std::ranges::stable_sort(images.all, {}, &Image::time);
  const auto doubled = std::ranges::unique(images.all, {}, &Image::time);
  if (!doubled.empty())
    frames.remarks.push_back(
        {false, "images left out, since they have the time of the one before: " +
                    std::to_string(doubled.size())});
  images.all.erase(doubled.begin(), doubled.end());
  for (const Image& image : images.all)
    frames.frames.push_back(
        {1e-9 * static_cast<double>(image.time), seconds_text(image.time),
         [image, type] { return image_file(type, image.file->read(image.place)); }});
}

// Takes the camera_info beside the images' topic, without what names their compression, or, as some
// drivers have it, below it.
void find_intrinsics(const Cameras& cameras, const std::string& recording, Frames& frames) {
  std::string base = frames.topic;
  if (cameras.channels.at(base).type == kCompressedImage) base.erase(base.rfind('/'));
  const std::string beside = base.substr(0, base.rfind('/') + 1) + "camera_info";
  frames.camera_info = cameras.infos.contains(beside) ? beside : base + "/camera_info";
  const auto found = cameras.infos.find(frames.camera_info);
  if (found == cameras.infos.end()) {
    frames.no_intrinsics = "no " + beside + " beside its images, " + frames.topic;
    return;
  }
  try {
    frames.intrinsics = read_camera_info(found->second.first, recording + ":" + frames.camera_info);
  } catch (const Error& fault) {
    frames.no_intrinsics = "its " + frames.camera_info + " is of no use: " + fault.problem();
  }
  if (found->second.changes)
    frames.remarks.push_back({true, "its " + frames.camera_info + " changes: the first is used"});
}

std::string line_of(const std::string& time, const std::array<double, 7>& numbers) {
  std::string line = time;
  for (const double number : numbers) {
    char text[40];
    std::snprintf(text, sizeof text, " %.17g", number);
    line += text;
  }
  return line + "\n";
}

Poses poses_of_topic(const PosesName& name) {
  std::map<std::string, std::map<std::int64_t, StampedPose>> found;
  std::map<std::string, Channel> channels;
  Poses poses;
  poses.remarks = scan(name.recording, channels, [&](const Message& message, const auto&) {
    if (message.channel.type != "geometry_msgs/msg/PoseStamped") return;
    StampedPose pose = read_pose(message.bytes);
    const std::int64_t time = pose.header.time != 0 ? pose.header.time : message.log_time;
    found[message.channel.topic].emplace(time, std::move(pose));
  });
  std::vector<Topic> topics;
  for (const auto& [topic, channel] : channels)
    topics.push_back({topic, channel.type, found.contains(topic)});
  const auto& all = found[telling(poses.remarks, [&] {
    return chosen(topics, name.topic, kPoses, name.recording + ":", name.recording);
  })];
  poses.world = all.begin()->second.header.frame;
  for (const auto& [time, pose] : all) poses.lines += line_of(seconds_text(time), pose.numbers);
  return poses;
}

// Adds what a message of TF tells, but for numbers that are no pose, as trackers write them where
// they are lost.
void add_transforms(const Message& message, FrameTree& tree) {
  if (message.channel.type != "tf2_msgs/msg/TFMessage") return;
  const bool is_fixed = message.channel.topic.ends_with("tf_static");
  for (const auto& [header, child, n] : read_transforms(message.bytes)) {
    Pose pose{{}, {n[0], n[1], n[2]}};
    try {
      pose.rotation = rotation_from_quaternion({n[3], n[4], n[5], n[6]});
    } catch (const Error&) {
      continue;
    }
    if (std::isfinite(n[0] + n[1] + n[2]))
      tree.add(child, header.frame, header.time != 0 ? header.time : message.log_time, pose,
               is_fixed);
  }
}

std::optional<Poses> poses_of_frame(const PosesName& name, bool may_lack) {
  FrameTree tree;
  std::map<std::string, Channel> channels;
  Poses poses;
  poses.remarks = scan(name.recording, channels,
                       [&](const Message& message, const auto&) { add_transforms(message, tree); });
  if (may_lack && !tree.has(name.frame)) return std::nullopt;
  const FrameMotion motion =
      naming(name.recording, [&] { return tree.motion(name.frame, name.world); });
  poses.world = motion.world;
  for (std::size_t k = 0; k < motion.poses.size(); ++k) {
    const Vec3 t = motion.poses[k].translation;
    const Quaternion q = quaternion_from_rotation(motion.poses[k].rotation);
    poses.lines += line_of(motion.times.empty() ? "" : seconds_text(motion.times[k]),
                           {t.x, t.y, t.z, q.x, q.y, q.z, q.w});
  }
  return poses;
}

}  // namespace

Frames read_frames(const std::string& recording, const std::string& topic) {
  Cameras cameras;
  Frames frames;
  frames.remarks = scan(recording, cameras.channels, [&](const Message& message, const auto& file) {
    cameras.take(message, file);
  });
  frames.topic = telling(frames.remarks, [&] {
    return chosen(cameras.topics(), topic, kDepths, "`topic` ", recording);
  });
  Images& images = cameras.images.at(frames.topic);
  frames.camera_frame = images.first.header.frame;
  add_frames(images, cameras.channels.at(frames.topic).type, frames);
  find_intrinsics(cameras, recording, frames);
  if (cameras.without_time > 0)
    frames.remarks.push_back(
        {false, "images whose header has no time have that of their recording"});
  return frames;
}

std::optional<PosesName> poses_name(const std::string& text) {
  for (std::size_t end = text.find(':'); true; end = text.find(':', end + 1)) {
    PosesName name{text.substr(0, end), {}, {}, {}};
    if (files_of(name.recording).empty()) {
      if (end == text.npos) return std::nullopt;
      continue;
    }
    const std::string poses = end == text.npos ? "" : text.substr(end + 1);
    const std::size_t between = poses.find(':');
    const bool is_topic = poses.empty() || poses.starts_with('/');
    if (is_topic) name.topic = poses;
    if (!is_topic && between != poses.npos) name.world = poses.substr(0, between);
    if (!is_topic) name.frame = poses.substr(between + 1);  // npos + 1 is 0
    return name;
  }
}

std::optional<Poses> read_poses(const PosesName& name, bool may_lack) {
  return name.frame.empty() ? poses_of_topic(name) : poses_of_frame(name, may_lack);
}

}  // namespace vpm::mcap
