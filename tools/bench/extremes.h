// Cases at the edge of what is possible, each with the only right answer: a number near a known
// truth, or a refusal in words.
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

// A measured quantity, mostly a part of the tool's volume, and how far it may be from the truth.
struct Deviation {
  double value = 0, truth = 0, bound = 0;
};

struct ExtremeCase {
  std::string group, name;
  bool refused = false;            // whether a message is the right answer
  std::function<Deviation()> run;  // what it says does not matter where `refused`
};

// Cases that ask this device. From mesh text to wrench at scales of 1e-9 to 1e9 m, log-uniform, the
// seed being the index.
std::vector<ExtremeCase> extreme_scales(const Device& device, bool quick);
// Clouds and images: far origins, few, many and coinciding points, odd normals, odd depths.
std::vector<ExtremeCase> extreme_clouds(const Device& device, bool quick);
// Tools of one to a million spheres, of very different spheres, needles and sheets; poses.
std::vector<ExtremeCase> extreme_tools(const Device& device, bool quick);

// The part of the tool's volume; not a number if anything in the result is none, or no volume.
double sound_fraction(const Result& result);

// Points that are planes to any tool here: their disks are huge.
Cloud plane_points(std::vector<Vec3f> positions, std::vector<Vec3f> normals);

// A cube of edge 2 at the origin with n^3 equal spheres that touch.
Packing lattice_packing(int n);

// The part of the tool's volume that is inside, by a query on this device.
double ask(const Device& device, const ToolModel& tool, const Cloud& cloud, Measure measure,
           const Pose& pose = {});

// The surface, or an image that a camera took, with estimated normals.
Camera small_camera();  // 160 x 120 pixels, at the world's origin
Cloud see(const synthetic::Surface& surface, const Camera& camera);

}  // namespace vpm::bench
