// What the library that packs meshes for vpm-query does. vpm-query loads it only where a mesh is
// given, since the libraries that it needs take longer to load than a query takes.
#pragma once

#include <vpm/robot.h>
#include <vpm/solid.h>

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

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

// Reads the mesh of a file and sets `body` to its solid, prepared for forces if `with_force`, too.
// Thread-safe. Returns false, and fills `fault`, where that fails.
using ReadSolid = bool (*)(const char* mesh, const SolidOptions* options, bool with_force,
                           SayOfMesh say, void* listener, std::optional<SolidBody>* body,
                           PackingFault* fault);

// Reads a robot and the pairs of its links that `srdf` ignores (vpm/robot.h). Returns false, and
// fills `fault`, where that fails.
using ReadRobot = bool (*)(const char* urdf, const RobotOptions* options, const char* srdf,
                           Robot* robot, std::vector<std::array<std::size_t, 2>>* ignored,
                           PackingFault* fault);

// Sets `body` to the solid of a link, prepared for forces if `with_force`, too, and writes its tool
// model, packed with `spheres` spheres, to the file `output` if that is not null. Thread-safe.
// Returns false, and fills `fault`, where that fails.
using PrepareLink = bool (*)(const Robot* robot, std::size_t link, bool with_force,
                             unsigned spheres, const char* output, SayOfMesh say, void* listener,
                             std::optional<SolidBody>* body, PackingFault* fault);

// Caps the threads of the plug-in, to be called once, before it works.
using UseThreads = void (*)(int threads);

inline constexpr const char* kMeshPlugin = "libvpm_mesh_plugin.so";
inline constexpr const char* kPackMesh = "vpm_pack_mesh";
inline constexpr const char* kReadSolid = "vpm_read_solid";
inline constexpr const char* kReadRobot = "vpm_read_robot";
inline constexpr const char* kPrepareLink = "vpm_prepare_link";
inline constexpr const char* kUseThreads = "vpm_use_threads";

}  // namespace vpm::tools
