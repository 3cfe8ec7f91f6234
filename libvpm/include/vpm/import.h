// Clouds of the files that sensors and other programs write. Library vpm::solid.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "vpm/camera.h"
#include "vpm/error.h"
#include "vpm/scene.h"

namespace vpm {

struct ImportParameters {
  std::optional<Intrinsics> intrinsics;   // depth images need it; an organised PCD tells its own
  std::optional<double> units_per_metre;  // unset: 1000 for images of integers, 1 otherwise
  std::optional<Pose> to_world;           // unset: VIEWPOINT of a PCD, or the identity
  NormalOptions normals = {};
};

// Returns the cloud of a PNG, OpenEXR, TIFF, PGM, PFM, NPY, PCD or PLY file, told by its content;
// "-" is standard input. Depth images and organised PCD get normals from their depth; other PCD and
// PLY must have normals that point into free space. Throws Error(refused) naming the file and the
// defect for what is damaged, unknown, without normals or without any point;
// Error(invalid_argument) for a depth image without intrinsics; Error(unavailable) for OpenEXR and
// TIFF in builds without them. Thread-safe.
VPM_API PointCloud import_cloud(const std::string& path, const ImportParameters& parameters = {});

}  // namespace vpm
