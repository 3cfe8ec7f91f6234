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
#include "libvpm/scene/any_body.h"
#include "libvpm/scene/depth_frames.h"

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

// Prepared result of all frames that come at one step: the newest usable one. Of several cameras
// each keeps its last one until it has another.
struct PreparedChange {
  FrameChange change;
  std::optional<AnyBody> body;        // empty if no frame is usable: the loop keeps the last one
  std::vector<std::size_t> frames{};  // of the body: indices in the recording, by their sources
  std::size_t used = 0;               // frames of the change that the body has
  std::size_t frame = 0;              // index of the newest of them, if there is one
  std::optional<Camera> camera;       // camera of that, if it is an image
  std::vector<UnusableFrame> unusable;
  double seconds = 0;  // time from the file to the prepared frame
  Remarks remarks;     // remarks of the reader about the frame
};

// Reads a frame's file: images and points of others as `options` say, .vpmc files as they are. The
// camera's pose comes from the recording where it has one. Throws as import_scan and parse_cloud.
ImportedScan read_frame(const RecordedFrame& frame, const ImportOptions& options);

// Reads and prepares frames on the calling thread. Keeps a reference to the recording. Depth images
// of several sources become one body (scene/rig); throws Error(invalid_argument) if one keeps no
// camera.
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
        sources_(recording.sources) {}

  PreparedChange prepare(FrameChange change);

 private:
  // Holds what a source shows now, and the memory of its images.
  struct Source {
    std::optional<DepthFrames> images;
    Camera camera;  // of these
    std::optional<AnyBody> body;
    std::size_t frame = 0;
  };

  AnyBody read(const RecordedFrame& frame, PreparedChange& result);
  AnyBody body_of(const ImportedScan& scan, const std::string& name, Source& source);
  void take_bodies(PreparedChange& result) const;

  const Recording& recording_;
  ImportOptions options_;
  Device device_;
  Denoising points_;
  std::vector<Source> sources_;
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
  // into the feed, where body() returns it until the next change.
  const PreparedChange* advance_to(std::size_t step);

  // Returns the body of the current frames, one for each source that had any; one of points before
  // the first usable frame.
  const AnyBody& body() const { return body_; }
  const std::vector<std::size_t>& frames() const { return frames_; }
  // Returns the newest of them.
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
  AnyBody body_{Cloud{}};
  std::vector<std::size_t> frames_;
  std::optional<std::size_t> frame_;
  PreparedChange taken_;
  FrameCounts counts_;

  std::mutex mutex_;
  std::condition_variable moved_;
  std::deque<PreparedChange> ready_;
  std::exception_ptr failure_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace vpm
