// Readings of a camera's surface at many places together. They have the bits of
// DepthSurface::read and DepthSurface::closest_normal, which read one, and come sooner: by vectors,
// for whatever vectors the CPU has. On the host.
#pragma once

#include <span>

#include "libvpm/model/tool_model.h"
#include "libvpm/scene/depth/depth_surface.h"

namespace vpm {

// A place and what was read there.
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

// Readings of those samples that the surface reaches: whose distance is less than their radius. In
// their order; returns how many. `readings` has room for all.
std::uint32_t sample_surface(const DepthSurface& surface, const Pose& to_surface,
                             std::span<const CellSample> samples, SurfaceOfSample* on_surface_at);

// DepthSurface::closest_normal of each; their readings are known.
void closest_normals(const DepthSurface& surface, std::span<const PlaceSample> places,
                     Vec3* normals);

}  // namespace vpm
