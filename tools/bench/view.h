// A scene as cameras see it: the cloud that a query gets, and where the cameras stood.
#pragma once

#include <string>
#include <vector>

#include "libvpm/surface/prepared_cloud.h"
#include "libvpm/synthetic/scenes.h"

namespace vpm::bench {

enum class CloudKind {
  camera,  // organised: one image with its camera
  points,  // the points alone; of the step and the plate also those of a second camera, which sees
           // the riser and the plate's back
};
enum class Noise { none, kinect };
std::string to_text(CloudKind kind);
std::string to_text(Noise noise);

inline constexpr std::uint64_t kNoiseSeed = 1;

struct View {
  std::vector<Camera> cameras;
  PreparedCloud cloud;
};

// Normals are estimated from the images, noisy or not, with the default options.
View make_view(const synthetic::Scene& scene, CloudKind kind, Noise noise,
               std::uint64_t noise_seed);

}  // namespace vpm::bench
