#include "libvpm/core/error.h"
#include "libvpm/import/depth_files.h"

namespace vpm {

RawDepth parse_tiff_depth(std::span<const std::byte>, const std::string& name) {
  throw Error(ErrorKind::unavailable, "this build reads no TIFF", name,
              "build it where libtiff is installed, or convert the image to a 16-bit PNG");
}

}  // namespace vpm
