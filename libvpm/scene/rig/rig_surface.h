// Defines the surface that several cameras see together: a rig, whose images may show the same
// thing. README.md has the reasons.
//
// Each image gives a signed distance at a place. A silhouette is read as a surface too: what one
// camera sees at a grazing angle begins there. Readings of one surface (normals alike, distances
// within what the images disagree by) are averaged, and then the greatest counts: what one camera
// clearly saw free is free. One text serves one place and four (core/vector_width.h).
#pragma once

#include "libvpm/core/pose.h"
#include "libvpm/scene/body.h"
#include "libvpm/scene/depth/depth_nearest.h"
#include "libvpm/scene/depth/depth_surface.h"
#include "libvpm/scene/mean_plane.h"
#include "libvpm/scene/rig/silhouettes.h"

namespace vpm {

// Names cameras of a rig by their bits. Where searches in other bodies begin at a point, those in a
// rig ask a set of cameras, so that kNoPoint stands for all.
using CameraSet = std::uint32_t;

struct RigCamera {
  DepthSurface image;
  Silhouettes silhouettes;
  Pose from_rig, to_rig;  // maps the rig's frame to the camera's, and back
};

// Holds what one image tells of a place, or of four.
template <class Real>
struct RigReading {
  MaskOf<Real> known;    // not set by default, as all of this: many are reserved, and few used
  Real distance;         // m, signed as in SurfaceSampleOf; 0 where not known
  Real depth;            // m, of the place
  Real below;            // m, by which the place is deeper than what is on its ray; 0 if aside
  Real weight;           // 0 where not known
  PlaceOf<Real> normal;  // unit, into free space, the rig's frame
};

// Holds plain pointers to a rig's data, for host or device.
struct RigSurface {
  static constexpr bool kSearchesFoot = true;
  static constexpr bool kTellsInside = true;
  static constexpr int kMostCameras = 16;

  const RigCamera* cameras = nullptr;
  // Distances per depth of the place, m/m (RigAgreement), within which readings of cameras i and j,
  // at i * count + j, may be of one surface; a camera's own, i = j, is the width of its pixels.
  const double* agreement = nullptr;
  std::int32_t count = 0;
  double most_agreement = 0;  // the greatest of these
  double well_before = 0;     // per depth: what hides a place by more tells less than other cameras

  VPM_HD CameraSet all_cameras() const { return (CameraSet{1} << count) - 1; }

  // Holds the class of a ball: the cameras that tell of places in it, and what they tell.
  struct BallClass {
    Side side = Side::free;
    CameraSet point = 0;  // the cameras that decide there
    Sight sight = Sight::out_of_view;
    bool is_whole = false;  // all pixels of these cameras have measured a surface
    double gap = HUGE_VAL;  // m, bounds how far places of a ball behind the surface are from it
    double margin = 0;      // m, bounds the distances within which readings in it are averaged
    Vec3 center;
    double radius = 0;
  };

  // The surface as a set of cameras sees it.
  struct View {
    const RigSurface* rig = nullptr;
    CameraSet cameras = 0;

    VPM_HD SurfaceSample sample(Vec3 x, std::uint32_t = kNoPoint) const {
      return rig->sample_near(x, cameras, HUGE_VAL);
    }
  };

  // Samples the surface, as the cameras see it that decide in a ball about x: kNoPoint are all.
  VPM_HD SurfaceSample sample(Vec3 x, std::uint32_t point = kNoPoint) const {
    return sample_near(x, point & all_cameras(), HUGE_VAL);
  }
  VPM_HD View around_ball(Vec3, double, std::uint32_t point) const {
    return {this, point & all_cameras()};
  }

  // Samples the surface as these cameras see it, which are those that decide in a ball about x; as
  // all do where each of them has something well before x, or none knows of x. Where the surface is
  // surely further than `enough`, m, before x, only that is told: any such distance.
  template <class Place>
  [[gnu::always_inline]] VPM_HD SurfaceSampleOf<RealOf<Place>> sample_near(
      const Place& x, CameraSet some, const RealOf<Place>& enough) const {
    using Real = RealOf<Place>;
    MaskOf<Real> is_decided{};
    const SurfaceSampleOf<Real> near = sample_by(x, some, enough, is_decided);
    if (some == all_cameras() || all(is_decided)) return near;
    return sample_by(x, all_cameras(), enough, is_decided);
  }

  // Samples the surface as these cameras see it. A reading from well before x counts only where
  // there is no other; `is_decided` receives where there is one.
  template <class Place>
  [[gnu::always_inline]] VPM_HD SurfaceSampleOf<RealOf<Place>> sample_by(
      const Place& x, CameraSet some, const RealOf<Place>& enough,
      MaskOf<RealOf<Place>>& is_decided) const {
    using Real = RealOf<Place>;
    RigReading<Real> readings[kMostCameras];
    std::int32_t names[kMostCameras], found = 0;
    SurfaceSampleOf<Real> on_surface;
    is_decided = MaskOf<Real>{};
    for (std::int32_t i = 0; i < count; ++i) {
      if ((some >> i & 1) == 0) continue;
      readings[found] = read(cameras[i], x);
      if (!any(readings[found].known)) continue;
      on_surface.known |= readings[found].known;
      is_decided |= readings[found].known & negated(is_well_before(readings[found]));
      names[found++] = i;
    }
    if (found == 0) return on_surface;
    const Real zero{};
    for (std::int32_t i = 0; i < found; ++i) {
      const MaskOf<Real> is_left_out = is_decided & is_well_before(readings[i]);
      readings[i].known &= negated(is_left_out);
      readings[i].weight = is_left_out ? zero : readings[i].weight;
    }
    const Nearest<Real> nearest = nearest_of(readings, names, found);
    if (all(negated(on_surface.known) | is_clearly_before(nearest, enough))) {
      on_surface.distance = nearest.length;
      return on_surface;
    }
    bound_free_distances(x, nearest, readings, names, found);
    on_surface.distance = zero - HUGE_VAL;
    for (std::int32_t i = 0; i < found; ++i) {
      RigReading<Real>& reading = readings[i];
      if (!any(reading.known &
               (reading.distance + kRounding * nearest.apart > on_surface.distance)))
        continue;  // its mean is not the greatest
      RigReading<Real> mean = reading;
      average(readings, names, found, i, mean);
      const MaskOf<Real> is_greater = mean.known & (mean.distance > on_surface.distance);
      on_surface.distance = is_greater ? mean.distance : on_surface.distance;
      on_surface.normal = choose(is_greater, mean.normal, on_surface.normal);
    }
    on_surface.foot = x - on_surface.distance * on_surface.normal;
    return on_surface;
  }

  // Return what is seen of a place by the cameras together: what one has seen is seen.
  VPM_HD Sight sight_at(const Vec3& x) const {
    const DepthSampler::ViewOf<double> view = view_of(x);
    return view.is_seen ? Sight::seen : view.is_in_image ? Sight::hole : Sight::out_of_view;
  }
  template <class Place>
  [[gnu::always_inline]] VPM_HD DepthSampler::ViewOf<RealOf<Place>> view_of(const Place& x) const {
    DepthSampler::ViewOf<RealOf<Place>> together;
    for (std::int32_t i = 0; i < count && !all(together.is_seen); ++i) {
      const auto [is_in_image, is_seen] = cameras[i].image.view_of(cameras[i].from_rig * x);
      together.is_in_image |= is_in_image;
      together.is_seen |= is_seen;
    }
    return together;
  }
  static VPM_HD Sight sight_of(const BallClass& in_ball) { return in_ball.sight; }

  // Classifies a ball. It is free where one camera has seen all of a ball free that is larger by
  // the distance within which readings are averaged: that camera's distances are then half of this
  // or more, bound or not, and no mean with one behind is behind. It is behind where it is so for
  // all cameras that see it.
  VPM_HD BallClass classify_ball(Vec3 center, double radius) const {
    BallClass in_ball;
    in_ball.center = center, in_ball.radius = radius;
    in_ball.margin = most_agreement * (greatest_depth(center) + radius);
    CameraSet deciding = 0, behind = 0, hidden = 0;
    Sight sight = Sight::out_of_view;
    bool is_whole = true;
    for (std::int32_t i = 0; i < count; ++i) {
      const DepthSurface& image = cameras[i].image;
      const Vec3 at = cameras[i].from_rig * center;
      const DepthSurface::BallClass own = class_of(image, at, radius);
      const Sight of_camera = DepthSurface::sight_of(own);
      if (of_camera == Sight::out_of_view) continue;
      if (own.side == Side::free && of_camera == Sight::seen && is_seen_free(image, at, in_ball))
        return free_ball(in_ball, Sight::seen);
      sight = joined(sight, of_camera);
      if (of_camera == Sight::hole) continue;
      const CameraSet bit = CameraSet{1} << i;
      in_ball.point |= bit;
      deciding |= own.side == Side::free ? 0 : bit;
      if (own.side == Side::behind) {
        behind |= bit;
        if (is_hidden(cameras[i], own, at, radius)) hidden |= bit;
        const double gap = image.largest_gap(own, at, radius) + in_ball.margin;
        in_ball.gap = gap < in_ball.gap ? gap : in_ball.gap;
      } else {
        is_whole = is_whole && image.may_be_flat(own);
      }
    }
    if (deciding == 0) return free_ball(in_ball, sight);
    in_ball.sight = Sight::mixed;
    in_ball.side = behind == in_ball.point ? Side::behind : Side::ambiguous;
    if (in_ball.side == Side::ambiguous) in_ball.point &= ~hidden;
    in_ball.is_whole = is_whole;
    return in_ball;
  }

  // Returns the side of a classified ball, of which a camera's own pixels may show all free.
  VPM_HD Side side_of(const BallClass& in_ball, Vec3 center, double radius) const {
    if (in_ball.side != Side::ambiguous) return in_ball.side;
    const double wider = radius + margin_of(in_ball);
    for (std::int32_t i = 0; i < count; ++i) {
      if ((in_ball.point >> i & 1) == 0) continue;
      const DepthSurface& image = cameras[i].image;
      const Vec3 at = cameras[i].from_rig * center;
      const DepthSurface::BallClass own = image.classify_ball(at, wider);
      if (image.may_be_flat(own) && image.side_of(own, at, wider) == Side::free) return Side::free;
    }
    return in_ball.side;
  }
  // True: the class of a ball holds for all balls in it.
  VPM_HD bool tells_of_parts(Vec3, double) const { return true; }
  // Leaves it to classify_ball() of the part.
  VPM_HD bool is_free_part(const BallClass& in_ball, Vec3, double) const {
    return in_ball.side == Side::free;
  }
  // Returns 0: each camera has its own depth.
  static VPM_HD float least_inverse_depth(const BallClass&) { return 0; }
  VPM_HD bool may_be_free(float least, Vec3 center, double radius) const {
    for (std::int32_t i = 0; i < count; ++i)
      if (cameras[i].image.may_be_free(least, cameras[i].from_rig * center, radius)) return true;
    return false;
  }
  VPM_HD bool may_hold_free(const BallClass& in_ball, Vec3 center, double radius) const {
    for (std::int32_t i = 0; i < count; ++i) {
      if ((in_ball.point >> i & 1) == 0) continue;
      const DepthSurface& image = cameras[i].image;
      const Vec3 at = cameras[i].from_rig * center;
      if (image.may_hold_free(image.classify_ball(at, radius), at, radius)) return true;
    }
    return false;
  }

  VPM_HD bool may_be_flat(const BallClass& in_ball) const { return in_ball.is_whole; }
  template <class Read>
  VPM_HD bool is_flat(const BallClass& in_ball, const Read& read, double tolerance,
                      TangentPlane& plane) const {
    const SurfaceSample on_surface = read();
    if (!on_surface.known) return false;
    plane = {on_surface.normal, on_surface.foot};
    return show(in_ball, plane, tolerance);
  }
  template <class SampleAll>
  VPM_HD bool mean_plane(const BallClass& in_ball, Vec3 center, double radius, double tolerance,
                         const SampleAll& sample_all, TangentPlane& plane) const {
    const View view{this, in_ball.point};
    return mean_of_five(view, center, radius, DepthSampler::kSmoothCosine, sample_all, plane) &&
           show(in_ball, plane, tolerance);
  }
  VPM_HD double largest_gap(const BallClass& in_ball, Vec3, double) const { return in_ball.gap; }

  template <class Shape>
  static VPM_HD double fraction_inside(const SurfaceSample& on_surface, Vec3, const Shape& shape) {
    return fraction_behind(shape, on_surface.distance, on_surface.normal);
  }

  // Returns the unit direction from a place x behind the surface to the nearest place that a camera
  // has seen free: that of the camera with the shortest way, averaged with those of cameras that
  // show the same surface there.
  template <class Place>
  [[gnu::always_inline]] VPM_HD Place
  closest_normal(const Place& x, const SurfaceSampleOf<RealOf<Place>>& on_surface) const {
    using Real = RealOf<Place>;
    RigReading<Real> ways[kMostCameras];
    std::int32_t names[kMostCameras];
    const std::int32_t found = find_ways(x, ways, names);
    const Real zero{};
    Real length = zero + HUGE_VAL, depth = zero;
    Place shortest = on_surface.normal;
    for (std::int32_t k = 0; k < found; ++k) {
      const MaskOf<Real> is_shorter = ways[k].known & (ways[k].distance < length);
      length = is_shorter ? ways[k].distance : length;
      shortest = choose(is_shorter, ways[k].normal, shortest);
      depth = ways[k].depth > depth ? ways[k].depth : depth;
    }
    Place direction{zero, zero, zero};
    for (std::int32_t k = 0; k < found; ++k) {
      const Real alike = likeness(ways[k].distance - length, most_agreement * depth,
                                  dot(ways[k].normal, shortest));
      direction = direction + (ways[k].known ? alike : zero) * ways[k].normal;
    }
    const MaskOf<Real> has_way = length < HUGE_VAL;
    return choose(has_way, normalized_or_zero(direction), shortest);
  }

  // True if a place is behind what two cameras see from sides that differ by more than 60 degrees:
  // then it is inside however deep it lies.
  VPM_HD bool is_seen_behind_from_sides(Vec3 x) const {
    Vec3 rays[kMostCameras];
    std::int32_t found = 0;
    for (std::int32_t i = 0; i < count; ++i) {
      const Vec3 at = cameras[i].from_rig * x;
      if (!is_behind_surface(cameras[i].image.sample(at))) continue;
      rays[found] = normalized_or_zero(cameras[i].to_rig.rotation * at);
      for (std::int32_t k = 0; k < found; ++k)
        if (dot(rays[k], rays[found]) < kOtherSide) return true;
      ++found;
    }
    return false;
  }

 private:
  static constexpr double kOtherSide = 0.5;     // cos 60 degrees
  static constexpr double kLeastCosine = 0.02;  // of incidence, for a reading's weight
  static constexpr double kSilhouetteWeight = 0.1;
  static constexpr double kRounding = 1 + 1e-9;         // far above what sums err by
  static constexpr double kUnlike = 0.5;                // cosines of normals of two surfaces,
  static constexpr double kAlike = 0.8660254037844387;  // and of one
  // A silhouette's direction is not taken where it has less than this part of the offset.
  static constexpr double kCornerCosine = 0.7;

  // Finds for each camera that knows of a place x behind the surface the nearest place that it has
  // seen free: as readings whose distance is the length of the way. Returns their number; those
  // whose tangent planes are much further away than another are left out.
  template <class Place>
  [[gnu::always_inline]] VPM_HD std::int32_t find_ways(const Place& x,
                                                       RigReading<RealOf<Place>>* ways,
                                                       std::int32_t* names) const {
    using Real = RealOf<Place>;
    constexpr double kMuchLonger = 2;  // times the way to the tangent plane of another camera
    std::int32_t found = 0;
    Real least = Real{} + HUGE_VAL, depth{};
    for (std::int32_t i = 0; i < count; ++i) {
      RigReading<Real>& way = ways[found];
      way = read(cameras[i], x);
      if (!any(way.known)) continue;
      way.distance = way.distance < 0 ? -way.distance : Real{};  // free, but for disagreement
      least = way.known & (way.distance < least) ? way.distance : least;
      depth = way.known & (way.depth > depth) ? way.depth : depth;
      names[found++] = i;
    }
    const Real most = kMuchLonger * least + most_agreement * depth;
    for (std::int32_t k = 0; k < found; ++k) {
      ways[k].known &= ways[k].distance <= most;
      if (any(ways[k].known & (ways[k].distance > 0))) search_way(cameras[names[k]], x, ways[k]);
    }
    return found;
  }
  // Searches the nearest place of the surface that a camera sees, and takes the way there for the
  // one that its tangent plane told, unless a silhouette is nearer.
  template <class Place>
  [[gnu::always_inline]] static VPM_HD void search_way(const RigCamera& camera, const Place& x,
                                                       RigReading<RealOf<Place>>& way) {
    using Real = RealOf<Place>;
    using Mask = MaskOf<Real>;
    const Place at = camera.from_rig * x;
    const SurfaceSampleOf<Real> seen =
        camera.image.sample_and(at, [](const IntOf<Real>&, const IntOf<Real>&) {});
    const FootSearch<Real> search = search_foot(camera.image, at, seen);
    const Real length = square_root(search.squared_distance());
    const Mask is_searched = way.known & (way.distance > 0);
    const Mask is_aside = way.below == 0;  // a silhouette
    const Mask is_taken = is_searched & (negated(is_aside) | (length < way.distance));
    way.distance = is_taken ? length : way.distance;
    way.normal = choose(is_taken, turned(camera.to_rig.rotation, search.normal()), way.normal);
  }

  // True if a plane about the middle of a ball is that which each camera that decides there sees.
  VPM_HD bool show(const BallClass& in_ball, const TangentPlane& plane, double tolerance) const {
    for (std::int32_t i = 0; i < count; ++i) {
      if ((in_ball.point >> i & 1) == 0) continue;
      const RigCamera& camera = cameras[i];
      const Vec3 at = camera.from_rig * in_ball.center;
      const SurfaceSample seen = camera.image.sample(at);
      const Vec3 normal = camera.from_rig.rotation * plane.normal;
      if (!seen.known || dot(seen.normal, normal) < DepthSampler::kSmoothCosine) return false;
      const double apart = dot(normal, seen.foot - camera.from_rig * plane.foot);
      if (!(std::fabs(apart) < in_ball.margin)) return false;
      if (!camera.image.shows(camera.image.classify_ball(at, in_ball.radius),
                              TangentPlane{normal, seen.foot}, tolerance))
        return false;
    }
    return true;
  }

  // Returns the class of a ball before one camera, decided by the plane at its middle too: samples
  // of a rig take many times as long.
  static VPM_HD DepthSurface::BallClass class_of(const DepthSurface& image, Vec3 at,
                                                 double radius) {
    DepthSurface::BallClass own = image.classify_ball(at, radius);
    own.side = image.side_by_plane(own, at, radius);
    return own;
  }
  // True if a camera has seen all of a larger ball free, so that no mean of readings in the ball is
  // behind the surface.
  static VPM_HD bool is_seen_free(const DepthSurface& image, Vec3 at, const BallClass& in_ball) {
    const DepthSurface::BallClass wider = class_of(image, at, in_ball.radius + in_ball.margin);
    return wider.side == Side::free && DepthSurface::sight_of(wider) == Sight::seen;
  }
  // True if a camera that has all of a ball behind what it sees has that well before each place in
  // it, and no silhouette beside.
  VPM_HD bool is_hidden(const RigCamera& camera, const DepthSurface::BallClass& own, Vec3 at,
                        double radius) const {
    const double nearest = at.z - radius, farthest = at.z + radius;
    return nearest - quotient(1, own.range.low) > kRounding * well_before * farthest &&
           !camera.silhouettes.may_be_near(own.pixels);
  }
  static VPM_HD BallClass free_ball(BallClass in_ball, Sight sight) {
    in_ball.side = Side::free;
    in_ball.sight = sight;
    return in_ball;
  }
  // Returns what is seen of a ball of which one camera sees this and others that; none of them has
  // it out of view, but the first at the start.
  static VPM_HD Sight joined(Sight so_far, Sight next) {
    if (so_far == Sight::seen || next == Sight::seen) return Sight::seen;
    if (so_far == Sight::mixed || next == Sight::mixed) return Sight::mixed;
    return Sight::hole;
  }
  // Returns by how much more than a ball a camera must have seen free: nothing where it is alone.
  static VPM_HD double margin_of(const BallClass& in_ball) {
    return (in_ball.point & (in_ball.point - 1)) == 0 ? 0 : in_ball.margin;
  }
  // Returns the greatest depth, m, that a place has to a camera; 0 if it is before none.
  VPM_HD double greatest_depth(const Vec3& x) const {
    double greatest = 0;
    for (std::int32_t i = 0; i < count; ++i) {
      const double depth = (cameras[i].from_rig * x).z;
      greatest = depth > greatest ? depth : greatest;
    }
    return greatest;
  }
  // True where a camera has something well before a place.
  template <class Real>
  [[gnu::always_inline]] VPM_HD MaskOf<Real> is_well_before(const RigReading<Real>& reading) const {
    return reading.below > well_before * reading.depth;
  }

  // Describes the surface that is nearest to a place, of those that cameras show.
  template <class Real>
  struct Nearest {
    Real length, distance;   // m; the first is not negative
    Real half_pixel;         // m, of its camera
    Real apart;              // m; readings further apart are of two surfaces
    MaskOf<Real> is_free{};  // where a camera has the place before its surface
    PlaceOf<Real> normal;
  };
  template <class Real>
  [[gnu::always_inline]] VPM_HD Nearest<Real> nearest_of(const RigReading<Real>* readings,
                                                         const std::int32_t* names,
                                                         std::int32_t found) const {
    const Real zero{};
    Nearest<Real> nearest{zero + HUGE_VAL, zero, zero, zero, {}, {zero, zero, zero}};
    Real depth = zero;
    for (std::int32_t k = 0; k < found; ++k) {
      const RigReading<Real>& reading = readings[k];
      const Real length = absolute(reading.distance);
      const MaskOf<Real> is_nearer = reading.known & (length < nearest.length);
      nearest.length = is_nearer ? length : nearest.length;
      nearest.distance = is_nearer ? reading.distance : nearest.distance;
      nearest.half_pixel = is_nearer ? half_pixel(reading, names[k]) : nearest.half_pixel;
      nearest.normal = choose(is_nearer, reading.normal, nearest.normal);
      nearest.is_free |= reading.known & (reading.distance > 0);
      depth = reading.known & (reading.depth > depth) ? reading.depth : depth;
    }
    nearest.apart = most_agreement * depth;
    return nearest;
  }
  // Returns half the width of a camera's pixel at the depth of a reading, m.
  template <class Real>
  [[gnu::always_inline]] VPM_HD Real half_pixel(const RigReading<Real>& reading,
                                                std::int32_t name) const {
    return 0.5 * agreement[name * count + name] * reading.depth;
  }
  // True where the greatest mean is surely more than `enough`: a camera has the place before its
  // surface, and no surface is so near that its reading, bound or not, is averaged with one behind.
  template <class Real>
  [[gnu::always_inline]] static VPM_HD MaskOf<Real> is_clearly_before(const Nearest<Real>& nearest,
                                                                      const Real& enough) {
    return nearest.is_free & (nearest.length > kRounding * enough) &
           (2 * nearest.length > kRounding * nearest.apart);
  }

  // Bounds how far a place is from what each camera has not seen free: no further than the nearest
  // surface that another camera shows, but for half a pixel of that, unless this one sees free
  // space there too. Without this a camera that looks along a face would tell the distance to what
  // is beyond the face, and that be the greatest.
  template <class Place>
  [[gnu::always_inline]] VPM_HD void bound_free_distances(const Place& x,
                                                          const Nearest<RealOf<Place>>& nearest,
                                                          RigReading<RealOf<Place>>* readings,
                                                          const std::int32_t* names,
                                                          std::int32_t found) const {
    using Real = RealOf<Place>;
    using Mask = MaskOf<Real>;
    for (std::int32_t i = 0; i < found; ++i) {
      RigReading<Real>& reading = readings[i];
      const Mask is_further =
          reading.known & (reading.distance > nearest.length + nearest.half_pixel);
      if (!any(is_further)) continue;
      // Half a pixel below the surface, since a camera may see past its border by as much.
      const Real below = nearest.distance + half_pixel(reading, names[i]);
      const RigCamera& camera = cameras[names[i]];
      const Place at = camera.from_rig * (x - below * nearest.normal);
      const SurfaceSampleOf<Real> seen =
          camera.image.sample_and(at, [](const IntOf<Real>&, const IntOf<Real>&) {});
      const Mask is_bound = is_further & negated(seen.known & (seen.foot.z > at.z));
      reading.distance = is_bound ? nearest.length : reading.distance;
      reading.normal = choose(is_bound, nearest.normal, reading.normal);
      reading.weight = is_bound ? kSilhouetteWeight * reading.weight : reading.weight;
    }
  }

  // Returns how much readings whose distances differ by this, m, and normals by this cosine, are of
  // one surface: 1 if they are equal.
  template <class Real>
  [[gnu::always_inline]] static VPM_HD Real likeness(const Real& apart, const Real& agreement,
                                                     const Real& cosine) {
    const Real zero{}, part = quotient(apart, agreement), rest = 1 - part * part;
    const Real near = rest > 0 ? rest : zero;
    const Real along = (cosine - kUnlike) * (1 / (kAlike - kUnlike));
    const Real low = along < 0 ? zero : along, one = zero + 1;
    const Real turned = low > 1 ? one : low;
    return near * near * (turned * turned * (3 - 2 * turned));
  }

  // Replaces a reading by the mean of those that are of its surface.
  template <class Real>
  [[gnu::always_inline]] VPM_HD void average(const RigReading<Real>* readings,
                                             const std::int32_t* names, std::int32_t found,
                                             std::int32_t own, RigReading<Real>& mean) const {
    Real weight = mean.weight, sum = mean.weight * mean.distance;
    PlaceOf<Real> direction = mean.weight * mean.normal;
    MaskOf<Real> has_others{};
    for (std::int32_t j = 0; j < found; ++j) {
      if (j == own) continue;
      const Real depth = readings[j].depth > mean.depth ? readings[j].depth : mean.depth;
      const Real apart = readings[j].distance - mean.distance,
                 most = agreement[names[own] * count + names[j]] * depth;
      if (!any(mean.known & (absolute(apart) < most))) continue;
      const Real alike = likeness(apart, most, dot(readings[j].normal, mean.normal));
      const Real counts = alike * readings[j].weight;
      const MaskOf<Real> is_one = mean.known & (counts > 0);
      if (!any(is_one)) continue;
      has_others |= is_one;
      weight = weight + counts;
      sum = sum + counts * readings[j].distance;
      direction = direction + counts * readings[j].normal;
    }
    if (!any(has_others)) return;
    mean.distance = has_others ? sum / weight : mean.distance;
    mean.normal = choose(has_others, normalized_or_zero(direction), mean.normal);
  }

  // Returns what an image tells of a place.
  template <class Place>
  [[gnu::always_inline]] static VPM_HD RigReading<RealOf<Place>> read(const RigCamera& camera,
                                                                      const Place& x) {
    using Real = RealOf<Place>;
    const Place at = camera.from_rig * x;
    IntOf<Real> nearest{};
    const SurfaceSampleOf<Real> seen = camera.image.sample_and(
        at, [&](const IntOf<Real>& u, const IntOf<Real>& v)
                __attribute__((always_inline)) { nearest = v * camera.image.width + u; });
    RigReading<Real> reading;
    reading.known = seen.known;
    if (!any(seen.known)) return reading;
    const Real zero{}, length = square_root(squared_norm(at));
    const Real steep = quotient(-dot(widen(gather(camera.image.normals, nearest)), at), length);
    const Real cosine = steep > kLeastCosine ? steep : zero + kLeastCosine;
    reading.distance = seen.known ? seen.distance : zero;
    reading.depth = at.z;
    reading.below = at.z - seen.foot.z;
    reading.weight = cosine * cosine;
    reading.normal = choose(seen.known, seen.normal, Place{zero, zero, zero});
    read_silhouette(camera, at, length, nearest, reading);
    // What has smaller pixels, or is nearer, is seen better.
    const Real per_metre = quotient(camera.image.k.fx, seen.foot.z);
    const Real rows_per_metre = quotient(camera.image.k.fy, seen.foot.z);
    reading.weight = seen.known ? reading.weight * (per_metre * rows_per_metre) : zero;
    reading.normal = turned(camera.to_rig.rotation, reading.normal);
    return reading;
  }
  template <class Place>
  [[gnu::always_inline]] static VPM_HD Place turned(const Rotation& r, const Place& v) {
    return {dot(r.row0, v), dot(r.row1, v), dot(r.row2, v)};
  }

  // Takes the nearest silhouette for the surface where that is nearer to a place at this distance
  // from the camera: from a free place, the side of what hides what is beyond; from a place behind,
  // the way out to what was seen beyond it.
  template <class Place>
  [[gnu::always_inline]] static VPM_HD void read_silhouette(const RigCamera& camera,
                                                            const Place& at,
                                                            const RealOf<Place>& length,
                                                            const IntOf<RealOf<Place>>& nearest,
                                                            RigReading<RealOf<Place>>& reading) {
    using Real = RealOf<Place>;
    using Mask = MaskOf<Real>;
    const IntOf<Real> number = gather(camera.silhouettes.nearest, nearest);
    const Mask is_beside = reading.known & widen_mask(number > 0);
    if (!any(is_beside)) return;
    const auto get = [&](float SilhouettePixel::*member) __attribute__((always_inline)) {
      return gather(number, [&](std::int32_t k) {
        return k > 0 ? camera.silhouettes.pixels[k - 1].*member : 1.0F;
      });
    };
    const Real zero{}, one = zero + 1, per_depth = quotient(1, at.z);
    const Intrinsics& k = camera.image.k;
    const Real u = k.fx * (at.x * per_depth) + k.cx - get(&SilhouettePixel::u);
    // Offsets in widths of a pixel.
    const double height = k.fx / k.fy;
    const Real v = (k.fy * (at.y * per_depth) + k.cy - get(&SilhouettePixel::v)) * height;
    const Real depth = get(&SilhouettePixel::depth);
    Real out_u = get(&SilhouettePixel::out_u), out_v = get(&SilhouettePixel::out_v);
    const Real offset = square_root(u * u + v * v), along = u * out_u + v * out_v;
    const Mask is_behind = reading.distance < 0;
    const Real side = is_behind ? -one : one;
    // At the corner of a silhouette, or beside something thin, the nearest pixel's direction is
    // wrong: the direction is that from the pixel to the place.
    const Mask is_corner = (side * along < kCornerCosine * offset) & (offset > 1);
    const Real by = offset > 1 ? offset : one;
    out_u = is_corner ? quotient(side * u, by) : out_u;
    out_v = is_corner ? quotient(side * v, by) : out_v;
    const Real to_border = 0.5 * (1 + (height - 1) * (out_v * out_v));  // of the pixel
    const Real aside = ((is_corner ? side * offset : along) - to_border) * at.z * (1 / k.fx);
    // The pixel of the place is on the far side if its surface is a step beyond the silhouette.
    const Mask is_far =
        camera.image.inverse_depth(nearest, IntOf<Real>{}) * depth < 1 - DepthSampler::kJump;
    const Real before = aside > 0 ? aside : zero, deeper = depth - at.z;
    const Real below = deeper > 0 ? deeper : zero;
    const Real to_side = square_root(before * before + below * below);
    const Real to_beyond = aside < 0 ? aside : zero;
    const Mask is_nearer = is_beside & negated(is_behind) & is_far & (to_side < reading.distance);
    const Mask is_way = is_beside & is_behind & negated(is_far) &
                        (get(&SilhouettePixel::beyond) > at.z) & (to_beyond > reading.distance);
    const Mask is_taken = is_nearer | is_way;
    if (!any(is_taken)) return;
    reading.distance = is_nearer ? to_side : is_way ? to_beyond : reading.distance;
    reading.weight = is_taken ? zero + kSilhouetteWeight : reading.weight;
    reading.below = is_way ? zero : reading.below;
    const Place ray{quotient(at.x, length), quotient(at.y, length), quotient(at.z, length)};
    const Place out{out_u, out_v, zero};
    reading.normal =
        choose(is_taken, normalized_or_zero(out - dot(out, ray) * ray), reading.normal);
  }
};

}  // namespace vpm
