#include "tools/query/frame_removal.h"

#include <vpm/error.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"
#include "libvpm/recording/pose_json.h"

namespace vpm::tools {
namespace {

constexpr const char* kFirstLine =
    "the first line names the solids: {\"remove\":[\"hand.vpmg\",\"link.stl\"]}";

// Returns the names of the first line, beside the folder of the file.
std::vector<std::string> names_in(const std::string& line, const std::string& file) {
  const nlohmann::json value = nlohmann::json::parse(line, nullptr, false);
  const bool is_list = value.is_object() && value.contains("remove") &&
                       value["remove"].is_array() && !value["remove"].empty();
  if (!is_list) refuse("no list \"remove\" of solids", file + ", line 1", kFirstLine);
  std::vector<std::string> names;
  for (const nlohmann::json& name : value["remove"]) {
    if (!name.is_string()) refuse("a solid that is no text", file + ", line 1", kFirstLine);
    names.push_back((std::filesystem::path(file).parent_path() / name.get<std::string>()).string());
  }
  return names;
}

std::string seconds_text(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f s", seconds);
  return text;
}

}  // namespace

FrameRemoval::FrameRemoval(const Program& program, const std::string& file,
                           const std::string& margin)
    : file_(file) {
  std::istringstream lines(file::utf8_of(file::as_text(file::read_all(file))));
  std::string line;
  for (std::size_t number = 1; std::getline(lines, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    if (removal_) {
      add_line(line, file + ", line " + std::to_string(number));
      continue;
    }
    removal_.emplace(program, names_in(line, file));
  }
  if (!removal_) refuse("it is empty", file, kFirstLine);
  if (!times_.empty()) path_.emplace(times_, poses_);
  margin_ = removal_margin_from_text(margin, true);
}

void FrameRemoval::add_line(const std::string& line, const std::string& place) {
  try {
    const nlohmann::json value = nlohmann::json::parse(line, nullptr, false);
    if (!value.is_object() || !value.contains("solids"))
      refuse("no \"solids\", the poses of the solids at a time", {},
             "write {\"time\":0.1,\"solids\":[[tx,ty,tz,qx,qy,qz,qw], …]}");
    double deviation = 0;
    std::vector<Pose> poses = poses_of_solids(value["solids"], deviation);
    if (poses.size() != removal_->solids())
      refuse("\"solids\" has " + std::to_string(poses.size()) + " poses, and \"remove\" " +
                 std::to_string(removal_->solids()) + " solids",
             {}, "give one for each");
    const std::optional<double> time = time_of(value);
    if (!poses_.empty() && time.has_value() == times_.empty())
      refuse("either every line has a time or none");
    if (time && !(std::isfinite(*time) && (times_.empty() || *time > times_.back())))
      refuse("times must ascend");
    if (time) times_.push_back(*time);
    poses_.push_back(std::move(poses));
  } catch (const Error& fault) {
    refuse(fault.problem(), place, fault.hint());
  }
}

void FrameRemoval::take_times(const Recording& recording) {
  if (poses_.empty() || path_) return;
  if (poses_.size() != recording.frames.size())
    refuse(std::to_string(poses_.size()) + " lines of poses without times, but " +
               std::to_string(recording.frames.size()) + " frames",
           file_, "give a line for each frame, or times");
  for (const RecordedFrame& frame : recording.frames) times_.push_back(frame.time);
  path_.emplace(times_, poses_);
}

void FrameRemoval::check(const RecordedFrame& frame) const {
  if (!path_) return;
  const bool is_early = frame.time < path_->start() - kPoseTolerance;
  if (!is_early && frame.time <= path_->end() + kPoseTolerance) return;
  refuse("its poses " +
             (is_early ? "begin at " + seconds_text(path_->start())
                       : "end at " + seconds_text(path_->end())) +
             ", but " + frame.path + " is of " + seconds_text(frame.time),
         file_, "give poses for the time of all frames, on their clock");
}

std::vector<SolidPlace> FrameRemoval::places_at(double time) const {
  const std::vector<Pose> poses = path_ ? path_->solids_at(time) : removal_->poses();
  std::vector<SolidPlace> places;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    double speed = margin_.speed.value_or(0);
    if (path_ && !margin_.speed && margin_.seconds > 0)
      speed = path_->speed_of_solid(k, time, margin_.seconds, removal_->reach(k));
    places.push_back({poses[k], margin_.distance + margin_.seconds * speed});
  }
  return places;
}

std::size_t FrameRemoval::remove(CloudSensor& image, double time) {
  return removal_->remove(places_at(time), image);
}

void FrameRemoval::say(const Program& program) const {
  removal_->say(program, words_of(margin_));
}

}  // namespace vpm::tools
