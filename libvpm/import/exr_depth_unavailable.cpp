#include "libvpm/core/error.h"
#include "libvpm/import/depth_files.h"

namespace vpm {

RawDepth parse_exr_depth(std::span<const std::byte>, const std::string& name, const std::string&) {
  throw Error(ErrorKind::unavailable, "this build reads no OpenEXR", name,
              "build with VPM_EXR=ON, or convert the image to a 16-bit PNG");
}

}  // namespace vpm
