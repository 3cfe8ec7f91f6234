// mesh-to-answer MESH DEPTH.png FX,FY,CX,CY POSE [SCALE]: from a mesh and a depth image to the
// volume of the tool inside the scene, in one program. SCALE is the mesh's unit in metres: 0.001
// for millimetres. Whatever the library doubts about them is printed with its cure.
#include <vpm/error.h>
#include <vpm/import.h>
#include <vpm/query.h>
#include <vpm/setup_check.h>
#include <vpm/solid.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

void print(const std::string& about, const vpm::Remarks& remarks) {
  for (const vpm::Remark& remark : remarks)
    std::fprintf(stderr, "%s: %s%s\n", remark.is_warning ? "warning" : "note", about.c_str(),
                 remark.text.c_str());
}

vpm::Tool tool_of(const std::string& mesh, double scale) {
  const vpm::SolidMesh solid = vpm::SolidMesh::read(mesh, {.scale = scale});
  for (const std::string& warning : solid.warnings()) print(mesh + ": ", {{true, warning}});
  const vpm::SpherePacking packing = vpm::pack(solid, {.spheres = 200});
  return vpm::build_tool(packing, {.levels = {50}});
}

vpm::PointCloud cloud_of(const std::string& image, const std::string& intrinsics) {
  vpm::Intrinsics k;
  if (std::sscanf(intrinsics.c_str(), "%lf,%lf,%lf,%lf", &k.fx, &k.fy, &k.cx, &k.cy) != 4)
    throw vpm::Error(vpm::ErrorKind::invalid_argument, "needed are fx,fy,cx,cy", intrinsics);
  vpm::Remarks remarks;
  vpm::PointCloud cloud = vpm::import_cloud(image, {.intrinsics = k}, &remarks);
  print(image + ": ", remarks);
  return cloud;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5 && argc != 6) {
    std::fputs("usage: mesh-to-answer MESH DEPTH.png FX,FY,CX,CY TX,TY,TZ,QX,QY,QZ,QW [SCALE]\n",
               stderr);
    return 2;
  }
  try {
    const vpm::PointCloud cloud = cloud_of(argv[2], argv[3]);
    const vpm::Tool tool = tool_of(argv[1], argc == 6 ? std::atof(argv[5]) : 1);
    const vpm::Pose pose = vpm::pose_from_text(argv[4]);
    const vpm::Scene scene(cloud);
    vpm::Query query(tool);
    const vpm::Result r = query.run(scene, pose);
    std::printf("volume %.6g m^3 (%.3g %% of the tool), force %.6g %.6g %.6g m^3\n", r.volume,
                100 * r.volume_fraction, r.wrench.force.x, r.wrench.force.y, r.wrench.force.z);
    const auto states = query.states();
    std::printf("%td of %zu spheres are behind the surface\n",
                std::count(states.begin(), states.end(), vpm::SphereState::inside), states.size());
    vpm::SetupCheck check(tool, cloud);
    check.see(pose, r);
    print("", check.remarks());
    return 0;
  } catch (const vpm::Error& error) {
    std::fprintf(stderr, "mesh-to-answer: %s\n", error.what());
    if (!error.hint().empty()) std::fprintf(stderr, "To mend it: %s\n", error.hint().c_str());
    return 1;
  }
}
