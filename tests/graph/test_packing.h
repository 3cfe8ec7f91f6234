// Simple packings and solids for tests of the graph.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "libvpm/model/packing.h"

namespace vpm::test {

// Makes pseudorandom numbers that are the same on every machine (SplitMix64).
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : state_(seed) {}
  double uniform(double low, double high);
  Vec3 direction();

 private:
  std::uint64_t state_;
};

struct Shape {
  std::string name;
  Solid solid;
  std::function<double(Vec3)> depth;  // at most the distance from the surface, positive inside
};

Shape convex(std::string name, Solid solid);
Shape cube();
Shape tetrahedron();
Shape octahedron();
Shape torus();
Shape plate();  // a fiftieth of its length thick
Shape wedge();  // a prism whose sharpest edge has 15 degrees
Shape ball();   // of 1280 facets

// Packs greedily, largest sphere first, with centres on a lattice of about `candidates` points in
// the box.
Packing greedy_packing(const Shape& shape, std::size_t spheres, double candidates = 125000);

// Returns the exact volume of the part of the solid where dot(normal, x) < offset.
double volume_below(const Solid& solid, Vec3 normal, double offset);

}  // namespace vpm::test
