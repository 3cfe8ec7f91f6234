// Computes the measure as printed, for host and device: sums over the points in a sphere, the entry
// test, and what spheres add to the result. README.md numbers the steps.
#pragma once

#include <cstdint>

#include "libvpm/measure/tool_piece.h"
#include "libvpm/model/sphere.h"

namespace vpm {

// Returns the volume of a cap of height `height` (0 to 2) of the unit ball (the paper's section 4).
VPM_HD constexpr double unit_cap_volume(double height) {
  return kPi * height * height * (3 - height) / 3;
}

// Sums over the points in a sphere, in fixed point (steps 2 and 3). Terms are local to the sphere
// and below 4 pi / 3 < 8, so 2^kPointBits points stay below 2^(3 + 24 + 36) = 2^63.
struct PaperContact {
  static constexpr int kPointBits = 24;
  using Sum = FixedSum<36>;

  std::int64_t points = 0, cap = 0, normal[3] = {}, offset[3] = {};

  // Returns the sums of one point at x with the unit normal n, in tool axes.
  VPM_HD static PaperContact of_point(const Sphere& s, Vec3 x, Vec3 n) {
    const Vec3 from_center = (x - s.center) / s.radius;
    const double depth = 1 + dot(n, from_center);  // r - d, d = n . (c - p), in radii
    const double height = depth < 0 ? 0 : depth > 2 ? 2 : depth;
    return {1,
            Sum::round(unit_cap_volume(height)),
            {Sum::round(n.x), Sum::round(n.y), Sum::round(n.z)},
            {Sum::round(from_center.x), Sum::round(from_center.y), Sum::round(from_center.z)}};
  }

  // Calls add(sum, term) for each sum of `total`. An atomic `add` lets many threads do so at once.
  template <class Add>
  VPM_HD void add_to(PaperContact& total, const Add& add) const {
    add(total.points, points);
    add(total.cap, cap);
    for (int k = 0; k < 3; ++k) add(total.normal[k], normal[k]);
    for (int k = 0; k < 3; ++k) add(total.offset[k], offset[k]);
  }

  VPM_HD Vec3 mean_normal() const { return normalized_or_zero(to_vector(normal)); }
  VPM_HD double mean_cap(const Sphere& s) const {
    return s.radius * s.radius * s.radius * (static_cast<double>(cap) * per_point());
  }
  VPM_HD Vec3 mean_place(const Sphere& s) const {
    return s.center + s.radius * (per_point() * to_vector(offset));
  }

 private:
  VPM_HD double per_point() const { return 1 / (Sum::kOne * static_cast<double>(points)); }
  VPM_HD static Vec3 to_vector(const std::int64_t (&v)[3]) {
    return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
  }
};

// True if a boundary sphere lets a neighbour in that is not boundary (step 4).
VPM_HD inline bool lets_in(const Sphere& boundary, Vec3 normal, const Sphere& neighbor) {
  return !(dot(normal, neighbor.center - boundary.center) > -neighbor.radius);
}

// Holds the units of a ToolSum's terms: volume, m^3, centre of mass, and radius, m, of the tool.
struct ToolMeasures {
  double volume = 0;
  Vec3 center_of_mass;
  double radius = 0;
};
inline ToolMeasures measures_of(const ToolModel& tool) {
  return {tool.volume, tool.center_of_mass, tool.radius};
}

// Adds the mean cap of a boundary sphere (step 6). Caps and spheres lie in disjoint spheres inside
// the solid, so the bounds of ToolSum hold.
VPM_HD inline void add_boundary(const ToolMeasures& tool, const Sphere& s,
                                const PaperContact& contact, Vec3 normal, ToolSum& sum) {
  sum.add(contact.mean_cap(s) / tool.volume, normal,
          (contact.mean_place(s) - tool.center_of_mass) / tool.radius);
}
VPM_HD inline void add_inside(const ToolMeasures& tool, const Sphere& s, Vec3 normal,
                              ToolSum& sum) {
  sum.add(volume(s) / tool.volume, normal, (s.center - tool.center_of_mass) / tool.radius);
}

}  // namespace vpm
