#include "libvpm/mesh/voxel_library.h"

#include <dlfcn.h>

#include <string>

#include "libvpm/core/error.h"

namespace vpm {
namespace {

const VoxelLibrary* load() {
  // Looked for where the program or library that holds this code looks for libraries.
  void* const library = ::dlopen(kVoxelLibrary, RTLD_NOW | RTLD_LOCAL);
  void* const function = library == nullptr ? nullptr : ::dlsym(library, kVoxelFunctions);
  if (function == nullptr) {
    const char* const why = ::dlerror();
    throw Error(
        ErrorKind::unavailable,
        std::string("voxels need ") + kVoxelLibrary +
            ", which cannot be loaded: " + (why == nullptr ? "" : why),
        {}, "install it beside the other libraries of vpm, or build it where OpenVDB is installed");
  }
  return reinterpret_cast<const VoxelLibrary* (*)()>(function)();
}

}  // namespace

const VoxelLibrary& voxel_library() {
  static const VoxelLibrary* const library = load();
  return *library;
}

}  // namespace vpm
