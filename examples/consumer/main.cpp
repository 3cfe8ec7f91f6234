// consumer TOOL.vpmg SCENE.vpmc POSE: one query, as a robot's controller would ask it.
#include <cstdio>

#include "libvpm/cloud/cloud_file.h"
#include "libvpm/core/error.h"
#include "libvpm/model/tool_model_file.h"
#include "libvpm/query/query.h"

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("usage: consumer TOOL.vpmg SCENE.vpmc tx,ty,tz,qx,qy,qz,qw\n", stderr);
    return 2;
  }
  try {
    const vpm::ToolModel tool = vpm::read_tool_model(argv[1]);
    const vpm::PreparedCloud cloud(vpm::read_cloud(argv[2]));  // once per frame
    vpm::Query query(tool, {});
    const vpm::Result r = query.run(cloud, vpm::pose_from_text(argv[3]));  // once per pose
    std::printf("volume %.6g m^3, force %.6g %.6g %.6g m^3\n", r.volume, r.wrench.force.x,
                r.wrench.force.y, r.wrench.force.z);
    return 0;
  } catch (const vpm::Error& fault) {
    std::fprintf(stderr, "consumer: error: %s\n", fault.what());
    return 1;
  }
}
