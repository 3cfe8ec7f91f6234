// Makes a scan of the points of PCD and PLY files.
#pragma once

#include <string>

#include "libvpm/import/import_cloud.h"
#include "libvpm/import/point_files.h"

namespace vpm {

// Returns the image of a grid that a pinhole camera sees, and other points with their normals.
// Throws as import_cloud does.
ImportedScan scan_of_points(PointSet points, const std::string& name, const ImportOptions& options);

// Returns the scan of a depth image as its file gives it, seen by this camera.
ImportedScan scan_of_depth(const RawDepth& raw, const Intrinsics& intrinsics, const Pose& to_world,
                           const std::string& name, const DepthReading& reading);

}  // namespace vpm
