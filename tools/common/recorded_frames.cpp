#include "tools/common/recorded_frames.h"

#include <cstdio>

#include "libvpm/core/error.h"
#include "libvpm/recording/frame_schedule.h"
#include "tools/common/error_text.h"
#include "tools/common/remarks.h"

namespace vpm::tools {
namespace {

void take_intrinsics(const Program& program, const std::string& path, const Recording& recording,
                     ImportOptions& import) {
  if (import.intrinsics) return;
  if (!recording.no_intrinsics.empty())
    refuse(recording.no_intrinsics, path, "give `intrinsics` fx,fy,cx,cy of its camera");
  if (!recording.intrinsics) return;
  const IntrinsicsFile& file = *recording.intrinsics;
  const std::string& source = recording.intrinsics_source;
  const std::string name = path + (source.starts_with('/') ? ":" : "/") + source;
  import.intrinsics = file.intrinsics;
  import.calibrated_width = file.width;
  import.calibrated_height = file.height;
  say(program, name, file.remarks);
  say(program, name, unused_factor(file.factor, import.depth.units_per_metre));
  check_intrinsics(*import.intrinsics);
  program.note("intrinsics " + intrinsics_text(*import.intrinsics) + " are read from " + source +
               " in " + path);
}

void warn_of_improbable_times(const Program& program, const Recording& recording) {
  constexpr double kShortest = 0.0015, kLongest = 5;  // s
  if (recording.frames.size() < 3) return;
  const double interval = median_interval(recording.frames);
  if (interval >= kShortest && interval <= kLongest) return;
  char apart[32];
  std::snprintf(apart, sizeof apart, "%.2g", interval);
  program.warn("the frames are " + std::string(apart) + " s apart, as their names or their list " +
               (recording.has_clock ? "tell their times" : "number them") +
               ", which is unusual; if that is wrong, give a list of \"seconds file\" "
               "lines");
}

}  // namespace

Recording open_recording(const Program& program, const std::string& path,
                         const RecordingOptions& options, ImportOptions& import) {
  Recording recording = read_recording(path, options);
  const bool has_option = import.intrinsics || options.camera || !options.camera_poses.empty();
  if (is_ready_cloud(recording.frames.front()) && has_option)
    refuse_usage("the frames of " + path +
                 " are clouds, which hold their camera and its pose: give --intrinsics, "
                 "--camera-pose and --camera-poses to vpm-normals, which makes them");
  take_intrinsics(program, path, recording, import);
  return recording;
}

void note_recording(const Program& program, const std::string& path, const Recording& recording,
                    const ImportOptions& import) {
  say(program, path, recording.remarks);
  if (!recording.camera_source.empty()) {
    program.detail("poses of the camera: " + recording.camera_source);
  } else if (!is_ready_cloud(recording.frames.front())) {
    program.note("the camera does not move: " + path +
                 (import.to_world ? " is seen from --camera-pose"
                                  : " has no poses of it, and no --camera-poses are given"));
  }
  note_deviation(program, recording.camera_source, recording.largest_deviation);
  note_lines(program, recording.camera_source, recording.camera_undefined,
             recording.camera_doubled);
  warn_of_gap(program, recording.camera_source, recording.camera_gap);
  warn_of_improbable_times(program, recording);
}

void note_deviation(const Program& program, const std::string& what, double deviation) {
  if (!(deviation > kRotationRounding)) return;
  char text[96];
  std::snprintf(text, sizeof text,
                "rotations were up to %.2g away from orthonormal and have been normalised",
                deviation);
  program.note((what.empty() ? "" : what + ": ") + text);
}

void note_lines(const Program& program, const std::string& name, std::size_t undefined,
                std::size_t doubled) {
  const std::string where = name == "-" ? "standard input" : name;
  if (undefined > 0)
    program.note(where + ": poses passed over, since their numbers are not finite or all zero: " +
                 std::to_string(undefined));
  if (doubled > 0)
    program.note(where + ": lines passed over, since they give the line before again: " +
                 std::to_string(doubled));
}

void warn_of_gap(const Program& program, const std::string& name,
                 const std::optional<PoseGap>& gap) {
  if (!gap) return;
  char text[200];
  std::snprintf(text, sizeof text,
                ": no pose from %.3f to %.3f s, more than ten times as long as from one pose to "
                "the next elsewhere; poses in between are interpolated",
                gap->start, gap->end);
  program.warn(name + text);
}

}  // namespace vpm::tools
