// What the library that packs meshes for vpm-query does. vpm-query loads it only where a mesh is
// given, since the libraries that it needs take longer to load than a query takes.
#pragma once

namespace vpm::tools {

// Texts of an error as Error has them, cut to what fits; `kind` is that of ErrorKind.
struct PackingFault {
  int kind = 0;
  char problem[1024] = {}, where[1024] = {}, hint[1024] = {};
};

// Takes what is said of the mesh.
using SayOfMesh = void (*)(void* listener, bool is_warning, const char* text);

// Packs the mesh of a file with `spheres` spheres on at most `threads` threads, and writes its tool
// model to the file `output`. Returns false, and fills `fault`, where that fails.
using PackMesh = bool (*)(const char* mesh, unsigned spheres, int threads, const char* output,
                          SayOfMesh say, void* listener, PackingFault* fault);

inline constexpr const char* kMeshPlugin = "libvpm_mesh_plugin.so";
inline constexpr const char* kPackMesh = "vpm_pack_mesh";

}  // namespace vpm::tools
