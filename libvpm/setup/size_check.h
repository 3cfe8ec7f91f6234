// Finds tools and scenes whose sizes cannot both be right, which mistakes of units cause.
#pragma once

#include <vpm/remark.h>

#include <optional>
#include <span>

#include "libvpm/model/tool_model.h"
#include "libvpm/setup/checked_scene.h"

namespace vpm {

// Returns a warning, with the unit that is likely, if a tool is much larger than all that the scene
// shows, or much smaller than its points can show; nothing for a scene without points. Sizes that
// are only unusual pass: a wand before a near wall, a hammer against a scanned screw, a needle in a
// room, a hand tool in a hall.
std::optional<Remark> improbable_sizes(std::span<const ToolModel* const> tools,
                                       const CheckedScene& scene, bool are_frames);

}  // namespace vpm
