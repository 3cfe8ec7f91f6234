// Frames made ready for queries ahead of their time, on a thread of their own, so that a loop at
// haptic rate does not wait for them. What a step gets depends on the data alone.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>

#include "libvpm/import/import_cloud.h"
#include "libvpm/recording/frame_schedule.h"
#include "libvpm/surface/depth_frames.h"
#include "libvpm/surface/frame_preparation.h"

namespace vpm {

enum class FrameFault {
  lost,    // no pose of the camera
  empty,   // nothing measured in it
  broken,  // not to be read
};

struct UnusableFrame {
  std::size_t frame = 0;  // of the recording
  FrameFault fault = FrameFault::broken;
  std::string message;
};

// What the frames that come at one step bring: the newest that can be used.
struct PreparedChange {
  FrameChange change;
  // One of them, or none: the loop goes on with what it has.
  std::unique_ptr<PreparedCloud> cloud;
  std::optional<DepthFrame> depth;  // on a device
  std::size_t frame = 0;            // of the recording; where there is one
  std::vector<UnusableFrame> unusable;
  double seconds = 0;  // from the file to the prepared cloud

  bool has_frame() const { return cloud != nullptr || depth.has_value(); }
};

// Reads and prepares frames, on the calling thread. The recording must outlive it.
class FrameReader {
 public:
  // `options`: how images become clouds, and where: those for a device are prepared there. The
  // cameras' poses are the recording's.
  FrameReader(const Recording& recording, const ImportOptions& options,
              PointReading points = PointReading::settled)
      : recording_(recording),
        options_(options),
        points_(points),
        preparation_(options.normals, points) {}

  PreparedChange prepare(FrameChange change);
  // A cloud that is not needed any more: the next frame takes its memory.
  void give_back(std::unique_ptr<PreparedCloud> cloud) { spare_ = std::move(cloud); }

 private:
  void read(const RecordedFrame& frame, PreparedChange& result);
  std::unique_ptr<PreparedCloud> prepared(const ImportedScan& scan, const std::string& name);
  DepthFrame on_device(const ImportedScan& scan, const std::string& name);

  const Recording& recording_;
  ImportOptions options_;
  PointReading points_;
  FramePreparation preparation_;
  std::unique_ptr<PreparedCloud> spare_;
  std::optional<DepthFrames> frames_;
  Camera camera_;  // of frames_
};

// What the prepared frames of a loop were.
struct FrameCounts {
  std::size_t used = 0, unseen = 0;  // unseen: a newer one came before any step saw them
  std::size_t late = 0, lost = 0, empty = 0, broken = 0;
  std::size_t waits = 0;          // steps that had to wait for the preparation
  double longest_wait = 0;        // s
  std::vector<double> seconds{};  // of each preparation
};

class FrameFeed {
 public:
  // The recording must outlive the feed. Preparation begins at once.
  FrameFeed(const Recording& recording, const ScheduleOptions& schedule,
            const ImportOptions& options, PointReading points = PointReading::settled);
  ~FrameFeed();
  FrameFeed(const FrameFeed&) = delete;
  FrameFeed& operator=(const FrameFeed&) = delete;

  // Waits until the first change is ready, so that a loop by the clock begins with a frame.
  void wait_for_first();

  // To be called for each step in turn. What comes with this step, or null. It has the frame no
  // more: that is cloud() or depth_frame() now, until the next change.
  const PreparedChange* advance_to(std::size_t step);

  // Empty, and frame() nothing, before the first frame that can be used.
  const PreparedCloud& cloud() const { return depth_ ? depth_->cloud() : *cloud_; }
  // Null where the frame is not on a device.
  const DepthFrame* depth_frame() const { return depth_ ? &*depth_ : nullptr; }
  std::optional<std::size_t> frame() const { return frame_; }
  const FrameCounts& counts() const { return counts_; }

 private:
  // Prepared changes that wait for their step. Each holds some 20 MB.
  static constexpr std::size_t kAhead = 2;

  void prepare_all(FrameSchedule schedule, const ImportOptions& options, PointReading points);
  PreparedChange take();
  void count(const PreparedChange& taken);

  const Recording& recording_;
  FrameSchedule schedule_;  // of the loop; the thread has a copy
  std::optional<FrameChange> next_;
  std::unique_ptr<PreparedCloud> cloud_;
  std::optional<DepthFrame> depth_;
  std::optional<std::size_t> frame_;
  PreparedChange taken_;
  FrameCounts counts_;

  std::mutex mutex_;
  std::condition_variable moved_;
  std::deque<PreparedChange> ready_;
  // Clouds that the loop has done with: the next frame takes the memory of one.
  std::vector<std::unique_ptr<PreparedCloud>> done_;
  std::exception_ptr failure_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace vpm
