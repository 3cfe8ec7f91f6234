#pragma once

#include <string>

#include "libvpm/cloud/depth_image.h"

namespace vpm::examples {

// Writes a 16-bit grey PNG with `scale` units per metre, 0 where nothing was measured. Throws
// Error(cannot_write), and Error(refused) for a depth that does not fit into 16 bits.
void write_depth_png(const std::string& path, const DepthImage& image, double scale);

}  // namespace vpm::examples
