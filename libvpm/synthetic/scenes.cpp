#include "libvpm/synthetic/scenes.h"

#include <functional>
#include <utility>

#include "libvpm/core/error.h"

namespace vpm::synthetic {
namespace {

constexpr double kFar = 20;  // m; ends of the profiles, out of every camera's sight

SurfacePtr make_groove() {
  constexpr double kDepth = 0.15;
  return make_prism({{-kFar, 1 - kDepth},
                     {-kDepth, 1 - kDepth},
                     {0, 1},
                     {kDepth, 1 - kDepth},
                     {kFar, 1 - kDepth},
                     {kFar, kFar},
                     {-kFar, kFar}},
                    {});
}

SurfacePtr make_step() {
  constexpr double kEdge = -0.03, kHeight = 0.05;  // the camera sees the riser
  return make_prism({{-kFar, 1 - kHeight},
                     {kEdge, 1 - kHeight},
                     {kEdge, 1},
                     {kFar, 1},
                     {kFar, kFar},
                     {-kFar, kFar}},
                    {});
}

SurfacePtr make_before_wall(Vec3 size) {
  const Vec3 toward_camera{0, 0, -1};
  return make_union(
      {make_block(size, {{}, {0, 0, 1 + size.z / 2}}), make_wall({0, 0, 1.5}, toward_camera)});
}

using Maker = std::function<SurfacePtr()>;
const std::vector<std::pair<std::string, Maker>>& makers() {
  static const std::vector<std::pair<std::string, Maker>> kMakers{
      {"wall",
       [] {
         return make_wall({0, 0, 1}, {0, 0, -1});
       }},
      {"inverted-ball",
       [] {
         return make_inverted_ball({0, 0, 0.7}, 0.3);
       }},
      {"tilted-wall",
       [] {
         return make_wall({0, 0, 1}, {0.5, 0, -std::sqrt(0.75)});
       }},
      {"ball",
       [] {
         return make_ball({0, 0, 1.25}, 0.25);
       }},
      {"groove", make_groove},
      {"step", make_step},
      {"plate",
       [] {
         return make_before_wall({0.4, 0.4, 0.004});
       }},
      {"block",
       [] {
         return make_before_wall({0.2, 0.2, 0.2});
       }},
  };
  return kMakers;
}

}  // namespace

Scene make_scene(const std::string& name) {
  std::string known;
  for (const auto& [candidate, maker] : makers()) {
    if (candidate == name) return {name, maker(), default_camera()};
    known += (known.empty() ? "" : ", ") + candidate;
  }
  throw Error(ErrorKind::invalid_argument, "there is no scene '" + name + "'", {},
              "the scenes are " + known);
}

const std::vector<std::string>& scene_names() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const auto& [name, maker] : makers()) names.push_back(name);
    return names;
  }();
  return kNames;
}

}  // namespace vpm::synthetic
