// Tools and scenes that the tests of the checks of a setup use.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "libvpm/cloud/cloud.h"
#include "libvpm/model/tool_model.h"

namespace vpm {

// Returns a cube about `center` of its own coordinates, as far as the checks ask for it: its size
// from corner to corner, pieces of it, and the `scale` that its provenance tells.
ToolModel cube_of(double across, Vec3 center = {}, double scale = 1);

// Returns what a camera of 64 x 48 pixels with this focal length sees of a depth for each pixel, m;
// 0 where it measures nothing.
Cloud seen_by_camera(double focal, const std::function<double(double u, double v)>& depth,
                     const Pose& camera_to_world = {});
// Returns what it sees of a wall that leans away by a tenth.
Cloud wall_at(double depth, double focal = 60, const Pose& camera_to_world = {});

// Returns points without a camera on the surface of a cube about the origin, so far apart, with
// normals outward.
Cloud scanned_cube(double across, double spacing);

// Returns the wall with a provenance as vpm-normals writes it: a `camera_pose`, or axes.
Cloud told(Cloud cloud, const std::string& key, const nlohmann::json& value);

}  // namespace vpm
