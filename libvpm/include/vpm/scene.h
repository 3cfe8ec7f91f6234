// Declares what a tool is measured against: bodies in one world frame.
#pragma once

#include <vpm/camera.h>
#include <vpm/error.h>
#include <vpm/export.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace vpm {

class AnyBody;        // the library's own
struct Cloud;         // the library's own
class DepthRemover;   // the library's own
struct HandleAccess;  // the library's own
struct PlacedSolid;   // the library's own
class SolidBody;

// Handle of immutable measured points with normals into free space; copies share it. Thread-safe.
// Whatever is asked of a handle that was moved from throws Error(invalid_argument), as of all
// handles of this library.
class VPM_API PointCloud {
 public:
  // Reads a .vpmc file (formats/cloud.md) whole and checks every number in it; "-" is standard
  // input. Throws Error(refused) naming the file and the first defect.
  static PointCloud read(const std::string& path);

  // Makes the cloud of a depth image: `depth` has width * height values in metres along the optical
  // axis, row by row; values that are not finite and positive mean that nothing was measured, and
  // -0 that a known solid was removed (SolidRemover). Throws Error(invalid_argument) for a camera
  // or options out of range, Error(refused) if the image has another size or no pixel has a normal.
  static PointCloud from_depth(std::span<const float> depth, const Camera& camera,
                               const NormalOptions& options = {});

  // Makes the cloud of points that no camera's image holds: positions in the world, m, and as
  // many normals of any length that point into free space. Points that are not finite are left out.
  // Throws Error(invalid_argument) if the numbers differ, Error(refused) if fewer than two places
  // remain.
  static PointCloud from_points(std::span<const Vec3> positions, std::span<const Vec3> normals);

  // Writes a .vpmc file, replacing it in one step; "-" is standard output. Throws
  // Error(cannot_write).
  void write(const std::string& path) const;

  // Returns the number of points that have a normal.
  std::size_t size() const;
  // Returns the camera, if the cloud keeps its depth image.
  std::optional<Camera> camera() const;
  // Returns it as if its camera, which it must keep, had been at this pose: its points move along.
  PointCloud seen_from(const Pose& camera_to_world) const;

 private:
  friend HandleAccess;
  explicit PointCloud(std::shared_ptr<const Cloud> cloud) : cloud_(std::move(cloud)) {}

  std::shared_ptr<const Cloud> cloud_;  // null once moved from
};

// Handle of an immutable body made ready for queries; copies share it. Thread-safe.
class VPM_API Body {
 public:
  // Prepares a cloud for queries: a millisecond for a depth image of 300 000 pixels on one core, a
  // second or two for as many points without a camera. Throws Error(refused) for more than 2^24
  // points, or places further than 2^100 m from the origin.
  explicit Body(const PointCloud& cloud, Denoising points = Denoising::on);

  // Makes a body of a solid (vpm/solid.h) at a pose, which maps its mesh to the world. Takes no
  // time, so a solid that moves is made anew, or moved by Job::solids. Throws
  // Error(invalid_argument) for a solid made without what forces need; Error(refused) for a pose
  // that is not finite, not rigid or further than 2^100 m from the origin.
  explicit Body(const SolidBody& solid, const Pose& to_world = {});

  // Makes one body of the depth images of several cameras, which may see the same things: what one
  // camera clearly saw free is free, and readings of one surface are averaged within what the
  // images disagree by, which they tell themselves. Behind what two cameras see from different
  // sides all is inside, however deep. The order of images changes no bit, and one that is given
  // twice counts once; one image alone is itself. As bodies of their own in a scene, what several
  // see would count several times. Takes a core 30 ms for four images of 300 000 pixels, most of it
  // once for each image; those of a DepthStream on a device are prepared on the CPU again. Throws
  // Error(invalid_argument) for none, more than 16, or one that is no depth image; else as above.
  static Body of_cameras(std::span<const Body> images);

  // Returns the number of points with a normal; waits for a depth image that is being prepared. A
  // solid has none.
  std::size_t points() const;
  bool is_solid() const;

 private:
  friend HandleAccess;
  explicit Body(std::shared_ptr<const AnyBody> body) : body_(std::move(body)) {}

  // One of them; both are null once moved from.
  std::shared_ptr<const AnyBody> body_;
  std::shared_ptr<const PlacedSolid> solid_;
};

// List of bodies in one world frame; copies share the bodies. Thread-safe.
class VPM_API Scene {
 public:
  // Makes a scene of one body.
  Scene(const Body& body);
  // Prepares a cloud, as Body does, and makes a scene of it: to be done once, not for each pose.
  explicit Scene(const PointCloud& cloud) : Scene(Body(cloud)) {}

  // Makes a scene of several bodies: volume, force, torque and counts of spheres are the sums over
  // them, so that a place in two bodies counts for both; a sphere's state is boundary if any body
  // cuts it, else inside if it is inside of any. The order of bodies changes no bit of the sums.
  // Throws Error(invalid_argument) for none.
  explicit Scene(std::vector<Body> bodies);

  const std::vector<Body>& bodies() const;

 private:
  friend HandleAccess;

  std::shared_ptr<const std::vector<Body>> bodies_;  // never empty; null once moved from
  // The same bodies, side by side: those of points, and the solids.
  std::shared_ptr<const std::vector<AnyBody>> list_;
  std::shared_ptr<const std::vector<PlacedSolid>> solids_;
};

// Where a known solid was when a depth image was taken.
struct SolidPlace {
  Pose to_world;      // maps the solid's mesh to the world
  double margin = 0;  // m; no point of the solid was further from where the pose puts it
};

// What a depth image told of a solid that was removed from it, in pixels.
struct RemovedSolid {
  std::size_t in_view = 0;  // that show the solid, if nothing is before it
  // Those of them that were measured before it, and those that were measured where it is. If many
  // are neither, the pose is probably another.
  std::size_t hidden = 0, explained = 0;
  bool holds_camera = false;  // the camera is inside of the solid, which hides all then
};

// Takes known solids at known poses, such as a robot's links and what its hand holds, out of depth
// images before they are bodies:
//
//   vpm::SolidRemover robot(links);                // a SolidBody each, made without forces
//   robot.remove(places, camera, depth);           // a SolidPlace each, at the time of the image
//   const vpm::Scene scene(vpm::PointCloud::from_depth(depth, camera));
//
// What the solid explains, and the pixels beside it, become -0: not measured, and unlike other
// holes never closed, so what is there or behind is `unseen` (vpm/query_types.h), not free and no
// contact. What was measured before the solid by more than the margin stays. A margin is what
// timing and calibration leave: seconds that the image may be late times the speed of the solid's
// fastest point, and the error of the camera's pose there; the camera's noise (kEdgeGate) comes on
// top. A camera inside of a solid sees nothing else: leave such a solid out. Shares the solids.
// Belongs to one thread at a time.
class VPM_API SolidRemover {
 public:
  // Throws Error(invalid_argument) if a solid was moved from.
  explicit SolidRemover(std::span<const SolidBody> solids);
  ~SolidRemover();
  SolidRemover(SolidRemover&&) noexcept;
  SolidRemover& operator=(SolidRemover&&) noexcept;

  // Marks the pixels of a depth image (m, row by row, as PointCloud::from_depth() takes it) and
  // returns the number of those that had been measured. The order of solids changes no bit. Takes a
  // millisecond or so for seven solids of 10 000 triangles and 640 x 480 pixels. Throws
  // Error(invalid_argument) if there are not as many places as solids, or a margin is negative or
  // not finite; Error(refused) for a pose or camera that is none, or an image of another size.
  std::size_t remove(std::span<const SolidPlace> places, const Camera& camera,
                     std::span<float> depth);
  // Returns a cloud without the points at these pixels. Throws the same, and Error(refused) for a
  // cloud that keeps no camera.
  PointCloud remove(std::span<const SolidPlace> places, const PointCloud& cloud);

  // Returns what the last image told of each solid.
  const std::vector<RemovedSolid>& found() const;

 private:
  DepthRemover& impl() const;

  std::unique_ptr<DepthRemover> impl_;  // null once moved from
};

}  // namespace vpm
