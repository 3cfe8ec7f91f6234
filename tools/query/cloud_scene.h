// Scene and poses of the modes that query a cloud.
#pragma once

#include <vpm/scene.h>
#include <vpm/setup_check.h>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libvpm/recording/pose_reader.h"
#include "tools/query/query_report.h"
#include "tools/query/query_setup.h"

namespace vpm::tools {

// Holds a cloud and the name of the file that it was read from.
struct NamedCloud {
  std::string name;
  PointCloud cloud;
};

// Cloud of --cloud, prepared for queries, or the body that several of cameras are together, and the
// solids of --solid.
class CloudScene {
 public:
  // Reads and prepares the clouds, if there are any, and adds them to the view, if there is one.
  // Moves their cameras first, if --register asks for it. Says what the clouds' cameras, and the
  // sizes of clouds and tools, let doubt. Throws Error(refused) for several clouds one of which
  // keeps no camera, and what register_cameras() throws.
  explicit CloudScene(QuerySetup& setup);
  // The same for clouds that were read.
  CloudScene(QuerySetup& setup, std::vector<NamedCloud> clouds);

  const Scene& scene() const { return *scene_; }
  // Returns the number of the cloud's points; 0 without a cloud.
  std::size_t points() const { return scene_->bodies().front().points(); }
  // Returns the time that the preparation took, s.
  double prepare_seconds() const { return prepare_seconds_; }
  // Shows the answer at a pose of the k-th tool to the checks, which are about clouds.
  void see(const Pose& pose, std::size_t k, const Result& result) {
    if (!setup_.solids.empty()) return;
    for (SetupCheck& check : checks_) check.see(pose, result, k);
  }
  // Says what the poses let doubt, where nothing was said of sizes.
  void warn_at_end() const;

 private:
  // Says which camera's pose is probably wrong; else what sizes let doubt.
  void say_at_start(const std::vector<Body>& images, const std::vector<NamedCloud>& clouds);
  // Returns what the checks of all clouds doubt: nothing where one camera shows what another does
  // not.
  Remarks remarks() const;

  const QuerySetup& setup_;
  std::optional<Scene> scene_;
  std::vector<SetupCheck> checks_;  // one for each cloud
  bool has_said_ = false;
  double prepare_seconds_ = 0;
};

// Returns the job of each pose for the first tool, which refers to what was asked.
std::vector<Job> jobs_of(const std::vector<AskedPose>& asked);

// Returns what a plain line of poses asks; empty for others, and unless it has poses of all solids
// or of none.
std::optional<AskedPose> asked_on(const std::string& line, std::size_t solids, PoseParser& parser);

// Pose of --pose, or those of --poses.
class PoseSource {
 public:
  // Parses --pose. Leaves the file of --poses closed until a pose is asked for. The arguments must
  // outlive this.
  explicit PoseSource(const Arguments& arguments);

  // Returns the first pose, which next() returns again. Throws Error(refused) if there is none.
  AskedPose first();
  // Returns the next poses, `most` of them or as many as are left. Throws what PoseReader throws.
  std::vector<AskedPose> next(std::size_t most);
  // Returns the next pose, and those after it in the same list or array, up to one that cannot be
  // read: the next call throws why.
  std::vector<AskedPose> next_together();
  // Return the next lines of poses and take them back, as PoseReader does. There are none any more
  // after some were given back.
  std::optional<PoseLines> next_lines();
  void give_back(std::string_view lines);
  // Passes over poses, whose lines another run wrote. Throws Error(refused) if there are fewer.
  void pass_over(std::size_t poses);
  // Returns the largest deviation of a rotation before it was normalised, also of poses that others
  // read.
  double largest_deviation() const;
  void add_deviation(double deviation) { deviation_ = std::max(deviation_, deviation); }

 private:
  std::optional<AskedPose> next_one();

  const Arguments& arguments_;
  std::optional<AskedPose>
      pending_;  // pose that was parsed or read, and not yet returned by next()
  double deviation_ = 0;
  std::exception_ptr unread_;  // of a pose after those that were returned
  bool has_lines_ = true;      // none was given back
  std::optional<PoseReader> reader_;
};

}  // namespace vpm::tools
