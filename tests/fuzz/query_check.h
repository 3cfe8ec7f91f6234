// Asks queries of what readers accept. Each has several ways to ask, of which a choice takes one:
// all of them together would take most of the time that fuzzing has.
#pragma once

#include "libvpm/cloud/cloud.h"
#include "libvpm/model/tool_model.h"
#include "tests/fuzz/fuzz_target.h"

namespace vpm::fuzz {

// Asks for the cube of formats/golden before the cloud or inside it, unless the cloud is large.
// Results must be finite, and fractions of 0 to 1.
void expect_sound_answers(const Cloud& cloud, Choice choice);

// Asks for the tool in one of the clouds of formats/golden.
void expect_sound_answers(const ToolModel& tool, Choice choice);

}  // namespace vpm::fuzz
