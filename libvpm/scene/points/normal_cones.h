// Bounds the normals of disks in each node of their PointTree by cones, for host and device.
#pragma once

#include <cstdint>
#include <vector>

#include "libvpm/core/vec3.h"

namespace vpm {

struct DiskSurface;

// Holds the cones of four nodes: a normal's cosine with the axis is at least `cosine`.
struct alignas(16) ConeQuad {
  float axis[3][4] = {};
  float cosine[4] = {};

  void set(std::uint32_t k, Vec3f axis_of_k, float cosine_of_k) {
    axis[0][k] = axis_of_k.x, axis[1][k] = axis_of_k.y, axis[2][k] = axis_of_k.z;
    cosine[k] = cosine_of_k;
  }
};

// Holds plain pointers to the cones of a tree.
struct NormalCones {
  const ConeQuad* quads = nullptr;  // node k is entry k % 4 of quad k / 4

  // True only if each normal of a node surely has a cosine above `least` with the unit vector n.
  VPM_HD bool are_within(std::uint32_t node, Vec3 n, double least) const {
    constexpr double kSlack = 1e-3;  // far above the rounding of float axes
    const ConeQuad& quad = quads[node / 4];
    const std::uint32_t k = node % 4;
    const double cosine = quad.cosine[k],
                 off = dot({quad.axis[0][k], quad.axis[1][k], quad.axis[2][k]}, n);
    // Uses cos(a + b) = cos a cos b - sin a sin b; the last term is known by its square.
    const double above = off * cosine - (least + kSlack);
    return off > 0 && cosine > 0 && above > 0 &&
           above * above > (1 - off * off) * (1 - cosine * cosine);
  }
};

// Returns the cones of all normals that the disks know, for the nodes that searches step to.
std::vector<ConeQuad> cones_of(const DiskSurface& disks);

}  // namespace vpm
