// control-loop TOOL.vpmg: a haptic loop of 1000 steps of 1 ms. A camera at the origin sees a wall
// that comes nearer, 30 images a second; a hand pushes the tool into it through a virtual coupling.
#include <vpm/depth_stream.h>
#include <vpm/error.h>
#include <vpm/query.h>
#include <vpm/setup_check.h>
#include <vpm/virtual_coupling.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>
#include <vector>

namespace {

constexpr std::uint32_t kWidth = 160, kHeight = 120;
constexpr vpm::Intrinsics kIntrinsics{100, 100, 79.5, 59.5};
constexpr int kSteps = 1000, kStepsPerImage = 33;

// Stands for a camera: every pixel sees the wall at this depth, m.
vpm::Scene wall_at(vpm::DepthStream& stream, float depth) {
  for (float& pixel : stream.metres()) pixel = depth;
  return stream.prepare({});
}

// Prints what is probably wrong with a tool before this wall, such as a mesh in millimetres.
void check(const vpm::Tool& tool, float depth) {
  const std::vector<float> image(std::size_t{kWidth} * kHeight, depth);
  const vpm::Camera camera{kIntrinsics, kWidth, kHeight, {}};
  const vpm::SetupCheck check(tool, vpm::PointCloud::from_depth(image, camera));
  for (const vpm::Remark& remark : check.remarks())
    std::fprintf(stderr, "control-loop: warning: %s\n", remark.text.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: control-loop TOOL.vpmg\n", stderr);
    return 2;
  }
  try {
    const vpm::Tool tool = vpm::Tool::read(argv[1]);
    check(tool, 1);
    const double size = tool.radius();
    vpm::QueryOptions options;
    options.stiffness = 500 / (size * size);  // N/m^3: as stiff as the coupling
    vpm::Query query(tool, options);
    vpm::DepthStream stream({kIntrinsics, kWidth, kHeight, std::nullopt});

    vpm::CouplingParameters coupling{.stiffness = 500, .damping = 5, .gyration = tool.gyration()};
    coupling.mass = vpm::critical_mass(coupling.stiffness, coupling.damping);
    const vpm::Vec3 center = tool.center_of_mass();
    vpm::Pose hand{{}, {-center.x, -center.y, 1 - center.z}};  // the tool 1 m before the camera
    vpm::VirtualCoupling held(coupling, center, hand);

    std::optional<vpm::Scene> scene;
    double most_volume = 0, most_force = 0, seconds = 0;
    for (int step = 0; step < kSteps; ++step) {
      if (step % kStepsPerImage == 0)
        scene = wall_at(stream, static_cast<float>(1 + size * (1.2 - 1.0 * step / kSteps)));
      const auto begin = std::chrono::steady_clock::now();
      const vpm::Result contact = query.run(*scene, held.tool());
      seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      const vpm::Wrench felt = held.advance(hand, contact.wrench);
      most_volume = std::max(most_volume, contact.volume_fraction);
      most_force = std::max(most_force, -felt.force.z);
    }
    std::printf("%d steps of %.1f us: at most %.3g %% of the tool inside, %.3g N felt\n", kSteps,
                1e6 * seconds / kSteps, 100 * most_volume, most_force);
    return 0;
  } catch (const vpm::Error& error) {
    std::fprintf(stderr, "control-loop: %s\n", error.what());
    return 1;
  }
}
