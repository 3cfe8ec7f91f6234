// Measures by how much several cameras' images disagree about the surfaces that they all see:
// noise, and what is wrong with the cameras' poses.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "libvpm/scene/rig/rig_surface.h"

namespace vpm {

// Distances per depth, m/m: noise and the width of pixels grow with depth, and so does what an
// angle is wrong by; a unit of length decides nothing.
struct RigAgreement {
  // For cameras i and j, at i * count + j, the distance within which their readings may be of one
  // surface: six times the robust deviation of the nearer half of what both see clearly; at least
  // the width of the coarser one's pixels, at most that of as many as silhouettes reach over. For i
  // = j it is the width of the camera's pixels.
  std::vector<double> of_pairs;
  double most = 0;  // the greatest of these
  // Depth by which something is well before a place: no camera that sees a surface of one piece of
  // the tool at less than a grazing angle has it so far before the piece.
  double well_before = 0;
};

RigAgreement agreement_of(std::span<const RigCamera> cameras);

// Returns the robust deviation, per depth, of the nearer half of what two cameras both see clearly;
// nothing if that is little.
std::optional<double> deviation_between(const RigCamera& one, const RigCamera& other);

}  // namespace vpm
