#include "tools/query/replay.h"

#include <cstdio>
#include <filesystem>

#include "libvpm/core/error.h"
#include "tools/query/query_report.h"
#include "tools/query/replay_report.h"

namespace vpm::tools {
namespace {

// Most warnings about frames that are printed; the report counts all.
constexpr std::size_t kMostWarnings = 5;

std::string name_of(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

SampledPath read_path(const Tool& tool, const std::string& name, double rate) {
  PoseReader reader(name);
  SampledPath path(TimedPath(reader), rate);
  note_deviation(tool, name, reader.largest_deviation());
  return path;
}

RecordingOptions recording_options(const ReplayArguments& a, const ImportOptions& import) {
  return {a.frame_rate, a.camera_poses, import.to_world};
}

}  // namespace

Replay::Replay(const Tool& tool, const ReplayArguments& arguments, double rate,
               const Device& device, Denoising points)
    : tool_(tool),
      arguments_(arguments),
      rate_(rate),
      path_(read_path(tool, arguments.trajectory, rate)),
      import_(import_options(tool, arguments.import)),
      device_(device),
      points_(points) {
  recording_ = read_recording(arguments.frames, recording_options(arguments, import_));
  if (!import_.intrinsics && recording_.intrinsics) {
    import_.intrinsics = recording_.intrinsics;
    check_intrinsics(*import_.intrinsics);
  }
  note_sources();
  schedule_ = {rate, path_.steps(), start_time(), arguments.frame_latency, arguments.repeat_frames};
  find_first_cloud();
}

void Replay::note_sources() const {
  if (recording_.camera_source.empty()) {
    tool_.note("the camera does not move: " + arguments_.frames +
               (import_.to_world ? " is seen from --camera-pose"
                                 : " has no poses of it, and no --camera-poses are given"));
  } else {
    tool_.detail("poses of the camera: " + recording_.camera_source);
  }
  note_deviation(tool_, recording_.camera_source, recording_.largest_deviation);
  if (!recording_.has_clock && path_.path().has_times())
    tool_.note("frames have numbers, not times: they begin with the path, at --frame-rate");
}

double Replay::start_time() const {
  const TimedPath& path = path_.path();
  const double first = recording_.frames.front().time, last = recording_.frames.back().time;
  if (arguments_.align_starts || !recording_.has_clock || !path.has_times()) return first;
  if (path.end() < first || path.start() > last) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "the path (%.3f to %.3f s) and the frames (%.3f to %.3f s) share no time; "
                  "--align-starts lets both begin together",
                  path.start(), path.end(), first, last);
    refuse(text);
  }
  return path.start();
}

void Replay::find_first_cloud() {
  FrameSchedule schedule(recording_, schedule_);
  FrameReader reader(recording_, import_, {}, points_);
  std::string why = "none comes before the path ends";
  // Frames that repeat are read once, since they tell nothing new.
  std::size_t looked_at = 0;
  while (looked_at < recording_.frames.size()) {
    std::optional<FrameChange> change = schedule.next();
    if (!change) break;
    looked_at += change->frames.size();
    PreparedChange prepared = reader.prepare(std::move(*change));
    if (!prepared.unusable.empty()) why = prepared.unusable.back().message;
    first_cloud_ = std::move(prepared.cloud);
    if (!first_cloud_) continue;
    tools::say(tool_, recording_.frames[prepared.frame].path, prepared.remarks);
    return;
  }
  refuse(arguments_.frames + ": no frame can be used; the last one: " + why);
}

CoupledStep Replay::ask(std::size_t k, LevelToolQuery& query,
                        std::optional<VirtualCoupling>& coupling) const {
  CoupledStep step{k, path_.time(k), path_.pose(k), {}, {}, {}, {}};
  step.tool = coupling ? coupling->tool() : step.device;
  const DepthFrame* const frame = feed_->depth_frame();
  step.contact =
      frame != nullptr ? query.run(*frame, step.tool) : query.run(feed_->cloud(), step.tool);
  if (coupling) {
    step.rendered = coupling->advance(step.device, step.contact.wrench);
    step.energy = coupling->energy();
  }
  return step;
}

void Replay::run(LevelToolQuery& query, std::optional<VirtualCoupling> coupling, Measure measure,
                 file::Output& output, std::optional<PoseView>& view) {
  if (view) view->set_frames(arguments_.frames, recording_, import_);
  feed_ = std::make_unique<FrameFeed>(recording_, schedule_, import_, device_, points_);
  feed_->wait_for_first();
  clock_.emplace(rate_, arguments_.realtime);
  for (std::size_t k = 0; k < path_.steps(); ++k) {
    // A loop that runs ahead of the clock waits for frames that a real stream would have brought in
    // time.
    const PreparedChange* change = arguments_.realtime ? nullptr : feed_->advance_to(k);
    clock_->begin_step();
    if (arguments_.realtime) change = feed_->advance_to(k);
    const CoupledStep step = ask(k, query, coupling);
    clock_->end_step();
    last_pose_ = step.tool;
    query_seconds_.push_back(query.seconds());
    if (view) view->see_frame(feed_->frame());
    if (view) view->add(0, step.tool, step.contact, query.query());
    steps_without_frame_ += !feed_->frame();
    if (change) say(*change);
    output.append(coupling ? coupled_line(step, frame_name())
                           : result_line(k, step.contact, query.query().level(), measure,
                                         query.reason(), StepOfReplay{step.time, frame_name()}));
  }
  wall_seconds_ = clock_->seconds();
  say_at_end();
}

std::string Replay::frame_name() const {
  const auto frame = feed_->frame();
  return frame ? name_of(recording_.frames[*frame].path) : "";
}

void Replay::say(const PreparedChange& change) {
  const auto say_one = [&](const std::string& text) {
    if (said_ < kMostWarnings) tool_.warn(text);
    if (++said_ == kMostWarnings) tool_.warn("further frames like these are only counted");
  };
  const std::string went_on =
      feed_->frame() ? "; the loop goes on with " + frame_name() : "; there is none before it";
  for (const UnusableFrame& frame : change.unusable) say_one(frame.message + went_on);
  if (change.change.is_late)
    say_one(recording_.frames[change.change.frames.front()].path +
            ": came late; the loop went on with the frame before");
}

void Replay::say_at_end() const {
  if (recording_.missing > 0)
    tool_.warn(std::to_string(recording_.missing) + " frames of " + arguments_.frames +
               " are missing; the loop went on with those before");
  if (steps_without_frame_ > 0)
    tool_.warn(std::to_string(steps_without_frame_) +
               " steps came before the first frame that can be used: nothing is in their way");
  const Durations latency(clock_->latencies());
  char text[256];
  std::snprintf(text, sizeof text,
                "%zu steps in %.3g s, %.3g times real time; latency %.0f us median, %.0f us p99, "
                "%.0f us longest; %zu frames used",
                latency.size(), wall_seconds_, path_.time(path_.steps()) / wall_seconds_,
                1e6 * latency.quantile(0.5), 1e6 * latency.quantile(0.99),
                1e6 * latency.quantile(1), feed_->counts().used);
  tool_.note(text);
}

double Replay::prepare_seconds() const {
  return Durations(feed_->counts().seconds).quantile(0.5);
}

nlohmann::json Replay::report(double deadline) const {
  nlohmann::json report = replay_report(*clock_, rate_, wall_seconds_, deadline);
  report["realtime"] = arguments_.realtime;
  report["steps_without_frame"] = steps_without_frame_;
  report["frames"] = frames_report(recording_, feed_->counts());
  return report;
}

}  // namespace vpm::tools
