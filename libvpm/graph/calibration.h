// How far each level of a tool model is from the solid itself.
#pragma once

#include <vector>

#include "libvpm/model/solid.h"
#include "libvpm/model/tool_model.h"

namespace vpm {

// Cuts of each kind that a calibration makes.
inline constexpr std::size_t kCalibrationCuts = 192;
// Radius of the balls, in longest sides of the solid's box.
inline constexpr double kCalibrationBall = 1.5;

// Cuts the solid by planes and balls at all depths and compares each level's samples with the exact
// volume: one entry per level, for ToolModel::calibration. Half of the directions are random, half
// are normals of the solid's own faces, most of them near the face, where the errors of
// neighbouring samples add up. A ball may be the obstacle or the free space: the error is the same.
// The distance to the cut is exact here, so what a camera adds by its pixels and its noise is not
// in it.
//
// `solid` must be the one that the model was made of; another one is refused (Error(refused)).
// Where its parts overlap they count once. Same bytes for any thread count.
std::vector<LevelError> calibrate(const ToolModel& model, const Solid& solid);

}  // namespace vpm
