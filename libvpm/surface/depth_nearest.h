// DepthSurface: the nearest place of the surface, and which side of a crease it lies on.
#pragma once

#include "libvpm/surface/depth_surface.h"

namespace vpm {

// The search for it, reading by reading. Starts from the point on x's ray, steps to the foot on its
// tangent plane and, where that overshoots a crease, back by halves; where it is the bottom of a
// groove that it overshoots, its walls tell the direction. A step that leads away without a crease
// has met noise: there the normals tell the direction, not single pixels. Beside a crease, where
// windows of normals hold both sides, those of one side lead.
class DepthSurface::FootSearch {
 public:
  FootSearch() = default;
  // `first`: what was read at x, and is known.
  VPM_HD FootSearch(const DepthSurface& surface, Vec3 x, Reading first, const Neighbors& beside)
      : x_(x) {
    surface.take_one_side(x, beside, first);
    foot_ = first.foot;
    normal_ = first.normal;
    squared_ = squared_norm(x - foot_);
    target_ = x - first.distance * normal_;
    pixel_ = quotient(foot_.z, surface.k.fx);
  }

  // Whether another reading is wanted, at this place.
  VPM_HD bool goes_on() const {
    const double near = kFootPixels * pixel_;
    return steps_ < kFootSteps && squared_norm(target_ - foot_) > near * near;
  }
  VPM_HD Vec3 target() const { return target_; }
  VPM_HD void take(const DepthSurface& surface, Reading next, const Neighbors& beside) {
    ++steps_;
    if (!next.known) {
      steps_ = kFootSteps;
      return;
    }
    surface.take_one_side(x_, beside, next);
    const double squared = squared_norm(x_ - next.foot);
    if (squared < squared_) {
      foot_ = next.foot;
      normal_ = next.normal;
      squared_ = squared;
      target_ = x_ - dot(normal_, x_ - foot_) * normal_;
    } else if (dot(normal_, next.normal) > kSmoothCosine) {
      end(normalized_or_zero(normal_ + next.normal));
    } else if (const TangentPlane one{normal_, foot_}, other{next.normal, next.foot};
               meet_above(x_, one, other)) {
      end(normal_below_groove(x_, one, other));
    } else {
      target_ = 0.5 * (foot_ + next.foot);
    }
  }

  // Where the foot is not below x on its own tangent plane, it lies on a crease: there the gradient
  // fans out.
  VPM_HD Vec3 normal() const {
    if (is_known_) return normal_;
    const Vec3 towards = foot_ - x_;
    const double above = dot(normal_, towards);
    const double aside = squared_norm(towards - above * normal_);
    return above > 0 && aside <= (kCreasePixels * pixel_) * (kCreasePixels * pixel_)
               ? normal_
               : normalized_or_zero(towards);
  }

 private:
  VPM_HD void end(Vec3 normal) {
    normal_ = normal;
    is_known_ = true;
    steps_ = kFootSteps;
  }

  Vec3 x_, foot_, normal_, target_;
  double squared_ = 0, pixel_ = 0;  // of the foot's distance; a pixel's width at the first foot
  int steps_ = 0;
  bool is_known_ = false;
};

VPM_HD inline Vec3 DepthSurface::closest_normal(Vec3 x, const Reading& reading) const {
  const auto i = static_cast<std::int32_t>(reading.point);
  FootSearch search(*this, x, reading, neighbors_of(i % width, i / width));
  while (search.goes_on()) {
    Neighbors beside;
    const Reading next = read_and(
        search.target(), [&](std::int32_t u, std::int32_t v) { beside = neighbors_of(u, v); });
    search.take(*this, next, beside);
  }
  return search.normal();
}

VPM_HD inline DepthSurface::Neighbors DepthSurface::neighbors_of(std::int32_t u,
                                                                 std::int32_t v) const {
  const bool in_row = u >= kAcross && u + kAcross < width;
  const bool in_column = v >= kAcross && v + kAcross < height;
  const std::int32_t i = v * width + u;
  const std::int32_t aside = in_row ? kAcross : 0, down = in_column ? kAcross * width : 0;
  return {in_row,           in_column, normals[i - aside], normals[i + aside], normals[i - down],
          normals[i + down]};
}

VPM_HD inline void DepthSurface::take_one_side(Vec3 x, const Neighbors& beside,
                                               Reading& reading) const {
  const bool in_row = beside.in_row && holds_crease(beside.left, beside.right, reading.normal),
             in_column =
                 beside.in_column && holds_crease(beside.above, beside.below, reading.normal);
  if (!in_row && !in_column) return;
  const auto i = static_cast<std::int32_t>(reading.point);
  const Vec3 foot = reading.foot;
  double least = HUGE_VAL;
  const auto consider = [&](std::int32_t j) {
    const Vec3 normal = widen(normals[j]);
    const double off = off_plane(foot, j, normal);
    if (!(off < least)) return;
    least = off;
    reading.normal = normal;
    reading.distance = dot(normal, x - foot);
  };
  for (std::int32_t side = -kAcross; side <= kAcross; side += 2 * kAcross) {
    if (in_row) consider(i + side);
    if (in_column) consider(i + side * width);
  }
}

VPM_HD inline bool DepthSurface::holds_crease(Vec3f one, Vec3f other, Vec3 normal) {
  const Vec3 before = widen(one), after = widen(other);
  return dot(before, after) < kSmoothCosine && dot(before, normal) < kSameCosine &&
         dot(after, normal) < kSameCosine;
}

VPM_HD inline double DepthSurface::off_plane(Vec3 place, std::int32_t i, Vec3 normal) const {
  const double per_depth = tiles[0][i].high;
  if (!(dot(normal, place) < 0 && std::fabs(per_depth * place.z - 1) <= kJump)) return HUGE_VAL;
  const std::int32_t v = i / width;
  return std::fabs(dot(normal, place - unproject(k, i - v * width, v, 1 / per_depth)));
}

}  // namespace vpm
