#include "libvpm/setup/cameras_check.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "libvpm/core/median.h"
#include "libvpm/scene/rig/agreement.h"
#include "libvpm/scene/rig/clear_pixel.h"
#include "libvpm/scene/rig/prepared_rig.h"

namespace vpm {
namespace {

constexpr double kSame = 0.03;      // per metre of depth: readings further apart contradict
constexpr double kBeside = 0.5;     // of that distance: free on all sides
constexpr double kDoubtful = 0.25;  // part of what two cameras share that contradicts
constexpr int kFew = 20;            // fewer pixels tell nothing
constexpr double kFarApart = 30;    // times the depths of cameras that cannot see one scene

struct ComparedCamera {
  DepthSurface image;
  Pose to_world;
  std::vector<Vec3> places;  // that clear pixels show, the camera's frame
  double depth = 0;          // m, the median of these
};

// Counts pixels that two cameras both know of.
struct Shared {
  int same = 0;          // both show the surface there
  int seen_through = 0;  // one shows a surface where the other saw free space
  int hidden = 0;        // one shows a surface well behind what the other shows
  void add(const Shared& other) {
    same += other.same, seen_through += other.seen_through, hidden += other.hidden;
  }
  double doubt() const {
    const int both = same + seen_through;
    return both >= kFew ? static_cast<double>(seen_through) / both : 0;
  }
};

ComparedCamera compared(const DepthBody& body) {
  ComparedCamera camera{body.surface(), body.to_world(), {}, 0};
  const DepthSurface& image = camera.image;
  std::vector<double> depths;
  for_clear_pixels(image, step_of_comparison(image), [&](int, int, const Vec3& place) {
    camera.places.push_back(place);
    depths.push_back(place.z);
  });
  if (!depths.empty()) camera.depth = median(depths);
  return camera;
}

// Adds what one camera knows of places that another shows.
void add_shared(const ComparedCamera& shows, const ComparedCamera& other, Shared& shared) {
  const Pose to_other = relative_to(other.to_world, shows.to_world);
  for (const Vec3& place : shows.places) {
    const Vec3 at = to_other * place;
    if (!(at.z > 0)) continue;
    const double reach = kSame * std::max(place.z, at.z);
    const SurfaceSample seen = other.image.sample(at);
    if (!seen.known) continue;
    shared.same += std::fabs(seen.distance) < reach;
    shared.hidden += seen.distance <= -reach;
    if (seen.distance < reach) continue;
    // Beside what the other camera sees its pose, or this one's, may be wrong by little.
    const DepthSurface::BallClass around = other.image.classify_ball(at, kBeside * reach);
    shared.seen_through +=
        around.side == Side::free && DepthSurface::sight_of(around) == Sight::seen;
  }
}

// Returns what each pair of cameras shares, at i * count + j and at j * count + i.
std::vector<Shared> share_of_pairs(const std::vector<ComparedCamera>& cameras) {
  const std::size_t count = cameras.size();
  std::vector<Shared> pairs(count * count);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j) {
      Shared& shared = pairs[i * count + j];
      add_shared(cameras[i], cameras[j], shared);
      add_shared(cameras[j], cameras[i], shared);
      pairs[j * count + i] = shared;
    }
  }
  return pairs;
}

// Returns how often the depth of what both show the nearest other camera is away from this one.
double depths_apart(const std::vector<ComparedCamera>& cameras, std::size_t own) {
  double least = HUGE_VAL;  // none shows anything
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    if (k == own) continue;
    const double depth = std::max(cameras[own].depth, cameras[k].depth);
    if (!(depth > 0)) continue;
    const Vec3 way = cameras[k].to_world.translation - cameras[own].to_world.translation;
    least = std::min(least, norm(way) / depth);
  }
  return least;
}

Remark nothing_in_common(bool is_warning) {
  return {is_warning,
          "it shows no surface that another camera shows too: if they see one thing, is its "
          "`import_cloud` `camera_pose` from camera to world, in metres, and `depth_scale` right?"};
}

bool is_same(const Pose& a, const Pose& b) {
  return a.translation == b.translation && a.rotation.row0 == b.rotation.row0 &&
         a.rotation.row1 == b.rotation.row1 && a.rotation.row2 == b.rotation.row2;
}

// Returns a camera that shows no surface which another one shows, too. Of several, one without a
// pose, or that which sees least far: what is too near hides what others show. Two cameras that
// look at a thing from opposite sides hide from each other what they show; that is nothing to be
// said.
std::optional<DoubtedCamera> lone_camera(const std::vector<ComparedCamera>& cameras,
                                         const std::vector<Shared>& pairs) {
  const std::size_t count = cameras.size();
  bool do_others_share = false;  // but for an image that is given twice
  for (std::size_t k = 0; k < pairs.size(); ++k)
    do_others_share |=
        pairs[k].same >= kFew && !is_same(cameras[k / count].to_world, cameras[k % count].to_world);
  std::optional<DoubtedCamera> found;
  std::pair<bool, double> least;
  for (std::size_t i = 0; count > 1 && i < count; ++i) {
    Shared all;
    for (std::size_t j = 0; j < count; ++j) all.add(pairs[i * count + j]);
    const bool is_hidden = all.hidden >= kFew;
    const std::pair key(!is_same(cameras[i].to_world, Pose{}), cameras[i].depth);
    if (!(cameras[i].depth > 0) || all.same >= kFew || (is_hidden && !do_others_share) ||
        (found && least <= key))
      continue;
    least = key;
    found = DoubtedCamera{i, nothing_in_common(!key.first && !is_hidden)};
  }
  return found;
}

Remark contradiction(double doubt) {
  char text[200];
  std::snprintf(text, sizeof text,
                "%.0f %% of what it and another camera know is solid to one and free to the other: "
                "is its `import_cloud` `camera_pose` from camera to world, in metres, and "
                "`depth_scale` right?",
                100 * doubt);
  return {true, text};
}

Remark distance_apart(double depths) {
  char text[200];
  std::snprintf(text, sizeof text,
                "its camera is %.2g times as far from the others as it sees: is its `import_cloud` "
                "`camera_pose` in metres?",
                depths);
  return {true, text};
}

// Returns the camera that is furthest from the origin of those that are too far from all others.
std::optional<DoubtedCamera> far_camera(const std::vector<ComparedCamera>& cameras) {
  std::optional<DoubtedCamera> found;
  double furthest = 0;
  for (std::size_t i = 0; cameras.size() > 1 && i < cameras.size(); ++i) {
    const double depths = depths_apart(cameras, i),
                 from_origin = norm(cameras[i].to_world.translation);
    if (!(depths > kFarApart && depths < HUGE_VAL) || !(from_origin > furthest)) continue;
    found = DoubtedCamera{i, distance_apart(depths)};
    furthest = from_origin;
  }
  return found;
}

constexpr double kOpposite = -0.5;  // greatest cosine between normals of two sides
constexpr double kThin = 2;         // deviations: thinner is uncertain by half or more
constexpr double kNotThick = 4;     // deviations: noise may make that seem thin here and there

// What some pixels show to be thin, m, and by how much the cameras on both sides disagree there, m.
struct ThinPlaces {
  std::vector<double> thicknesses, deviations;
  std::size_t not_thick = 0;  // of these and others
};

// Adds places that one camera shows and that another has behind a surface which faces the other
// way, where they are no further apart than some deviations, per depth.
void add_thin_places(const RigCamera& shows, const RigCamera& other, double deviation,
                     ThinPlaces& thin) {
  const DepthSurface& image = shows.image;
  const Pose to_other = relative_to(other.to_rig, shows.to_rig);
  for_clear_pixels(image, step_of_comparison(image), [&](int u, int v, const Vec3& place) {
    const Vec3 normal = widen(image.normals[v * image.width + u]), at = to_other * place;
    if (!(at.z > 0) || !(-dot(normal, place) > kFrontal * norm(place))) return;
    const SurfaceSample seen = other.image.sample(at);
    const double apart = deviation * std::max(place.z, at.z);
    if (!seen.known || !(std::fabs(seen.distance) < kNotThick * apart) ||
        !(dot(seen.normal, to_other.rotation * normal) < kOpposite) ||
        !(-dot(seen.normal, at) > kFrontal * norm(at)))
      return;
    ++thin.not_thick;
    if (!(std::fabs(seen.distance) < kThin * apart)) return;
    thin.thicknesses.push_back(std::fabs(seen.distance));
    thin.deviations.push_back(apart);
  });
}

}  // namespace

std::optional<Remark> check_thickness(std::span<const DepthBody> images) {
  const std::vector<DepthBody> different = different_images({images.begin(), images.end()});
  std::vector<RigCamera> cameras;
  for (const DepthBody& body : different) {
    const Pose to_rig = relative_to(different.front().to_world(), body.to_world());
    cameras.push_back({body.surface(), {}, inverse(to_rig), to_rig});
  }
  const std::size_t all = cameras.size();
  std::vector<std::optional<double>> deviations(all * all);
  double largest = 0;
  for (std::size_t pair = 0; pair < all * all; ++pair) {
    const std::size_t i = pair / all, j = pair % all;
    deviations[pair] = i < j ? deviation_between(cameras[i], cameras[j]) : deviations[j * all + i];
    largest = std::max(largest, deviations[pair].value_or(0));
  }
  ThinPlaces thin;  // none where no two cameras share a surface
  for (std::size_t pair = 0; pair < all * all; ++pair) {
    const std::size_t i = pair / all, j = pair % all;
    if (i != j) add_thin_places(cameras[i], cameras[j], deviations[pair].value_or(largest), thin);
  }
  const std::size_t count = thin.thicknesses.size();
  if (count < kFew || 2 * count < thin.not_thick) return std::nullopt;
  char text[300];
  std::snprintf(text, sizeof text,
                "something about %.1f mm thin is seen from both sides by cameras that disagree by "
                "%.1f mm: how much of it is in the way is uncertain; calibrate them better",
                1e3 * median(thin.thicknesses), 1e3 * median(thin.deviations));
  return Remark{true, text};
}

std::optional<DoubtedCamera> check_cameras(std::span<const DepthBody> images) {
  std::vector<ComparedCamera> cameras;
  for (const DepthBody& body : images) cameras.push_back(compared(body));
  const std::size_t count = cameras.size();
  const std::vector<Shared> pairs = share_of_pairs(cameras);
  std::size_t most_doubted = 0;
  double most = 0, of_pair = 0;
  for (std::size_t i = 0; i < count; ++i) {
    double sum = 0, worst = 0;
    for (std::size_t j = 0; j < count; ++j) {
      const double doubt = pairs[i * count + j].doubt();
      sum += doubt;
      worst = std::max(worst, doubt);
    }
    // Of two cameras alone, the one that shows what is further away.
    const bool is_more =
        sum > most || (sum == most && cameras[i].depth > cameras[most_doubted].depth);
    if (is_more) most = sum, of_pair = worst, most_doubted = i;
  }
  if (of_pair >= kDoubtful) return DoubtedCamera{most_doubted, contradiction(of_pair)};
  if (const std::optional<DoubtedCamera> far = far_camera(cameras)) return far;
  return lone_camera(cameras, pairs);
}

}  // namespace vpm
