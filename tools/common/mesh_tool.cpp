#include "tools/common/mesh_tool.h"

#include <dlfcn.h>
#include <sys/mman.h>
#include <unistd.h>
#include <vpm/device.h>
#include <vpm/error.h>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <set>
#include <system_error>
#include <vector>

#include "libvpm/file/overwrite.h"
#include "libvpm/file/sniff.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"
#include "tools/common/mesh_plugin.h"
#include "tools/common/remarks.h"

namespace vpm::tools {
namespace {

namespace fs = std::filesystem;

constexpr unsigned kSpheres = 1000;

// A file in memory, which has a name as long as this lives.
class MemoryFile {
 public:
  MemoryFile() : descriptor_(::memfd_create("tool.vpmg", MFD_CLOEXEC)) {
    if (descriptor_ < 0) throw Error(ErrorKind::refused, "not enough memory for a tool model");
  }
  ~MemoryFile() { ::close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::string path() const { return "/dev/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

// Loads the plug-in, which lies below the libraries where it is installed, and beside them in a
// build.
void* load_plugin() {
  std::error_code fault;
  const fs::path folder = fs::read_symlink("/proc/self/exe", fault).parent_path();
  void* library = nullptr;
  for (const fs::path& place :
       {folder / ".." / "lib" / "vpm" / kMeshPlugin, folder / ".." / "lib" / kMeshPlugin})
    if (library == nullptr) library = ::dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL);
  return library;
}

// Returns the error that a function of the plug-in met; `place` stands where it names none.
Error error_of(const PackingFault& fault, const std::string& place = {}) {
  return {static_cast<ErrorKind>(fault.kind), fault.problem,
          fault.where[0] == 0 ? place : fault.where, fault.hint};
}

struct Listener {
  const Program& program;
  const std::string& path;
};

void say_of_mesh(void* listener, bool is_warning, const char* text) {
  const auto& [program, path] = *static_cast<const Listener*>(listener);
  is_warning ? program.warn(path + ": " + text) : program.note(path + ": " + text);
}

}  // namespace

void* function_of_meshes(const char* name) {
  static void* const library = load_plugin();
  void* const function = library == nullptr ? nullptr : ::dlsym(library, name);
  if (function == nullptr)
    throw Error(
        ErrorKind::unavailable,
        std::string("a mesh in place of a model needs ") + kMeshPlugin + ", which is not there", {},
        "give the .vpmg that vpm-pack and vpm-graph make of it");
  return function;
}

bool has_mesh_ending(const std::string& path) {
  static const std::set<std::string> kEndings{".stl", ".obj", ".off",  ".ply", ".om",
                                              ".dae", ".glb", ".gltf", ".3mf", ".fbx"};
  return kEndings.contains(file::in_lower_case(fs::path(path).extension().string()));
}

bool is_mesh_file(const std::string& path) {
  std::error_code fault;
  if (!fs::is_regular_file(path, fault) || file::is_container(path)) return false;
  if (has_mesh_ending(path)) return true;
  const auto content = file::sniff(file::read_all(path));
  return content && (content->is_mesh || content->scan == file::ScanFormat::ply);
}

Tool tool_of_mesh(const Program& program, const std::string& path) {
  const auto pack_mesh = reinterpret_cast<PackMesh>(function_of_meshes(kPackMesh));
  const MemoryFile model;
  Listener listener{program, path};
  PackingFault fault;
  if (!pack_mesh(path.c_str(), kSpheres, program.common().threads, model.path().c_str(),
                 say_of_mesh, &listener, &fault))
    throw error_of(fault);
  Tool tool = Tool::read(model.path());
  program.note(path + ": packed with " + std::to_string(tool.spheres().size()) +
               " spheres for this run; vpm-pack and vpm-graph make a .vpmg to keep, of other units "
               "and numbers too");
  return tool;
}

SolidBody solid_of_mesh(const Program& program, const std::string& path, bool with_force) {
  const auto read_solid = reinterpret_cast<ReadSolid>(function_of_meshes(kReadSolid));
  reinterpret_cast<UseThreads>(function_of_meshes(kUseThreads))(program.common().threads);
  const SolidOptions options;
  Listener listener{program, path};
  std::optional<SolidBody> solid;
  PackingFault fault;
  if (!read_solid(path.c_str(), &options, with_force, say_of_mesh, &listener, &solid, &fault))
    throw error_of(fault);
  return *solid;
}

RobotOfFiles read_robot_files(const Program& program, const std::string& urdf,
                              const RobotOptions& options, const std::string& srdf) {
  const auto read = reinterpret_cast<ReadRobot>(function_of_meshes(kReadRobot));
  reinterpret_cast<UseThreads>(function_of_meshes(kUseThreads))(program.common().threads);
  RobotOfFiles files;
  PackingFault fault;
  if (!read(urdf.c_str(), &options, srdf.c_str(), &files.robot, &files.ignored, &fault))
    throw error_of(fault);
  say(program, urdf, files.robot.remarks);
  return files;
}

LinkBodies bodies_of_link(const Program& program, const Robot& robot, std::size_t link,
                          bool with_force, unsigned spheres) {
  const auto prepare = reinterpret_cast<PrepareLink>(function_of_meshes(kPrepareLink));
  const std::string name = "link '" + file::shown(robot.links[link].name) + "'";
  Listener listener{program, name};
  std::optional<MemoryFile> model;
  if (spheres > 0) model.emplace();
  const std::string path = model ? model->path() : "";
  std::optional<SolidBody> solid;
  PackingFault fault;
  if (!prepare(&robot, link, with_force, spheres, model ? path.c_str() : nullptr, say_of_mesh,
               &listener, &solid, &fault))
    throw error_of(fault, name);
  return {*solid, model ? std::optional(Tool::read(path)) : std::nullopt};
}

}  // namespace vpm::tools
