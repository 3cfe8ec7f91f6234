#include "libvpm/recording/mcap/ros_recording.h"

#include <map>
#include <memory>
#include <set>
#include <utility>

#include "libvpm/file/text.h"
#include "libvpm/recording/mcap/mcap_file.h"
#include "libvpm/recording/mcap/messages.h"
#include "libvpm/recording/pose_line.h"
#include "libvpm/recording/pose_numbers.h"
#include "libvpm/recording/transform_tree.h"

namespace vpm::mcap {
namespace {

struct Topic {
  std::string kind;     // its type, and what else is known of it
  bool serves = false;  // for what is asked
};
using Topics = std::map<std::string, Topic>;

// Returns the topic `wanted`, or the only one that serves if that is empty. `words` tell what for,
// and `option` stands before its name where users give it. Throws Error(refused) if there is none.
std::string chosen(const Topics& topics, const std::string& wanted, const std::string& words,
                   const std::string& option, const std::string& recording,
                   const Remarks& remarks) {
  std::vector<std::string> serving, all;
  for (const auto& [name, topic] : topics) {
    all.push_back(name + " (" + topic.kind.substr(topic.kind.rfind('/') + 1) + ")");
    if (topic.serves) serving.push_back(name);
  }
  const auto found = topics.find(wanted);
  if (found != topics.end() && found->second.serves) return wanted;
  if (wanted.empty() && serving.size() == 1) return serving.front();
  std::string problem = "no topic " + file::shown(wanted) + " in it";
  if (found != topics.end())
    problem = "its topic " + wanted + " is " + found->second.kind + ", and none of " + words;
  else if (wanted.empty())
    problem = (serving.empty() ? "no topic" : std::to_string(serving.size()) + " topics") + " of " +
              words + " in it";
  for (const Remark& remark : remarks)
    if (remark.is_warning) problem += "; " + remark.text;
  if (serving.size() > 1) all = serving;
  if (serving.size() != 1) problem += "; it has " + (all.empty() ? "none" : file::listed(all));
  refuse(problem, recording, serving.empty() ? "" : "give " + option + serving.front());
}

// Shows all messages of a recording that are in CDR, and tells its topics.
template <class See>
Remarks scan(const std::string& recording, Topics& topics, See see) {
  Remarks remarks;
  for (const std::string& path : files_of(recording)) {
    const auto file = std::make_shared<const File>(path);
    const Remarks of_file = file->scan([&](const Message& message) {
      const auto& [name, type, encoding] = message.channel;
      Topic& topic = topics[name];
      const std::string kind =
          file::shown(type) + (encoding == "cdr" ? "" : " in " + file::shown(encoding));
      if (topic.kind.empty()) topic.kind = kind;
      if (!topic.kind.starts_with(kind)) throw Damage("its topic has another type");
      if (encoding == "cdr") see(message, file, topic);
    });
    for (const Remark& remark : of_file)
      remarks.push_back({remark.is_warning, (path == recording ? "" : path + ": ") + remark.text});
  }
  return remarks;
}

std::uint64_t time_of(const Header& header, const Message& message) {
  return header.time != 0 ? header.time : message.log_time;
}

// What a topic has of images.
struct Images {
  std::string type, frame;                                                // of the first
  std::map<std::uint64_t, std::function<std::vector<std::byte>()>> read;  // by time, ns
  std::size_t count = 0;
  bool lack_times = false;  // that headers should have

  void take(const Message& message, const std::shared_ptr<const File>& file, Topic& topic) {
    const ImageKind kind = read_image_kind(message.channel.type, message.bytes);
    if (count++ == 0) {
      type = message.channel.type;
      frame = kind.header.frame;
      topic.kind += " of " + file::shown(kind.coding);
      topic.serves = is_of_depths(type, kind.coding);
    }
    lack_times |= kind.header.time == 0;
    read.emplace(time_of(kind.header, message), [type = type, file, place = message.place] {
      return image_file(type, file->read(place));
    });
  }
};

// Takes the camera_info beside the images' topic, without what names their compression, or, as some
// drivers have it, below it.
void find_intrinsics(const std::map<std::string, std::vector<std::byte>>& infos,
                     const std::string& base, const std::string& recording, Frames& frames) {
  const std::string beside = base.substr(0, base.rfind('/') + 1) + "camera_info";
  frames.camera_info = infos.contains(beside) ? beside : base + "/camera_info";
  const auto found = infos.find(frames.camera_info);
  if (found == infos.end()) {
    frames.no_intrinsics = "no " + beside + " beside its images, " + frames.topic;
    return;
  }
  try {
    frames.intrinsics = read_camera_info(found->second, recording + ":" + frames.camera_info);
  } catch (const Error& fault) {
    frames.no_intrinsics = "its " + frames.camera_info + " is of no use: " + fault.problem();
  }
}

// Adds the transforms of a message to the tree. Passes over numbers that are no pose, as trackers
// write them where they are lost.
void take_transforms(const Message& message, TransformTree& tree) {
  const bool are_fixed = message.channel.topic.ends_with("tf_static");
  for (const auto& [header, child, numbers] : read_transforms(message.bytes)) {
    try {
      tree.add(child, header.frame, from_untimed(numbers, nullptr), time_of(header, message),
               are_fixed);
    } catch (const Error&) {  // the numbers are no pose
    }
  }
}

}  // namespace

Frames read_frames(const std::string& recording, const std::string& topic) {
  Topics topics;
  std::map<std::string, Images> images;
  std::map<std::string, std::vector<std::byte>> infos;
  std::set<std::string> placed;
  Frames frames;
  frames.remarks = scan(recording, topics, [&](const Message& message, const auto& file, auto& of) {
    const auto& [name, type, encoding] = message.channel;
    if (type == kCameraInfo) infos.try_emplace(name, message.bytes.begin(), message.bytes.end());
    if (type == kTransforms)
      for (const StampedPose& pose : read_transforms(message.bytes)) placed.insert(pose.child);
    if (type == kImage || type == kCompressedImage) images[name].take(message, file, of);
  });
  frames.topic = chosen(topics, topic, "depth images (16UC1, 32FC1 or compressedDepth of PNG)",
                        "`topic` ", recording, frames.remarks);
  const Images& of_topic = images.at(frames.topic);
  for (const auto& [time, read] : of_topic.read)
    frames.frames.push_back({in_seconds(time), seconds_text(time), read});
  frames.camera_frame = of_topic.frame;
  frames.is_camera_placed = placed.contains(frames.camera_frame);
  const std::size_t end =
      of_topic.type == kCompressedImage ? frames.topic.rfind('/') : frames.topic.size();
  find_intrinsics(infos, frames.topic.substr(0, end), recording, frames);
  if (const std::size_t doubled = of_topic.count - frames.frames.size(); doubled > 0)
    frames.remarks.push_back(
        {false, "images left out that have the time of one before: " + std::to_string(doubled)});
  if (of_topic.lack_times)
    frames.remarks.push_back(
        {false, "images whose header has no time have that of their recording"});
  return frames;
}

std::optional<PosesName> poses_name(const std::string& text) {
  for (std::size_t end = text.find(':'); true; end = text.find(':', end + 1)) {
    const std::string recording = text.substr(0, end);
    if (!files_of(recording).empty())
      return PosesName{recording, end == text.npos ? "" : text.substr(end + 1)};
    if (end == text.npos) return std::nullopt;
  }
}

Poses read_poses(const PosesName& name) {
  const auto& [recording, wanted] = name;
  Topics topics;
  TransformTree tree;
  std::map<std::string, std::map<std::uint64_t, StampedPose>> found;
  Poses poses;
  poses.remarks = scan(recording, topics, [&](const Message& message, const auto&, auto& topic) {
    const std::string& type = message.channel.type;
    if (type == kTransforms) take_transforms(message, tree);
    if (type != kPoseStamped) return;
    StampedPose pose = read_pose(message.bytes);
    auto& of_topic = found[message.channel.topic];
    if (!of_topic.empty() && of_topic.begin()->second.header.frame != pose.header.frame)
      throw Damage("its topic has poses in another frame");
    of_topic.emplace(time_of(pose.header, message), std::move(pose));
    topic.serves = true;
  });
  if (!wanted.empty() && !wanted.starts_with('/')) {
    const std::size_t colon = wanted.rfind(':');  // npos + 1 is 0
    const std::string world = colon == wanted.npos ? "" : wanted.substr(0, colon);
    const FrameMotion motion = tree.motion(wanted.substr(colon + 1), world, recording);
    return {motion.lines, motion.world, poses.remarks};
  }
  const auto& all = found.at(chosen(topics, wanted, "poses (PoseStamped; of TF: FILE:FRAME)",
                                    recording + ":", recording, poses.remarks));
  poses.world = all.begin()->second.header.frame;
  for (const auto& [time, pose] : all) poses.lines += pose_line(seconds_text(time), pose.numbers);
  return poses;
}

}  // namespace vpm::mcap
