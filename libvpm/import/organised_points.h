// Finds the pinhole camera of a sensor's grid of points.
#pragma once

#include <optional>
#include <string>

#include "libvpm/import/camera_axes.h"
#include "libvpm/import/pinhole_fit.h"

namespace vpm {

// Holds what a file tells of the frame that its points are in.
struct PointFrame {
  CameraAxes axes = CameraAxes::opencv;  // of the points
  std::optional<Pose> to_world;          // of those axes; translation in the file's unit
};

// Points of a grid in their camera's frame, and the camera.
struct OrganisedView {
  PointSet points;
  PinholeFit fit;
  bool were_in_world = false;  // the file's points were in the world's frame
};

// Returns the points turned to this library's axes.
PointSet in_own_axes(PointSet points, CameraAxes axes);

// Returns the view of the camera with these intrinsics, or else of one that is fitted. Points that
// fit only after `to_world` is undone were in the world's frame. Returns nothing if no camera fits
// points that have normals, since these need none. Throws Error(refused), naming other axes that
// fit or the residual, for other points that fit none.
std::optional<OrganisedView> find_view(const PointSet& points, const PointFrame& frame,
                                       const std::optional<Intrinsics>& intrinsics,
                                       const std::string& name);

}  // namespace vpm
