// A tool whose truth needs no integration: a cube of equal spheres, each with a small cube for its
// cell.
#pragma once

#include "libvpm/cloud/cloud.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/synthetic/scenes.h"

namespace vpm::testing {

// Returns a cube of edge length `edge` centred at the origin, with `spheres` per edge and `samples`
// per edge of each cell.
ToolModel lattice_cube(double edge, std::uint32_t spheres, std::uint32_t samples);

// Returns places in such a cube, `per_edge` along each edge.
std::vector<Vec3> places_in_cube(double edge, int per_edge);

// Returns the cloud that the scene's camera sees, with the surface's own normals.
Cloud see(const synthetic::Scene& scene);

// Returns what a Kinect measures of a scene in a small image, whose numbers of pixels are no
// multiples of each other.
struct SmallImage {
  Camera camera;
  DepthImage depth;
};
SmallImage small_noisy_image(const char* scene);

// Returns the cloud of a flat wall at a depth of 1 m, 1 m wide, of which a rectangle of pixels was
// not measured: kHole of them along each axis.
Cloud wall_with_hole();
struct PixelSpan {
  std::uint32_t begin, end;
  bool holds(double pixel) const { return pixel >= begin - 0.5 && pixel < end - 0.5; }
};
inline constexpr PixelSpan kHoleAcross{60, 100}, kHoleDown{30, 90};

// Returns a generic rotation, so that nothing is aligned by chance.
Rotation generic_rotation();

Cloud permuted(const Cloud& cloud);  // the points in another order
Cloud doubled(const Cloud& cloud);   // every point twice

}  // namespace vpm::testing
