#include "libvpm/recording/recording.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <set>
#include <span>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/file/sniff.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"
#include "libvpm/recording/mcap/mcap_file.h"
#include "libvpm/recording/mcap/ros_recording.h"
#include "libvpm/recording/pose_reader.h"
#include "libvpm/recording/timed_path.h"

namespace vpm {
namespace {

namespace fs = std::filesystem;

// Returns the status, file_type::none for links in a circle, for which exists() would throw.
fs::file_status status_of(const fs::path& path) {
  std::error_code unknown;
  return fs::status(path, unknown);
}

// True for files, and for paths that cannot be examined: reading these reports why.
bool is_file(const fs::path& path) {
  const fs::file_type type = status_of(path).type();
  return type == fs::file_type::regular || type == fs::file_type::none ||
         type == fs::file_type::unknown;
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  file::TextCursor cursor(text);
  while (const auto line = cursor.line()) lines.push_back(line->substr(0, line->find('#')));
  return lines;
}

// Returns the time and file of the depth image in a line "time file", "time,file" or "time file
// time file".
std::optional<std::pair<double, std::string>> entry_of(std::string_view line) {
  std::vector<std::string_view> words = file::split_words(line);
  if (const std::size_t comma = line.find(','); words.size() == 1 && comma != line.npos) {
    words = file::split_words(line.substr(0, comma));
    for (const std::string_view word : file::split_words(line.substr(comma + 1)))
      words.push_back(word);
  }
  if (words.empty()) return std::nullopt;
  const bool second = words.size() == 4 && words[3].find("depth") != std::string_view::npos;
  const bool fits = words.size() == 2 || words.size() == 4;
  const std::optional<double> time = fits ? file::to_number(words[second ? 2 : 0]) : std::nullopt;
  if (!time || !std::isfinite(*time)) refuse("not a time and a file: " + file::shown(line));
  return std::pair(seconds_of_stamp(*time), std::string(words[second ? 3 : 1]));
}

void read_list(const fs::path& list, Recording& recording) {
  const std::vector<std::byte> bytes = file::read_all(list.string());
  const std::string text = file::utf8_of(file::as_text(bytes));
  const auto other = file::sniff(std::as_bytes(std::span(text.data(), text.size())));
  if (other)
    refuse("this is " + other->what, list.string(),
           other->scan ? "give the folder of the frames, or a list of \"time file\" lines"
                       : other->next);
  std::size_t number = 0;
  for (const std::string_view line : lines_of(text)) {
    ++number;
    try {
      const auto entry = entry_of(line);
      if (!entry) continue;
      const fs::path path = list.parent_path() / entry->second;
      if (status_of(path).type() != fs::file_type::not_found) {
        recording.frames.push_back({entry->first, path.string(), {}, false});
      } else {
        ++recording.missing;
      }
    } catch (const Error& fault) {
      refuse(fault.problem(), list.string() + ", line " + std::to_string(number), fault.hint());
    }
  }
  if (recording.frames.empty())
    refuse("none of the " + std::to_string(recording.missing) + " files that it names is there",
           list.string());
}

bool is_frame(const fs::path& path) {
  static const std::set<std::string> kKinds{".png",  ".exr", ".pcd", ".ply", ".tif",
                                            ".tiff", ".pgm", ".pfm", ".npy", ".vpmc"};
  return kKinds.contains(file::in_lower_case(path.extension().string()));
}

std::string stem_of(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.substr(0, name.find('.'));
}

// True unless the path is a folder or something that blocks, like a pipe. Reading reports defects.
bool may_be_read(const fs::path& path) {
  return is_file(path) || status_of(path).type() == fs::file_type::not_found;
}

std::vector<fs::path> files_of(const fs::path& folder) {
  std::vector<fs::path> files, depth;
  std::error_code fault;
  for (fs::directory_iterator entry(folder, fault), end; !fault && entry != end;
       entry.increment(fault)) {
    const fs::path& path = entry->path();
    if (!is_frame(path) || !may_be_read(path)) continue;
    files.push_back(path);
    if (path.filename().string().find("depth") != std::string::npos) depth.push_back(path);
  }
  if (fault) refuse("cannot read " + folder.string() + ": " + fault.message());
  if (!depth.empty()) files = std::move(depth);
  std::sort(files.begin(), files.end());
  return files;
}

// True if the whole name is a number with a point.
bool is_decimal(const fs::path& path) {
  const std::string name = path.stem().string();
  const std::optional<double> time = file::to_number(name);
  return name.find('.') != std::string::npos && time && std::isfinite(*time);
}

// Returns the time in a name that is a number with a point, or has a number of so many digits that
// it counts milli-, micro- or nanoseconds since 1970.
std::optional<double> time_in(const fs::path& path) {
  constexpr std::uint64_t kSmallestStamp = 1'000'000'000'000;
  if (is_decimal(path)) return seconds_of_stamp(*file::to_number(path.stem().string()));
  const std::optional<std::uint64_t> number = file::number_in_name(path.string());
  if (!number || *number < kSmallestStamp) return std::nullopt;
  return seconds_of_stamp(static_cast<double>(*number));
}

void number_frames(const std::vector<fs::path>& files, double frame_rate, Recording& recording) {
  std::vector<std::pair<std::uint64_t, fs::path>> numbered;
  for (const fs::path& path : files) {
    const std::optional<std::uint64_t> number = file::number_in_name(path.string());
    if (!number)
      refuse("its name is neither a time (12.345.png) nor has it a number (frame-000001.png)",
             path.string(), "give a list of \"time file\" lines instead");
    numbered.emplace_back(*number, path);
  }
  std::sort(numbered.begin(), numbered.end());
  const std::uint64_t first = numbered.front().first;
  std::uint64_t stride = 0;
  for (std::size_t k = 1; k < numbered.size(); ++k) {
    const std::uint64_t gap = numbered[k].first - numbered[k - 1].first;
    if (gap == 0)
      refuse("has the number of " + numbered[k - 1].second.filename().string(),
             numbered[k].second.string(), "give a list of \"time file\" lines");
    stride = stride == 0 ? gap : std::min(stride, gap);
  }
  recording.has_clock = false;
  for (const auto& [number, path] : numbered) {
    const double time = static_cast<double>(number - first) / frame_rate;
    recording.frames.push_back({time, path.string(), {}, false});
  }
  if (stride > 0)
    recording.missing = (numbered.back().first - first) / stride + 1 - numbered.size();
}

// Refuses a folder whose frames lie in a folder in it, as ScanNet's in depth/.
void refuse_if_frames_lie_below(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code fault;
  for (fs::directory_iterator entry(folder, fault), end; !fault && entry != end;
       entry.increment(fault)) {
    const bool is_of_depths = entry->path().filename().string().find("depth") != std::string::npos;
    if (is_of_depths && fs::is_directory(status_of(entry->path())) &&
        !files_of(entry->path()).empty())
      found.push_back(entry->path());
  }
  if (found.empty()) return;
  const fs::path first = *std::min_element(found.begin(), found.end());
  refuse("no frames in it, but " + std::to_string(files_of(first).size()) + " in its folder " +
             first.filename().string(),
         folder.string(), "give `frames` " + first.string());
}

// Refuses a folder that is a bag of ROS, or that holds one.
void refuse_if_bag(const fs::path& folder) {
  std::error_code fault;
  for (fs::directory_iterator entry(folder, fault), end; !fault && entry != end;
       entry.increment(fault)) {
    const fs::path ending = entry->path().extension();
    if (ending != ".bag" && ending != ".db3") continue;
    const std::string from = ending == ".bag" ? entry->path().string() : folder.string();
    refuse("no frames in it, but a recording of ROS, " + entry->path().filename().string(),
           folder.string(),
           "convert it to MCAP: rosbags-convert --src " + from + " --dst OUT --dst-storage mcap");
  }
}

bool are_all_lost(const Recording& recording) {
  return std::all_of(recording.frames.begin(), recording.frames.end(),
                     [](const RecordedFrame& frame) { return frame.is_lost; });
}

// Refuses a path of the camera without a pose for any frame.
[[noreturn]] void refuse_other_times(const TimedPath& path, const std::string& name,
                                     const Recording& recording) {
  char text[200];
  std::snprintf(text, sizeof text,
                "no frame (%.3f to %.3f s) lies in the time of the camera's path (%.3f to %.3f s)",
                recording.frames.front().time, recording.frames.back().time, path.start(),
                path.end());
  refuse(text, name,
         recording.has_clock
             ? "give `camera_poses` of the frames' clock, or without times one for each frame"
             : "numbered frames begin at 0 s; give a pose without a time for each frame");
}

void place_by_path(PoseReader& reader, Recording& recording) {
  const std::string& name = reader.name();
  const TimedPath path(reader, UndefinedPoses::skipped);
  if (path.solids() > 0)
    refuse("\"solids\" do not move with the camera", reader.place(), "give them with the tool's");
  recording.largest_deviation = reader.largest_deviation();
  recording.camera_source = name;
  recording.camera_undefined = path.undefined();
  recording.camera_doubled = path.doubled();
  const bool is_fixed = !path.has_times() && path.poses().size() == 1;
  if (is_fixed && reader.world().empty() && recording.frames.size() > 1)
    recording.remarks.push_back({false, "the camera does not move: " + name + " has one pose"});
  if (!path.has_times() && !is_fixed && path.poses().size() != recording.frames.size())
    refuse(std::to_string(path.poses().size()) + " poses without times for " +
               std::to_string(recording.frames.size()) + " frames",
           name, "give one for each, or times");
  for (std::size_t k = 0; k < recording.frames.size(); ++k) {
    RecordedFrame& frame = recording.frames[k];
    if (path.has_times()) {
      frame.is_lost =
          frame.time < path.start() - kPoseTolerance || frame.time > path.end() + kPoseTolerance;
      if (!frame.is_lost) frame.camera = path.at(frame.time);
    } else {
      frame.is_lost = path.is_undefined(is_fixed ? 0 : k);
      if (!frame.is_lost) frame.camera = path.poses()[is_fixed ? 0 : k];
    }
  }
  if (path.has_times() && are_all_lost(recording)) refuse_other_times(path, name, recording);
  const std::optional<PoseGap> gap = path.improbable_gap();
  const auto is_within = [&](const RecordedFrame& frame) {
    return frame.time > gap->start && frame.time < gap->end;
  };
  if (gap && std::any_of(recording.frames.begin(), recording.frames.end(), is_within))
    recording.camera_gap = gap;
}

// Takes the images of MCAP, and their camera.
void take_mcap(const std::string& path, const RecordingOptions& options, Recording& recording) {
  mcap::Frames read = mcap::read_frames(path, options.topic);
  for (mcap::Frame& frame : read.frames)
    recording.frames.push_back(
        {frame.time, path + "/" + frame.name, {}, false, std::move(frame.read)});
  recording.intrinsics = std::move(read.intrinsics);
  recording.intrinsics_source = read.camera_info;
  recording.no_intrinsics = read.no_intrinsics;
  recording.remarks = std::move(read.remarks);
  if (options.topic.empty())
    recording.remarks.push_back({false, "its only topic of depth images is " + read.topic});
  const bool is_elsewhere = !options.world.empty() && options.world != read.camera_frame;
  if (options.camera || !options.camera_poses.empty() || (!is_elsewhere && !read.is_camera_placed))
    return;
  const std::string world = options.world.empty() ? "" : options.world + ":";
  PoseReader reader(path + ":" + world + read.camera_frame);
  place_by_path(reader, recording);
  recording.remarks.push_back({false, "the world is the frame " + reader.world() +
                                          " of TF, which has the poses of the camera, " +
                                          read.camera_frame});
}

void read_folder(const fs::path& folder, const RecordingOptions& options, Recording& recording) {
  for (const char* list : {"depth.txt", "associations.txt"}) {
    if (is_file(folder / list)) return read_list(folder / list, recording);
  }
  const std::vector<fs::path> files = files_of(folder);
  if (files.empty() && !mcap::files_of(folder.string()).empty())
    return take_mcap(folder.string(), options, recording);
  if (files.empty()) refuse_if_frames_lie_below(folder);
  if (files.empty()) refuse_if_bag(folder);
  if (files.empty())
    refuse("no frames in it", folder.string(),
           "wanted are .png, .exr, .tif, .pgm, .pfm, .npy, .pcd, .ply or .vpmc files, or depth.txt "
           "with \"time file\" lines");
  const bool timed = std::all_of(files.begin(), files.end(),
                                 [](const fs::path& path) { return time_in(path).has_value(); });
  if (!timed) return number_frames(files, options.frame_rate, recording);
  for (const fs::path& path : files)
    recording.frames.push_back({*time_in(path), path.string(), {}, false});
}

// Returns the file of a frame's pose: beside it, or as ScanNet has it in pose/ beside its folder.
fs::path pose_beside(const RecordedFrame& frame) {
  const fs::path path(frame.path), folder = path.parent_path();
  const std::string name = path.stem().string();
  std::vector<fs::path> places{folder / (name + ".pose.txt")};
  if (!is_decimal(path)) places.push_back(folder / (stem_of(path) + ".pose.txt"));
  fs::path beside = places.back();
  for (const char* const other : {"pose", "poses"})
    places.push_back(folder / ".." / other / (name + ".txt"));
  for (const fs::path& place : places)
    if (fs::exists(status_of(place))) return place;
  return beside;
}

void place_by_files(Recording& recording) {
  std::optional<Error> first_fault;
  for (RecordedFrame& frame : recording.frames) {
    try {
      PoseReader reader(pose_beside(frame).string());
      frame.camera = reader.next();
      recording.largest_deviation =
          std::max(recording.largest_deviation, reader.largest_deviation());
    } catch (const Error& fault) {  // trackers write invalid poses where they are lost
      if (!first_fault) first_fault = fault;
    }
    frame.is_lost = !frame.camera;
  }
  if (are_all_lost(recording) && first_fault) throw *first_fault;
  recording.camera_source = pose_beside(recording.frames.front()).parent_path() ==
                                    fs::path(recording.frames.front().path).parent_path()
                                ? ".pose.txt beside the frames"
                                : "pose/ beside the folder of the frames";
}

void place_cameras(const fs::path& folder, const RecordingOptions& options, Recording& recording) {
  const auto& frames = recording.frames;
  if (!options.camera_poses.empty()) {
    PoseReader reader(options.camera_poses);
    place_by_path(reader, recording);
  } else if (options.camera) {
    for (RecordedFrame& frame : recording.frames) frame.camera = options.camera;
  } else if (std::any_of(frames.begin(), frames.end(), [](const RecordedFrame& frame) {
               return fs::exists(status_of(pose_beside(frame)));
             })) {
    place_by_files(recording);
  } else if (recording.has_clock && is_file(folder / "groundtruth.txt")) {
    PoseReader reader((folder / "groundtruth.txt").string());
    place_by_path(reader, recording);
  }
}

void read_intrinsics(const fs::path& path, Recording& recording) {
  if (!is_file(path)) return;
  recording.intrinsics_source = path.filename().string();
  recording.intrinsics = parse_intrinsics(file::read_all(path.string()), path.string());
}

bool is_earlier(const RecordedFrame& a, const RecordedFrame& b) {
  return a.time < b.time;
}

}  // namespace

bool is_ready_cloud(const RecordedFrame& frame) {
  return file::in_lower_case(fs::path(frame.path).extension().string()) == ".vpmc";
}

std::vector<std::byte> bytes_of(const RecordedFrame& frame) {
  if (!frame.read) return file::read_all(frame.path);
  try {
    return frame.read();
  } catch (const Error& fault) {
    throw Error(fault.kind(), fault.problem(), frame.path, fault.hint());
  }
}

std::string stem_of(const RecordedFrame& frame) {
  const fs::path path(frame.path);
  return frame.read ? path.filename().string() : path.stem().string();
}

Recording joined(std::vector<Recording> recordings) {
  Recording all = std::move(recordings.front());
  for (std::size_t k = 1; k < recordings.size(); ++k) {
    Recording& next = recordings[k];
    if (next.has_clock != all.has_clock)
      refuse("the frames of one camera have times, and those of another numbers",
             next.frames.front().path, "give a list of \"time file\" lines for each of them");
    for (RecordedFrame& frame : next.frames) frame.source = k;
    std::move(next.frames.begin(), next.frames.end(), std::back_inserter(all.frames));
    all.missing += next.missing;
  }
  all.sources = recordings.size();
  std::stable_sort(all.frames.begin(), all.frames.end(), is_earlier);
  return all;
}

Recording read_recording(const std::string& path, const RecordingOptions& options) {
  const bool is_folder = fs::is_directory(status_of(path));
  const fs::path folder = is_folder ? fs::path(path) : fs::path(path).parent_path();
  Recording recording;
  if (!is_folder && !mcap::files_of(path).empty()) {
    take_mcap(path, options, recording);
  } else if (is_folder) {
    read_folder(folder, options, recording);
  } else {
    read_list(path, recording);
  }
  std::stable_sort(recording.frames.begin(), recording.frames.end(), is_earlier);
  const bool is_mcap = static_cast<bool>(recording.frames.front().read);
  if (!is_mcap && !options.topic.empty())
    throw Error(ErrorKind::invalid_argument, "`topic` is for recordings in MCAP: leave it out",
                path);
  if (!is_mcap || !options.camera_poses.empty() || options.camera)
    place_cameras(folder, options, recording);
  if (is_folder && !is_mcap) read_intrinsics(folder / "camera-intrinsics.txt", recording);
  return recording;
}

}  // namespace vpm
