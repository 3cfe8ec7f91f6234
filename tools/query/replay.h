// vpm-query --frames: queries a recorded stream of frames along a path of the tool, step by step.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "libvpm/file/stream.h"
#include "libvpm/haptics/virtual_coupling.h"
#include "libvpm/query/level_tool_query.h"
#include "libvpm/recording/frame_feed.h"
#include "libvpm/recording/loop_clock.h"
#include "libvpm/recording/timed_path.h"
#include "tools/query/coupled_step.h"
#include "tools/query/pose_view.h"
#include "tools/query/replay_arguments.h"

namespace vpm::tools {

// Path of the tool through a recording.
class Replay {
 public:
  // Reads the recording and the path, which has `rate` steps per second. Prepares depth images on
  // the device of the queries, and reads frames without a camera as `points` says. Throws what the
  // readers throw, and Error(refused) if recording and path share no time or no frame can be used.
  Replay(const Tool& tool, const ReplayArguments& arguments, double rate, const Device& device,
         Denoising points);

  const SampledPath& path() const { return path_; }
  // Returns the first frame that can be used, by which levels are chosen.
  const PreparedCloud& first_cloud() const { return *first_cloud_; }

  // Queries step by step and writes a line of results for each. Prints notes and warnings about
  // frames as they happen.
  void run(LevelToolQuery& query, std::optional<VirtualCoupling> coupling, Measure measure,
           file::Output& output, std::optional<PoseView>& view);

  // Returns the last pose of the tool. The values from here on need run().
  const Pose& last_pose() const { return last_pose_; }
  const PreparedCloud& last_cloud() const { return feed_->cloud(); }
  // Returns the time of each query, s.
  const std::vector<double>& query_seconds() const { return query_seconds_; }
  // Returns the median time of preparing a frame, s.
  double prepare_seconds() const;
  // Returns the field "replay" of --stats. `deadline` is in seconds.
  nlohmann::json report(double deadline) const;

 private:
  void note_sources() const;
  double start_time() const;
  void find_first_cloud();
  void say(const PreparedChange& change);
  void say_at_end() const;
  std::string frame_name() const;
  // Returns step k, without rendered wrench and energy if there is no coupling.
  CoupledStep ask(std::size_t k, LevelToolQuery& query,
                  std::optional<VirtualCoupling>& coupling) const;

  const Tool& tool_;
  const ReplayArguments& arguments_;
  double rate_;
  Recording recording_;
  SampledPath path_;
  ImportOptions import_;
  Device device_;
  Denoising points_;
  ScheduleOptions schedule_;
  std::unique_ptr<const PreparedCloud> first_cloud_;
  std::unique_ptr<FrameFeed> feed_;
  std::optional<LoopClock> clock_;
  Pose last_pose_;
  std::vector<double> query_seconds_;
  std::size_t said_ = 0, steps_without_frame_ = 0;
  double wall_seconds_ = 0;
};

}  // namespace vpm::tools
