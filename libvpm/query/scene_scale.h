// Measures how large the spheres of a tool should be for a scene, as scene-scale.md derives.
#pragma once

#include <vpm/level_query.h>

#include <cstddef>
#include <optional>
#include <span>

#include "libvpm/model/tool_model.h"
#include "libvpm/scene/any_body.h"

namespace vpm {

// Returns the scale of the surface within kNear tool radii of `place` (world), or of the whole body
// where that holds too few points or no place is given. `tool_radius` is in m. The same bits for
// any thread count and order of points. Throws Error(refused) for fewer than kFewestPoints points.
inline constexpr double kNear = 1.5;
inline constexpr std::size_t kFewestPoints = 32;
SceneScale scene_scale(const AnyBody& body, double tool_radius, std::optional<Vec3> place);
// Returns that of the body of a scene whose points resolve the smallest spheres.
SceneScale scene_scale(std::span<const AnyBody> scene, double tool_radius,
                       std::optional<Vec3> place);

// Returns the index of the finest level without spheres below scale.smallest_radius(), else the
// coarsest. For a calibrated model, returns the coarsest level whose mean error is within kNoBetter
// of that level's.
inline constexpr double kNoBetter = 1.25;
std::size_t level_for_scene(const ToolModel& tool, const SceneScale& scale);

}  // namespace vpm
