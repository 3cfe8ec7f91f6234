#include "libvpm/recording/frame_feed.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"

namespace vpm {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

bool same_image_size_and_rays(const Camera& a, const Camera& b) {
  const Intrinsics &k = a.intrinsics, &l = b.intrinsics;
  return a.width == b.width && a.height == b.height && k.fx == l.fx && k.fy == l.fy &&
         k.cx == l.cx && k.cy == l.cy;
}

}  // namespace

ImportedScan read_frame(const RecordedFrame& frame, const ImportOptions& options) {
  if (is_ready_cloud(frame)) {
    ImportedScan scan;
    scan.points = read_cloud(frame.path);
    if (options.remove) {
      if (!scan.points.sensor)
        refuse("points without a camera: `remove` takes pixels out of depth images", frame.path,
               "make clouds of the depth images");
      scan.removed = options.remove(*scan.points.sensor, frame.time);
      scan.points = without_removed(std::move(scan.points));
    }
    scan.image = scan.points.sensor;
    return scan;
  }
  ImportOptions of_frame = options;
  if (frame.camera) of_frame.to_world = frame.camera;
  if (frame.intrinsics) of_frame.intrinsics = frame.intrinsics;
  of_frame.time = frame.time;
  return import_scan(bytes_of(frame), frame.path, of_frame);
}

AnyBody FrameReader::read(const RecordedFrame& frame, PreparedChange& result) {
  const ImportedScan scan = read_frame(frame, options_);
  if (!scan.image && recording_.sources > 1)
    throw Error(ErrorKind::invalid_argument,
                "several recordings are one body by their cameras, but this frame keeps none",
                frame.path, "replay it alone, or make its cloud of the depth image");
  const AnyBody body = is_ready_cloud(frame) ? AnyBody(scan.points, points_)  // with its normals
                                             : body_of(scan, frame.path, sources_[frame.source]);
  result.remarks.insert(result.remarks.end(), scan.remarks.begin(), scan.remarks.end());
  if (scan.image && result.used == 0) result.camera = scan.image->camera;
  return body;
}

AnyBody FrameReader::body_of(const ImportedScan& scan, const std::string& name, Source& source) {
  if (!scan.image) return AnyBody(PointsBody(scan.points, points_));
  const auto& [camera, depth] = *scan.image;
  if (!source.images || !same_image_size_and_rays(camera, source.camera)) {
    source.images.emplace(DepthFrameOptions{camera.intrinsics, camera.width, camera.height,
                                            std::nullopt, options_.normals, device_, points_});
    source.camera = camera;
  }
  std::copy(depth.depth.begin(), depth.depth.end(), source.images->metres().begin());
  const DepthBody body = source.images->prepare(camera.to_world);
  if (body.points() == 0) throw nothing_with_normal(scan, name);
  return body;
}

// Sets what all sources show now.
void FrameReader::take_bodies(PreparedChange& result) const {
  std::vector<DepthBody> images;
  for (const Source& source : sources_) {
    if (!source.body) continue;
    result.frames.push_back(source.frame);
    result.body = source.body;
    if (recording_.sources > 1) images.push_back(*source.body->as<DepthBody>());
  }
  if (images.size() > 1) result.body = body_of_cameras(std::move(images));
}

PreparedChange FrameReader::prepare(FrameChange change) {
  const auto start = std::chrono::steady_clock::now();
  PreparedChange result;
  std::vector<bool> has_newer(sources_.size());
  for (auto at = change.frames.rbegin(); at != change.frames.rend(); ++at) {
    const RecordedFrame& frame = recording_.frames[*at];
    if (has_newer[frame.source]) continue;
    const auto fails = [&](FrameFault fault, const std::string& message) {
      result.unusable.push_back({*at, fault, message});
    };
    if (frame.is_lost) {
      fails(FrameFault::lost, frame.path + ": no pose of its camera");
      continue;
    }
    try {
      Source& source = sources_[frame.source];
      source.body = read(frame, result);
      source.frame = *at;
      has_newer[frame.source] = true;
      if (result.used++ == 0) result.frame = *at;
    } catch (const NothingMeasured& fault) {
      fails(FrameFault::empty, fault.what());
    } catch (const Error& fault) {
      // Errors other than `refused` concern the call, not this frame.
      if (fault.kind() != ErrorKind::refused) throw;
      fails(FrameFault::broken, fault.what());
    }
  }
  if (result.used > 0) take_bodies(result);
  result.change = std::move(change);
  result.seconds = seconds_since(start);
  return result;
}

FrameFeed::FrameFeed(const Recording& recording, const ScheduleOptions& schedule,
                     const ImportOptions& options, const Device& device, Denoising points)
    : recording_(recording), schedule_(recording, schedule) {
  const FrameSchedule all = schedule_;
  next_ = schedule_.next();
  thread_ = std::thread(
      [this, all, options, device, points] { prepare_all(all, options, device, points); });
}

FrameFeed::~FrameFeed() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  moved_.notify_all();
  thread_.join();
}

void FrameFeed::prepare_all(FrameSchedule schedule, const ImportOptions& options,
                            const Device& device, Denoising points) {
  try {
    ImportOptions quick = options;
    quick.depth.looks_for_mistakes = false;  // the caller may look at one frame
    FrameReader reader(recording_, quick, device, points);
    while (std::optional<FrameChange> change = schedule.next()) {
      PreparedChange result = reader.prepare(std::move(*change));
      std::unique_lock lock(mutex_);
      moved_.wait(lock, [&] { return stop_ || ready_.size() < kAhead; });
      if (stop_) return;
      ready_.push_back(std::move(result));
      lock.unlock();
      moved_.notify_all();
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
    moved_.notify_all();
  }
}

void FrameFeed::wait_for_first() {
  std::unique_lock lock(mutex_);
  if (next_) moved_.wait(lock, [&] { return !ready_.empty() || failure_; });
}

PreparedChange FrameFeed::take() {
  std::unique_lock lock(mutex_);
  if (ready_.empty() && !failure_) {
    const auto start = std::chrono::steady_clock::now();
    moved_.wait(lock, [&] { return !ready_.empty() || failure_; });
    ++counts_.waits;
    counts_.longest_wait = std::max(counts_.longest_wait, seconds_since(start));
  }
  if (ready_.empty()) std::rethrow_exception(failure_);
  PreparedChange change = std::move(ready_.front());
  ready_.pop_front();
  lock.unlock();
  moved_.notify_all();
  return change;
}

void FrameFeed::count(const PreparedChange& taken) {
  counts_.used += taken.used;
  counts_.unseen += taken.change.frames.size() - taken.unusable.size() - taken.used;
  counts_.late += taken.change.is_late;
  for (const UnusableFrame& frame : taken.unusable) {
    counts_.lost += frame.fault == FrameFault::lost;
    counts_.empty += frame.fault == FrameFault::empty;
    counts_.broken += frame.fault == FrameFault::broken;
  }
  counts_.seconds.push_back(taken.seconds);
}

const PreparedChange* FrameFeed::advance_to(std::size_t step) {
  if (!next_ || step < next_->step) return nullptr;
  taken_ = take();
  next_ = schedule_.next();
  count(taken_);
  if (taken_.body) {
    body_ = *std::exchange(taken_.body, std::nullopt);
    frames_ = taken_.frames;
    frame_ = taken_.frame;
  }
  return &taken_;
}

}  // namespace vpm
