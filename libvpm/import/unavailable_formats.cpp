// Formats that this build does not read, for want of a library.
#include "libvpm/core/error.h"
#include "libvpm/import/depth_files.h"
#include "libvpm/import/intrinsics_file.h"

namespace vpm {

#ifdef VPM_WITHOUT_EXR
RawDepth parse_exr_depth(std::span<const std::byte>, const std::string& name, const std::string&) {
  throw Error(ErrorKind::unavailable, "this build reads no OpenEXR", name,
              "build with VPM_EXR=ON, or convert the image to a 16-bit PNG");
}
#endif

#ifdef VPM_WITHOUT_TIFF
RawDepth parse_tiff_depth(std::span<const std::byte>, const std::string& name) {
  throw Error(ErrorKind::unavailable, "this build reads no TIFF", name,
              "build it where libtiff is installed, or convert the image to a 16-bit PNG");
}
#endif

#ifdef VPM_WITHOUT_YAML
nlohmann::json parse_yaml(std::string_view, const std::string& name) {
  throw Error(ErrorKind::unavailable, "this build reads no YAML", name,
              "build it where yaml-cpp is installed, or give the numbers");
}
#endif

}  // namespace vpm
