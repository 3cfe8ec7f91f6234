#include "libvpm/import/organised_points.h"

#include <utility>

#include "libvpm/core/error.h"

namespace vpm {
namespace {

struct AxesName {
  CameraAxes axes;
  const char* name;
  const char* words;
};

constexpr AxesName kAxes[] = {
    {CameraAxes::opencv, "opencv", "x right, y down, z forward"},
    {CameraAxes::opengl, "opengl", "x right, y up, z backward"},
    {CameraAxes::ros, "ros", "x forward, y left, z up"},
};

PointSet moved(PointSet points, const Pose& pose) {
  for (Vec3& p : points.positions) p = pose * p;
  for (Vec3& n : points.normals) n = pose.rotation * n;
  return points;
}

PinholeFit fit(const PointSet& points, const std::optional<Intrinsics>& intrinsics) {
  return intrinsics ? fit_of(points, *intrinsics) : fit_pinhole(points);
}

// Throws if the points fit a camera with other axes than those that are told.
void refuse_other_axes(const PointSet& points, const PointFrame& frame,
                       const std::optional<Intrinsics>& intrinsics, const std::string& name) {
  for (const AxesName& other : kAxes) {
    if (other.axes == frame.axes || !fit(in_own_axes(points, other.axes), intrinsics).fits())
      continue;
    refuse(std::string("its points are those of a camera with ") + other.words, name,
           std::string("give `axes` ") + other.name);
  }
}

[[noreturn]] void refuse_fit(const PinholeFit& failed, const PointSet& points,
                             const PointFrame& frame, bool is_given, const std::string& name) {
  if (is_given)
    refuse("the organised cloud does not fit the intrinsics given: " + words_of(failed, points),
           name, "leave `intrinsics` out to have them recovered");
  refuse("the organised cloud fits no pinhole camera with x right, y down, z forward: " +
             words_of(failed, points),
         name,
         frame.to_world ? "points of a lidar need normals"
                        : "points in the world's frame need their camera's `camera_pose`, and "
                          "those of a lidar normals");
}

}  // namespace

PointSet in_own_axes(PointSet points, CameraAxes axes) {
  if (axes == CameraAxes::opencv) return points;
  return moved(std::move(points), Pose{transpose(to_axes(axes)), {}});
}

std::optional<OrganisedView> find_view(const PointSet& points, const PointFrame& frame,
                                       const std::optional<Intrinsics>& intrinsics,
                                       const std::string& name) {
  OrganisedView view{in_own_axes(points, frame.axes), {}, false};
  view.fit = fit(view.points, intrinsics);
  if (view.fit.fits()) return view;
  if (frame.to_world) {
    OrganisedView back{
        moved(points, inverse(with_own_axes(*frame.to_world, frame.axes))), {}, true};
    back.fit = fit(back.points, intrinsics);
    if (back.fit.fits()) return back;
  }
  refuse_other_axes(points, frame, intrinsics, name);
  if (!points.normals.empty() && !intrinsics) return std::nullopt;
  refuse_fit(view.fit, view.points, frame, intrinsics.has_value(), name);
}

}  // namespace vpm
