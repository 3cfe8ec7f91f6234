// Mode of vpm-normals that makes clouds of the frames of a recording.
#include <vpm/error.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <set>
#include <utility>

#include "libvpm/cloud/cloud.h"
#include "libvpm/file/sniff.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"
#include "libvpm/recording/mcap/mcap_file.h"
#include "libvpm/recording/pose_columns.h"
#include "tools/common/error_text.h"
#include "tools/common/recorded_frames.h"
#include "tools/common/remarks.h"
#include "tools/normals/arguments.h"

namespace vpm::tools {
namespace {

namespace fs = std::filesystem;

// Most warnings about frames that are printed.
constexpr std::size_t kMostWarnings = 5;

// Throws a refusal of one image whose output is a folder.
void refuse_one_image(const Arguments& a) {
  std::error_code fault;
  if (!fs::is_regular_file(a.depth, fault) || !mcap::files_of(a.depth).empty()) return;
  const auto content = file::sniff(file::read_all(a.depth));
  if (!content || !content->scan) return;
  const fs::path name = fs::path(a.depth).filename().replace_extension(".vpmc");
  refuse_usage("--output " + a.output + " is a folder, and " + a.depth +
               " is one frame: name a file, such as " + (fs::path(a.output) / name).string());
}

void check(const Arguments& a) {
  if (a.output.empty() || a.output == "-")
    refuse_usage("the input is a recording: give -o FOLDER for its clouds");
  if (!a.report.empty() || !a.export_path.empty() || !a.view.empty())
    refuse_usage("--report, --export and --view are for one frame: leave them out, or name it");
  check_camera(a);
  refuse_one_image(a);
  std::error_code fault;
  if (fs::equivalent(a.depth, a.output, fault))
    refuse_usage("--output " + a.output + " is the folder of the frames: name another one");
}

// Makes the folder. Throws Error(invalid_argument) if files are in it already.
void make_folder(const std::string& folder, const CommonOptions& common) {
  std::error_code fault;
  if (fs::exists(folder, fault) && !fs::is_directory(folder, fault))
    refuse_usage("--output " + folder + " is a file: name a folder for the clouds of a recording");
  fs::create_directories(folder, fault);
  if (fault)
    throw Error(ErrorKind::cannot_write,
                "cannot make the folder " + folder + ": " + fault.message());
  if (!common.force && !fs::is_empty(folder, fault))
    refuse_usage("--output " + folder +
                 " has files in it already; name another folder, or give --force");
}

// Returns the name of each frame's cloud: that of the frame with another ending.
std::vector<std::string> names_of(const Recording& recording) {
  std::vector<std::string> names;
  std::set<std::string> seen;
  for (const RecordedFrame& frame : recording.frames) {
    names.push_back(stem_of(frame) + ".vpmc");
    if (!seen.insert(names.back()).second)
      refuse("two frames have this name", frame.path, "give each of them a name of its own");
  }
  return names;
}

RecordingOptions options_of(const Arguments& a, const ImportOptions& options) {
  return {a.frame_rate, a.camera_poses, options.to_world, a.topic, {}};
}

// Returns the frame nearest to a time, s, on the recording's clock or, as "+S", after the first
// frame; the first for "".
const RecordedFrame& frame_at(const Recording& recording, const std::string& at,
                              const std::string& name) {
  const std::vector<RecordedFrame>& frames = recording.frames;
  if (at.empty()) return frames.front();
  const bool is_after_first = at.starts_with('+');
  const std::optional<double> number = file::to_number(at.substr(is_after_first));
  if (!number || !std::isfinite(*number))
    refuse_usage("--at " + at + ": give seconds, such as 12.5, or +12.5 after the first image");
  const double time = is_after_first ? frames.front().time + *number : seconds_of_stamp(*number);
  if (time < frames.front().time - kPoseTolerance || time > frames.back().time + kPoseTolerance) {
    char text[160];
    std::snprintf(text, sizeof text, "no image at %.3f s: they are from %.3f to %.3f s", time,
                  frames.front().time, frames.back().time);
    refuse(text, name, "give --at +0 for the first, or a time among them");
  }
  return *std::ranges::min_element(
      frames, {}, [&](const RecordedFrame& frame) { return std::abs(frame.time - time); });
}

// Converts frames one by one, and counts those that cannot be used.
class FrameWriter {
 public:
  FrameWriter(const Program& program, const ImportOptions& options, const std::string& folder)
      : program_(program), options_(options), folder_(folder) {}

  void write(const RecordedFrame& frame, const std::string& name) {
    try {
      if (frame.is_lost) refuse("no pose of its camera", frame.path);
      convert(frame, name);
    } catch (const Error& fault) {
      // Errors other than `refused` concern the call, not this frame.
      if (fault.kind() != ErrorKind::refused) throw;
      last_fault_ = fault.what();
      if (++unusable_ <= kMostWarnings) program_.warn(last_fault_ + "; it is left out");
    }
  }

  std::size_t written() const { return written_; }
  std::size_t unusable() const { return unusable_; }
  const std::string& last_fault() const { return last_fault_; }

 private:
  void convert(const RecordedFrame& frame, const std::string& name) {
    ImportOptions options = options_;
    if (frame.camera) options.to_world = frame.camera;
    options.time = frame.time;
    options.depth.looks_for_mistakes = written_ == 0;  // those of one frame are said
    const std::vector<std::byte> bytes = bytes_of(frame);
    ImportedCloud imported = import_cloud(bytes, frame.path, options);
    if (written_ == 0) say(program_, frame.path, imported.remarks);
    imported.cloud.provenance = provenance_of(program_, options, bytes);
    write_cloud((fs::path(folder_) / name).string(), imported.cloud);
    ++written_;
  }

  const Program& program_;
  const ImportOptions& options_;
  const std::string& folder_;
  std::size_t written_ = 0, unusable_ = 0;
  std::string last_fault_;
};

// Writes the list that tells the times of the clouds; those that could not be made are in it, so
// that whoever reads it knows what is missing.
void write_times(const std::string& folder, const Recording& recording,
                 const std::vector<std::string>& names) {
  std::string list = "# time file\n";
  for (std::size_t k = 0; k < names.size(); ++k) {
    char time[40];
    std::snprintf(time, sizeof time, "%.9f ", recording.frames[k].time);
    list += time + names[k] + "\n";
  }
  file::write_all((fs::path(folder) / "depth.txt").string(), list);
}

}  // namespace

void check_camera(const Arguments& a) {
  if (!a.camera_poses.empty() && !a.import.camera_pose.empty())
    refuse_usage("--camera-pose and --camera-poses exclude each other: leave one of them out");
}

Source source_of(const Program& program, const Arguments& a, ImportOptions& options) {
  if (mcap::files_of(a.depth).empty()) {
    for (const auto& [option, value] : {std::pair("--topic", &a.topic), std::pair("--at", &a.at)})
      if (!value->empty())
        refuse_usage(std::string(option) + " is for a recording in MCAP: leave it out");
    return {a.depth == "-" ? "standard input" : a.depth, file::read_all(a.depth)};
  }
  const Recording recording = open_recording(program, a.depth, options_of(a, options), options);
  note_recording(program, a.depth, recording, options);
  const RecordedFrame& frame = frame_at(recording, a.at, a.depth);
  if (frame.is_lost) refuse("no pose of its camera", frame.path);
  if (frame.camera) options.to_world = frame.camera;
  options.time = frame.time;
  program.note("the image of " + stem_of(frame) + " s is read, of " +
               std::to_string(recording.frames.size()));
  return {frame.path, bytes_of(frame)};
}

bool is_recording(const Arguments& a) {
  std::error_code fault;
  return fs::is_directory(a.depth, fault) || a.output.ends_with('/') ||
         (!a.output.empty() && a.depth != "-" && fs::is_directory(a.output, fault));
}

void run_recording(const Program& program, const Arguments& a) {
  check(a);
  if (!a.at.empty())
    refuse_usage("--at is for one frame: leave it out, or name a file by --output");
  ImportOptions options = import_options(program, a.import);
  const auto removed = remove_solids(program, a, options);
  const Recording recording = open_recording(program, a.depth, options_of(a, options), options);
  if (is_ready_cloud(recording.frames.front()))
    refuse_usage(a.depth + " holds clouds already: give it to vpm-query --frames");
  note_recording(program, a.depth, recording, options);
  const std::vector<std::string> names = names_of(recording);
  make_folder(a.output, program.common());
  FrameWriter writer(program, options, a.output);
  Progress progress("frames", program.common());
  for (std::size_t k = 0; k < names.size(); ++k) {
    writer.write(recording.frames[k], names[k]);
    progress.update(static_cast<double>(k + 1) / static_cast<double>(names.size()));
  }
  if (writer.written() == 0)
    refuse(a.depth + ": no frame can be used; the last one: " + writer.last_fault());
  if (removed) removed->say(program);
  if (recording.has_clock) write_times(a.output, recording, names);
  if (recording.missing > 0)
    program.warn(std::to_string(recording.missing) + " frames of " + a.depth + " are missing");
  program.note(std::to_string(writer.written()) +
               (writer.written() == 1 ? " cloud is in " : " clouds are in ") + a.output +
               (writer.unusable() > 0
                    ? ", and " + std::to_string(writer.unusable()) + " frames could not be used"
                    : ""));
}

}  // namespace vpm::tools
