// Finds the nearest place of a camera's surface. The same code searches for one place and for four.
#pragma once

#include "libvpm/scene/depth/depth_sampler.h"

namespace vpm {

// Searches for the nearest place of the surface. Starts from the point on x's ray, steps to the
// foot on its tangent plane, and steps back by halves if that overshoots a crease. Below a groove
// both walls tell the direction. A step that leads away without a crease has met noise: there the
// normals tell the direction. Beside a crease normals of one side replace those that mix both.
template <class Real>
class FootSearch {
 public:
  using Mask = MaskOf<Real>;
  using Int = IntOf<Real>;
  using Place = PlaceOf<Real>;
  using Stored = StoredOf<Real>;

  // Holds the pixels kAcross to either side of one, in its row and its column.
  struct Neighbors {
    Int across{}, down{};              // kAcross, or 0 where one is missing
    Stored left, right, above, below;  // normals
  };
  [[gnu::always_inline]] static VPM_HD Neighbors neighbors_of(const DepthSampler& image,
                                                              const Int& u, const Int& v) {
    const Int none{}, some = none + kAcross;
    const Int across = (u >= kAcross) & (u < image.width - kAcross) ? some : none,
              down = (v >= kAcross) & (v < image.height - kAcross) ? some : none;
    const Int pixel = v * image.width + u, rows = down * image.width;
    const auto normal = [&](const Int& i) __attribute__((always_inline)) {
      return gather(image.normals, i);
    };
    return {across,
            down,
            normal(pixel - across),
            normal(pixel + across),
            normal(pixel - rows),
            normal(pixel + rows)};
  }

  FootSearch() = default;
  // Begins at `first`, the surface sample at x, which must be known.
  [[gnu::always_inline]] VPM_HD FootSearch(const DepthSampler& image, const Place& x,
                                           SurfaceSampleOf<Real> first, const Neighbors& beside)
      : x_(x) {
    take_one_side(image, beside, first);
    foot_ = first.foot;
    normal_ = first.normal;
    squared_ = squared_norm(x - foot_);
    target_ = x - first.distance * normal_;
    pixel_ = quotient(foot_.z, image.k.fx);
    searches_ = negated(Mask{});
  }

  // True where a sample at target() is needed. Call it before each take().
  [[gnu::always_inline]] VPM_HD Mask goes_on() {
    if (steps_ == kSteps) searches_ = Mask{};
    const Real near = kNearPixels * pixel_;
    if (any(searches_)) searches_ &= squared_norm(target_ - foot_) > near * near;
    return searches_;
  }
  [[gnu::always_inline]] VPM_HD const Place& target() const { return target_; }
  [[gnu::always_inline]] VPM_HD void take(const DepthSampler& image, SurfaceSampleOf<Real> next,
                                          const Neighbors& beside) {
    ++steps_;
    searches_ &= next.known;
    if (!any(searches_)) return;
    take_one_side(image, beside, next);
    const Real squared = squared_norm(x_ - next.foot);
    const Mask is_closer = searches_ & (squared < squared_),
               is_not = searches_ & negated(is_closer);
    if (any(is_closer)) step_to(next, squared, is_closer);
    if (any(is_not)) turn_back(next, is_not);
  }

  // Returns the squared distance, m^2, of the foot that was found.
  [[gnu::always_inline]] VPM_HD const Real& squared_distance() const { return squared_; }
  // Returns the direction to the foot that was found. A foot that is not below x on its own tangent
  // plane lies on a crease, where the gradient fans out.
  [[gnu::always_inline]] VPM_HD Place normal() const {
    const Place towards = choose(has_met_noise_, normal_, foot_ - x_);
    const Real above = dot(normal_, towards), aside = squared_norm(towards - above * normal_);
    const Real crease = kCreasePixels * pixel_;
    const Mask is_found =
        has_met_groove_ | (negated(has_met_noise_) & (above > 0) & (aside <= crease * crease));
    if (all(is_found)) return normal_;
    return choose(is_found, normal_, normalized_or_zero(towards));
  }

 private:
  static constexpr std::int32_t kAcross = DepthSampler::kAcross;
  static constexpr double kSmoothCosine = DepthSampler::kSmoothCosine;
  static constexpr double kSameCosine = 0.99;  // cos 8 degrees: normals of one side of a crease
  static constexpr int kSteps = 5;             // limit of the search
  static constexpr double kNearPixels = 0.5;   // a shorter step ends the search
  static constexpr double kCreasePixels = 2;   // a foot further aside lies on a crease

  [[gnu::always_inline]] VPM_HD void step_to(const SurfaceSampleOf<Real>& next, const Real& squared,
                                             const Mask& which) {
    foot_ = choose(which, next.foot, foot_);
    normal_ = choose(which, next.normal, normal_);
    squared_ = which ? squared : squared_;
    target_ = choose(which, x_ - dot(normal_, x_ - foot_) * normal_, target_);
  }
  // Ends the search: sums normals in normal_ where noise was met, stores the direction where a
  // groove was. Steps back toward a crease otherwise.
  [[gnu::always_inline]] VPM_HD void turn_back(const SurfaceSampleOf<Real>& next,
                                               const Mask& which) {
    const Mask is_noise = which & (dot(normal_, next.normal) > kSmoothCosine);
    normal_ = choose(is_noise, normal_ + next.normal, normal_);
    has_met_noise_ |= is_noise;
    const Mask is_crease = which & negated(is_noise);
    if (any(is_crease)) {
      const TangentPlaneOf<Real> one{normal_, foot_}, other{next.normal, next.foot};
      const Mask is_groove = is_crease & meet_above(one, other);
      if (any(is_groove))
        normal_ = choose(is_groove, normal_below_groove<Real>(x_, one, other), normal_);
      has_met_groove_ |= is_groove;
      target_ = choose(is_crease, 0.5 * (foot_ + next.foot), target_);
    }
    searches_ &= negated(has_met_noise_ | has_met_groove_);
  }
  // True if two walls, each with a sampled foot, enclose a groove above x, which is behind both.
  [[gnu::always_inline]] VPM_HD Mask meet_above(const TangentPlaneOf<Real>& one,
                                                const TangentPlaneOf<Real>& other) const {
    return (one.distance(other.foot) > 0) & (other.distance(one.foot) > 0) &
           (one.distance(x_) < 0) & (other.distance(x_) < 0);
  }

  // Replaces the normal of a sample beside a crease by that of the side on whose tangent plane the
  // foot lies, and its distance by that of x from the plane.
  [[gnu::always_inline]] VPM_HD void take_one_side(const DepthSampler& image,
                                                   const Neighbors& beside,
                                                   SurfaceSampleOf<Real>& on_surface) const {
    const Mask in_row = widen_mask(beside.across > 0) &
                        holds_crease(beside.left, beside.right, on_surface.normal),
               in_column = widen_mask(beside.down > 0) &
                           holds_crease(beside.above, beside.below, on_surface.normal);
    if (!any(in_row | in_column)) return;
    const Int pixel = static_cast<Int>(on_surface.point), v = pixel / image.width,
              u = pixel - v * image.width;
    Real least = Real{} + HUGE_VAL;
    const auto consider = [&](const Mask& which, const Int& at_u, const Int& at_v,
                              const Stored& stored) __attribute__((always_inline)) {
      if (!any(which)) return;
      const Place normal = widen(stored);
      const Real off = off_plane(image, on_surface.foot, at_u, at_v, normal);
      const Mask is_better = which & (off < least);
      least = is_better ? off : least;
      on_surface.normal = choose(is_better, normal, on_surface.normal);
    };
    // Takes each normal by value: a choice between members would put them all in local memory.
    Stored in_row_side = beside.left, in_column_side = beside.above;
#ifdef __CUDA_ARCH__
#pragma unroll 1  // needs fewer registers
#endif
    for (std::int32_t side = -1; side <= 1; side += 2) {
      consider(in_row, u + side * beside.across, v, in_row_side);
      consider(in_column, u, v + side * beside.down, in_column_side);
      in_row_side = beside.right, in_column_side = beside.below;
    }
    on_surface.distance =
        least < HUGE_VAL ? dot(on_surface.normal, x_ - on_surface.foot) : on_surface.distance;
  }
  // True if a crease passes between two neighbours of a pixel and its normal belongs to neither.
  [[gnu::always_inline]] static VPM_HD Mask holds_crease(const Stored& one, const Stored& other,
                                                         const Place& normal) {
    const Place before = widen(one), after = widen(other);
    const Mask differ = dot(before, after) < kSmoothCosine;
    if (!any(differ)) return differ;
    return differ & (dot(before, normal) < kSameCosine) & (dot(after, normal) < kSameCosine);
  }
  // Returns the distance of a place from the tangent plane of a pixel, m; HUGE_VAL where the pixel
  // shows another surface, or nothing.
  [[gnu::always_inline]] static VPM_HD Real off_plane(const DepthSampler& image, const Place& place,
                                                      const Int& u, const Int& v,
                                                      const Place& normal) {
    const Real per_depth = image.inverse_depth(u, v), none = Real{} + HUGE_VAL;
    const Mask is_same =
        (dot(normal, place) < 0) & (absolute(per_depth * place.z - 1) <= DepthSampler::kJump);
    if (!any(is_same)) return none;
    const Intrinsics& k = image.k;
    const Real z = 1 / per_depth;
    const Place point{(widen(u) - k.cx) / k.fx * z, (widen(v) - k.cy) / k.fy * z, z};
    return is_same ? absolute(dot(normal, place - point)) : none;
  }

  Place x_, foot_, normal_, target_;
  Real squared_{}, pixel_{};  // squared distance to the foot, m^2; pixel width at the first foot, m
  int steps_ = 0;
  Mask searches_{}, has_met_noise_{}, has_met_groove_{};
};

// Searches for the nearest place of the surface from a place x behind it. `on_surface` is the
// sample at x and must be known.
template <class Place>
[[gnu::always_inline]] VPM_HD inline FootSearch<RealOf<Place>> search_foot(
    const DepthSampler& image, const Place& x, const SurfaceSampleOf<RealOf<Place>>& on_surface) {
  using Real = RealOf<Place>;
  using Int = IntOf<Real>;
  using Search = FootSearch<Real>;
  const Int pixel = static_cast<Int>(on_surface.point), v = pixel / image.width,
            u = pixel - v * image.width;
  Search search(image, x, on_surface, Search::neighbors_of(image, u, v));
  while (any(search.goes_on())) {
    typename Search::Neighbors beside{};
    const auto also = [&](const Int& at_u, const Int& at_v) __attribute__((always_inline)) {
      beside = Search::neighbors_of(image, at_u, at_v);
    };
    const SurfaceSampleOf<Real> next = image.sample_and(search.target(), also);
    search.take(image, next, beside);
  }
  return search;
}

// Returns the gradient of the distance to the surface at a place x behind it, which points towards
// the nearest surface point. `on_surface` is the sample at x and must be known.
template <class Place>
[[gnu::always_inline]] VPM_HD inline Place search_normal(
    const DepthSampler& image, const Place& x, const SurfaceSampleOf<RealOf<Place>>& on_surface) {
  return search_foot(image, x, on_surface).normal();
}

}  // namespace vpm
