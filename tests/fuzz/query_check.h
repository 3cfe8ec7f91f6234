// Asks queries of what readers accept.
#pragma once

#include "libvpm/cloud/cloud.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/scene/prepared_cloud.h"

namespace vpm::fuzz {

// Asks in every way at this pose; results must be finite, and fractions of 0 to 1.
void expect_sound_answers(const ToolModel& tool, const PreparedCloud& cloud, const Pose& pose);

// Asks where the cube of formats/golden touches the cloud, unless the cloud is large.
void expect_sound_answers(const Cloud& cloud);

// Asks the tool in both clouds of formats/golden.
void expect_sound_answers(const ToolModel& tool);

}  // namespace vpm::fuzz
