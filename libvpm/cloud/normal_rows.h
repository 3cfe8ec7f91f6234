// The two estimators, row by row.
#pragma once

#include "libvpm/cloud/normal_window.h"

namespace vpm {

// Normals of the rows [begin, end) into `normals`, which covers the whole image and holds zeros.
void inverse_depth_rows(const PaddedImage& inverse, const Intrinsics& k,
                        const NormalOptions& options, int begin, int end, Vec3f* normals);
void pca_rows(const PaddedImage& depth, const PaddedImage& inverse, const Intrinsics& k,
              const NormalOptions& options, int begin, int end, Vec3f* normals);

}  // namespace vpm
