// Measures how far each level of a tool model is from the solid itself.
#pragma once

#include <vector>

#include "libvpm/model/solid.h"
#include "libvpm/model/tool_model.h"

namespace vpm {

// Number of cuts of each kind, planes and balls.
inline constexpr std::size_t kCalibrationCuts = 192;
// Radius of the balls, in longest sides of the solid's bounding box.
inline constexpr double kCalibrationBall = 1.5;

// Returns one entry per level for ToolModel::calibration. Cuts the solid by planes and balls at all
// depths and compares each level's samples with the exact volume. Half the directions are random;
// half are normals of the solid's faces, mostly near the face, where errors of neighbouring samples
// add up. The error is the same whether a ball is obstacle or free space. Distances to the cut are
// exact, so errors from a camera's pixels and noise are not included.
//
// `solid` must be the one that the model was made of, else Error(refused) is thrown. Overlapping
// shells count once. Same bytes for any thread count.
std::vector<LevelError> calibrate(const ToolModel& model, const Solid& solid);

}  // namespace vpm
