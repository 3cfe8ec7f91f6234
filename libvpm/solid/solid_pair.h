// What two solids share at a pose: volume, its gradient, and the wrench that parts them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "libvpm/solid/pair_order.h"
#include "libvpm/solid/solid_surface.h"
#include "libvpm/solid/surface_pair.h"

namespace vpm {

// A connected part of what two solids share, or several, as in SharedSolid; the torque is about the
// centroid of all that is shared.
struct SharedContact {
  double volume = 0;
  Vec3 centroid, area, force, torque;
  double depth = 0;           // greatest, of one surface below the other, m; 0 without force
  std::uint32_t patches = 1;  // that are summed
};

// All in world axes and the world's frame.
struct SharedSolid {
  double volume = 0;  // m^3
  Vec3 centroid;      // m; 0 where the volume is 0
  // ∫ n dA over the part of the first solid's surface inside the other, m^2: the rate at which the
  // volume grows where the first moves; and ∫ (x - centroid) cross n dA, m^3, where it turns about
  // the centroid.
  Vec3 area, turn;
  // Force on the first solid, m^3 (times a stiffness in N/m^3: N), and its torque about the
  // centroid, m^4. The other's are the opposite.
  Vec3 force, torque;
  // How far the boundary of what is shared is from closed: |∫ n dA| relative to the square, and
  // |∫ x cross n dA| to the cube, of the smaller reach; the larger of both.
  double closure = 0;
  int attempts = 0;  // with different jitter
  // The contacts asked for, largest first, and one with all others; they add up to the above, to
  // rounding. Empty if none were asked for.
  std::vector<SharedContact> contacts;

  Vec3 torque_about(Vec3 x) const { return torque + cross(centroid - x, force); }
};

// Returns how far faces that are flush may come to lie inside each other, m, where the larger reach
// is so long and the places so far from an origin: both surfaces are moved by the jitter, and one
// by a small motion if the boundary does not close at once, and places are rounded.
double depth_of_touch(double reach, double distance_from_origin);

// Two solids in the one order in which a pair is computed, and what follows from sums over their
// surfaces. Immutable.
class OrderedPair {
 public:
  static constexpr int kAttempts = 6;  // with different jitter, at most

  // Shares the surfaces.
  OrderedPair(std::shared_ptr<const SolidSurface> a, std::shared_ptr<const SolidSurface> b);

  const SolidSurface& first() const { return *first_; }
  const SolidSurface& second() const { return *second_; }

  // Whether the surfaces are `turned` into the one order, the first's pose with the origin at its
  // centre of mass, and that of the second in the first's frame.
  struct Place {
    bool is_turned;
    Pose first, relative;
  };
  // Takes poses that map the surfaces' meshes to the world.
  Place place(const Pose& pose_a, const Pose& pose_b) const;
  // Returns whether the solids are near enough to share anything.
  bool may_meet(const Place& place) const;
  // Returns the relative pose with the small motion of an attempt.
  Pose moved(const Place& place, int attempt) const;
  // Returns how far sums over both surfaces are from closed, as SharedSolid::closure.
  double closure(const std::array<InnerSurface, 2>& inner) const;
  // Returns how many times as large as the other the larger solid is.
  double unlikeness() const;
  // Throws Error(refused) of sums that miss to close by so much.
  [[noreturn]] void refuse_unclosed(double gap) const;
  // Returns the volume that the solids may seem to share though they only touch, m^3, where the
  // area of one inside the other is so large: a layer, and the rounding of parts of triangles.
  double volume_of_touch(double area, const Place& place) const;
  // Returns what the parts of the two surfaces enclose, in the first's frame, with the torque about
  // the centroid. 0 without volume.
  SharedSolid shared_of(const std::array<InnerSurface, 2>& inner) const;
  // Returns that for the world, and for a in place of the first.
  static SharedSolid in_world(SharedSolid shared, const Place& place);

 private:
  PairOrder order_;
  std::shared_ptr<const SolidSurface> first_, second_;
};

// Pair of solids, prepared to be asked at many poses. Belongs to one thread.
class SolidPair {
 public:
  // Shares the surfaces.
  SolidPair(std::shared_ptr<const SolidSurface> a, std::shared_ptr<const SolidSurface> b)
      : pair_(std::move(a), std::move(b)), surfaces_(pair_.first(), pair_.second()) {}

  // Measures at poses that map the surfaces' meshes to the world; both must be rigid. a and b
  // swapped give the same bits, with signs of area, turn, force and torque turned, since a pair is
  // computed in one order. Leaves force and torque 0 without `with_force`, which needs surfaces
  // with depth. Solids that only touch share nothing: what is no thicker on average than
  // depth_of_touch(), or of the size of rounding. Lists `contacts` contacts, and the sum of all
  // others; none are found for 0. Throws Error(refused) where no attempt closes, and where solids
  // more unlike than kMostUnlike share something.
  SharedSolid measure(const Pose& pose_a, const Pose& pose_b, bool with_force = true,
                      std::uint32_t contacts = 0);

  // Largest SharedSolid::closure that is given.
  static constexpr double kMaxClosure = 1e-8;
  // Solids are refused if one has more than so many times the reach of the other. The jitter moves
  // the faces of the larger by half of kJitter times its reach. At this limit that changes the
  // volume which it shares with a cube standing on it by .87e-6 of the cube's; with thin solids by
  // more, since they have more area for their volume.
  static constexpr double kMostUnlike = 0x1p17;

 private:
  SharedSolid closed(const OrderedPair::Place& place, bool with_force, bool with_contacts);
  std::vector<SharedContact> contacts(std::uint32_t count, Vec3 about) const;

  OrderedPair pair_;
  SurfacePair surfaces_;
};

}  // namespace vpm
