// Runs the refined measure on a device for bodies of the tests.
#pragma once

#include "libvpm/include/vpm/query_types.h"
#include "tests/measure/analytic_bodies.h"

namespace vpm {
struct Pose;
struct ToolModel;
}  // namespace vpm

namespace vpm::testing {

// Returns the answer of the first device for the finest level of a tool before one body, whose
// frame is the world's.
Result run_on_device(const ToolModel& tool, const HalfSpace& body, const Pose& pose);
Result run_on_device(const ToolModel& tool, const Both<HalfSpace, HalfSpace>& body,
                     const Pose& pose);

}  // namespace vpm::testing
