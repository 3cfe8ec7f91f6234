// make-example FOLDER [SCENE]: writes a tool, the image of a scene by a noisy depth camera, a path
// of the tool into the scene, and the true results along it. SCENE is one of
// libvpm/synthetic/scenes.h, by default a bowl.
//   tool.off      a twisted torus of 0.2 m
//   depth.png     640 x 480 pixels, 5000 units per metre, f = 525 px, Kinect noise
//   poses.jsonl   one pose per line: [tx,ty,tz,qx,qy,qz,qw]
//   truth.csv     pose,depth,volume,force_x,force_y,force_z: metres and cubic metres
// And of a robot's cell, the world's z upward, in which three cameras see an arm over a part on a
// table:
//   link.off      the arm's last link, m, about its middle, which is .5 m above the world's origin
//   left.png ...  320 x 240 pixels, 5000 units per metre, f = 262.5 px; left, right and back
//   left.txt ...  where each camera is said to be: 3 mm and .2 degrees from where it is

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

void make_cell(const std::string& folder) {
  const Vec3 size{0.05, 0.05, 0.4};
  const Pose link{{}, {0, 0, 0.5}};
  synthetic::write_off(folder + "/link.off", synthetic::make_box(size.x, size.y, size.z));
  const synthetic::SurfacePtr cell = synthetic::make_union(
      {synthetic::make_inverted_ball({0, 0, 0.5}, 2.5),
       synthetic::make_block({1.4, 1.4, 0.05}, {{}, {0, 0, -0.026}}),
       synthetic::make_block({0.12, 0.09, 0.1}, {rotation_from_vector({0, 0, 0.5}), {0, 0, 0.05}}),
       synthetic::make_block(size, link)});
  const std::pair<const char*, double> places[] = {{"left", 0.4}, {"right", 2.5}, {"back", 4.6}};
  for (const auto& [name, around] : places) {
    Camera camera{{262.5, 262.5, 159.75, 119.75}, 320, 240, {}};
    camera.to_world = synthetic::looking_at({0.8 * std::cos(around), 0.8 * std::sin(around), 0.7},
                                            {0, 0, 0.15}, {0, 0, 1});
    examples::write_depth_png(
        folder + "/" + name + ".png",
        synthetic::render_with_kinect_noise(*cell, camera, kNoiseSeed + std::uint64_t(name[0])),
        kUnitsPerMetre);
    const Vec3 turn{0.0035 * std::sin(9 * around), 0, 0.0035 * std::cos(9 * around)};
    const Vec3 said = camera.to_world.translation +
                      Vec3{0, 0.003 * std::cos(5 * around), 0.003 * std::sin(5 * around)};
    const Quaternion q =
        quaternion_from_rotation(rotation_from_vector(turn) * camera.to_world.rotation);
    char line[256];
    std::snprintf(line, sizeof line, "%.6f %.6f %.6f %.9f %.9f %.9f %.9f\n", said.x, said.y, said.z,
                  q.x, q.y, q.z, q.w);
    file::write_all(folder + "/" + name + ".txt", std::string_view(line));
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    std::cerr << "usage: make-example FOLDER [SCENE]\n";
    return 2;
  }
  try {
    make_example(argv[1], argc == 3 ? argv[2] : "inverted-ball");
    make_cell(argv[1]);
    return 0;
  } catch (const Error& fault) {
    std::cerr << "make-example: error: " << fault.what() << '\n';
    return 1;
  }
}
