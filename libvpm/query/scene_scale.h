// How small and how large the spheres of a tool should be for a scene: scene-scale.md derives the
// rule.
#pragma once

#include <cstddef>
#include <optional>

#include "libvpm/include/vpm/level_query.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/scene/prepared_cloud.h"

namespace vpm {

// Of the surface within kNear reaches of `place` (world), or of the whole cloud where that holds
// too few points or no place is given. `reach` is that of the tool, m. Same bits for any thread
// count and order of the points. Throws Error(refused) for clouds of fewer than kFewestPoints
// points.
inline constexpr double kNear = 1.5;
inline constexpr std::size_t kFewestPoints = 32;
SceneScale scene_scale(const PreparedCloud& cloud, double reach, std::optional<Vec3> place);

// Index of the finest level without spheres below scale.smallest_radius(), or the coarsest level
// where all have such; where the model is calibrated, of the coarsest one whose mean error is that
// of the former within kNoBetter.
inline constexpr double kNoBetter = 1.25;
std::size_t level_for_scene(const ToolModel& tool, const SceneScale& scale);

}  // namespace vpm
