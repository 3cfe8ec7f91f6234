// Cases at the edge of what is possible. Each has one right answer: a number near a known truth, or
// a refusal with a message.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "libvpm/cloud/cloud.h"
#include "libvpm/cloud/normals.h"
#include "libvpm/model/packing.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/synthetic/surface.h"

namespace vpm::bench {

// Difference of a measured quantity, mostly a fraction of the tool's volume, from the truth, and
// its bound.
struct Deviation {
  double value = 0, truth = 0, bound = 0;
};

struct ExtremeCase {
  std::string group, name;
  bool refused = false;            // true if the right answer is a message
  std::function<Deviation()> run;  // its value does not matter if `refused`
};

// Returns cases from mesh text to wrench at scales of 1e-9 to 1e9 m, log-uniform, seeded by their
// index, queried on `device`.
std::vector<ExtremeCase> extreme_scales(const Device& device, bool quick);
// Returns cases of clouds and images: far origins, few, many and coinciding points, odd normals,
// odd depths.
std::vector<ExtremeCase> extreme_clouds(const Device& device, bool quick);
// Returns cases of tools with one to a million spheres, with very different radii, needles and
// sheets, and of odd poses.
std::vector<ExtremeCase> extreme_tools(const Device& device, bool quick);

// Returns the penetrating fraction of the tool; NaN if the result lacks a volume or holds a number
// that is not finite.
double sound_fraction(const Result& result);

// Returns a cloud whose disks are so large that each point is a plane to any tool here.
Cloud plane_points(std::vector<Vec3f> positions, std::vector<Vec3f> normals);

// Returns a cube of edge 2 at the origin with n^3 equal spheres that touch.
Packing lattice_packing(int n);

// Returns the penetrating fraction of the tool, by a query on `device`.
double ask(const Device& device, const ToolModel& tool, const Cloud& cloud, Measure measure,
           const Pose& pose = {});

// Returns the camera of the image cases: 160 x 120 pixels, at the world's origin.
Camera small_camera();
Cloud see(const synthetic::Surface& surface, const Camera& camera);

}  // namespace vpm::bench
