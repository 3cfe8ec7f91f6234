// Runs the refined measure on a device for bodies of the tests.
#pragma once

#include "libvpm/measure/body_sum.h"
#include "tests/measure/analytic_bodies.h"

namespace vpm {
struct Pose;
struct ToolModel;
}  // namespace vpm

namespace vpm::testing {

// Returns what the first device finds for the finest level of a tool before one body, whose
// frame is the world's.
BodySum run_on_device(const ToolModel& tool, const HalfSpace& body, const Pose& pose);
BodySum run_on_device(const ToolModel& tool, const SeenHalfSpace& body, const Pose& pose);
BodySum run_on_device(const ToolModel& tool, const Step& body, const Pose& pose);
BodySum run_on_device(const ToolModel& tool, const Both<HalfSpace, HalfSpace>& body,
                      const Pose& pose);

}  // namespace vpm::testing
