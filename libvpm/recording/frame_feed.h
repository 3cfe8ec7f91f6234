// Prepares frames for queries ahead of time on a thread of its own, so that a loop at haptic rate
// does not wait for them. The frame that a step gets depends on the data alone.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>

#include "libvpm/import/import_cloud.h"
#include "libvpm/recording/frame_schedule.h"
#include "libvpm/scene/depth_frames.h"
#include "libvpm/scene/frame_preparation.h"

namespace vpm {

enum class FrameFault {
  lost,    // no camera pose
  empty,   // nothing measured
  broken,  // unreadable
};

struct UnusableFrame {
  std::size_t frame = 0;  // index in the recording
  FrameFault fault = FrameFault::broken;
  std::string message;
};

// Prepared result of all frames that come at one step: the newest usable one.
struct PreparedChange {
  FrameChange change;
  // Frame on the CPU; both this and `depth` are empty if no frame is usable, and the loop keeps the
  // last one.
  std::unique_ptr<PreparedCloud> cloud;
  std::optional<DepthFrame> depth;  // frame on a device
  std::size_t frame = 0;            // index in the recording, if there is a frame
  std::optional<Camera> camera;     // camera of the frame, if it is an image
  std::vector<UnusableFrame> unusable;
  double seconds = 0;  // time from the file to the prepared frame
  Remarks remarks;     // remarks of the reader about the frame

  bool has_frame() const { return cloud != nullptr || depth.has_value(); }
};

// Reads and prepares frames on the calling thread. Keeps a reference to the recording.
class FrameReader {
 public:
  // `options` tell how images become clouds, `device` where they are prepared. Camera poses come
  // from the recording.
  FrameReader(const Recording& recording, const ImportOptions& options, const Device& device = {},
              Denoising points = Denoising::on)
      : recording_(recording),
        options_(options),
        device_(device),
        points_(points),
        preparation_(options.normals, points) {}

  PreparedChange prepare(FrameChange change);
  // Takes back a cloud that is no longer needed, to reuse its memory for the next frame.
  void give_back(std::unique_ptr<PreparedCloud> cloud) { spare_ = std::move(cloud); }

 private:
  void read(const RecordedFrame& frame, PreparedChange& result);
  std::unique_ptr<PreparedCloud> prepared(const ImportedScan& scan, const std::string& name);
  DepthFrame on_device(const ImportedScan& scan, const std::string& name);

  const Recording& recording_;
  ImportOptions options_;
  Device device_;
  Denoising points_;
  FramePreparation preparation_;
  std::unique_ptr<PreparedCloud> spare_;
  std::optional<DepthFrames> frames_;
  Camera camera_;  // camera of frames_
};

// Statistics of the frames of a loop.
struct FrameCounts {
  // Unseen frames were replaced by a newer one before any step saw them.
  std::size_t used = 0, unseen = 0;
  std::size_t late = 0, lost = 0, empty = 0, broken = 0;
  std::size_t waits = 0;    // steps that had to wait for the preparation
  double longest_wait = 0;  // s
  // Time of each preparation.
  std::vector<double> seconds{};
};

class FrameFeed {
 public:
  // Starts preparing, as FrameReader does it. Keeps a reference to the recording.
  FrameFeed(const Recording& recording, const ScheduleOptions& schedule,
            const ImportOptions& options, const Device& device = {},
            Denoising points = Denoising::on);
  ~FrameFeed();
  FrameFeed(const FrameFeed&) = delete;
  FrameFeed& operator=(const FrameFeed&) = delete;

  // Waits until the first change is ready, so that a real-time loop begins with a frame.
  void wait_for_first();

  // Returns what comes with this step, or null; to be called for each step in turn. Moves the frame
  // into the feed, where cloud() or depth_frame() returns it until the next change.
  const PreparedChange* advance_to(std::size_t step);

  // Returns the current cloud; empty before the first usable frame.
  const PreparedCloud& cloud() const { return depth_ ? depth_->cloud() : *cloud_; }
  // Returns the current frame on a device, or null if it is on the CPU.
  const DepthFrame* depth_frame() const { return depth_ ? &*depth_ : nullptr; }
  std::optional<std::size_t> frame() const { return frame_; }
  const FrameCounts& counts() const { return counts_; }

 private:
  // Number of prepared changes that may wait for their step. Each holds some 20 MB.
  static constexpr std::size_t kAhead = 2;

  void prepare_all(FrameSchedule schedule, const ImportOptions& options, const Device& device,
                   Denoising points);
  PreparedChange take();
  void count(const PreparedChange& taken);

  const Recording& recording_;
  FrameSchedule schedule_;  // schedule of the loop; the thread has a copy
  std::optional<FrameChange> next_;
  std::unique_ptr<PreparedCloud> cloud_;
  std::optional<DepthFrame> depth_;
  std::optional<std::size_t> frame_;
  PreparedChange taken_;
  FrameCounts counts_;

  std::mutex mutex_;
  std::condition_variable moved_;
  std::deque<PreparedChange> ready_;
  // Clouds that the loop is done with; the next frames reuse their memory.
  std::vector<std::unique_ptr<PreparedCloud>> done_;
  std::exception_ptr failure_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace vpm
