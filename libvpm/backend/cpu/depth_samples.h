// Samples a camera's surface at many places at once by vectors. Results have the bits of
// DepthSurface::sample and DepthSurface::closest_normal. Host only.
#pragma once

#include <span>

#include "libvpm/model/tool_model.h"
#include "libvpm/scene/depth/depth_surface.h"

namespace vpm {

// Holds a place and its surface sample, surface frame.
struct PlaceSample {
  Vec3 x;
  SurfaceSample on_surface;
};

struct SurfaceOfSample {
  std::uint32_t sample = 0;  // index
  PlaceSample at;
};

void sample_four(const DepthSurface& surface, const Vec3 (&places)[4],
                 SurfaceSample (&on_surface_at)[4]);

// Samples the surface for those tool samples that it reaches: whose distance is less than their
// radius. Writes them in order to `on_surface_at` and returns their number.
std::uint32_t sample_surface(const DepthSurface& surface, const Pose& to_surface,
                             std::span<const CellSample> samples, SurfaceOfSample* on_surface_at);

// Writes DepthSurface::closest_normal of each sampled place.
void closest_normals(const DepthSurface& surface, std::span<const PlaceSample> places,
                     Vec3* normals);

}  // namespace vpm
