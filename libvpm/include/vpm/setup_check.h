// Finds setups that are probably wrong: units, frames of poses and cameras, unseen places.
//
//   vpm::SetupCheck check(vpm::Tool::read("tool.vpmg"), vpm::PointCloud::read("scene.vpmc"));
//   check.see(pose, query.run(scene, pose));               // for each pose, by <vpm/query.h>
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
#include <vector>

namespace vpm {

// Compares sizes, and some hundred of the poses that were asked, evenly chosen, with what a cloud
// shows. Shares tools and cloud. Belongs to one thread at a time.
class VPM_API SetupCheck {
 public:
  // Takes milliseconds. `measure` is the one that is asked: what a camera has not seen is told for
  // the refined one. Throws Error(invalid_argument) without a tool; otherwise as Body.
  SetupCheck(const Tool& tool, const PointCloud& cloud, Measure measure = Measure::refined);
  SetupCheck(std::span<const Tool> tools, const PointCloud& cloud,
             Measure measure = Measure::refined);
  ~SetupCheck();
  SetupCheck(SetupCheck&&) noexcept;
  SetupCheck& operator=(SetupCheck&&) noexcept;

  // Notes an answer at a pose of the tool of this index. Throws Error(invalid_argument) beyond all.
  void see(const Pose& pose, const Result& result, std::size_t tool = 0);

  // Returns a warning with its cure if something is probably wrong, otherwise nothing, in some
  // milliseconds. It is the first that holds of:
  // - a tool is much larger than all that the scene shows, or smaller than its points can show,
  //   which mistakes of units cause; known before the first pose;
  // - a tool is behind points without a camera that show one side of what is there only, so that
  //   nobody knows whether it is inside, and hardly anything of it counted;
  // - a quarter or more of what a tool has behind the surface lies where the camera measured
  //   nothing, at half of the poses or more;
  // - no pose brought a tool into the camera's view, or near the surface: the remark names what
  //   would (poses in metres, inverse poses, other axes);
  // - what a tool has behind the surface lies unmeasured, as above, at fewer poses than that.
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

// Compares depth images of several cameras, which Body::of_cameras() is to take. Returns the one
// that contradicts others most, if a quarter or more of what it and another know is a surface to
// one, and free to the other by more than 3 % of the depth: its pose is missing, inverse or in
// millimetres, its depths are in another unit, or a thing moved. Otherwise returns one more than 30
// times as far from all others as they see; else one that shows no surface which another shows too:
// with a warning if its pose is the identity and it hides nothing that others show; else with a
// note, or nothing where no two share a surface and one hides what another shows, as from opposite
// sides of a thing. Returns nothing if none is doubted. Takes a core 20 ms for four. Thread-safe.
// Throws Error(invalid_argument) for a body that is no depth image.
VPM_API std::optional<DoubtedCamera> doubted_camera(std::span<const Body> images);

// Returns a warning if some images show both sides of a thing that is thinner than twice the robust
// deviation of their cameras where these see one surface: its volume is then uncertain by half or
// more. Otherwise returns nothing. Cost, threads and errors are as for doubted_camera().
VPM_API std::optional<Remark> uncertain_thickness(std::span<const Body> images);

// Where several cameras are by what their images show.
struct Registration {
  std::vector<Pose> to_world;    // of each image's camera; PointCloud::seen_from() takes it
  double before = 0, after = 0;  // m, robust deviation of readings of one surface, then and now
  std::size_t motions = 0;       // of cameras against each other: 6 for each but one
  std::size_t observable = 0;    // of these, how many the images determine
};

// Corrects poses that are wrong by millimetres and tenths of a degree: moves cameras, in the mean
// not at all, until surfaces that two of them show agree (point to plane, Tukey's weights), by no
// more than the images tell beside the error that is expected of each. What they do not tell, as
// three of six motions along a plane, stays, and so does an error of all. The order of images
// changes no bit. Takes a core .2 s for four. Thread-safe. Throws Error(refused) for one camera
// alone, and if one shows fewer than 60 of 6000 places that others show; or as doubted_camera().
VPM_API Registration register_cameras(std::span<const Body> images);

}  // namespace vpm
