// Parts of this build that are missing for want of a library.
#include "libvpm/core/error.h"
#include "libvpm/mesh/mesh_parsers.h"
#include "libvpm/mesh/polygon_cutting.h"

namespace vpm {

#ifdef VPM_WITHOUT_GLU
PolygonCutting cut_polygon(std::span<const Vec2>) {
  return {{}, CuttingFault::unavailable, {}};
}
#endif

#ifdef VPM_WITHOUT_EXPAT
RawMesh parse_threemf(std::string_view, const std::string& name, const std::string&) {
  throw Error(ErrorKind::unavailable,
              "3MF is not read by this build, for want of expat (Debian: libexpat1-dev)", name,
              "save it as OBJ, OFF, PLY or STL");
}
#endif

#ifdef VPM_WITHOUT_ASSIMP
RawMesh parse_scene(std::string_view, const std::string& name, MeshFormat format,
                    const std::string&) {
  throw Error(ErrorKind::unavailable,
              std::string(name_of(format)) +
                  " is not read by this build, for want of assimp and expat (Debian: "
                  "libassimp-dev, libexpat1-dev)",
              name, "save it as OBJ, OFF, PLY or STL");
}
#endif

}  // namespace vpm
