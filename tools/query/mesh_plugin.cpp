// The library that reads and packs meshes for vpm-query, a client of vpm::solid.
#include "tools/common/mesh_plugin.h"

#include <vpm/device.h>
#include <vpm/solid.h>

#include <cstring>
#include <exception>
#include <string>

namespace vpm::tools {
namespace {

void copy(const std::string& text, char (&into)[1024]) {
  std::strncpy(into, text.c_str(), sizeof into - 1);
}

void tell(const SolidMesh& mesh, SayOfMesh say, void* listener) {
  for (const std::string& note : mesh.notes()) say(listener, false, note.c_str());
  for (const std::string& warning : mesh.warnings()) say(listener, true, warning.c_str());
}

void pack_mesh(const char* path, unsigned spheres, const char* output, SayOfMesh say,
               void* listener) {
  const SolidMesh mesh = SolidMesh::read(path);
  tell(mesh, say, listener);
  build_tool(pack(mesh, {.spheres = spheres})).write(output);
}

// Returns true if the job is done, and fills `fault` if it throws.
bool is_done(const auto& job, PackingFault* fault) {
  try {
    job();
    return true;
  } catch (const Error& error) {
    fault->kind = static_cast<int>(error.kind());
    copy(error.problem(), fault->problem);
    copy(error.where(), fault->where);
    copy(error.hint(), fault->hint);
  } catch (const std::exception& error) {
    copy(error.what(), fault->problem);
  }
  return false;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) bool vpm_pack_mesh(const char* mesh,
                                                                     unsigned spheres, int threads,
                                                                     const char* output,
                                                                     SayOfMesh say, void* listener,
                                                                     PackingFault* fault) {
  set_thread_count(threads);
  return is_done([&] { pack_mesh(mesh, spheres, output, say, listener); }, fault);
}

extern "C" __attribute__((visibility("default"))) void vpm_use_threads(int threads) {
  set_thread_count(threads);
}

extern "C" __attribute__((visibility("default"))) bool vpm_read_solid(
    const char* mesh, const SolidOptions* options, bool with_force, SayOfMesh say, void* listener,
    std::optional<SolidBody>* body, PackingFault* fault) {
  return is_done(
      [&] {
        const SolidMesh solid = SolidMesh::read(mesh, *options);
        tell(solid, say, listener);
        body->emplace(solid, with_force);
      },
      fault);
}

extern "C" __attribute__((visibility("default"))) bool vpm_read_robot(
    const char* urdf, const RobotOptions* options, const char* srdf, Robot* robot,
    std::vector<std::array<std::size_t, 2>>* ignored, PackingFault* fault) {
  return is_done(
      [&] {
        *robot = read_robot(urdf, *options);
        *ignored = ignored_pairs(*robot, srdf);
      },
      fault);
}

extern "C" __attribute__((visibility("default"))) bool vpm_prepare_link(
    const Robot* robot, std::size_t link, bool with_force, unsigned spheres, const char* output,
    SayOfMesh say, void* listener, std::optional<SolidBody>* body, PackingFault* fault) {
  return is_done(
      [&] {
        const SolidMesh solid = link_solid(*robot, link);
        // Shapes of one link overlap as a rule, which is no reason for a warning.
        if (robot->links[link].shapes.size() == 1) tell(solid, say, listener);
        body->emplace(solid, with_force);
        if (output != nullptr) build_tool(pack(solid, {.spheres = spheres})).write(output);
      },
      fault);
}

}  // namespace vpm::tools
