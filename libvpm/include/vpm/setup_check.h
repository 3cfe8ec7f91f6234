// Finds setups that are probably wrong: units, frames of poses and cameras, unseen places.
//
//   const vpm::PointCloud cloud = vpm::PointCloud::read("scene.vpmc");
//   const vpm::Tool tool = vpm::Tool::read("tool.vpmg");
//   const vpm::Scene scene(cloud);
//   vpm::Query query(tool);                                // <vpm/query.h>
//   vpm::SetupCheck check(tool, cloud);
//   check.see(pose, query.run(scene, pose));               // for each pose
//   const vpm::Remarks remarks = check.remarks();          // to be shown, if there are any
#pragma once

#include <vpm/error.h>
#include <vpm/query_types.h>
#include <vpm/remark.h>
#include <vpm/scene.h>
#include <vpm/tool.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

namespace vpm {

// Compares sizes, and the poses that were asked, with what a cloud shows. Shares tools and cloud.
// Belongs to one thread at a time. Keeps at most some hundred poses, evenly chosen.
class VPM_API SetupCheck {
 public:
  // Takes a millisecond or a few. `measure` is the one that is asked: what a camera has not seen is
  // told for the refined one. Throws Error(invalid_argument) without a tool; otherwise as Body for
  // a depth image that no query could use.
  SetupCheck(const Tool& tool, const PointCloud& cloud, Measure measure = Measure::refined);
  SetupCheck(std::span<const Tool> tools, const PointCloud& cloud,
             Measure measure = Measure::refined);
  ~SetupCheck();
  SetupCheck(SetupCheck&&) noexcept;
  SetupCheck& operator=(SetupCheck&&) noexcept;

  // Notes the answer that a query of this cloud gave at a pose of a tool, which is named by its
  // place. Throws Error(invalid_argument) if there is no such tool.
  void see(const Pose& pose, const Result& result, std::size_t tool = 0);

  // Returns a warning with its cure if something is probably wrong, otherwise nothing. It is the
  // first that holds of:
  // - a tool is much larger than all that the scene shows, or smaller than its points can show,
  //   which mistakes of units cause; known before the first pose;
  // - a tool is behind points without a camera that show one side of what is there only, so that
  //   nobody knows whether it is inside, and hardly anything of it counted;
  // - a quarter or more of what a tool has behind the surface lies where the camera measured
  //   nothing, at half of the poses or more;
  // - no pose brought a tool into the camera's view, or near the surface. The remark names what
  //   would: poses in metres, inverse poses, other axes;
  // - the third, at fewer poses.
  // Takes some milliseconds.
  Remarks remarks() const;

 private:
  struct Impl;
  Impl& impl() const;

  std::unique_ptr<Impl> impl_;  // null once moved from
};

// Names a camera that is probably not where its pose tells, by its place in a list, and says why.
struct DoubtedCamera {
  std::size_t camera = 0;
  Remark remark;
};

// Compares depth images of several cameras, which Body::of_cameras() is to take. Returns, of those
// that contradict others, the one that does so most: a quarter or more of what two both know is a
// surface to one, and free to the other by more than 3 % of the depth. A pose that is missing,
// inverse or in millimetres and depths in another unit cause that; so may a thing that moved.
// Otherwise returns a camera that is more than 30 times as far from each other one as they see;
// else one that shows no surface which another shows too: with a warning if its pose is the
// identity, as one that was left out, and it hides nothing that others show; else with a note, or
// nothing where no two cameras share a surface and one hides what another shows, as from opposite
// sides of a thing. Returns nothing where there is none. Takes a core 20 ms for four images.
// Thread-safe. Throws Error(invalid_argument) for a body that is no depth image.
VPM_API std::optional<DoubtedCamera> doubted_camera(std::span<const Body> images);

}  // namespace vpm
