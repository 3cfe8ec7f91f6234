#include "libvpm/core/error.h"
#include "libvpm/mesh/mesh_parsers.h"

namespace vpm {

RawMesh parse_scene(std::string_view, const std::string& name, MeshFormat format,
                    const std::string&) {
  throw Error(ErrorKind::unavailable,
              std::string(name_of(format)) +
                  " is not read by this build, for want of assimp (Debian: libassimp-dev)",
              name, "save it as OBJ, OFF, PLY or STL");
}

}  // namespace vpm
