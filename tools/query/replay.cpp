// Mode of vpm-query that moves the tool, or a haptic device that holds it, through recorded frames,
// step by step.
#include <vpm/level_query.h>
#include <vpm/virtual_coupling.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "libvpm/api/handle_access.h"
#include "libvpm/core/error.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/recording/frame_feed.h"
#include "libvpm/recording/frame_schedule.h"
#include "libvpm/recording/loop_clock.h"
#include "libvpm/setup/pose_check.h"
#include "libvpm/setup/size_check.h"
#include "libvpm/view/pose_view.h"
#include "tools/common/error_text.h"
#include "tools/common/recorded_frames.h"
#include "tools/common/remarks.h"
#include "tools/query/arguments.h"
#include "tools/query/contact_lines.h"
#include "tools/query/coupling.h"
#include "tools/query/frame_removal.h"
#include "tools/query/mode.h"
#include "tools/query/query_report.h"
#include "tools/query/registration.h"
#include "tools/query/replay_report.h"
#include "tools/query/result_output.h"
#include "tools/query/tool_paths.h"

namespace vpm::tools {
namespace {

// Returns the scene of a frame and solids.
Scene scene_with(const AnyBody& frame, const std::vector<Body>& solids) {
  std::vector<Body> bodies{HandleAccess::make<Body>(frame)};
  bodies.insert(bodies.end(), solids.begin(), solids.end());
  return Scene(std::move(bodies));
}

// Paths of tools through a recording.
class Replay {
 public:
  // Reads the recording and the path, which has `rate` steps per second. Prepares depth images on
  // the device of the queries, and reads frames without a camera as the options say. The solids
  // stay beside each frame. Throws what the readers throw, and Error(refused) if recording and path
  // share no time or no frame can be used.
  Replay(const QuerySetup& setup, double rate);

  const ToolPaths& paths() const { return paths_; }
  // Returns the scene of the first frame that can be used, by which levels are chosen.
  Scene first() const { return scene_with(*first_body_, solids_); }

  // Queries step by step, writes a line of results for each and shows them to `check`. Prints notes
  // and warnings about frames as they happen. The first `passed` steps are not asked.
  void run(LevelQuery& query, PoseCheck& check, std::optional<VirtualCoupling> coupling,
           Measure measure, std::size_t passed, Collisions& collisions, ResultOutput& output,
           std::optional<View>& view);

  // Reads the frames of a scene of the page again, one of each camera.
  view::PoseView::Images clouds_of(std::size_t number) const;

  // Return what the checks of the setup compare poses and sizes with.
  SceneSource source() const;
  CheckedScene scene_of(std::size_t frame) const;
  CheckedScene first_scene() const {
    return checked_scene(first_body_->origin(), first_body_->positions(), first_camera_);
  }

  // Returns the last pose of the tool. The values from here on need run().
  const Pose& last_pose() const { return last_pose_; }
  const AnyBody& last_body() const { return feed_->body(); }
  // Returns the time of each query, s.
  const std::vector<double>& query_seconds() const { return query_seconds_; }
  // Returns the median time of preparing a frame, s.
  double prepare_seconds() const;
  // Returns the field "replay" of --stats. `deadline` is in seconds.
  nlohmann::json report(double deadline) const;

 private:
  void open_recordings();
  double start_time() const;
  // Returns the number by which the page knows the current frames.
  std::optional<std::size_t> number_of_scene();
  // Has frames freed of the solids of --remove, if it is given.
  void begin_removal();
  void find_first_body();
  void say(const PreparedChange& change);
  void compare_size(const PreparedChange& change);
  void say_at_end() const;
  // Asks step k of all tools.
  void ask_all(std::size_t k, LevelQuery& query, std::optional<VirtualCoupling>& coupling);
  // Shows the step that was asked last to the checks and the view, and writes
  // its lines.
  void tell(const LevelQuery& query, PoseCheck& check, Measure measure, bool are_coupled,
            Collisions& collisions, ResultOutput& output, std::optional<View>& view);
  // Returns the names of the current frames, of several cameras with the name of each.
  std::string frame_name() const;
  // Returns step k of a tool, without rendered wrench and energy if there is no
  // coupling.
  CoupledStep ask(std::size_t k, std::size_t tool, LevelQuery& query,
                  std::optional<VirtualCoupling>& coupling) const;

  const Program& program_;
  const ReplayArguments& arguments_;
  double rate_;
  std::string folders_;               // names of the recordings
  std::vector<std::string> cameras_;  // the same, as short as they differ
  Recording recording_;
  std::size_t tools_;
  ToolPaths paths_;
  ImportOptions import_;
  std::unique_ptr<FrameRemoval> removal_;  // null without --remove
  Device device_;
  Denoising points_;
  std::vector<Body> solids_;
  bool tells_contacts_;
  ScheduleOptions schedule_;
  std::optional<AnyBody> first_body_;
  std::optional<Scene> scene_;  // the frame that the loop sees
  std::unique_ptr<FrameFeed> feed_;
  std::optional<LoopClock> clock_;
  std::vector<std::vector<std::size_t>> shown_;  // frames of each scene that the page may show
  std::vector<CoupledStep> now_;                 // the step of each tool
  Pose last_pose_;
  std::vector<double> query_seconds_;
  std::optional<Camera> first_camera_;  // camera of the first frame, if it is an image
  bool sizes_differ_ = false;
  std::size_t said_ = 0, steps_without_frame_ = 0;
  double wall_seconds_ = 0;
};

// Most warnings about frames that are printed; the report counts all.
constexpr std::size_t kMostWarnings = 5;

std::string name_of(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

std::string joined(const std::vector<std::string>& names, const char* between) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : between) + name;
  return all;
}

// Returns the names of the cameras: those of their recordings, with topics where these are given.
std::vector<std::string> camera_names(const ReplayArguments& a) {
  std::vector<std::string> names;
  for (const std::string& folder : a.frames) {
    const std::filesystem::path path(folder);  // whose name would be empty behind a last /
    names.push_back((path.has_filename() ? path : path.parent_path()).filename().string());
  }
  if (std::set(names.begin(), names.end()).size() < names.size()) names = a.frames;
  if (names.size() > 1 && !a.topic.empty())
    for (std::size_t k = 0; k < names.size(); ++k) names[k] += ":" + a.topic[k];
  return names;
}

void check_cameras(const ReplayArguments& a) {
  const auto check_count = [&](const char* option, std::size_t count) {
    if (count > 0 && count != a.frames.size())
      refuse_usage("give " + std::string(option) +
                   " once for each --frames, in their order, or not at all");
  };
  check_count("--camera-poses", a.camera_poses.size());
  check_count("--topic", a.topic.size());
  if (a.frames.size() > 1 && !a.import.camera_pose.empty())
    refuse_usage(
        "--camera-pose would put the cameras of several --frames at one place: give "
        "--camera-poses for each");
}

Replay::Replay(const QuerySetup& setup, double rate)
    : program_(setup.program),
      arguments_(setup.arguments.replay),
      rate_(rate),
      folders_(joined(arguments_.frames, ", ")),
      tools_(setup.arguments.tools.size()),
      paths_(program_, setup.arguments.poses, rate, setup.arguments.solids.size()),
      import_(import_options(program_, arguments_.import)),
      device_(setup.options.device),
      points_(setup.points),
      solids_(setup.solids),
      tells_contacts_(setup.arguments.contacts > 0) {
  open_recordings();
  if (!recording_.has_clock && paths_.has_times())
    program_.note("frames have numbers, not times: they begin with the path, at --frame-rate");
  schedule_ = {rate, paths_.steps(), start_time(), arguments_.frame_latency,
               arguments_.repeat_frames};
  begin_removal();
  if (setup.arguments.registers) {
    if (recording_.sources < 2)
      refuse_usage("--register makes the images of cameras agree: give several --frames");
    move_to_agree(program_, arguments_.frames, import_, recording_);
  }
  find_first_body();
}

void Replay::open_recordings() {
  check_cameras(arguments_);
  cameras_ = camera_names(arguments_);
  std::vector<Recording> recordings;
  for (const std::string& folder : arguments_.frames) {
    const std::size_t k = recordings.size();
    RecordingOptions options{arguments_.frame_rate, {}, import_.to_world, {}, paths_.world()};
    if (!arguments_.camera_poses.empty()) options.camera_poses = arguments_.camera_poses[k];
    if (!arguments_.topic.empty()) options.topic = arguments_.topic[k];
    ImportOptions import = import_;
    Recording& one = recordings.emplace_back(open_recording(program_, folder, options, import));
    note_recording(program_, folder, one, import);
    for (RecordedFrame& frame : one.frames) frame.intrinsics = import.intrinsics;
  }
  recording_ = vpm::joined(std::move(recordings));
}

void Replay::begin_removal() {
  if (arguments_.remove.empty()) return;
  removal_ = std::make_unique<FrameRemoval>(program_, arguments_.remove, arguments_.remove_margin);
  removal_->take_times(recording_);
  FrameSchedule schedule(recording_, schedule_);
  // Frames that repeat are looked at once.
  for (std::size_t looked_at = 0; looked_at < recording_.frames.size();) {
    const std::optional<FrameChange> change = schedule.next();
    if (!change) break;
    looked_at += change->frames.size();
    for (const std::size_t frame : change->frames) removal_->check(recording_.frames[frame]);
  }
  import_.remove = [removal = removal_.get()](CloudSensor& image, double time) {
    return removal->remove(image, time);
  };
}

double Replay::start_time() const {
  const double first = recording_.frames.front().time, last = recording_.frames.back().time;
  if (arguments_.align_starts || !recording_.has_clock || !paths_.has_times()) return first;
  if (paths_.end() < first || paths_.start() > last) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "the path (%.3f to %.3f s) and the frames (%.3f to %.3f s) share no time; "
                  "--align-starts lets both begin together",
                  paths_.start(), paths_.end(), first, last);
    refuse(text);
  }
  return paths_.start();
}

void Replay::find_first_body() {
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
    first_camera_ = prepared.camera;
    first_body_ = std::move(prepared.body);
    if (!first_body_) continue;
    tools::say(program_, recording_.frames[prepared.frame].path, prepared.remarks);
    return;
  }
  refuse(folders_ + ": no frame can be used; the last one: " + why);
}

CoupledStep Replay::ask(std::size_t k, std::size_t tool, LevelQuery& query,
                        std::optional<VirtualCoupling>& coupling) const {
  CoupledStep step{k, paths_.time(k), paths_.pose(tool, k), {}, {}, {}, {}};
  step.tool = coupling ? coupling->tool() : step.device;
  step.contact = query.run(*scene_, step.tool, tool, paths_.solids(k));
  if (coupling) {
    step.rendered = coupling->advance(step.device, step.contact.wrench);
    step.energy = coupling->energy();
  }
  return step;
}

SceneSource Replay::source() const {
  const RecordedFrame& first = recording_.frames.front();
  if (is_ready_cloud(first)) return source_of(read_cloud(first.path));
  return {.axes = import_.axes, .points_to_world = import_.to_world, .are_frames = true};
}

// Reads a frame again.
CheckedScene Replay::scene_of(std::size_t frame) const {
  const RecordedFrame& recorded = recording_.frames[frame];
  ImportOptions options = import_;
  options.depth.looks_for_mistakes = false;
  try {
    const ImportedScan scan = read_frame(recorded, options);
    return scan.image ? checked_scene(*scan.image) : checked_scene(scan.points);
  } catch (const Error&) {  // it has changed since, or came by a pipe
    return {};
  }
}

view::PoseView::Images Replay::clouds_of(std::size_t number) const {
  const bool is_one = recording_.sources == 1;
  view::PoseView::Images clouds(recording_.sources);
  for (const std::size_t frame : is_one ? std::vector{number} : shown_[number]) {
    ImportedScan scan = read_frame(recording_.frames[frame], import_);
    if (scan.image) scan.points.sensor = std::move(scan.image);
    clouds[recording_.frames[frame].source] =
        HandleAccess::make<PointCloud>(std::move(scan.points));
  }
  return clouds;
}

std::optional<std::size_t> Replay::number_of_scene() {
  if (recording_.sources == 1 || !feed_->frame()) return feed_->frame();
  if (shown_.empty() || shown_.back() != feed_->frames()) shown_.push_back(feed_->frames());
  return shown_.size() - 1;
}

void Replay::ask_all(std::size_t k, LevelQuery& query, std::optional<VirtualCoupling>& coupling) {
  now_.clear();
  for (std::size_t tool = 0; tool < tools_; ++tool) {
    now_.push_back(ask(k, tool, query, coupling));
    query_seconds_.push_back(query.seconds());
  }
  last_pose_ = now_.back().tool;
}

void Replay::tell(const LevelQuery& query, PoseCheck& check, Measure measure, bool are_coupled,
                  Collisions& collisions, ResultOutput& output, std::optional<View>& view) {
  std::vector<Pose> solids;  // for the view alone
  if (view) {
    view->see_frame(number_of_scene());
    solids = paths_.solids(now_.front().step);
  }
  for (std::size_t tool = 0; tool < now_.size(); ++tool) {
    const CoupledStep& step = now_[tool];
    const auto index = static_cast<std::uint32_t>(tool);
    if (view) view->add({step.tool, index, solids}, step.contact, query);
    if (feed_->frame() && solids_.empty() && recording_.sources == 1)
      check.see(step.tool, tool, step.contact, *feed_->frame());
    const auto told = tools_ > 1 ? std::optional(tool) : std::nullopt;
    nlohmann::ordered_json line =
        are_coupled ? coupled_line(step, frame_name())
                    : result_line(step.step, {}, step.contact, query.level(tool), measure,
                                  query.reason(tool), StepOfReplay{step.time, frame_name()}, told);
    if (tells_contacts_) line["contacts"] = contacts_of_pose(query.contacts(tool));
    collisions.answer(step.contact, line);
    output.append(line);
  }
}

void Replay::run(LevelQuery& query, PoseCheck& check, std::optional<VirtualCoupling> coupling,
                 Measure measure, std::size_t passed, Collisions& collisions, ResultOutput& output,
                 std::optional<View>& view) {
  if (view)
    view::PoseView::of(*view).set_frames(cameras_, [this](std::size_t k) { return clouds_of(k); });
  if (removal_) removal_->begin_counting();
  feed_ = std::make_unique<FrameFeed>(recording_, schedule_, import_, device_, points_);
  feed_->wait_for_first();
  scene_.emplace(scene_with(feed_->body(), solids_));
  clock_.emplace(rate_, arguments_.realtime);
  for (std::size_t k = 0; k < paths_.steps(); ++k) {
    // A loop that runs ahead of the clock waits for frames that a real stream would have brought in
    // time.
    const PreparedChange* change = arguments_.realtime ? nullptr : feed_->advance_to(k);
    clock_->begin_step();
    if (arguments_.realtime) change = feed_->advance_to(k);
    if (change) scene_.emplace(scene_with(feed_->body(), solids_));
    if (k >= passed) ask_all(k, query, coupling);
    clock_->end_step();
    steps_without_frame_ += !feed_->frame();
    if (change) say(*change);
    if (change && !sizes_differ_) compare_size(*change);
    if (k >= passed) tell(query, check, measure, coupling.has_value(), collisions, output, view);
  }
  wall_seconds_ = clock_->seconds();
  say_at_end();
}

std::string Replay::frame_name() const {
  std::vector<std::string> names;
  for (const std::size_t k : feed_->frames()) {
    const RecordedFrame& frame = recording_.frames[k];
    names.push_back((cameras_.size() > 1 ? cameras_[frame.source] + "/" : "") +
                    name_of(frame.path));
  }
  return joined(names, ";");
}

void Replay::say(const PreparedChange& change) {
  const auto say_one = [&](const std::string& text) {
    if (said_ < kMostWarnings) program_.warn(text);
    if (++said_ == kMostWarnings) program_.warn("further frames like these are only counted");
  };
  const std::string went_on =
      feed_->frame() ? "; the loop goes on with " + frame_name() : "; there is none before it";
  for (const UnusableFrame& frame : change.unusable) say_one(frame.message + went_on);
  if (change.change.is_late)
    say_one(recording_.frames[change.change.frames.front()].path +
            ": came late; the loop went on with the frame before");
}

// Warns once of a frame of another size than the first's, where the same intrinsics are used.
void Replay::compare_size(const PreparedChange& change) {
  if (!change.camera || !first_camera_ || recording_.sources > 1) return;
  const Camera &own = *change.camera, &first = *first_camera_;
  const Intrinsics &k = own.intrinsics, &l = first.intrinsics;
  const bool is_same_size = own.width == first.width && own.height == first.height;
  if (is_same_size || k.fx != l.fx || k.fy != l.fy || k.cx != l.cx || k.cy != l.cy) return;
  sizes_differ_ = true;
  program_.warn(recording_.frames[change.frame].path + ": has " + std::to_string(own.width) +
                " x " + std::to_string(own.height) + " pixels, and the first frame " +
                std::to_string(first.width) + " x " + std::to_string(first.height) +
                ": the same intrinsics hardly fit both");
}

void Replay::say_at_end() const {
  if (removal_) removal_->say(program_);
  if (recording_.missing > 0)
    program_.warn(std::to_string(recording_.missing) + " frames of " + folders_ +
                  " are missing; the loop went on with those before");
  if (steps_without_frame_ > 0)
    program_.warn(std::to_string(steps_without_frame_) +
                  " steps came before the first frame that can be used: nothing is in their way");
  const Durations latency(clock_->latencies());
  char text[256];
  std::snprintf(text, sizeof text,
                "%zu steps in %.3g s, %.3g times real time; latency %.0f us median, %.0f us p99, "
                "%.0f us longest; %zu frames used",
                latency.size(), wall_seconds_, paths_.time(paths_.steps()) / wall_seconds_,
                1e6 * latency.quantile(0.5), 1e6 * latency.quantile(0.99),
                1e6 * latency.quantile(1), feed_->counts().used);
  program_.note(text);
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

// Returns the parameters of --coupling, if it is given.
std::optional<CouplingParameters> coupling_of(const Arguments& a, const Tool& tool) {
  if (a.coupling.empty()) return std::nullopt;
  const double rate = a.replay.rate.value_or(ReplayArguments::kRate);
  const CouplingParameters parameters = coupling_from_text(a.coupling, tool, rate);
  if (a.replay.rate && rate != parameters.rate)
    throw Error(ErrorKind::invalid_argument,
                "--rate and the rate of --coupling differ; give one of them");
  return parameters;
}

}  // namespace

void run_frames(QuerySetup& setup) {
  const Arguments& a = setup.arguments;
  const Tool& tool = setup.tools.front();
  const std::optional<CouplingParameters> parameters = coupling_of(a, tool);
  const double rate =
      parameters ? parameters->rate : a.replay.rate.value_or(ReplayArguments::kRate);
  Replay replay(setup, rate);
  const Pose first = replay.paths().pose(0, 0);
  LevelQuery query(setup.tools, setup.options, setup.level, replay.first(), first);
  for (std::size_t k = 0; k < setup.tools.size(); ++k) note_scale(setup.program, query, k);
  std::optional<VirtualCoupling> coupling;
  if (parameters) {
    note_coupling(setup.program, *parameters, tool, setup.options.stiffness);
    coupling.emplace(*parameters, tool.center_of_mass(), first);
  }
  ResultOutput output(setup.program, a, parameters ? coupling_columns() : result_columns());
  std::vector<const ToolModel*> tools;
  for (const Tool& one : setup.tools) tools.push_back(&HandleAccess::held(one));
  const std::optional<Remark> sizes = improbable_sizes(tools, replay.first_scene(), true);
  if (sizes) say(setup.program, {*sizes});
  PoseCheck check(tools, replay.source(),
                  [&](std::size_t frame) { return replay.scene_of(frame); });
  // Steps that depend on those before are asked again, and their lines passed over.
  const std::size_t passed =
      parameters || setup.options.coherent ? 0 : output.pass_over(tools.size());
  replay.run(query, check, coupling, setup.options.measure, passed, setup.collisions, output,
             setup.view);
  output.finish();
  const std::optional<Remark> missing = check.remark();
  if (missing && !sizes) say(setup.program, {*missing});
  nlohmann::json stats =
      query_stats(replay.query_seconds(), replay.prepare_seconds(), a.deadline_us);
  stats["cloud_points"] = replay.last_body().positions().size();
  stats["replay"] = replay.report(a.deadline_us ? 1e-6 * *a.deadline_us : 1 / rate);
  add_levels(stats, query, tools.size());
  write_last_spheres(setup, query, replay.last_pose());
  write_stats_and_view(setup, std::move(stats));
}

}  // namespace vpm::tools
