// The file of --remove: solids that move, and are taken out of recorded frames
// (formats/removed-solids.md).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/cloud/cloud.h"
#include "libvpm/recording/recording.h"
#include "libvpm/recording/timed_path.h"
#include "tools/common/program.h"
#include "tools/common/removal.h"

namespace vpm::tools {

class FrameRemoval {
 public:
  // Reads the file and its solids. Throws Error(refused), naming the line, for what is not of the
  // format; Error(invalid_argument) for a margin that is none.
  FrameRemoval(const Program& program, const std::string& file, const std::string& margin);

  // Gives lines without times those of the frames. Throws Error(refused) if there are not as many.
  void take_times(const Recording& recording);
  // Throws Error(refused) if the poses begin after a frame or end before it.
  void check(const RecordedFrame& frame) const;

  // Marks the pixels of an image that was taken at `time`, s. Thread-safe.
  std::size_t remove(CloudSensor& image, double time);
  // Forgets the images so far.
  void begin_counting() { removal_->begin_counting(); }
  void say(const Program& program) const;

 private:
  void add_line(const std::string& line, const std::string& place);
  std::vector<SolidPlace> places_at(double time) const;

  std::string file_;
  std::optional<Removal> removal_;
  RemovalMargin margin_;
  std::vector<double> times_;             // of the lines; empty if they have none
  std::vector<std::vector<Pose>> poses_;  // of the lines
  std::optional<TimedPath> path_;         // unset if the solids stay
};

}  // namespace vpm::tools
