// A scene as cameras see it: the cloud for a query, and the cameras.
#pragma once

#include <string>
#include <vector>

#include "libvpm/scene/any_body.h"
#include "libvpm/synthetic/scenes.h"

namespace vpm::bench {

enum class CloudKind {
  camera,  // one image with its camera
  // points without camera; in the scenes step and plate also those of a second camera, which sees
  // the riser and the plate's back
  points,
};
enum class Noise { none, kinect };
std::string to_text(CloudKind kind);
std::string to_text(Noise noise);

inline constexpr std::uint64_t kNoiseSeed = 1;

struct View {
  std::vector<Camera> cameras;
  AnyBody cloud;
};

// Renders the scene and returns its cloud. Normals are estimated from the images, with or without
// noise, by the default options.
View make_view(const synthetic::Scene& scene, CloudKind kind, Noise noise,
               std::uint64_t noise_seed);

}  // namespace vpm::bench
