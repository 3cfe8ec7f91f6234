// What cameras cannot know of a scene: where a measure cannot be held to the truth.
//
// Rule. A place is *known* to be free if a camera sees it, and known to be inside if a camera's ray
// enters the obstacle before it and does not leave it again. The part of the tool in free space
// that no camera sees (behind a thin plate, in the shadow of a block) may or may not be counted; so
// may the part inside that free space hides (a wall behind a block), everything whose pixel is a
// hole, and what lies between the two depths of a jump within a pixel of it. The volume must lie
// between both.
#pragma once

#include <span>
#include <vector>

#include "libvpm/model/solid.h"
#include "libvpm/synthetic/render.h"

namespace vpm::bench {

// Places spread evenly over a solid (Halton's sequence), in its own coordinates. Counting them
// gives volumes within about 1 / count^(2/3) of the solid's.
std::vector<Vec3> places_in(const Solid& solid, std::size_t count);

// Parts of a placed tool.
struct Unseen {
  double free = 0;    // in free space, and not known to be
  double inside = 0;  // inside the obstacle, and not known to be
  double foot = 0;    // inside, but nearest to a part of the surface that no camera sees well: the
                      // depth there, and so the force, cannot be known
};

// Surface that a ray meets at a lower cosine than this is not seen well: a pixel spans twenty times
// the width of its ray there.
inline constexpr double kGrazingCosine = 0.05;

// One camera's knowledge. `hole[pixel]`, if given, marks pixels without measurement.
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
    bool sees = false;    // the place itself: free all the way
    bool inside = false;  // entered once, and not left
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

}  // namespace vpm::bench
