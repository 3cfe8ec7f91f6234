// Tells what one camera of a rig knows of a place, or of four: the signed distance to what it sees
// on the ray of the place, where a silhouette is read as a surface too. README.md has the reasons.
#pragma once

#include "libvpm/core/pose.h"
#include "libvpm/scene/body.h"
#include "libvpm/scene/depth/depth_surface.h"
#include "libvpm/scene/rig/silhouettes.h"

namespace vpm {

struct RigCamera {
  DepthSurface image;
  Silhouettes silhouettes;
  Pose from_rig, to_rig;  // maps the rig's frame to the camera's, and back
};

// Holds what one image tells of a place, or of four. Nothing is set by default: many readings are
// reserved, and few used.
template <class Real>
struct RigReading {
  MaskOf<Real> known;          // nothing else means anything where it is false
  MaskOf<Real> is_measured;    // false: the distance is that to the fit of a hole
  MaskOf<Real> is_silhouette;  // the distance is that to a silhouette, or to a fit
  Real distance;               // m, signed as in SurfaceSampleOf; 0 where not known
  Real nearer;      // m, by which a fit's surface may be nearer than it; set where there are fits
  Real depth;       // m, of the place
  Real foot_depth;  // m, of what is on its ray
  Real below;       // m, by which the place is deeper than that; 0 if aside
  Real weight;      // set by weigh(); 0 where not known
  PlaceOf<Real> normal;  // unit, into free space: the camera's frame, the rig's after weigh()
  IntOf<Real> pixel;     // index of the nearest one
  std::int32_t camera;   // index in the rig
};

// Reads an image, and its silhouettes. All members are functions of one camera and a place x, in
// the rig's frame.
struct RigReader {
  // Reads what a camera's image tells of a place. The weight, which few readings need, is left to
  // weigh().
  template <class Place>
  [[gnu::always_inline]] static VPM_HD void read(const RigCamera& camera, const Place& x,
                                                 RigReading<RealOf<Place>>& reading) {
    read_measured(camera, x, reading);
    if (camera.silhouettes.holes.numbers == nullptr) return;
    reading.nearer = RealOf<Place>{};
    if (!all(reading.is_measured)) read_hole(camera, camera.from_rig * x, reading);
  }

  // Reads that where the camera has measured something; elsewhere nothing is known.
  template <class Place>
  [[gnu::always_inline]] static VPM_HD void read_measured(const RigCamera& camera, const Place& x,
                                                          RigReading<RealOf<Place>>& reading) {
    using Real = RealOf<Place>;
    const Place at = camera.from_rig * x;
    const SurfaceSampleOf<Real> seen =
        camera.image.sample_and(at, [](const IntOf<Real>&, const IntOf<Real>&) {});
    const Real zero{};
    reading.known = reading.is_measured = seen.known;
    reading.is_silhouette = MaskOf<Real>{};
    reading.distance = seen.known ? seen.distance : zero;
    reading.depth = at.z;
    reading.foot_depth = seen.known ? seen.foot.z : zero;
    reading.below = seen.known ? at.z - seen.foot.z : zero;
    reading.normal = choose(seen.known, seen.normal, Place{zero, zero, zero});
    reading.pixel = static_cast<IntOf<Real>>(seen.point);
    if (any(seen.known)) read_silhouette(camera, at, reading);
  }

  // Sets the weight of a reading, and turns its normal into the rig's frame.
  template <class Place>
  [[gnu::always_inline]] static VPM_HD void weigh(const RigCamera& camera, const Place& x,
                                                  RigReading<RealOf<Place>>& reading) {
    using Real = RealOf<Place>;
    const Place at = camera.from_rig * x;
    const Real zero{}, length = square_root(squared_norm(at));
    const Real steep =
        quotient(-dot(widen(gather(camera.image.normals, reading.pixel)), at), length);
    const Real cosine = steep > kLeastCosine ? steep : zero + kLeastCosine;
    const Real weight = reading.is_silhouette ? zero + kSilhouetteWeight : cosine * cosine;
    // What has smaller pixels, or is nearer, is seen better.
    const Real per_metre = quotient(camera.image.k.fx, reading.foot_depth);
    const Real rows_per_metre = quotient(camera.image.k.fy, reading.foot_depth);
    reading.weight = reading.known ? weight * (per_metre * rows_per_metre) : zero;
    reading.normal = turned(camera.to_rig.rotation, reading.normal);
  }
  template <class Place>
  [[gnu::always_inline]] static VPM_HD Place turned(const Rotation& r, const Place& v) {
    return {dot(r.row0, v), dot(r.row1, v), dot(r.row2, v)};
  }

  static constexpr double kSilhouetteWeight = 0.1;

 private:
  static constexpr double kLeastCosine = 0.02;  // of incidence, for a reading's weight
  // A silhouette's direction is not taken where it has less than this part of the offset.
  static constexpr double kCornerCosine = 0.7;

  // Holds the silhouette pixel that is nearest to a place in the image, or those of four places,
  // and how far the place is from it, in widths of a pixel.
  template <class Real>
  struct Beside {
    IntOf<Real> index;        // of the silhouette's pixels
    Real u, v, offset;        // the last is the length of the others
    double height;            // of a pixel
    MaskOf<Real> may_matter;  // the silhouette may be nearer than the surface that was read
  };

  // Takes the surface that goes on in a hole for what is measured there.
  template <class Place>
  [[gnu::always_inline]] static VPM_HD void read_hole(const RigCamera& camera, const Place& at,
                                                      RigReading<RealOf<Place>>& reading) {
    using Real = RealOf<Place>;
    const IntOf<Real> none{};
    const HoleFits& holes = camera.silhouettes.holes;
    const auto [is_in_image, u, v] = camera.image.project(at);
    const IntOf<Real> number =
        gather(holes.numbers, truncated(v + 0.5) * camera.image.width + truncated(u + 0.5));
    const MaskOf<Real> is_hole =
        is_in_image & negated(reading.is_measured) & widen_mask(number > 0);
    if (!any(is_hole)) return;
    const auto get = [&](float HoleFit::*member) {
      return gather(number > 0 ? number - 1 : none,
                    [&](std::int32_t i) { return holes.fits[i].*member; });
    };
    const Intrinsics& k = camera.image.k;
    const auto [inverse_depth, per_u, per_v] = evaluate<Real>(get, u, v);
    const MaskOf<Real> is_fit = is_hole & (inverse_depth > 0);
    // The plane through that point: inverse depth times depth is 1 on it.
    const Place along{k.fx * per_u, k.fy * per_v,
                      inverse_depth - per_u * (u - k.cx) - per_v * (v - k.cy)};
    const Real per_length = quotient(1, square_root(squared_norm(along)));
    const Real foot_depth = quotient(1, inverse_depth);
    reading.known |= is_fit;
    reading.is_silhouette |= is_fit;
    reading.distance = is_fit ? (1 - inverse_depth * at.z) * per_length : reading.distance;
    reading.nearer = is_fit ? get(&HoleFit::nearer) * at.z * per_length : reading.nearer;
    reading.foot_depth = is_fit ? foot_depth : reading.foot_depth;
    reading.below = is_fit ? at.z - foot_depth : reading.below;
    reading.normal = choose(is_fit, -per_length * along, reading.normal);
    if (!any(reading.is_measured)) reading.pixel = none;
  }

  // Takes the nearest silhouette for the surface where that is nearer to a place: from a free
  // place, the side of what hides what is beyond; from a place behind, the way out to what was seen
  // beyond it.
  template <class Place>
  [[gnu::always_inline]] static VPM_HD void read_silhouette(const RigCamera& camera,
                                                            const Place& at,
                                                            RigReading<RealOf<Place>>& reading) {
    using Real = RealOf<Place>;
    using Mask = MaskOf<Real>;
    const IntOf<Real> number = gather(camera.silhouettes.nearest, reading.pixel);
    Mask may_matter = reading.is_measured & widen_mask(number > 0);
    if (!any(may_matter)) return;
    const IntOf<Real> none{}, index = number > 0 ? number - 1 : none;  // the first where none is
    const Real zero{}, depth = get(camera, index, &SilhouettePixel::depth);
    const Mask is_behind = reading.distance < 0;
    // The pixel of the place is on the far side if its surface is a step beyond the silhouette.
    const Mask is_far =
        camera.image.inverse_depth(reading.pixel, none) * depth < 1 - DepthSampler::kJump;
    may_matter &= is_behind ^ is_far;  // on different sides of the silhouette
    if (!any(may_matter)) return;
    const Beside<Real> beside = find_beside(camera, at, reading, index);
    may_matter &= beside.may_matter;
    if (!any(may_matter)) return;
    Real out_u{}, out_v{};
    const Real aside = offset_aside(camera, at, beside, is_behind, out_u, out_v);
    const Real before = aside > 0 ? aside : zero, deeper = depth - at.z;
    const Real below = deeper > 0 ? deeper : zero;
    const Real to_side = square_root(before * before + below * below);
    const Real to_beyond = aside < 0 ? aside : zero;
    const Mask is_nearer = may_matter & negated(is_behind) & is_far & (to_side < reading.distance);
    const Mask is_way = may_matter & is_behind & negated(is_far) &
                        (get(camera, beside.index, &SilhouettePixel::beyond) > at.z) &
                        (to_beyond > reading.distance);
    const Mask is_beside = is_nearer | is_way;
    if (!any(is_beside)) return;
    reading.is_silhouette |= is_beside;
    reading.distance = is_nearer ? to_side : is_way ? to_beyond : reading.distance;
    reading.below = is_way ? zero : reading.below;
    const Real length = square_root(squared_norm(at));
    const Place ray{quotient(at.x, length), quotient(at.y, length), quotient(at.z, length)};
    const Place out{out_u, out_v, zero};
    reading.normal =
        choose(is_beside, normalized_or_zero(out - dot(out, ray) * ray), reading.normal);
  }

  // Finds how far places are from silhouette pixels.
  template <class Place>
  [[gnu::always_inline]] static VPM_HD Beside<RealOf<Place>> find_beside(
      const RigCamera& camera, const Place& at, const RigReading<RealOf<Place>>& reading,
      const IntOf<RealOf<Place>>& index) {
    using Real = RealOf<Place>;
    const Intrinsics& k = camera.image.k;
    Beside<Real> beside;
    beside.index = index;
    beside.height = k.fx / k.fy;
    const Real per_depth = quotient(1, at.z);
    beside.u = k.fx * (at.x * per_depth) + k.cx - get(camera, beside.index, &SilhouettePixel::u);
    beside.v = (k.fy * (at.y * per_depth) + k.cy - get(camera, beside.index, &SilhouettePixel::v)) *
               beside.height;
    beside.offset = square_root(beside.u * beside.u + beside.v * beside.v);
    // offset_aside() is at least this far from 0, by the same operations.
    const double most_to_border = 0.5 * (beside.height > 1 ? beside.height : 1);
    const Real least = (kCornerCosine * beside.offset - most_to_border) * at.z * (1 / k.fx);
    beside.may_matter = (beside.offset <= 1) | (least < absolute(reading.distance));
    return beside;
  }

  // Returns how far a place is aside of the border of the nearest silhouette pixel, m: negative on
  // the side of what is nearer. `out_u` and `out_v` receive the direction out of that.
  template <class Place>
  [[gnu::always_inline]] static VPM_HD RealOf<Place> offset_aside(
      const RigCamera& camera, const Place& at, const Beside<RealOf<Place>>& beside,
      const MaskOf<RealOf<Place>>& is_behind, RealOf<Place>& out_u, RealOf<Place>& out_v) {
    using Real = RealOf<Place>;
    const Real zero{}, one = zero + 1;
    out_u = get(camera, beside.index, &SilhouettePixel::out_u);
    out_v = get(camera, beside.index, &SilhouettePixel::out_v);
    const Real along = beside.u * out_u + beside.v * out_v;
    const Real side = is_behind ? -one : one;
    // At the corner of a silhouette, or beside something thin, the nearest pixel's direction is
    // wrong: the direction is that from the pixel to the place.
    const MaskOf<Real> is_corner =
        (side * along < kCornerCosine * beside.offset) & (beside.offset > 1);
    const Real by = beside.offset > 1 ? beside.offset : one;
    out_u = is_corner ? quotient(side * beside.u, by) : out_u;
    out_v = is_corner ? quotient(side * beside.v, by) : out_v;
    const Real to_border = 0.5 * (1 + (beside.height - 1) * (out_v * out_v));  // of the pixel
    return ((is_corner ? side * beside.offset : along) - to_border) * at.z *
           (1 / camera.image.k.fx);
  }

  // Returns a number of silhouette pixels.
  template <class Int>
  [[gnu::always_inline]] static VPM_HD auto get(const RigCamera& camera, const Int& index,
                                                float SilhouettePixel::*member) {
    const SilhouettePixel* const pixels = camera.silhouettes.pixels;
    return gather(index, [&](std::int32_t k) { return pixels[k].*member; });
  }
};

}  // namespace vpm
