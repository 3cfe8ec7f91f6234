// mesh-to-answer MESH DEPTH.png FX,FY,CX,CY POSE: from a mesh and a depth image to the volume of
// the tool inside the scene, in one program. The mesh is in metres.
#include <vpm/error.h>
#include <vpm/import.h>
#include <vpm/query.h>
#include <vpm/solid.h>

#include <algorithm>
#include <cstdio>
#include <string>

namespace {

vpm::Tool tool_of(const std::string& mesh) {
  const vpm::SolidMesh solid = vpm::SolidMesh::read(mesh);
  const vpm::SpherePacking packing = vpm::pack(solid, {.spheres = 200});
  return vpm::build_tool(packing, {.levels = {50}});
}

vpm::Scene scene_of(const std::string& image, const std::string& intrinsics) {
  vpm::Intrinsics k;
  if (std::sscanf(intrinsics.c_str(), "%lf,%lf,%lf,%lf", &k.fx, &k.fy, &k.cx, &k.cy) != 4)
    throw vpm::Error(vpm::ErrorKind::invalid_argument, "needed are fx,fy,cx,cy", intrinsics);
  return vpm::Scene(vpm::import_cloud(image, {.intrinsics = k}));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fputs("usage: mesh-to-answer MESH DEPTH.png FX,FY,CX,CY TX,TY,TZ,QX,QY,QZ,QW\n", stderr);
    return 2;
  }
  try {
    const vpm::Scene scene = scene_of(argv[2], argv[3]);
    vpm::Query query(tool_of(argv[1]));  // keeps the tool
    const vpm::Result r = query.run(scene, vpm::pose_from_text(argv[4]));
    std::printf("volume %.6g m^3 (%.3g %% of the tool), force %.6g %.6g %.6g m^3\n", r.volume,
                100 * r.volume_fraction, r.wrench.force.x, r.wrench.force.y, r.wrench.force.z);
    const auto states = query.states();
    std::printf("%td of %zu spheres are behind the surface\n",
                std::count(states.begin(), states.end(), vpm::SphereState::inside), states.size());
    return 0;
  } catch (const vpm::Error& error) {
    std::fprintf(stderr, "mesh-to-answer: %s\n", error.what());
    if (!error.hint().empty()) std::fprintf(stderr, "To mend it: %s\n", error.hint().c_str());
    return 1;
  }
}
