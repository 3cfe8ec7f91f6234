#include "tools/query/replay_arguments.h"

#include "tools/common/number_checks.h"

namespace vpm::tools {

void declare(CLI::App& app, ReplayArguments& a) {
  app.add_option("--frames", a.frames,
                 "Instead of --cloud: folder of depth images with their "
                 "times (TUM RGB-D, 7-Scenes), or a list "
                 "of \"time file\" lines; goes with --trajectory");
  app.add_option("--trajectory", a.trajectory,
                 "Path of the tool through the frames, as for --poses");
  app.add_option("--rate", a.rate, "Steps per second along --trajectory (1000)")
      ->check(number_in(1, 1e6));
  app.add_option("--camera-poses", a.camera_poses,
                 "Path of the camera: TUM text or a pose per frame; else NAME.pose.txt beside the "
                 "frames, or groundtruth.txt");
  app.add_option("--frame-rate", a.frame_rate,
                 "Frames per second, where their names have numbers but no times")
      ->check(number_in(1e-3, 1e6))
      ->capture_default_str();
  app.add_option("--frame-latency", a.frame_latency,
                 "Seconds from the time of a frame until a step can see it")
      ->check(number_in(0, 3600))
      ->capture_default_str();
  app.add_flag("--align-starts", a.align_starts,
               "Path and frames begin together, whatever their times say");
  app.add_flag("--repeat-frames", a.repeat_frames,
               "Frames go back and forth as long as the path lasts; otherwise the last one stays");
  app.add_flag("--realtime", a.realtime,
               "Steps wait for the clock; otherwise as fast as it goes, with the same results");
  declare(app, a.import);
}

}  // namespace vpm::tools
