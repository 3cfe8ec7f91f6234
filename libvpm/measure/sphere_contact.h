// What two balls share: what the measure as printed sums between solids, for host and device
// (README.md).
#pragma once

#include "libvpm/measure/paper_contact.h"
#include "libvpm/model/sphere.h"

namespace vpm {

struct SphereContact {
  double volume = 0;  // m^3; 0 if they touch or are apart
  Vec3 centroid;      // of what is shared
  Vec3 normal;        // from b's centre to a's, unit length; 0 where they coincide
  bool is_a_inside = false, is_b_inside = false;  // all of it in the other

  // Both spheres are in one frame. What they share is a cap of each, which meet in the circle where
  // the spheres cross; its centroid is the mean of the centres by their caps, since the moments of
  // the caps about them cancel.
  VPM_HD static SphereContact of(const Sphere& a, const Sphere& b) {
    const Vec3 apart = a.center - b.center;
    const double distance = norm(apart), overlap = a.radius + b.radius - distance;
    SphereContact contact;
    if (!(overlap > 0)) return contact;
    contact.normal = normalized_or_zero(apart);
    contact.is_a_inside = distance <= b.radius - a.radius;
    contact.is_b_inside = distance <= a.radius - b.radius;
    if (contact.is_a_inside || contact.is_b_inside) {
      const Sphere& smaller = contact.is_a_inside ? a : b;
      contact.volume = vpm::volume(smaller), contact.centroid = smaller.center;
      return contact;
    }
    const double half = overlap / (2 * distance);
    const double of_a = cap(a, half * (distance + b.radius - a.radius)),
                 of_b = cap(b, half * (distance + a.radius - b.radius));
    contact.volume = of_a + of_b;
    contact.centroid = a.center - of_b / contact.volume * apart;
    return contact;
  }

 private:
  VPM_HD static double cap(const Sphere& s, double height) {
    return s.radius * s.radius * s.radius * unit_cap_volume(height / s.radius);
  }
};

}  // namespace vpm
