// What two solids share at a pose: volume, its gradient, and the wrench that parts them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
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

// Pair of solids, prepared to be asked at many poses. Belongs to one thread.
class SolidPair {
 public:
  // Shares the surfaces.
  SolidPair(std::shared_ptr<const SolidSurface> a, std::shared_ptr<const SolidSurface> b);

  // Measures at poses that map the surfaces' meshes to the world; both must be rigid. a and b
  // swapped give the same bits, with signs of area, turn, force and torque turned, since a pair is
  // computed in one order. Leaves force and torque 0 without `with_force`, which needs surfaces
  // with depth. Lists `contacts` contacts, and the sum of all others; none are found for 0. Throws
  // Error(refused) where no attempt closes.
  SharedSolid measure(const Pose& pose_a, const Pose& pose_b, bool with_force = true,
                      std::uint32_t contacts = 0);

  // Largest SharedSolid::closure that is given.
  static constexpr double kMaxClosure = 1e-8;

 private:
  // Whether the surfaces are `turned` into the one order, and their poses with the origin at the
  // centres of mass.
  struct Order {
    bool is_turned;
    Pose first, second;
  };
  Order order(const Pose& pose_a, const Pose& pose_b) const;
  SurfacePairSums sums(const Pose& relative, bool with_force, bool with_contacts,
                       SharedSolid& shared);
  SharedSolid shared_of(const std::array<InnerSurface, 2>& inner) const;
  std::vector<SharedContact> contacts(std::uint32_t count, Vec3 about) const;
  double closure(const SurfacePairSums& sums) const;

  PairOrder order_;
  std::shared_ptr<const SolidSurface> first_, second_;  // in that order
  SurfacePair surfaces_;
};

}  // namespace vpm
