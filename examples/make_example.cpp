// make-example FOLDER [SCENE]: writes a tool, the image of a scene by a noisy depth camera, a path
// of the tool into the scene, and the true results along it. SCENE is one of
// libvpm/synthetic/scenes.h, by default a bowl.
//   tool.off      a twisted torus of 0.2 m
//   depth.png     640 x 480 pixels, 5000 units per metre, f = 525 px, Kinect noise
//   poses.jsonl   one pose per line: [tx,ty,tz,qx,qy,qz,qw]
//   truth.csv     pose,depth,volume,force_x,force_y,force_z: metres and cubic metres

#include <cstdio>
#include <iostream>

#include "examples/write_png.h"
#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "libvpm/synthetic/render.h"
#include "libvpm/synthetic/scenes.h"
#include "libvpm/synthetic/shapes.h"
#include "libvpm/synthetic/truth.h"

namespace {

using namespace vpm;

constexpr double kUnitsPerMetre = 5000;
constexpr std::uint64_t kNoiseSeed = 1;
constexpr int kPoses = 121;
constexpr double kStart = 0.87, kEnd = 0.97;  // z of the tool's centre; the scene begins near z = 1

void make_example(const std::string& folder, const std::string& name) {
  const synthetic::Scene scene = synthetic::make_scene(name);
  const synthetic::TrueSolid tool(synthetic::make_twisted_torus(0.07, 0.045, 3, 192));
  synthetic::write_off(folder + "/tool.off", tool.solid());
  examples::write_depth_png(
      folder + "/depth.png",
      synthetic::render_with_kinect_noise(*scene.surface, scene.camera, kNoiseSeed),
      kUnitsPerMetre);

  // Stands the ring upright, leaning a little.
  const Rotation upright = rotation_from_quaternion({0.7, 0.1, 0.0, std::sqrt(0.5)});
  const Quaternion q = quaternion_from_rotation(upright);
  std::string poses, truth = "pose,depth,volume,force_x,force_y,force_z\n";
  for (int k = 0; k < kPoses; ++k) {
    const Pose pose{upright, {0.01, 0, kStart + (kEnd - kStart) * k / (kPoses - 1)}};
    const synthetic::Penetration p = tool.penetration(pose, *scene.surface);
    char line[256];
    std::snprintf(line, sizeof line, "[%.9g,%.9g,%.9g,%.17g,%.17g,%.17g,%.17g]\n",
                  pose.translation.x, pose.translation.y, pose.translation.z, q.x, q.y, q.z, q.w);
    poses += line;
    std::snprintf(line, sizeof line, "%d,%.9g,%.9g,%.9g,%.9g,%.9g\n", k,
                  pose.translation.z - kStart, p.volume, p.force.x, p.force.y, p.force.z);
    truth += line;
  }
  file::write_all(folder + "/poses.jsonl", std::string_view(poses));
  file::write_all(folder + "/truth.csv", std::string_view(truth));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    std::cerr << "usage: make-example FOLDER [SCENE]\n";
    return 2;
  }
  try {
    make_example(argv[1], argc == 3 ? argv[2] : "inverted-ball");
    return 0;
  } catch (const Error& fault) {
    std::cerr << "make-example: error: " << fault.what() << '\n';
    return 1;
  }
}
