// Samples the surface that several cameras see together: a rig, whose images may show the same
// thing. README.md has the reasons.
//
// Each image gives a signed distance at a place (rig_reading.h). Readings of one surface (normals
// alike, distances within what the images disagree by) are averaged, and then the greatest counts:
// what one camera clearly saw free is free. One text serves one place and four
// (core/vector_width.h).
#pragma once

#include "libvpm/scene/depth/depth_nearest.h"
#include "libvpm/scene/rig/rig_reading.h"

namespace vpm {

// Names cameras of a rig by their bits. Where searches in other bodies begin at a point, those in a
// rig ask a set of cameras, so that kNoPoint stands for all.
using CameraSet = std::uint32_t;

// Holds plain pointers to a rig's data, for host or device.
struct RigSampler {
  static constexpr int kMostCameras = 16;

  const RigCamera* cameras = nullptr;
  // At i * count + j: how far readings of cameras i and j may be apart and still be of one surface,
  // in parts of the place's depth (RigAgreement); for i = j the width of the camera's pixels.
  const double* agreement = nullptr;
  std::int32_t count = 0;
  double most_agreement = 0;  // the greatest of these
  double well_before = 0;     // per depth: what hides a place by more tells less than other cameras

  VPM_HD CameraSet all_cameras() const { return (CameraSet{1} << count) - 1; }

  // Samples the surface as these cameras see it, which are those that decide in a ball about x; as
  // all do where each of them has something well before x, or none knows of x. Where x is surely
  // more than `enough`, m, before the surface, only that is told: any such distance. So it is where
  // x is surely more than `enough` behind the surface, and less than `deepest`, m.
  template <class Place>
  [[gnu::always_inline]] VPM_HD SurfaceSampleOf<RealOf<Place>> sample_near(
      const Place& x, CameraSet some, const RealOf<Place>& enough, double deepest = 0) const {
    using Real = RealOf<Place>;
    SurfaceSampleOf<Real> sampled;
    MaskOf<Real> is_decided{};
    // Asks `some` cameras first, and all where these leave a place open. By a loop, since
    // sample_by() is inlined: with two calls the compiler would take twice as long.
    for (CameraSet asked = some;; asked = all_cameras()) {
      const MaskOf<Real> is_taken = is_decided;
      const SurfaceSampleOf<Real> found = sample_by(x, asked, enough, deepest, is_decided);
      sampled.known = (is_taken & sampled.known) | (negated(is_taken) & found.known);
      sampled.distance = is_taken ? sampled.distance : found.distance;
      sampled.normal = choose(is_taken, sampled.normal, found.normal);
      sampled.foot = choose(is_taken, sampled.foot, found.foot);
      if (asked == all_cameras() || all(is_decided)) return sampled;
    }
  }

  // Samples the surface as these cameras see it. A reading from well before x counts only where
  // there is no other; `is_decided` receives where there is one.
  template <class Place>
  [[gnu::always_inline]] VPM_HD SurfaceSampleOf<RealOf<Place>> sample_by(
      const Place& x, CameraSet some, const RealOf<Place>& enough, double deepest,
      MaskOf<RealOf<Place>>& is_decided) const {
    using Real = RealOf<Place>;
    RigReading<Real> readings[kMostCameras];
    SurfaceSampleOf<Real> on_surface;
    Knowledge<Real> knowledge;
    const std::int32_t found = read_all(x, some, readings, knowledge);
    is_decided = knowledge.is_decided;
    if (found == 0) return on_surface;
    Nearest<Real> nearest = nearest_of(readings, found);
    const MaskOf<Real> is_clear =
        is_clearly_before(nearest, enough) | is_clearly_behind(nearest, enough, deepest);
    // Most places with fits need none.
    if (any(nearest.has_fits) &&
        any((knowledge.is_measured | nearest.has_fits) & negated(is_clear))) {
      settle_fits(x, some == all_cameras(), readings, found, knowledge);
      nearest = nearest_of(readings, found);
    }
    on_surface.known = knowledge.is_measured | knowledge.is_fitted;
    // Behind a fit where nobody has measured anything, its normal is the way out.
    const MaskOf<Real> is_behind =
        negated(knowledge.is_fitted) & is_clearly_behind(nearest, enough, deepest);
    if (all(negated(on_surface.known) | is_clearly_before(nearest, enough) | is_behind)) {
      on_surface.distance = is_behind ? nearest.greatest : nearest.length;
    } else {
      weigh(x, nearest, readings, found);
      bound_free_distances(x, nearest, readings, found);
      take_greatest(readings, found, nearest.apart, on_surface);
      on_surface.foot = x - on_surface.distance * on_surface.normal;
    }
    // What lies before a fit where nobody has measured anything was not seen free.
    on_surface.known &= knowledge.is_measured | (on_surface.distance < enough);
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

  // Returns the unit direction from a place x behind the surface to the nearest place that a camera
  // has seen free: that of the camera with the shortest way, averaged with those of cameras that
  // show the same surface there.
  template <class Place>
  [[gnu::always_inline]] VPM_HD Place
  closest_normal(const Place& x, const SurfaceSampleOf<RealOf<Place>>& on_surface) const {
    using Real = RealOf<Place>;
    RigReading<Real> ways[kMostCameras];
    const std::int32_t found = find_ways(x, ways);
    const Real zero{};
    Real length = zero + HUGE_VAL, depth = zero;
    Place shortest = on_surface.normal;
    for (std::int32_t k = 0; k < found; ++k) {
      const MaskOf<Real> is_shorter = ways[k].known & (ways[k].distance < length);
      length = is_shorter ? ways[k].distance : length;
      shortest = choose(is_shorter, ways[k].normal, shortest);
      depth = ways[k].known & (ways[k].depth > depth) ? ways[k].depth : depth;
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
  static constexpr double kOtherSide = 0.5;             // cos 60 degrees
  static constexpr double kRounding = 1 + 1e-9;         // far above what sums err by
  static constexpr double kUnlike = 0.5;                // cosines of normals of two surfaces,
  static constexpr double kAlike = 0.8660254037844387;  // and of one

  // Tells which of several places cameras have measured something about.
  template <class Real>
  struct Knowledge {
    MaskOf<Real> is_measured{};  // a camera has measured something on the ray of the place
    MaskOf<Real> is_decided{};   // and that is not well before the place
    MaskOf<Real> is_fitted{};    // where none is: the fit of a hole tells
  };

  // Reads these cameras. Returns the number of those that know of a place. Where one has nothing
  // well before the place, those that have are left out.
  template <class Place>
  [[gnu::always_inline]] VPM_HD std::int32_t read_all(const Place& x, CameraSet some,
                                                      RigReading<RealOf<Place>>* readings,
                                                      Knowledge<RealOf<Place>>& knowledge) const {
    std::int32_t found = 0;
    for (std::int32_t i = 0; i < count; ++i) {
      if ((some >> i & 1) == 0) continue;
      RigReading<RealOf<Place>>& reading = readings[found];
      RigReader::read(cameras[i], x, reading);
      if (!any(reading.known)) continue;
      reading.camera = i;
      knowledge.is_measured |= reading.is_measured;
      knowledge.is_decided |= reading.is_measured & negated(is_well_before(reading));
      ++found;
    }
    leave_out_hidden(knowledge.is_decided, readings, found);
    return found;
  }
  template <class Real>
  [[gnu::always_inline]] VPM_HD void leave_out_hidden(const MaskOf<Real>& is_decided,
                                                      RigReading<Real>* readings,
                                                      std::int32_t found) const {
    for (std::int32_t k = 0; k < found; ++k)
      readings[k].known &= negated(is_decided & is_well_before(readings[k]));
  }
  // Takes fits of holes for measured where no camera has decided, if all were asked. Elsewhere a
  // fit tells of places before it only, where a camera has measured something.
  template <class Place>
  [[gnu::always_inline]] VPM_HD void settle_fits(const Place& x, bool are_all,
                                                 RigReading<RealOf<Place>>* readings,
                                                 std::int32_t found,
                                                 Knowledge<RealOf<Place>>& knowledge) const {
    using Real = RealOf<Place>;
    using Mask = MaskOf<Real>;
    const Mask none{}, is_open = are_all ? negated(knowledge.is_decided) : none;
    Mask is_decided{};
    for (std::int32_t k = 0; k < found; ++k) {
      RigReading<Real>& fit = readings[k];
      const Mask is_fit = fit.known & negated(fit.is_measured);
      if (!any(is_fit)) continue;
      const Mask is_before = is_fit & knowledge.is_measured & (fit.distance > 0);
      fit.distance = is_before ? fit.distance - fit.nearer : fit.distance;
      fit.known &=
          negated(is_fit) | (is_before & (fit.distance > 0)) | (negated(is_before) & is_open);
      leave_out_contradicted(x, is_fit & fit.known, k, readings, found);
      const Mask is_taken = is_fit & fit.known & is_open;
      knowledge.is_fitted |= is_taken;
      is_decided |= is_taken & negated(is_well_before(fit));
    }
    if (!any(knowledge.is_fitted)) return;
    for (std::int32_t k = 0; k < found; ++k) readings[k].is_measured |= readings[k].known & is_open;
    leave_out_hidden(is_decided, readings, found);
  }
  // Leaves out a fit before which a place lies where another camera shows a surface that the fit's
  // camera would see past: it has not measured something there.
  template <class Place>
  [[gnu::always_inline]] VPM_HD void leave_out_contradicted(const Place& x,
                                                            const MaskOf<RealOf<Place>>& is_fit,
                                                            std::int32_t k,
                                                            RigReading<RealOf<Place>>* readings,
                                                            std::int32_t found) const {
    using Real = RealOf<Place>;
    RigReading<Real>& fit = readings[k];
    for (std::int32_t j = 0; j < found; ++j) {
      const RigReading<Real>& other = readings[j];
      const MaskOf<Real> is_behind =
          is_fit & (fit.distance > 0) & other.known & other.is_measured & (other.distance < 0);
      if (!any(is_behind)) continue;
      const RigCamera& camera = cameras[other.camera];
      const Place at = camera.from_rig * x;
      const Place foot = camera.to_rig * (quotient(other.foot_depth, at.z) * at);
      RigReading<Real> there{};
      RigReader::read(cameras[fit.camera], foot, there);
      const Real most = agreement[fit.camera * count + other.camera] * fit.depth + there.nearer;
      fit.known &= negated(is_behind & there.known & (there.distance > most));
    }
  }
  // True where a camera has something well before a place.
  template <class Real>
  [[gnu::always_inline]] VPM_HD MaskOf<Real> is_well_before(const RigReading<Real>& reading) const {
    return reading.below > well_before * reading.depth;
  }

  // Describes the surface that is nearest to a place, of those that cameras show.
  template <class Real>
  struct Nearest {
    Real length, distance;        // m; the first is not negative
    Real greatest;                // m, of all distances
    Real half_pixel;              // m, of its camera
    Real apart;                   // m; readings further apart are of two surfaces
    MaskOf<Real> is_free{};       // where a camera has the place before its surface
    MaskOf<Real> is_seen_free{};  // and that is no silhouette
    MaskOf<Real> has_fits{};      // where one reads the fit of a hole
    PlaceOf<Real> normal;         // set by weigh()
  };
  template <class Real>
  [[gnu::always_inline]] VPM_HD Nearest<Real> nearest_of(const RigReading<Real>* readings,
                                                         std::int32_t found) const {
    const Real zero{};
    Nearest<Real> nearest{zero + HUGE_VAL,   zero, zero - HUGE_VAL, zero, zero, {}, {}, {},
                          {zero, zero, zero}};
    Real depth = zero;
    for (std::int32_t k = 0; k < found; ++k) {
      const RigReading<Real>& reading = readings[k];
      const Real length = absolute(reading.distance);
      const MaskOf<Real> is_measured = reading.known & reading.is_measured;
      const MaskOf<Real> is_nearer = is_measured & (length < nearest.length);
      nearest.length = is_nearer ? length : nearest.length;
      nearest.distance = is_nearer ? reading.distance : nearest.distance;
      nearest.half_pixel = is_nearer ? half_pixel(reading) : nearest.half_pixel;
      nearest.greatest =
          is_measured & (reading.distance > nearest.greatest) ? reading.distance : nearest.greatest;
      const MaskOf<Real> is_free = is_measured & (reading.distance > 0);
      nearest.is_free |= is_free;
      nearest.is_seen_free |= is_free & negated(reading.is_silhouette);
      nearest.has_fits |= reading.known & negated(reading.is_measured);
      depth = reading.known & (reading.depth > depth) ? reading.depth : depth;
    }
    nearest.apart = most_agreement * depth;
    return nearest;
  }
  // Returns half the width of a camera's pixel at the depth of a reading, m.
  template <class Real>
  [[gnu::always_inline]] VPM_HD Real half_pixel(const RigReading<Real>& reading) const {
    return 0.5 * agreement[reading.camera * count + reading.camera] * reading.depth;
  }
  // True where the greatest mean is surely more than `enough`: a camera has the place before its
  // surface, and no surface is so near that its reading, bound or not, is averaged with one behind.
  // Fits of holes are averaged with silhouettes however near they are, but not with what is seen.
  template <class Real>
  [[gnu::always_inline]] static VPM_HD MaskOf<Real> is_clearly_before(const Nearest<Real>& nearest,
                                                                      const Real& enough) {
    const MaskOf<Real> is_free =
        nearest.is_seen_free | (nearest.is_free & negated(nearest.has_fits));
    return is_free & (nearest.length > kRounding * enough) &
           (2 * nearest.length > kRounding * nearest.apart);
  }

  // True where all means are surely less than -`enough`, and the greatest, which is within `apart`
  // of the greatest reading that it holds, is surely more than -`deepest`.
  template <class Real>
  [[gnu::always_inline]] static VPM_HD MaskOf<Real> is_clearly_behind(const Nearest<Real>& nearest,
                                                                      const Real& enough,
                                                                      double deepest) {
    return negated(nearest.has_fits) & (nearest.greatest < -(kRounding * enough)) &
           (nearest.greatest - kRounding * nearest.apart > -deepest);
  }

  // Weighs those readings that may be of the nearest surface, or of that whose mean is the
  // greatest, leaves out the others, and sets the nearest normal. A mean is within `apart` of each
  // reading that it holds, so the greatest is no less than the greatest distance, bound or not,
  // less `apart`; it holds no reading that is less than that distance by three times as much.
  template <class Place>
  [[gnu::always_inline]] VPM_HD void weigh(const Place& x, Nearest<RealOf<Place>>& nearest,
                                           RigReading<RealOf<Place>>* readings,
                                           std::int32_t found) const {
    using Real = RealOf<Place>;
    const Real bound = nearest.greatest < nearest.length ? nearest.greatest : nearest.length;
    const Real least = bound - 3 * kRounding * nearest.apart;
    MaskOf<Real> has_normal{};
    for (std::int32_t k = 0; k < found; ++k) {
      RigReading<Real>& reading = readings[k];
      const MaskOf<Real> is_nearest = reading.known & reading.is_measured &
                                      (absolute(reading.distance) == nearest.length) &
                                      negated(has_normal);
      reading.known &= is_nearest | (reading.distance > least);
      if (!any(reading.known)) continue;
      RigReader::weigh(cameras[reading.camera], x, reading);
      nearest.normal = choose(is_nearest, reading.normal, nearest.normal);
      has_normal |= is_nearest;
    }
  }

  // Bounds how far a place is from what each camera has not seen free: no further than the nearest
  // surface that another camera shows, but for half a pixel of that, unless this one sees free
  // space there too. Otherwise a camera that looks along a face would tell how far it is to what
  // lies beyond the face, and as the greatest distance that would count.
  template <class Place>
  [[gnu::always_inline]] VPM_HD void bound_free_distances(const Place& x,
                                                          const Nearest<RealOf<Place>>& nearest,
                                                          RigReading<RealOf<Place>>* readings,
                                                          std::int32_t found) const {
    using Real = RealOf<Place>;
    using Mask = MaskOf<Real>;
    for (std::int32_t k = 0; k < found; ++k) {
      RigReading<Real>& reading = readings[k];
      const Mask is_further =
          reading.known & (reading.distance > nearest.length + nearest.half_pixel);
      if (!any(is_further)) continue;
      // Half a pixel below the surface, since a camera may see past its border by as much.
      const Real below = nearest.distance + half_pixel(reading);
      const RigCamera& camera = cameras[reading.camera];
      const Place at = camera.from_rig * (x - below * nearest.normal);
      const SurfaceSampleOf<Real> seen =
          camera.image.sample_and(at, [](const IntOf<Real>&, const IntOf<Real>&) {});
      const Mask is_bound = is_further & negated(seen.known & (seen.foot.z > at.z));
      reading.distance = is_bound ? nearest.length : reading.distance;
      reading.normal = choose(is_bound, nearest.normal, reading.normal);
      reading.weight = is_bound ? RigReader::kSilhouetteWeight * reading.weight : reading.weight;
    }
  }

  // Takes the mean that is the greatest, and its normal.
  template <class Real>
  [[gnu::always_inline]] VPM_HD void take_greatest(const RigReading<Real>* readings,
                                                   std::int32_t found, const Real& apart,
                                                   SurfaceSampleOf<Real>& on_surface) const {
    on_surface.distance = Real{} - HUGE_VAL;
    for (std::int32_t k = 0; k < found; ++k) {
      const RigReading<Real>& reading = readings[k];
      if (!any(reading.known & (reading.distance + kRounding * apart > on_surface.distance)))
        continue;  // its mean is not the greatest
      const Mean<Real> mean = mean_about(readings, found, k);
      const MaskOf<Real> is_greater = reading.known & (mean.distance > on_surface.distance);
      on_surface.distance = is_greater ? mean.distance : on_surface.distance;
      on_surface.normal = choose(is_greater, mean.normal, on_surface.normal);
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

  // Holds the mean of readings of one surface.
  template <class Real>
  struct Mean {
    Real distance;
    PlaceOf<Real> normal;
  };
  // Returns the mean of those readings that are of the surface of one.
  template <class Real>
  [[gnu::always_inline]] VPM_HD Mean<Real> mean_about(const RigReading<Real>* readings,
                                                      std::int32_t found, std::int32_t k) const {
    const RigReading<Real>& own = readings[k];
    Real weight = own.weight, sum = own.weight * own.distance;
    PlaceOf<Real> direction = own.weight * own.normal;
    MaskOf<Real> has_others{};
    for (std::int32_t j = 0; j < found; ++j) {
      if (j == k) continue;
      const RigReading<Real>& other = readings[j];
      const Real depth = other.depth > own.depth ? other.depth : own.depth;
      const Real apart = other.distance - own.distance,
                 most = agreement[own.camera * count + other.camera] * depth;
      if (!any(own.known & other.known & (absolute(apart) < most))) continue;
      const Real alike = likeness(apart, most, dot(other.normal, own.normal));
      // A silhouette ends what its camera hides; the surface may lie deeper, as one that is seen
      // tells better.
      const MaskOf<Real> is_told = own.is_silhouette | negated(other.is_silhouette);
      const Real counts = is_told ? alike * other.weight : Real{};
      const MaskOf<Real> is_one = own.known & (counts > 0);
      if (!any(is_one)) continue;
      has_others |= is_one;
      weight = weight + counts;
      sum = sum + counts * other.distance;
      direction = direction + counts * other.normal;
    }
    if (!any(has_others)) return {own.distance, own.normal};
    return {has_others ? sum / weight : own.distance,
            choose(has_others, normalized_or_zero(direction), own.normal)};
  }

  // Finds for each camera that knows of a place x behind the surface the nearest place that it has
  // seen free: as readings whose distance is the length of the way. Returns their number; those
  // whose tangent planes are much further away than another are left out.
  template <class Place>
  [[gnu::always_inline]] VPM_HD std::int32_t find_ways(const Place& x,
                                                       RigReading<RealOf<Place>>* ways) const {
    using Real = RealOf<Place>;
    constexpr double kMuchLonger = 2;  // times the way to the tangent plane of another camera
    std::int32_t found = 0;
    Real least = Real{} + HUGE_VAL, depth{};
    for (std::int32_t i = 0; i < count; ++i) {
      RigReading<Real>& way = ways[found];
      RigReader::read_measured(cameras[i], x, way);
      if (!any(way.known)) continue;
      way.distance = way.distance < 0 ? -way.distance : Real{};  // free, but for disagreement
      least = way.known & (way.distance < least) ? way.distance : least;
      depth = way.known & (way.depth > depth) ? way.depth : depth;
      way.normal = RigReader::turned(cameras[i].to_rig.rotation, way.normal);
      way.camera = i;
      ++found;
    }
    const Real most = kMuchLonger * least + most_agreement * depth;
    for (std::int32_t k = 0; k < found; ++k) {
      ways[k].known &= ways[k].distance <= most;
      if (any(ways[k].known & (ways[k].distance > 0)))
        search_way(cameras[ways[k].camera], x, ways[k]);
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
    way.normal =
        choose(is_taken, RigReader::turned(camera.to_rig.rotation, search.normal()), way.normal);
  }
};

}  // namespace vpm
