// Places of a scene that cameras can know, which are the only ones where a measure can be held to
// the truth.
//
// A place is known to be free if a camera sees it, and known to be inside if a camera's ray enters
// the obstacle before it and does not leave it again. All else is unknown: free space that no
// camera sees (behind a thin plate or a block), parts of an obstacle hidden by free space (a wall
// behind a block), places whose pixel is a hole, and places between the two depths of a jump within
// a pixel of it. Volumes with and without the unknown part bound what a measure may say.
#pragma once

#include <span>
#include <vector>

#include "libvpm/cloud/camera.h"
#include "libvpm/cloud/depth_image.h"
#include "libvpm/model/solid.h"
#include "libvpm/synthetic/render.h"

namespace vpm::bench {

// Places spread evenly over a solid (Halton's sequence), in its own coordinates. Counting them
// gives volumes within about 1 / count^(2/3) of the solid's.
std::vector<Vec3> places_in(const Solid& solid, std::size_t count);

// Fractions of a placed tool that no camera can know.
struct Unseen {
  double free = 0;    // in free space, and not known to be
  double inside = 0;  // inside the obstacle, and not known to be
  // inside, but nearest to a part of the surface that no camera sees well, so that depth and force
  // cannot be known there
  double foot = 0;
};

// Smallest cosine between ray and normal at which a surface is seen well: a pixel spans twenty
// times the width of its ray there.
inline constexpr double kGrazingCosine = 0.05;

// Knowledge of one camera. `hole[pixel]`, if given, marks pixels without measurement.
class Sight {
 public:
  Sight(const synthetic::Surface& surface, const Camera& camera,
        const std::vector<bool>* hole = nullptr)
      : surface_(surface), camera_(camera), hole_(hole) {}

  enum class Place { free, inside, unknown };
  Place at(Vec3 world) const;
  bool sees_well(Vec3 on_surface, Vec3 normal) const;

 private:
  struct Ray {
    bool sees = false;    // the ray reaches the place through free space alone
    bool inside = false;  // the ray has entered once and not left
    double entry = 0;     // depth of the first entry; 0: none
  };
  Ray ray(Vec3 from_camera) const;
  bool is_ambiguous(Vec3 from_camera, double entry) const;

  const synthetic::Surface& surface_;
  const Camera& camera_;
  const std::vector<bool>* hole_;
};

Unseen unseen_parts(std::span<const Vec3> places, const Pose& pose,
                    const synthetic::Surface& surface, const std::vector<Sight>& cameras);

// Fractions of the places. The count takes occluded space as solid, as Shadows::solid does.
struct ProjectiveCount {
  double behind = 0;    // behind the depth of the nearest pixel
  double occluded = 0;  // the part of `behind` that is further behind it than the tool radius
};

// Counts `places`, which are spread evenly over the tool. A place in front of a pixel without
// depth, or of no pixel, is not behind.
ProjectiveCount count_behind(std::span<const Vec3> places, double reach, const Pose& pose,
                             const DepthImage& depth, const Camera& camera);

}  // namespace vpm::bench
